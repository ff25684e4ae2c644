// What all rungs share about a body: its id, its rung, and the definition that it is made from. A body's rung
// is `tables`, `support` or full; its level is full, or statistical on the other two rungs; a LevelChoice is
// what a caller asks for.
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

/// Names a body of a Manager; it stays the same when the body changes its rung. Zero is null. The id of a
/// removed body is never valid again.
struct BodyId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(BodyId, BodyId) = default;
};

/// Names bodies of a Manager that change rung together (Manager::make_group). Zero is null.
struct GroupId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(GroupId, GroupId) = default;
};

/// Whether a body is simulated by ODE (`full`), or on one of the two cheaper rungs.
enum class Level : std::uint8_t { statistical, full };

/// How a statistical body answers contacts. `support`: as its hull, with exact contact points and impulses.
/// `tables`: the same, but coarser, while it touches no other body; among others as a sphere that knows the
/// heights of its hull. Only the published model (TablesOptions) draws responses as the paper does.
enum class StatisticalModel : std::uint8_t { tables, support };

/// How a body is simulated, from the cheapest to the most accurate: by one of the two statistical models, or
/// by ODE.
enum class Rung : std::uint8_t { tables, support, full };
inline constexpr std::size_t kRungs = 3;
inline constexpr Rung rung_of(StatisticalModel model) {
  return model == StatisticalModel::tables ? Rung::tables : Rung::support;
}
inline constexpr Level level_of(Rung rung) { return rung == Rung::full ? Level::full : Level::statistical; }
std::string_view name_of(Rung rung);  ///< "tables", "support", "full"

/// A change of one body's rung; `from` and `to` differ.
struct RungChange {
  BodyId body;
  Rung from = Rung::support, to = Rung::support;
  friend bool operator==(const RungChange&, const RungChange&) = default;
};

/// Who decides a body's rung. `automatic`: the policy. `statistical`: the policy, but only between the two
/// statistical rungs. Any other: the caller, who names the rung; it holds until he chooses again.
enum class LevelChoice : std::uint8_t { automatic, full, statistical, support, tables };

/// When a body falls asleep: once it has been still for a while. Gravity g below 9.81 m/s² lowers the speeds,
/// and lengthens the time.
struct SleepThresholds {
  /// m/s, > 0: a body slower than this is still. For a full body this is the speed of its centre of mass and
  /// of its farthest point about that. For a statistical body that touches others it holds at a bounding
  /// radius R of .2 m; at others it is multiplied by √(R/.2 m). A statistical body that touches no other is
  /// still while its kinetic energy is less than (speed/.05)² · 2.5e-4 m g R.
  double speed = 0.05;
  /// s, ≥ 0: how long a statistical body that touches others must be still. A full one, or one that touches
  /// no other, must be still five times as long. Both times are multiplied by √(R/.3 m · 9.81 m/s²/g),
  /// limited to 1 … 10.
  double time = 0.1;
};

/// What a body is made from; the ranges of `state` are those of Manager::add_body.
struct BodyDefinition {
  std::shared_ptr<const Shape> shape = {};  ///< not null; any number of bodies may share one
  RigidState state = {};
  MaterialId material = 0;
  /// kg, 1e-6 … 1e12; none: the material's density times the shape's volume, which must be in that range.
  std::optional<double> mass = {};
  LevelChoice level = LevelChoice::automatic;
  double importance = 1.0;  ///< > 0: the policy treats the body as so many times as near
  /// The rungs between which the policy keeps it; the least must not be above the greatest. A `level` that
  /// names a rung overrides them.
  Rung least_rung = Rung::tables, greatest_rung = Rung::full;
  BodyProperties properties = {};  ///< what it meets and what acts on it
  std::uintptr_t user_data = 0;    ///< for the caller: a pointer or a number
  bool events = false;             ///< whether its contacts make events (events.h)
};

}  // namespace lodestone
