#include "lod/contact/near_faces.h"

#include <algorithm>

namespace lodestone {
namespace {

// Over the radius: so far before a face another solid is looked for, and steps of less stop nobody.
constexpr double kBefore = 0.02, kStep = 0.01;

}  // namespace

void SolidFaces::find(const PlacedSolid& solid) {
  faces.clear(), walls.clear();
  const auto add = [&](std::vector<Face>& to, const Vec3& normal, double offset) {
    const Vec3 outward = solid.orientation * normal;
    to.push_back({outward, offset + outward.dot(solid.position)});
  };
  const auto& t = solid.solid->surface;
  depth = t ? t->depth : 1e300;
  ends = t ? t->ridge : std::array<bool, 3>{};
  for (std::size_t i = 0; t && i < 3; ++i) {
    const Vec3 from = t->corner[i] - solid.solid->center,
               outward = (t->corner[(i + 1) % 3] - t->corner[i]).cross(t->normal).normalized();
    if (i == 0) add(faces, t->normal, t->normal.dot(from));
    add(walls, outward, outward.dot(from));
  }
  for (std::size_t i = 0; !t && i < solid.solid->faces.size(); ++i)
    add(faces, solid.solid->faces[i].normal, solid.solid->faces[i].offset);
}

bool SolidFaces::are_under(const Vec3& point, const Face& face, double rounding) const {
  const Vec3 foot = point - face.height_of(point) * face.normal;
  return std::ranges::all_of(bounds(), [&](const Face& f) { return f.height_of(foot) <= rounding; });
}

void NearFaces::take(std::span<const PlacedSolid> near, const Vec3& center, double radius) {
  near_ = near, center_ = center, radius_ = radius;
  if (faces_.size() < near.size()) faces_.resize(near.size());
  known_.assign(near.size(), false);
}

const SolidFaces& NearFaces::of(const PlacedSolid& solid) {
  const auto i = std::size_t(&solid - near_.data());
  if (!known_[i]) faces_[i].find(solid), known_[i] = true;
  return faces_[i];
}

// Where what is before the face's foot lies in the other solid, it leaves that towards the body; if this
// leads over the face's end, nothing is seen of the face there. (A wall goes on over the floor that it stands
// in.) Nor is of a step there, but where the other solid falls away from the end: over a ridge.
bool NearFaces::covers(const PlacedSolid& other, const SolidFaces& own, const Face& face, const Vec3& foot) {
  constexpr double kLeads = 0.05, kRidge = -0.05;  // cosines
  const SolidFaces& its = of(other);
  const Vec3 before = foot + kBefore * radius_ * face.normal;
  const double step = kStep * radius_;
  const auto is_out = [&](const Face& f) { return f.height_of(before) > 0.0; };
  if (std::ranges::any_of(its.walls, is_out)) return false;
  const Face* way_out = nullptr;
  double height = -its.depth;
  for (const Face& f : its.faces) {
    const double h = f.height_of(before);
    if (h >= step) return false;
    if (h > height && f.height_of(center_) > 0.0) height = h, way_out = &f;
  }
  if (!way_out) return false;
  const Vec3 &up = way_out->normal, out = before - height * up,
             away = (face.normal - face.normal.dot(up) * up).normalized();  // along the other's surface
  const auto leads_over = [&](const Face& end) {
    return end.normal.dot(up) > kLeads && end.height_of(out) > -step &&
           (height < 0.0 || end.normal.dot(away) > kRidge);
  };
  for (std::size_t i = 0; i < own.walls.size(); ++i)
    if (own.ends[i] && leads_over(own.walls[i])) return true;
  return own.walls.empty() &&
         std::ranges::any_of(own.faces, [&](const Face& f) { return &f != &face && leads_over(f); });
}

bool NearFaces::is_covered(const PlacedSolid& solid, const Face& face, const Vec3& place) {
  if (near_.size() < 2) return false;
  const SolidFaces& own = of(solid);
  const Vec3 foot = place - face.height_of(place) * face.normal;
  return std::ranges::any_of(near_, [&](const PlacedSolid& other) {
    // The triangles of one surface know each other.
    const bool is_one = &other == &solid || (other.part == solid.part && other.solid->surface);
    return !is_one && !other.solid->shape->sphere_radius && covers(other, own, face, foot);
  });
}

std::optional<Vec3> NearFaces::find_uncovered(const PlacedSolid& solid, const Vec3& place,
                                              const Vec3& normal) {
  constexpr double kSame = 0.999, kBeside = 0.02;  // cosines
  if (near_.size() < 2 || solid.solid->shape->sphere_radius) return normal;
  const SolidFaces& own = of(solid);
  const auto is_along = [&](const Face& f) { return f.normal.dot(normal) > kSame; };
  if (const auto along = std::ranges::find_if(own.faces, is_along); along != own.faces.end())
    return is_covered(solid, *along, place) ? std::nullopt : std::optional(normal);
  const Face* best = nullptr;
  bool any_covered = false;
  for (const Face& face : own.faces) {
    if (face.normal.dot(normal) < kBeside || face.height_of(place) < -kBefore * radius_) continue;
    if (is_covered(solid, face, place))
      any_covered = true;
    else if (!best || face.normal.dot(normal) > best->normal.dot(normal))
      best = &face;
  }
  if (!any_covered) return normal;
  return best ? std::optional(best->normal) : std::nullopt;
}

}  // namespace lodestone
