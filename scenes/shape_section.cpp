// The `shapes:` of a scene.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string_view>

#include "reference/error.h"
#include "scenes/scene_sections.h"

namespace lodestone {

void fail_at(const YamlCursor& place, const InputError& error, const std::string& hint) {
  const std::string what = error.what();
  const std::size_t found = what.find("found "), expected = what.find(", expected ");
  if (found == what.npos) place.fail(what, "a mesh that bounds a solid" + hint);
  const std::string name = what.substr(0, found >= 2 ? found - 2 : 0);
  const std::string defect = what.substr(found + 6, expected == what.npos ? what.npos : expected - found - 6);
  place.fail(name.empty() ? defect : fmt::format("{} ({})", defect, name),
             (expected == what.npos ? "a mesh that bounds a solid" : what.substr(expected + 11)) + hint);
}

namespace {

/// Three numbers are the diagonal, three rows the whole tensor.
Mat3 load_inertia(const YamlCursor& key) {
  const std::vector<YamlCursor> items = key.items(3);
  if (!items[0].is_list()) return key.vector(kPositive).asDiagonal();
  Mat3 inertia;
  for (int row = 0; row < 3; ++row) inertia.row(row) = items[std::size_t(row)].vector();
  return inertia;
}

std::string words_of_moments(const Mat3& inertia) {
  if (inertia != inertia.transpose()) return ", which is not symmetric";
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  return fmt::format(", of moments {:g}, {:g} and {:g}", moments[0], moments[1], moments[2]);
}

MassOverride load_mass_override(const YamlCursor& place, const std::optional<double>& mass) {
  MassOverride result;
  if (auto key = place.find("center_of_mass_m")) result.center_of_mass_m = key->vector();
  if (auto key = place.find("inertia")) {
    if (!mass) key->fail("an inertia without a mass", "mass_kg beside it");
    const Mat3 inertia = load_inertia(*key);
    if (!is_possible_inertia(inertia / *mass))
      key->fail("an impossible inertia" + words_of_moments(inertia),
                "a symmetric, positive one with I1 + I2 ≥ I3 (kg m²)");
    result.inertia_per_mass_m2 = inertia / *mass;
  }
  return result;
}

/// At the key of the centre of mass where that is what is wrong, else at `part`, what the shape is made of.
[[noreturn]] void fail_at_part(const YamlCursor& place, const YamlCursor& part, const InputError& error,
                               const std::string& hint = "") {
  const auto center = place.find("center_of_mass_m");
  const bool is_center = std::string_view(error.what()).find("center of mass: found ") != std::string::npos;
  fail_at(center && is_center ? *center : part, error, hint);
}

void check_inertia_at(const YamlCursor& key, const Shape& shape) {
  try {
    check_inertia(shape);
  } catch (const InputError& error) {
    fail_at(key, error);
  }
}

Shape load_mesh_shape(const YamlCursor& place, ShapeOptions options, const MassOverride& mass,
                      bool has_mass) {
  place.expect_keys(
      {"mesh", "size_m", "faces", "obtain", "material", "mass_kg", "inertia", "center_of_mass_m"});
  const YamlCursor mesh = place.at("mesh");
  const std::string name = mesh.text();
  if (auto key = place.find("size_m")) options.size_m = key->number(kLength);
  if (auto key = place.find("faces")) options.faces = int(key->integer(4, 10'000'000));
  std::string hint;
  if (auto key = place.find("obtain")) hint = ". To obtain it: " + key->text();
  MeshReport report;
  try {
    Shape shape = make_mesh_shape(name, options, mass, &report);
    if (report.closed() || has_mass) return shape;
  } catch (const InputError& error) {
    fail_at_part(place, mesh, error, hint);
  }
  place.fail(fmt::format("a mesh with {} open edges and no mass", report.open_edges),
             "a closed mesh, or mass_kg");
}

/// The solid that `place` describes with a key such as `box_m`; none where it names a mesh.
std::optional<Shape> load_solid(const YamlCursor& place, const MassOverride& mass) {
  for (const SolidForm& form : solid_forms()) {
    const auto key = place.find(form.scene_key);
    if (!key) continue;
    place.expect_keys({form.scene_key, "material", "mass_kg", "inertia", "center_of_mass_m"});
    const std::vector<double> lengths = form.length_count == 1
                                            ? std::vector{key->number(kPositive)}
                                            : key->numbers(std::size_t(form.length_count), kPositive);
    try {
      return make_solid(form.kind, lengths, mass);
    } catch (const InputError& error) {
      fail_at_part(place, *key, error);
    }
  }
  return std::nullopt;
}

SceneShape load_shape(const std::string& name, const YamlCursor& place, const Scene& scene,
                      const ShapeOptions& search) {
  place.expect_keys({"mesh", "box_m", "sphere_m", "l_m", "plate_m", "needle_m", "size_m", "faces", "obtain",
                     "material", "mass_kg", "inertia", "center_of_mass_m"});
  place.one_key_of({"mesh", "box_m", "sphere_m", "l_m", "plate_m", "needle_m"});
  SceneShape result{.material = load_material_id(place, scene)};
  if (auto key = place.find("mass_kg")) result.mass = key->number(kMass);
  const MassOverride mass = load_mass_override(place, result.mass);
  std::optional<Shape> shape = load_solid(place, mass);
  if (!shape) {
    shape = load_mesh_shape(place, search, mass, result.mass.has_value());
    if (const std::string mesh_name = place.at("mesh").text(); mesh_name != "bunny")
      result.file = find_mesh_file(mesh_name, search);
  }
  shape->name = name;
  if (auto key = place.find("inertia")) check_inertia_at(*key, *shape);
  result.shape = std::make_shared<const Shape>(std::move(*shape));
  return result;
}

}  // namespace

std::map<std::string, SceneShape> load_shapes(const YamlCursor& root, const Scene& scene,
                                              const ShapeOptions& search) {
  std::map<std::string, SceneShape> shapes;
  if (auto section = root.find("shapes"))
    for (const auto& [name, place] : section->entries())
      shapes.emplace(name, load_shape(name, place, scene, search));
  return shapes;
}

}  // namespace lodestone
