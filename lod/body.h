// What the levels share about a body: its id, its level, its definition. A body's rung is `tables`, `support`
// or full; its level is full, or statistical on the other two; a LevelChoice is what a caller asks for.
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

/// How a statistical body meets contacts. `support`: as its hull, by exact contact points and impulses.
/// `tables`: alone the same, coarser; among others as a sphere that knows the heights of its hull; with the
/// paper's drawn responses only as published (TablesOptions).
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
  /// m/s, > 0: what is slower is still. On the statistical rungs at a bounding radius R of .2 m, times
  /// √(R/.2 m) at others; of full bodies as it is, for the centre of mass and for the farthest point about
  /// it.
  double speed = 0.05;
  /// s, ≥ 0: so long it must be still among other bodies; alone, or full, five times as long.
  double time = 0.1;
};

struct BodyDefinition {
  std::shared_ptr<const Shape> shape = {};
  RigidState state = {};
  MaterialId material = 0;
  /// kg, 1e-6 … 1e12; else the material's density times the shape's volume, in the same range.
  std::optional<double> mass = {};
  LevelChoice level = LevelChoice::automatic;
  double importance = 1.0;  ///< > 0, scales the distance within which the policy makes it full
  /// Between which the policy keeps it, the least no higher than the greatest; a `level` that names a rung
  /// goes before them.
  Rung least_rung = Rung::tables, greatest_rung = Rung::full;
  BodyProperties properties = {};  ///< what it meets and what acts on it
  std::uintptr_t user_data = 0;    ///< the caller's own: a pointer or a number
  bool events = false;             ///< its contacts make events, see events.h
};

}  // namespace lodestone
