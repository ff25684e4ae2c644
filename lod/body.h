// What the levels share about a body: its id, its level, its definition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "reference/material.h"
#include "reference/shape.h"

namespace lodestone {

/// A body of a Manager, stable over changes of level. Zero is null; a removed body's id is never valid again.
struct BodyId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(BodyId, BodyId) = default;
};

enum class Level : std::uint8_t { statistical, full };

/// How a statistical body meets contacts: the paper's sphere with drawn responses, or ours with the exact support height and impulse.
enum class StatisticalModel : std::uint8_t { tables, support };

/// Where a body is on the ladder, from the cheapest to the truest: both statistical models, then ODE.
enum class Rung : std::uint8_t { tables, support, full };
inline constexpr std::size_t kRungs = 3;
inline constexpr Rung rung_of(StatisticalModel model) { return model == StatisticalModel::tables ? Rung::tables : Rung::support; }
inline constexpr Level level_of(Rung rung) { return rung == Rung::full ? Level::full : Level::statistical; }
std::string_view name_of(Rung rung);  ///< "tables", "support", "full"

/// Who decides a body's rung: the policy, or the caller for good. `statistical`: whichever of the two statistical rungs the policy finds.
enum class LevelChoice : std::uint8_t { automatic, full, statistical, support, tables };

struct BodyDefinition {
  std::shared_ptr<const Shape> shape = {};
  RigidState state = {};
  MaterialId material = 0;
  std::optional<double> mass = {};  ///< kg; else the material's density times the shape's volume
  LevelChoice level = LevelChoice::automatic;
  double importance = 1.0;     ///< > 0, scales the distance within which the policy makes it full
};

}  // namespace lodestone
