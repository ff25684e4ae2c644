#include "reference/shape.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/error.h"
#include "reference/hull/convex_pieces.h"

namespace lodestone {
namespace {

/// What the hash covers is rounded to this much of the radius, so that copies at another scale agree in spite
/// of rounding. Finer than single precision, in which ODE has its meshes.
constexpr double kHashQuantum = 0x1p-26;

/// In units of kHashQuantum.
std::int64_t round_ratio(double ratio) { return std::llround(ratio / kHashQuantum); }

void require_solid(const std::string& name, const MeshReport& report, const MassOverride& mass) {
  if (report.closed() || (mass.center_of_mass_m && mass.inertia_per_mass_m2)) return;
  const auto [count, kind] =
      report.open_edges > 0
          ? std::pair(report.open_edges, "open edges (with one face only)")
          : std::pair(report.non_manifold_edges, "non-manifold edges (with more than two faces)");
  throw InputError(fmt::format(
      "{}: found {} {}, expected a closed mesh, or both a centre of mass and an inertia given for it", name,
      count, kind));
}

/// Measured, then overridden. The mass of an open mesh is spread over its hull's volume.
MassProperties find_mass_properties(const Mesh& mesh, const Hull& hull, bool closed,
                                    const MassOverride& given) {
  MassProperties mass = measure_mass_properties(closed ? mesh : Mesh{hull.vertices, hull.faces});
  if (given.center_of_mass_m) mass.center_of_mass = *given.center_of_mass_m;
  if (given.inertia_per_mass_m2) mass.inertia_per_mass = *given.inertia_per_mass_m2;
  return mass;
}

bool is_inside(const Hull& hull, const Vec3& point) {
  for (const auto& [a, b, c] : hull.faces) {
    const Vec3 normal = (hull.vertices[b] - hull.vertices[a]).cross(hull.vertices[c] - hull.vertices[a]);
    if (normal.dot(point - hull.vertices[a]) >= 0.0) return false;
  }
  return true;
}

void require_possible(const std::string& name, const MassProperties& mass, const Hull& hull) {
  const Vec3& center = mass.center_of_mass;
  if (!center.allFinite() || !is_inside(hull, center))
    throw InputError(
        fmt::format("{}: center of mass: found ({:g}, {:g}, {:g}) m, expected a point inside the mesh's hull",
                    name, center.x(), center.y(), center.z()));
  if (!is_possible_inertia(mass.inertia_per_mass))
    throw InputError(name +
                     ": inertia: found one that no body can have, expected a symmetric positive definite "
                     "matrix with I1 + I2 ≥ I3");
}

bool is_convex(const Mesh& mesh, const Hull& hull) {
  constexpr double kSameVolume = 1e-6;
  const double hull_volume = measure_mass_properties(Mesh{hull.vertices, hull.faces}).volume;
  return measure_mass_properties(mesh).volume > (1.0 - kSameVolume) * hull_volume;
}

double greatest_distance(std::span<const Vec3> points) {
  double greatest = 0.0;
  for (const Vec3& point : points) greatest = std::max(greatest, point.norm());
  return greatest;
}

double least_distance_of_faces(const Hull& hull) {
  double least = std::numeric_limits<double>::max();
  for (int face = 0; face < int(hull.faces.size()); ++face)
    least = std::min(least, hull.face_normals[face].dot(hull.vertices[hull.faces[face][0]]));
  return least;
}

double longest_side(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return box.sizes().maxCoeff();
}

std::uint64_t hash_content(const Shape& shape) {
  std::vector<std::int64_t> content;
  const auto add = [&](double ratio) { content.push_back(round_ratio(ratio)); };
  for (const Vec3& vertex : shape.mesh.vertices)
    for (double coordinate : vertex) add(coordinate / shape.radius);
  for (const auto& face : shape.mesh.faces) content.insert(content.end(), face.begin(), face.end());
  for (double moment : shape.inertia_per_mass.reshaped()) add(moment / (shape.radius * shape.radius));
  content.push_back(shape.sphere_radius.has_value());
  return XXH3_64bits(content.data(), content.size() * sizeof(content[0]));
}

/// None where one of them is no shape by itself, such as a step smaller than any shape may be.
std::vector<Shape> make_pieces(const Shape& shape) try {
  std::vector<Shape> pieces;
  for (const Hull& hull : find_convex_pieces(shape.mesh, shape.hull))
    pieces.push_back(make_shape(shape.name + " piece", {hull.vertices, hull.faces}));
  return pieces;
} catch (const InputError&) {
  return {};
}

/// From vertices already about the centre of mass.
void finish(Shape& shape) {
  shape.support_map = SupportMap(shape.hull);
  shape.inverse_inertia_per_mass = shape.inertia_per_mass.inverse();
  shape.radius = greatest_distance(shape.hull.vertices);
  shape.tips = TipMap(shape.hull, shape.radius);
  shape.inner_radius = least_distance_of_faces(shape.hull);
  shape.size = longest_side(shape.hull.vertices);
  shape.content_hash = hash_content(shape);
}

}  // namespace

Shape make_shape(std::string name, Mesh mesh, const MassOverride& mass, MeshReport* report) {
  MeshReport found;
  Shape shape;
  shape.mesh = repair_mesh(std::move(mesh), name, &found);
  require_solid(name, found, mass);
  try {
    shape.hull = make_hull(shape.mesh.vertices);
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.what());
  }
  const MassProperties properties = find_mass_properties(shape.mesh, shape.hull, found.closed(), mass);
  require_possible(name, properties, shape.hull);

  shape.name = std::move(name);
  shape.volume = properties.volume;
  shape.convex = found.closed() && is_convex(shape.mesh, shape.hull);
  shape.center_of_mass_in_mesh = properties.center_of_mass;
  shape.inertia_per_mass = properties.inertia_per_mass;
  for (Vec3& vertex : shape.mesh.vertices) vertex -= properties.center_of_mass;
  transform_hull(shape.hull, properties.center_of_mass, 1.0);
  finish(shape);
  if (found.closed() && !shape.convex) shape.pieces = make_pieces(shape);
  if (report) *report = found;
  return shape;
}

Shape make_sphere_shape(double radius_m) {
  Shape shape;
  shape.name = "sphere";
  shape.mesh = repair_mesh(make_sphere(radius_m), shape.name);
  shape.hull = make_hull(shape.mesh.vertices);
  shape.convex = true;
  shape.volume = 4.0 / 3.0 * std::numbers::pi * radius_m * radius_m * radius_m;
  shape.inertia_per_mass = 0.4 * radius_m * radius_m * Mat3::Identity();
  shape.sphere_radius = radius_m;
  finish(shape);
  shape.radius = shape.inner_radius = radius_m;
  shape.size = 2.0 * radius_m;
  return shape;
}

Shape scale_shape(const Shape& shape, double factor) {
  if (!(factor > 0.0 && std::isfinite(factor)))
    throw_input_error("scale factor", fmt::to_string(factor), "a positive, finite number");
  Shape scaled = shape;
  for (Vec3& vertex : scaled.mesh.vertices) vertex *= factor;
  transform_hull(scaled.hull, Vec3::Zero(), factor);
  scaled.volume *= factor * factor * factor;
  scaled.center_of_mass_in_mesh *= factor;
  scaled.inertia_per_mass *= factor * factor;
  scaled.inverse_inertia_per_mass /= factor * factor;
  scaled.radius *= factor;
  scaled.inner_radius *= factor;
  scaled.size *= factor;
  for (Shape& piece : scaled.pieces) piece = scale_shape(piece, factor);
  if (scaled.sphere_radius) *scaled.sphere_radius *= factor;
  return scaled;
}

Shape make_hashed_copy(const Shape& shape, double radius_m) {
  if (shape.sphere_radius) return make_sphere_shape(radius_m);
  const auto rounded = [](double value, double unit) {
    return double(round_ratio(value / unit)) * kHashQuantum;
  };
  Shape copy;
  copy.name = shape.name;
  copy.mesh = shape.mesh;
  for (Vec3& vertex : copy.mesh.vertices)
    for (double& coordinate : vertex) coordinate = rounded(coordinate, shape.radius) * radius_m;
  copy.hull = make_hull(copy.mesh.vertices);
  copy.convex = shape.convex;
  copy.volume = shape.volume * std::pow(radius_m / shape.radius, 3);
  for (int i = 0; i < 9; ++i)
    copy.inertia_per_mass(i) =
        rounded(shape.inertia_per_mass(i), shape.radius * shape.radius) * (radius_m * radius_m);
  finish(copy);
  copy.radius = radius_m;  // so that a copy's copy is the same
  copy.content_hash = shape.content_hash;
  return copy;
}

}  // namespace lodestone
