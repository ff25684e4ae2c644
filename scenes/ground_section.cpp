// The `ground:` of a scene.
#include <algorithm>
#include <iterator>

#include "lod/manager/checks.h"
#include "scenes/scene_sections.h"
#include "scenes/terrain.h"

namespace lodestone {
namespace {

GroundMesh load_ground_mesh(const YamlCursor& place, const ShapeOptions& search) {
  place.expect_keys({"mesh", "size_m", "position_m", "material"});
  const YamlCursor key = place.at("mesh");
  const std::string name = key.text();
  const auto size = place.find("size_m"), position = place.find("position_m");
  const double size_m = size ? size->number(kLength) : 0.0;
  const Vec3 position_m = position ? position->vector() : Vec3::Zero();
  try {
    const std::filesystem::path file = find_mesh_file(name, search);
    GroundMesh ground{.mesh = load_mesh(file, {.untrusted = search.untrusted}), .file = file};
    if (size) ground.mesh = scale_to_size(std::move(ground.mesh), size_m);
    for (Vec3& vertex : ground.mesh.vertices) vertex += position_m;
    check_ground_mesh(ground.mesh);
    return ground;
  } catch (const InputError& error) {
    fail_at(key, error);
  }
}

GroundPlane load_ground_plane(const YamlCursor& plane) {
  plane.expect_keys({"normal", "offset_m"});
  GroundPlane ground;
  if (auto key = plane.find("normal")) ground.normal = key->direction();
  if (auto key = plane.find("offset_m")) ground.offset_m = key->number();
  return ground;
}

GroundBox load_ground_box(const YamlCursor& box) {
  box.expect_keys({"sides_m", "position_m", "orientation"});
  const YamlCursor sides = box.at("sides_m");
  GroundBox ground{
      .sides_m = sides.vector(kPositive), .position_m = Vec3::Zero(), .orientation = Quat::Identity()};
  try {
    check_box_sides(ground.sides_m);
  } catch (const InputError& error) {
    fail_at(sides, error);
  }
  if (auto key = box.find("position_m")) ground.position_m = key->vector();
  if (auto key = box.find("orientation")) ground.orientation = key->rotation();
  return ground;
}

Hill load_hill(const YamlCursor& place) {
  place.expect_keys({"height_m", "length_m", "crest_m"});
  Hill hill{.height_m = place.at("height_m").number(), .length_m = {0, 0}};
  const std::vector<double> lengths = place.at("length_m").numbers(2, kLength);
  hill.length_m = {lengths[0], lengths[1]};
  if (auto key = place.find("crest_m")) {
    const std::vector<double> crest = key->numbers(2, {});
    hill.crest_m = {crest[0], crest[1]};
  }
  return hill;
}

/// Rows from the least y on, each from the least x on.
std::vector<double> load_heights(const YamlCursor& key, int columns, int rows) {
  std::vector<double> heights;
  for (const YamlCursor& row : key.items(std::size_t(rows)))
    for (const double height : row.numbers(std::size_t(columns), {})) heights.push_back(height);
  return heights;
}

GroundMesh load_terrain(const YamlCursor& place) {
  constexpr std::int64_t kMostCells = 1000;
  place.expect_keys({"cells", "size_m", "position_m", "hills", "heights_m"});
  TerrainGrid grid;
  const std::vector<YamlCursor> cells = place.at("cells").items(2);
  grid.cells = {int(cells[0].integer(1, kMostCells)), int(cells[1].integer(1, kMostCells))};
  const std::vector<double> size = place.at("size_m").numbers(2, {1e-2, 1e5});
  grid.size_m = {size[0], size[1]};
  if (auto key = place.find("position_m")) grid.middle_m = key->vector();
  const YamlCursor key = place.at(place.one_key_of({"hills", "heights_m"}));
  std::vector<double> heights;
  if (place.find("heights_m")) {
    heights = load_heights(key, grid.cells[0] + 1, grid.cells[1] + 1);
  } else {
    std::vector<Hill> hills;
    for (const YamlCursor& hill : key.items()) hills.push_back(load_hill(hill));
    heights = heights_of(grid, hills);
  }
  GroundMesh terrain{.mesh = make_terrain(grid, heights)};
  try {
    check_ground_mesh(terrain.mesh);
  } catch (const InputError& error) {
    fail_at(key, error);
  }
  return terrain;
}

std::vector<GroundBox> load_stairs(const YamlCursor& place) {
  place.expect_keys({"steps", "rise_m", "run_m", "width_m", "position_m", "turn_deg"});
  Stairs stairs;
  stairs.steps = int(place.at("steps").integer(1, 1000));
  stairs.rise_m = place.at("rise_m").number(kLength);
  stairs.run_m = place.at("run_m").number(kLength);
  stairs.width_m = place.at("width_m").number(kLength);
  if (auto key = place.find("position_m")) stairs.position_m = key->vector();
  if (auto key = place.find("turn_deg")) stairs.turn_deg = key->number({-360, 360});
  return make_stairs(stairs);
}

/// Stairs are several parts, all else is one.
std::vector<SceneGround> load_ground_parts(const YamlCursor& place, const Scene& scene,
                                           const ShapeOptions& search) {
  place.expect_keys({"plane", "box", "mesh", "terrain", "stairs", "size_m", "position_m", "material"});
  const std::string_view kind = place.one_key_of({"plane", "box", "mesh", "terrain", "stairs"});
  if (kind != "mesh") place.expect_keys({kind, "material"});
  std::vector<SceneGround> parts;
  if (kind == "plane")
    parts.push_back(load_ground_plane(place.at(kind)));
  else if (kind == "box")
    parts.push_back(load_ground_box(place.at(kind)));
  else if (kind == "terrain")
    parts.push_back(load_terrain(place.at(kind)));
  else if (kind == "mesh")
    parts.push_back(load_ground_mesh(place, search));
  else
    for (const GroundBox& step : load_stairs(place.at(kind))) parts.push_back(step);
  for (SceneGround& ground : parts)
    std::visit([&](auto& part) { part.material = load_material_id(place, scene); }, ground);
  return parts;
}

}  // namespace

std::vector<SceneGround> load_ground(const YamlCursor& root, const Scene& scene, const ShapeOptions& search) {
  std::vector<SceneGround> ground;
  if (auto section = root.find("ground"))
    for (const YamlCursor& place : section->items())
      std::ranges::move(load_ground_parts(place, scene, search), std::back_inserter(ground));
  return ground;
}

}  // namespace lodestone
