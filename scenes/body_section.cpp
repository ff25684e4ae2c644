// The `bodies:` of a scene, scatters expanded.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "scenes/ground_heights.h"
#include "scenes/scatter.h"
#include "scenes/scene_sections.h"

namespace lodestone {
namespace {

constexpr NumberRange kSpeed{-1e6, 1e6};

/// One entry of the list: one body, or a scatter of bodies that are alike.
struct BodyEntry {
  YamlCursor place;
  SceneBody body = {};
  bool has_orientation = false;
  std::optional<Scatter> scatter = {};
  bool on_ground = false, lying = false;
  int count() const { return scatter ? scatter->count : 1; }
  double radius() const { return body.definition.shape->radius; }
};

const std::array<std::string, 5> kLevelNames{"auto", "full", "statistical", "support", "tables"};

LevelChoice load_level(const YamlCursor& key) { return LevelChoice(key.choice(kLevelNames)); }

Rung load_rung(const YamlCursor& key) {
  static const std::array<std::string, 3> kNames{"tables", "support", "full"};
  return Rung(key.choice(kNames));
}

struct RungRange {
  Rung least, greatest;
};

/// That a body of that level may be on.
RungRange rungs_of(LevelChoice level) {
  switch (level) {
    case LevelChoice::full:
      return {Rung::full, Rung::full};
    case LevelChoice::support:
      return {Rung::support, Rung::support};
    case LevelChoice::tables:
      return {Rung::tables, Rung::tables};
    case LevelChoice::statistical:
      return {Rung::tables, Rung::support};
    case LevelChoice::automatic:
      break;
  }
  return {Rung::tables, Rung::full};
}

ScatterRegion load_region(const YamlCursor& scatter) {
  if (scatter.one_key_of({"box_m", "cylinder"}) == "box_m") {
    const YamlCursor key = scatter.at("box_m");
    const std::vector<YamlCursor> corners = key.items(2);
    const ScatterBox box{corners[0].vector(), corners[1].vector()};
    if ((box.high.array() < box.low.array()).any())
      key.fail("a second corner below the first", "[[low x, y, z], [high x, y, z]]");
    return box;
  }
  const YamlCursor key = scatter.at("cylinder");
  key.expect_keys({"base_m", "radius_m", "height_m"});
  return ScatterCylinder{key.at("base_m").vector(), key.at("radius_m").number(kNotNegative),
                         key.at("height_m").number(kNotNegative)};
}

Scatter load_scatter(const YamlCursor& place, std::uint64_t otherwise_seed,
                     const SceneLoadSettings& settings) {
  place.expect_keys({"count", "box_m", "cylinder", "seed", "spacing_m", "on_ground", "lying"});
  Scatter scatter{.region = load_region(place), .seed = otherwise_seed};
  scatter.count = int(place.at("count").integer(1, settings.max_bodies));
  if (auto key = place.find("seed")) {
    // Added to the run's seed, not replaced by it, so that scatters given the same seed stay alike.
    scatter.seed =
        std::uint64_t(key->integer(0, std::numeric_limits<std::int64_t>::max())) + settings.seed.value_or(0);
  }
  if (auto key = place.find("spacing_m")) scatter.spacing_m = key->number(kNotNegative);
  return scatter;
}

const SceneShape& find_shape(const YamlCursor& key, const std::map<std::string, SceneShape>& shapes) {
  std::vector<std::string> names;
  for (const auto& [name, shape] : shapes) names.push_back(name);
  return shapes.at(names[key.choice(names)]);
}

void load_motion(const YamlCursor& place, BodyEntry& entry) {
  RigidState& state = entry.body.definition.state;
  if (auto key = place.find("position_m")) state.position = key->vector();
  if (auto key = place.find("orientation")) {
    state.orientation = key->rotation();
    entry.has_orientation = true;
  }
  if (auto key = place.find("velocity_m_per_s")) state.velocity = key->vector(kSpeed);
  if (auto key = place.find("angular_velocity_rad_per_s")) state.angular_velocity = key->vector(kSpeed);
}

/// A level that names a rung goes before the range, and what sleeps lies still: neither is left to do
/// nothing.
void check_agrees(const YamlCursor& place, const SceneBody& body) {
  const BodyDefinition& definition = body.definition;
  const RungRange asked = rungs_of(definition.level);
  if (asked.greatest < definition.least_rung || asked.least > definition.greatest_rung)
    place.at("level").fail(fmt::format("{}, out of {} … {}", name_of(definition.level),
                                       name_of(definition.least_rung), name_of(definition.greatest_rung)),
                           "one from least_rung to greatest_rung");
  if (!body.asleep) return;
  for (const auto& [key, velocity] : {std::pair("velocity_m_per_s", definition.state.velocity),
                                      {"angular_velocity_rad_per_s", definition.state.angular_velocity}})
    if (!velocity.isZero(0.0)) place.at(key).fail("a body that moves and is asleep", "one of the two");
}

BodyEntry load_entry(const YamlCursor& place, int index, const Scene& scene,
                     const std::map<std::string, SceneShape>& shapes, const SceneLoadSettings& settings) {
  place.expect_keys({"shape", "position_m", "orientation", "velocity_m_per_s", "angular_velocity_rad_per_s",
                     "scatter", "level", "name", "material", "mass_kg", "importance", "asleep", "least_rung",
                     "greatest_rung"});
  place.one_key_of({"position_m", "scatter"});
  const SceneShape& shape = find_shape(place.at("shape"), shapes);
  BodyEntry entry{.place = place};
  BodyDefinition& body = entry.body.definition;
  body.shape = shape.shape;
  body.material = load_material_id(place, scene, shape.material);
  body.mass = shape.mass;
  load_motion(place, entry);
  if (auto key = place.find("mass_kg")) body.mass = key->number(kMass);
  check_mass_at(place.at("shape"), body, scene);
  if (auto key = place.find("importance")) body.importance = key->number(kPositive);
  if (auto key = place.find("level")) body.level = load_level(*key);
  if (auto key = place.find("least_rung")) body.least_rung = load_rung(*key);
  if (auto key = place.find("greatest_rung")) {
    body.greatest_rung = load_rung(*key);
    if (body.greatest_rung < body.least_rung)
      key->fail(key->found(), fmt::format("at least least_rung ({})", name_of(body.least_rung)));
  }
  if (auto key = place.find("name")) entry.body.name = key->text();
  if (auto key = place.find("asleep")) entry.body.asleep = key->truth();
  check_agrees(place, entry.body);
  if (auto scatter = place.find("scatter")) {
    entry.scatter = load_scatter(*scatter, scene.step.seed + std::uint64_t(index), settings);
    if (auto key = scatter->find("on_ground")) entry.on_ground = key->truth();
    if (auto key = scatter->find("lying")) entry.lying = key->truth();
    if (entry.lying && entry.on_ground) scatter->at("lying").fail("lying beside on_ground", "one of them");
  }
  return entry;
}

std::vector<BodyEntry> load_entries(const YamlCursor& list, const Scene& scene,
                                    const std::map<std::string, SceneShape>& shapes,
                                    const SceneLoadSettings& settings) {
  std::vector<BodyEntry> entries;
  std::int64_t bodies = std::int64_t(scene.bodies.size());
  for (const YamlCursor& place : list.items()) {
    entries.push_back(load_entry(place, int(entries.size()), scene, shapes, settings));
    bodies += entries.back().count();
    if (bodies > settings.max_bodies)
      place.fail(fmt::format("{} bodies", bodies), fmt::format("at most {}", settings.max_bodies));
  }
  return entries;
}

std::optional<RigidState> lay(const GroundHeights& heights, const BodyEntry& entry, int index,
                              const Vec3& center) {
  const BodyDefinition& body = entry.body.definition;
  return heights.lay(*body.shape, body.state.orientation, scatter_turn(*entry.scatter, index), center);
}

/// Empty for bodies that are where they were drawn.
PutOnGround put_on(const GroundHeights& heights, const BodyEntry& entry) {
  if (entry.lying)
    return [&](int index, const Vec3& center) {
      const std::optional<RigidState> state = lay(heights, entry, index, center);
      return state ? std::optional(state->position) : std::nullopt;
    };
  if (!entry.on_ground) return {};
  return [&](int, const Vec3& center) -> std::optional<Vec3> {
    const std::optional<double> highest = heights.highest_under(center, entry.radius());
    if (!highest) return std::nullopt;
    return Vec3(center + (*highest + entry.radius()) * Vec3::UnitZ());
  };
}

void expand_scatter(const BodyEntry& entry, std::span<const KeepAbove> planes, const GroundHeights& heights,
                    PlacedSpheres& placed, std::vector<SceneBody>& bodies) {
  const Scatter& scatter = *entry.scatter;
  PutOnGround put = put_on(heights, entry);
  bool has_ground = !put;  // or needs none
  if (put)
    put = [&has_ground, find = std::move(put)](int index, const Vec3& center) {
      const std::optional<Vec3> found = find(index, center);
      has_ground = has_ground || found;
      return found;
    };
  const std::vector<Vec3> centers = place_scatter(scatter, entry.radius(), planes, placed, put);
  if (!has_ground)
    entry.place.at("scatter")
        .at(entry.lying ? "lying" : "on_ground")
        .fail(
            entry.lying ? "no ground below the region that they could lie on" : "no ground below the region",
            "some");
  if (int(centers.size()) < scatter.count)
    entry.place.at("scatter").fail(
        fmt::format("{} bodies of radius {:.3g} m", scatter.count, entry.radius()),
        fmt::format("at most the {} that found room without overlap (a larger region, or fewer)",
                    centers.size()));
  for (int i = 0; i < scatter.count; ++i) {
    SceneBody body = entry.body;
    RigidState& state = body.definition.state;
    state.position = centers[std::size_t(i)];
    if (entry.lying)
      state.orientation = lay(heights, entry, i, state.position)->orientation;
    else if (!entry.has_orientation)
      state.orientation = scatter_orientation(scatter, i);
    if (!body.name.empty()) body.name += fmt::format("[{}]", i);
    bodies.push_back(std::move(body));
  }
}

std::vector<KeepAbove> planes_of(const Scene& scene) {
  std::vector<KeepAbove> planes;
  for (const SceneGround& ground : scene.ground)
    if (const auto* plane = std::get_if<GroundPlane>(&ground))
      planes.push_back({plane->normal, plane->offset_m});
  return planes;
}

}  // namespace

std::string_view name_of(LevelChoice level) { return kLevelNames[std::size_t(level)]; }

void check_mass_at(const YamlCursor& place, const BodyDefinition& body, const Scene& scene) {
  try {
    check_mass(body.mass.value_or(scene.materials[body.material].density * body.shape->volume));
  } catch (const InputError& error) {
    fail_at(place, error);
  }
}

void add_bodies(const YamlCursor& root, Scene& scene, const std::map<std::string, SceneShape>& shapes,
                const SceneLoadSettings& settings) {
  const std::vector<BodyEntry> entries = load_entries(root.at("bodies"), scene, shapes, settings);
  double largest = 1e-4;
  for (const BodyEntry& entry : entries) largest = std::max(largest, entry.radius());
  for (const SceneBody& body : scene.bodies) largest = std::max(largest, body.definition.shape->radius);
  PlacedSpheres placed(largest);
  for (const SceneBody& body : scene.bodies)
    placed.add(body.definition.state.position, body.definition.shape->radius);
  for (const BodyEntry& entry : entries)
    if (!entry.scatter) placed.add(entry.body.definition.state.position, entry.radius());
  const std::vector<KeepAbove> planes = planes_of(scene);
  const GroundHeights heights(scene.ground);
  for (const BodyEntry& entry : entries) {
    if (entry.scatter)
      expand_scatter(entry, planes, heights, placed, scene.bodies);
    else
      scene.bodies.push_back(entry.body);
  }
}

}  // namespace lodestone
