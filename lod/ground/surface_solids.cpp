#include "lod/ground/surface_solids.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "reference/mesh/mesh_edges.h"
#include "reference/mesh/rays.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr double kDepth = 0.02;  // of the solids, at most, over the diagonal of the surface's bounding box
constexpr double kBelow = 1e-9;  // over that diagonal: so far under a triangle a ray begins
constexpr double kRidgeSine = 0.05;  // an edge whose faces fall away by more than this (3°) stands out

// Of the face's area, twice.
Vec3 area_vector(const Mesh& mesh, const std::array<int, 3>& f) {
  return (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
}

// Whether the surface falls away at an edge, or ends there.
bool is_ridge(const Mesh& mesh, std::span<const EdgeUse> uses) {
  if (uses.size() != 2) return true;
  const Vec3 normal = area_vector(mesh, mesh.faces[std::size_t(uses[0].face)]).normalized();
  for (const int v : mesh.faces[std::size_t(uses[1].face)]) {
    if (v == uses[1].low || v == uses[1].high) continue;
    const Vec3& at = mesh.vertices[uses[1].low];
    const Vec3 along = (mesh.vertices[uses[1].high] - at).normalized(), way = mesh.vertices[v] - at;
    const Vec3 away = way - way.dot(along) * along;  // from the edge, however long that is
    return away.dot(normal) < -kRidgeSine * away.norm();
  }
  return true;
}

// Between the normals on both sides of an edge.
double find_cosine(const Mesh& mesh, std::span<const EdgeUse> uses) {
  if (uses.size() != 2) return -1.0;
  const auto normal = [&](const EdgeUse& use) {
    return area_vector(mesh, mesh.faces[std::size_t(use.face)]).normalized();
  };
  return normal(uses[0]).dot(normal(uses[1]));
}

// The place in `face` of the edge that it uses.
std::size_t edge_of(const std::array<int, 3>& face, const EdgeUse& use) {
  const int from = use.forward ? use.low : use.high;
  return std::size_t(std::ranges::find(face, from) - face.begin());
}

Vec3 unit_normal(const std::array<Vec3, 3>& corner) {
  return (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
}

// As shares of a triangle's corners: no likely places of others' edges.
constexpr std::size_t kPlaces = 4;
const std::array<Vec3, kPlaces>& places_within() {
  static const std::array<Vec3, kPlaces> places{Vec3(0.90, 0.06, 0.04), Vec3(0.04, 0.90, 0.06),
                                                Vec3(0.06, 0.04, 0.90), Vec3(0.35, 0.33, 0.32)};
  return places;
}

Vec3 point_in(const std::array<Vec3, 3>& corner, const Vec3& share) {
  return share[0] * corner[0] + share[1] * corner[1] + share[2] * corner[2];
}

// Of its corners, and of what lies below them.
Box bounds_of(const std::array<Vec3, 3>& corner, const std::array<Vec3, 3>& below) {
  Box box;
  for (std::size_t i = 0; i < 3; ++i) box.extend(corner[i]), box.extend(corner[i] + below[i]);
  return box;
}

}  // namespace

bool has_area(const Mesh& mesh, const std::array<int, 3>& f) {
  const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return area_vector(mesh, f).norm() > 1e-9 * longest * longest;
}

SurfaceSolids::SurfaceSolids(const Mesh& mesh) : vertices_(mesh.vertices) {
  Box box;
  for (const Vec3& v : vertices_) box.extend(v);
  size_ = box.diagonal().norm();
  depth_ = kDepth * size_;
  std::vector<std::array<bool, 3>> ridge(mesh.faces.size(), {true, true, true});
  std::vector<std::array<double, 3>> cosine(mesh.faces.size(), {-1, -1, -1});
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) {
    for (const EdgeUse& use : uses) {
      const auto face = std::size_t(use.face), edge = edge_of(mesh.faces[face], use);
      ridge[face][edge] = is_ridge(mesh, uses), cosine[face][edge] = find_cosine(mesh, uses);
    }
  });
  triangles_.reserve(mesh.faces.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i)
    if (has_area(mesh, mesh.faces[i])) triangles_.push_back({mesh.faces[i], ridge[i], cosine[i]});
  solids_ = std::make_unique<std::atomic<const GroundSolid*>[]>(size());
  std::vector<std::array<Vec3, 3>> corners;
  for (const Triangle& triangle : triangles_) corners.push_back(corners_of(triangle));
  const std::optional<OneWay> one_way = find_one_way();
  deep_ = DeepTriangles(corners, depth_, one_way);
  if (one_way) return;
  find_reversed();
  std::vector<Box> boxes;
  for (const std::array<Vec3, 3>& corner : corners)
    boxes.push_back(bounds_of(corner, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}));
  tree_ = BoxHierarchy(boxes);
}

SurfaceSolids::~SurfaceSolids() {
  for (std::size_t i = 0; i < size(); ++i) delete solids_[i].load();
}

std::array<Vec3, 3> SurfaceSolids::corners_of(const Triangle& triangle) const {
  const auto at = [&](int i) { return vertices_[std::size_t(triangle.corner[std::size_t(i)])]; };
  return {at(0), at(1), at(2)};
}

// Where a ray crosses the surface, in no order: how far along it, m, and whether it goes in there.
template <class Visit>
void SurfaceSolids::visit_crossings(const Vec3& from, const Vec3& direction, const Visit& visit) const {
  tree_.visit_along(from, direction, size_, 0.0, [&](int i) {
    const std::array<Vec3, 3> corner = corners_of(triangles_[std::size_t(i)]);
    if (const auto in = meet_front(corner, from, direction, size_))
      visit(*in, true);
    else if (const auto out = meet_back(corner, from, direction, size_))
      visit(*out, false);
  });
}

// None where a ray may meet another side of the surface.
std::optional<OneWay> SurfaceSolids::find_one_way() const {
  constexpr double kApart = 0.71;  // cosine, of 45°: of no two are the normals more than 90° apart
  OneWay way{.up = Vec3::Zero()};
  for (const Triangle& triangle : triangles_) {
    const std::array<Vec3, 3> corner = corners_of(triangle);
    way.up += (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  }
  way.up.normalize();
  for (const Triangle& triangle : triangles_)
    way.least_cosine = std::min(way.least_cosine, unit_normal(corners_of(triangle)).dot(way.up));
  return way.least_cosine > kApart ? std::optional(way) : std::nullopt;
}

// Notes those triangles that are there again, seen from the other side: sheets that are solid to both.
void SurfaceSolids::find_reversed() {
  using Corners = std::array<std::array<double, 3>, 3>;
  const auto sorted_corners = [&](const Triangle& triangle) {
    Corners sorted;
    const std::array<Vec3, 3> corner = corners_of(triangle);
    for (std::size_t i = 0; i < 3; ++i) sorted[i] = {corner[i].x(), corner[i].y(), corner[i].z()};
    std::ranges::sort(sorted);
    return sorted;
  };
  std::vector<std::pair<Corners, std::size_t>> all;
  for (std::size_t i = 0; i < size(); ++i) all.emplace_back(sorted_corners(triangles_[i]), i);
  std::ranges::sort(all);
  const auto normal_at = [&](const auto& entry) { return unit_normal(corners_of(triangles_[entry.second])); };
  for (auto run = all.begin(); run != all.end();) {
    const auto end =
        std::find_if(run, all.end(), [&](const auto& other) { return other.first != run->first; });
    const Vec3 first = normal_at(*run);
    const bool both_ways =
        std::any_of(run, end, [&](const auto& other) { return normal_at(other).dot(first) < 0.0; });
    for (; run != end; ++run) triangles_[run->second].reversed = both_ways;
  }
}

// m: from just below the surface to where a ray has left all solids that it was in there, which may overlap:
// a pedestal is let into its floor. Along a line that does not leave as many as it enters the surface is
// open, as a landscape is, or a room without an outer skin: there it is the triangle's own alone. `size_`: to
// no end.
double SurfaceSolids::find_thickness_at(const Vec3& point, const Vec3& normal) const {
  const Vec3 from = point - kBelow * size_ * normal;
  int within = 0;                                              // so many
  thread_local std::vector<std::pair<double, int>> crossings;  // m; how many more it is in from there on
  crossings.clear();
  visit_crossings(from, -normal, [&](double at, bool in) { crossings.emplace_back(at, in ? 1 : -1); });
  if (std::ranges::none_of(crossings, [](const auto& c) { return c.second < 0; })) return size_;
  visit_crossings(from, normal, [&](double, bool in) { within += in ? -1 : 1; });
  std::ranges::sort(crossings);
  const int outside = std::accumulate(crossings.begin(), crossings.end(), within,
                                      [](int sum, const auto& c) { return sum + c.second; });
  if (outside != 0) within = 1;
  for (const auto& [at, more] : crossings)
    if ((within += more) <= 0) return at;
  return size_;
}

// Whether the other side of a sheet lies in its plane all over it, however that is divided into triangles.
bool SurfaceSolids::is_backed(const std::array<Vec3, 3>& corner, const Vec3& normal) const {
  const double apart = kBelow * size_;
  return std::ranges::all_of(places_within(), [&](const Vec3& share) {
    bool there = false;
    visit_crossings(point_in(corner, share) + apart * normal, -normal,
                    [&](double at, bool in) { there = there || (!in && at <= 2.0 * apart); });
    return there;
  });
}

// m, below each corner: so that the plane through these ends lies nowhere beyond the other side, as seen by
// rays from a few places in the triangle.
std::array<double, 3> SurfaceSolids::find_thickness(const std::array<Vec3, 3>& corner, const Vec3& normal,
                                                    bool reversed) const {
  if (tree_.empty()) return {size_, size_, size_};
  constexpr double kThinnest = 2e-4;  // over the longest edge
  const std::array<Vec3, kPlaces>& places = places_within();
  const double longest = std::max(
      {(corner[1] - corner[0]).norm(), (corner[2] - corner[1]).norm(), (corner[0] - corner[2]).norm()});
  Vec3 thickness = Vec3::Constant(reversed || is_backed(corner, normal) ? 0.0 : size_);
  std::array<double, kPlaces> there;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    there[i] = find_thickness_at(point_in(corner, places[i]), normal);
    if (i < 3) thickness[int(i)] = std::min(thickness[int(i)], there[i]);
  }
  // Towards a sharp edge it goes on to shrink.
  if (*std::max_element(there.begin(), there.begin() + 3) < size_) {
    Mat3 shares;
    for (int i = 0; i < 3; ++i) shares.row(i) = places[std::size_t(i)];
    thickness = thickness.cwiseMin(shares.inverse() * Vec3(there[0], there[1], there[2])).cwiseMax(0.0);
  }
  for (std::size_t i = 0; i < kPlaces; ++i)
    if (const double at = places[i].dot(thickness); at > there[i]) thickness *= there[i] / at;
  thickness = thickness.cwiseMax(kThinnest * longest);
  return {thickness[0], thickness[1], thickness[2]};
}

GroundSolid SurfaceSolids::make(const Triangle& triangle) const {
  const std::array<Vec3, 3> corner = corners_of(triangle);
  const Vec3 normal = unit_normal(corner);
  const std::array<double, 3> thickness = find_thickness(corner, normal, triangle.reversed);
  const auto below = [&](std::size_t i) { return Vec3(-std::min(depth_, thickness[i]) * normal); };
  const std::array<Vec3, 3> down{below(0), below(1), below(2)};
  const Vec3 middle = bounds_of(corner, down).center();
  GroundSolid solid = make_ground_solid(
      make_prism_hull({corner[0] - middle, corner[1] - middle, corner[2] - middle}, down), middle);
  solid.surface =
      SurfaceTriangle{normal,          corner,    triangle.ridge,
                      triangle.cosine, thickness, std::min(depth_, *std::ranges::max_element(thickness))};
  return solid;
}

const GroundSolid& SurfaceSolids::operator[](std::size_t i) const {
  std::atomic<const GroundSolid*>& place = solids_[i];
  if (const GroundSolid* made = place.load(std::memory_order_acquire)) return *made;
  auto fresh = std::make_unique<const GroundSolid>(make(triangles_[i]));
  const GroundSolid* there = nullptr;  // of two threads one comes second, and takes the other's
  if (place.compare_exchange_strong(there, fresh.get(), std::memory_order_acq_rel)) return *fresh.release();
  return *there;
}

std::size_t SurfaceSolids::made() const {
  return std::size_t(
      std::count_if(solids_.get(), solids_.get() + size(), [](const auto& s) { return s.load(); }));
}

}  // namespace lodestone
