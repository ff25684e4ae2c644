// A recording: first the snapshot that it begins with, then one chunk for each call that changed the manager,
// in order, and for each step what came of it.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lod/manager/levels.h"
#include "lod/policy.h"
#include "lod/record.h"
#include "reference/error.h"
#include "reference/state_archive.h"

namespace lodestone {

enum class Call : std::uint8_t {
  begin,  ///< a snapshot: of the beginning, or one that was restored
  step,
  add_plane,
  add_static_mesh,
  add_static_box,
  move_ground,
  remove_ground,
  add_body,
  remove_body,
  set_level,
  set_importance,
  set_state,
  set_user_data,
  set_body_events,
  set_properties,
  add_force,
  add_impulse,
  sleep,
  wake,
  set_positions,
  set_viewpoints,
  set_rung_range,
  make_group,  ///< without the functions for its joints
  dissolve_group,
  set_gravity,
  set_full_substeps,
  set_policy,    ///< without its functions
  callers_step,  ///< between before_world_step and after_world_step
};
inline constexpr auto kLastCall = Call::callers_step;

/// What a recording starts with.
inline constexpr std::array<char, 8> kRecordingMagic = {'L', 'O', 'D', 'E', 'R', 'E', 'C', '3'};

/// Before each chunk: how long it is, and by what damage to that and to its bytes is known.
struct ChunkHead {
  std::uint64_t length = 0, length_hash = 0, hash = 0;
  static ChunkHead of(std::span<const std::byte> chunk);
  /// False: what says how long the chunk is was damaged.
  bool has_true_length() const;
  bool fits(std::span<const std::byte> chunk) const { return of(chunk).hash == hash; }
};

/// What a shape is told by, wherever it was made.
struct ShapeName {
  std::uint64_t content_hash = 0;
  double radius = 0.0;  // m
  friend bool operator==(const ShapeName&, const ShapeName&) = default;
};
inline ShapeName name_of(const Shape& shape) { return {shape.content_hash, shape.radius}; }
/// Of one that is not to be found.
std::string words_of(ShapeName name);
/// Among those given and those of bodies; null where there is none.
std::shared_ptr<const Shape> find_shape(ShapeName name, std::span<const std::shared_ptr<const Shape>> given,
                                        const BodyTable& bodies);

/// Of each body's state, whether it sleeps and is full, in order of creation.
std::vector<std::uint32_t> body_hashes(const Levels& levels);

/// A policy as it is recorded: of its functions only whether there were any.
struct RecordedPolicy {
  PolicySettings settings;
  bool visible = false, significance = false;
  void archive(StateArchive& a) {
    archive_kind(a, settings.policy);
    a(settings.hysteresis, settings.min_dwell_frames, settings.max_transitions_per_frame, settings.most_full,
      settings.most_support, settings.out_of_view_factor);
    a(settings.look_ahead_s, settings.contact_groups_together, visible, significance);
  }

 private:
  /// By values: bytes that none has may be those of a policy before.
  template <class... Kinds>
  static void archive_kind(StateArchive& a, std::variant<Kinds...>& policy) {
    auto index = std::uint64_t(policy.index());
    a(index);
    if (index >= sizeof...(Kinds))
      throw_input_error("recording", fmt::format("a policy of kind {}", index),
                        fmt::format("0 … {}", sizeof...(Kinds) - 1));
    if (a.reading()) {
      const std::array<std::variant<Kinds...>, sizeof...(Kinds)> fresh{Kinds{}...};
      policy = fresh[index];
    }
    std::visit([&](auto& kind) { archive_values(a, kind); }, policy);
  }
  template <class Kind>
  static void archive_values(StateArchive& a, Kind& kind) {
    a(kind);
  }
  static void archive_values(StateArchive& a, ErrorBudgetPolicy& kind) {
    bool in_work = kind.budget_work.has_value();
    double work = kind.budget_work.value_or(0.0);
    a(kind.budget_ms, in_work, work);
    kind.budget_work = in_work ? std::optional(work) : std::nullopt;
  }
};

class Recorder {
 public:
  /// Begins with `snapshot`; empty `write`: ends. Throws what a `write` has thrown.
  void set(RecordFunction write, std::vector<std::byte> snapshot);
  bool on() const { return bool(write_); }

  template <class... T>
  void note(Call call, const T&... values) {
    if (!write_) return;
    StateArchive chunk;
    chunk(call, const_cast<T&>(values)...);  // which changes nothing where it writes
    put(chunk.bytes());
  }
  /// What `write` has thrown since the last call, if it has: the recording ended there.
  void rethrow();

 private:
  void put(const std::vector<std::byte>& chunk);

  RecordFunction write_;
  std::exception_ptr thrown_;
};

}  // namespace lodestone
