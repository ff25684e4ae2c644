#include "lod/callers/body_forms.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lod/callers/geom_solids.h"
#include "reference/error.h"

namespace lodestone {
namespace {

constexpr std::size_t kKept = 64;  // forms: the limbs of several kinds of ragdoll

bool has_corners(const PlacedGeom& geom) { return !geom.shape.vertices.empty(); }

// Of geoms without corners of their own.
bool are_alike(const PlacedGeom& a, const PlacedGeom& b) {
  return a.shape.kind == b.shape.kind && a.shape.sides == b.shape.sides && a.shape.radius == b.shape.radius &&
         a.shape.length == b.shape.length && a.offset == b.offset && a.turn.coeffs() == b.turn.coeffs();
}

// About `center`; none of what is flat, which can be no solid.
std::optional<Shape> make_solid(std::span<const Vec3> points, const Vec3& center) {
  try {
    return make_contact_shape(points, center);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Vec3 middle_of(std::span<const Vec3> points) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p / double(points.size());
  return middle;
}

// Each geom a convex piece, or several; of a trimesh that has no pieces, its hull.
std::vector<std::vector<Vec3>> find_pieces(std::span<const PlacedGeom> geoms,
                                           std::span<const std::shared_ptr<const GroundSolids>> solids) {
  std::vector<std::vector<Vec3>> pieces;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    const PlacedGeom& geom = geoms[i];
    const auto add_piece = [&](std::span<const Vec3> points, const Vec3& from) {
      std::vector<Vec3>& piece = pieces.emplace_back();
      for (const Vec3& p : points) piece.push_back(geom.offset + geom.turn * Vec3(from + p));
    };
    const GroundSolids* const parts = solids[i].get();
    if (geom.shape.kind == GeomKind::sphere)
      add_piece(corners_of(geom.shape), Vec3::Zero());
    else if (parts && (*parts)[0].surface)
      add_piece(geom.shape.vertices, Vec3::Zero());
    else
      for (int k = 0; parts && k < int(parts->size()); ++k)
        add_piece((*parts)[k].shape->hull.vertices, (*parts)[k].center);
  }
  return pieces;
}

std::optional<Shape> make_whole(std::span<const std::vector<Vec3>> pieces) {
  if (pieces.size() == 1) return make_solid(pieces.front(), Vec3::Zero());
  std::vector<Vec3> points;
  std::vector<Shape> solids;
  for (const std::vector<Vec3>& piece : pieces) {
    std::optional<Shape> solid = make_solid(piece, middle_of(piece));
    if (!solid) continue;
    points.insert(points.end(), piece.begin(), piece.end());
    solids.push_back(std::move(*solid));
  }
  if (solids.empty()) return std::nullopt;
  Shape shape = make_contact_shape(points, Vec3::Zero());
  if (solids.size() > 1) shape.convex = false, shape.pieces = std::move(solids);
  return shape;
}

BodyForm make_form(std::span<const PlacedGeom> geoms) {
  BodyForm form;
  for (const PlacedGeom& geom : geoms) {
    const auto solids = std::make_shared<const GroundSolids>(solids_of(geom.shape));
    form.solids.push_back(solids->size() > 0 ? solids : nullptr);
  }
  std::optional<Shape> shape = make_whole(find_pieces(geoms, form.solids));
  if (!shape) return form;
  if (const GeomShape& only = geoms.front().shape;
      geoms.size() == 1 && only.kind == GeomKind::sphere && geoms.front().offset.norm() < 1e-9 * only.radius)
    shape->sphere_radius = shape->radius = only.radius;
  form.shape = std::make_shared<const Shape>(std::move(*shape));
  return form;
}

}  // namespace

Shape make_contact_shape(std::span<const Vec3> points, const Vec3& center) {
  Shape shape;
  shape.name = "a body of the caller's";
  std::vector<Vec3> around;
  for (const Vec3& p : points) around.push_back(p - center);
  shape.hull = make_hull(around);
  shape.support_map = SupportMap(shape.hull, 8);
  shape.center_of_mass_in_mesh = center;
  shape.convex = true;
  for (const Vec3& v : shape.hull.vertices) shape.radius = std::max(shape.radius, v.norm());
  return shape;
}

BodyForm BodyForms::form_of(std::vector<PlacedGeom> geoms) {
  if (std::ranges::any_of(geoms, has_corners)) return make_form(geoms);
  const auto known = std::ranges::find_if(
      known_, [&](const Known& one) { return std::ranges::equal(one.geoms, geoms, are_alike); });
  if (known != known_.end()) {
    std::rotate(known, known + 1, known_.end());
    return known_.back().form;
  }
  if (known_.size() == kKept) known_.erase(known_.begin());
  BodyForm form = make_form(geoms);
  return known_.emplace_back(Known{std::move(geoms), std::move(form)}).form;
}

}  // namespace lodestone
