// What the levels share about a body: its id, its level, its definition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "reference/body_properties.h"
#include "reference/material.h"
#include "reference/shape.h"

namespace lodestone {

/// A body of a Manager, stable over changes of level. Zero is null; a removed body's id is never valid again.
struct BodyId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(BodyId, BodyId) = default;
};

/// Bodies of a Manager that change rung together. Zero is null.
struct GroupId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(GroupId, GroupId) = default;
};

enum class Level : std::uint8_t { statistical, full };

/// How a statistical body meets contacts: the paper's sphere with drawn responses, or ours with the exact
/// support height and impulse.
enum class StatisticalModel : std::uint8_t { tables, support };

/// Where a body is on the ladder, from the cheapest to the truest: both statistical models, then ODE.
enum class Rung : std::uint8_t { tables, support, full };
inline constexpr std::size_t kRungs = 3;
inline constexpr Rung rung_of(StatisticalModel model) {
  return model == StatisticalModel::tables ? Rung::tables : Rung::support;
}
inline constexpr Level level_of(Rung rung) { return rung == Rung::full ? Level::full : Level::statistical; }
std::string_view name_of(Rung rung);  ///< "tables", "support", "full"

/// What a step did to a body's place on the ladder.
struct RungChange {
  BodyId body;
  Rung from = Rung::support, to = Rung::support;
  friend bool operator==(const RungChange&, const RungChange&) = default;
};

/// Who decides a body's rung: the policy, or the caller for good. `statistical`: whichever of the two
/// statistical rungs the policy finds.
enum class LevelChoice : std::uint8_t { automatic, full, statistical, support, tables };

/// When a body at rest falls asleep.
struct SleepThresholds {
  /// m/s, > 0: slower is still; on the statistical rungs for a body with a bounding sphere of .2 m radius, of
  /// others in proportion to its square root.
  double speed = 0.05;
  /// s, ≥ 0: so long it must be still among other bodies; alone, or full, five times as long.
  double time = 0.1;
};

struct BodyDefinition {
  std::shared_ptr<const Shape> shape = {};
  RigidState state = {};
  MaterialId material = 0;
  std::optional<double> mass = {};  ///< kg; else the material's density times the shape's volume
  LevelChoice level = LevelChoice::automatic;
  double importance = 1.0;  ///< > 0, scales the distance within which the policy makes it full
  Rung least_rung = Rung::tables,
       greatest_rung = Rung::full;  ///< between which it is kept, unless its level is forced
  BodyProperties properties = {};   ///< what it meets and what acts on it
  std::uintptr_t user_data = 0;     ///< the caller's own: a pointer or a number
  bool events = false;              ///< its contacts make events, see events.h
};

}  // namespace lodestone
