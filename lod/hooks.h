// Hooks by which a program watches a Manager: its log, the stages of a step as zones of a profiler, and lines
// and points to draw.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

#include "lod/body.h"
#include "reference/geometry.h"

namespace lodestone {

enum class LogLevel : std::uint8_t {
  info,  ///< a signature is there; promotions were put off; new bodies were held back
  /// Trouble that was met and mended: states recovered, contacts dropped, messages of ODE's, uneven contacts
  /// (the names of Counters). Once, that there is no viewpoint. That the cache of signatures cannot be used,
  /// or that another process is measuring the signature.
  warning,
  error,  ///< a signature cannot be had; an InputError follows
};

/// Called with one line of text, on the thread that steps or restores, within that call. It must not change
/// the manager.
using LogFunction = std::function<void(LogLevel, std::string_view)>;

/// The zones of a profiler: `begin` and `end` are called on the thread that steps, and must not throw. `zone`
/// is "step" for a whole call of step(), before_world_step() or after_world_step(); for a stage it is its
/// name in StageTimes without "_ms": "choose", "transfer", "flight", "broad_phase", "pairs", "crowd", "rest",
/// "cross_level" or "full". The text stays valid for good. Zones are nested as calls are; a stage may come
/// more than once in a step.
struct ProfileHooks {
  std::function<void(std::string_view zone)> begin = {}, end = {};
};

/// A colour to draw in.
struct DebugColor {
  float red = 1.0f, green = 1.0f, blue = 1.0f;  ///< 0 … 1
};

/// Functions that draw; positions are in the world frame, m. What has an empty function is not drawn.
struct DebugDrawer {
  std::function<void(const Vec3& from, const Vec3& to, DebugColor)> line = {};
  std::function<void(const Vec3& at, DebugColor)> point = {};
};

/// What Manager::draw draws, and how.
struct DrawSettings {
  /// Each body as its rung has it: the edges of its hull; at `tables`, and for a shape that is a sphere,
  /// three circles of the sphere. And a point at its centre of mass.
  bool bodies = true;
  /// Contacts of the last step between bodies, and of full bodies with the ground: a point, and a line along
  /// the normal. Contacts between two spheres of `tables` are not drawn.
  bool contacts = true;
  bool bounds = false;  ///< axis-aligned boxes around the hulls
  std::array<DebugColor, kRungs> colors{
      {{0.0f, 0.45f, 0.3f}, {0.35f, 0.7f, 0.9f}, {0.9f, 0.6f, 0.0f}}};  ///< by Rung; half as bright asleep
  DebugColor contact_color{0.9f, 0.2f, 0.2f}, bounds_color{0.5f, 0.5f, 0.5f};
  double normal_length = 0.1;  ///< m, of the lines along normals
};

}  // namespace lodestone
