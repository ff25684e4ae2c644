// What a program may watch a Manager by: its log, the stages of a step as zones of a profiler, and lines and
// points to draw.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

#include "lod/body.h"
#include "reference/geometry.h"

namespace lodestone {

enum class LogLevel : std::uint8_t {
  info,  ///< a signature is there; promotions that were put off
  /// Trouble that was met and mended: states recovered, contacts dropped, ODE's messages. Once, that there is
  /// no viewpoint. A cache of signatures that cannot be used.
  warning,
  error,  ///< a signature that cannot be had, before the InputError that follows
};

/// Called on the thread that steps, within step(), with one line of text. It must not change the manager.
using LogFunction = std::function<void(LogLevel, std::string_view)>;

/// Zones of a profiler, called on the thread that steps; they must not throw. `zone` is "step" for a call of
/// step(), before_world_step() or after_world_step() and else the stage of StageTimes without its "_ms":
/// "choose", "transfer", "flight", "broad_phase", "pairs", "crowd", "rest", "cross_level", "full"; the text
/// lasts. Zones lie within each other as calls do; a stage may come more than once a step.
struct ProfileHooks {
  std::function<void(std::string_view zone)> begin = {}, end = {};
};

struct DebugColor {
  float red = 1.0f, green = 1.0f, blue = 1.0f;  ///< 0 … 1
};

/// How to draw, in the world frame, m. What is empty is left out.
struct DebugDrawer {
  std::function<void(const Vec3& from, const Vec3& to, DebugColor)> line = {};
  std::function<void(const Vec3& at, DebugColor)> point = {};
};

struct DrawSettings {
  /// As their rung has them: hulls, and for `tables` the colliding sphere, as three circles.
  bool bodies = true;
  /// Between bodies, and of full ones with the ground, in the last step: a point, and a line along the
  /// normal; not those between two spheres.
  bool contacts = true;
  bool bounds = false;  ///< axis-aligned boxes around the hulls
  std::array<DebugColor, kRungs> colors{
      {{0.0f, 0.45f, 0.3f}, {0.35f, 0.7f, 0.9f}, {0.9f, 0.6f, 0.0f}}};  ///< by Rung; half as bright asleep
  DebugColor contact_color{0.9f, 0.2f, 0.2f}, bounds_color{0.5f, 0.5f, 0.5f};
  double normal_length = 0.1;  ///< m
};

}  // namespace lodestone
