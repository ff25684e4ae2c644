// The full level: bodies as trimeshes in ODE. Its world is made when a first body becomes full, or is the
// caller's from the start.
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "lod/ground/ground.h"
#include "lod/step_report.h"
#include "reference/ode/ode_world.h"
#include "reference/state_archive.h"

namespace lodestone {

/// Over the shape's size. ODE notices an impact up to v·h inside the plane. Where it is not answered at its
/// own time (timed_contacts.h) bouncing before that is as wrong in height as after it, so it is done only
/// where the depth would show.
inline constexpr double kPlaneDepthMax = 0.04;

struct FullSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s²; the caller's world keeps its own
  std::uint64_t seed = 1;
  int substeps = 4;
  bool sleeping = true;
  SleepThresholds sleep = {};
};

/// How the full level has ODE work.
OdeSettings ode_settings_of(const FullSettings& settings);

class FullLevel {
 public:
  struct Member {
    std::uint32_t owner;  ///< the manager's index of the body
    OdeBodyId id;
  };

  /// `materials` must outlive the level.
  FullLevel(const FullSettings& settings, const MaterialTable& materials);
  /// On the caller's world and space, which must outlive the level.
  FullLevel(dxWorld* world, dxSpace* space, const FullSettings& settings, const MaterialTable& materials);

  /// Ground of this level; see OdeWorld. Costs nothing before there is a world.
  void add_plane(GroundId id, const HalfSpace& plane);
  void add_static_box(GroundId id, const Vec3& sides, const Vec3& position, const Quat& orientation,
                      MaterialId material);
  void add_static_mesh(GroundId id, const Mesh& mesh, MaterialId material);
  void move_ground(GroundId id, const RigidState& state);
  void remove_ground(GroundId id);
  void go_on(double gone);  ///< OdeWorld::go_on
  /// Null for ground of the caller's.
  GroundId ground_of(OdeGroundId id) const;

  /// m/s², from the next step on, in a caller's world too.
  void set_gravity(const Vec3& gravity);
  /// Of the owners of two bodies: whether they may meet; empty: all may.
  void set_pair_filter(std::function<bool(std::uint32_t, std::uint32_t)> filter);
  void set_substeps(int substeps) { settings_.substeps = substeps; }
  int substeps() const { return settings_.substeps; }
  int substeps_of(double dt) const;  ///< in a step of `dt` seconds

  OdeBodyId add(std::uint32_t owner, const OdeBodyDefinition& definition, bool asleep);
  /// Wakes what touched it, unless it `stays` where it is, on another rung.
  void remove(OdeBodyId body, bool stays = false);

  /// See OdeWorld::archive.
  void archive(StateArchive& a);

  /// Advances every body, the caller's too, and adds what happened to `counters`.
  void step(double dt, Counters& counters);

  /// What step() does, around a step of the caller's world that he takes himself; see
  /// OdeWorld::begin_callers_step.
  void begin_callers_step(double dt);
  void end_callers_step(Counters& counters);

  std::span<const Member> members() const { return members_; }
  /// Where in members() a body is; −1 for one that was removed.
  std::int32_t index_of(OdeBodyId body) const;
  int asleep_count() const;

  /// Notes which bodies touched each other in the last substep.
  void note_touching();
  /// That a body touches another, of another level.
  void note_touching(std::size_t index) { touching_[index] = true; }
  /// As noted last.
  bool touches(OdeBodyId body) const { return touching_[std::size_t(index_of(body))]; }
  /// Null before a first body was full, unless it is the caller's.
  const OdeWorld* world() const { return world_ ? &*world_ : nullptr; }
  OdeWorld* world() { return world_ ? &*world_ : nullptr; }

 private:
  /// Ground that was given, laid once there is a world.
  struct Piece {
    GroundId id;
    std::function<OdeGroundId(OdeWorld&)> make;
    std::optional<RigidState> moved = {};  // since it was made
    OdeGroundId laid = {};
  };
  void add_ground(GroundId id, std::function<OdeGroundId(OdeWorld&)> make);
  void lay(Piece& piece);
  void filter_pairs();
  void make_world();
  /// As many as were set, or more while thin bodies are awake among others.
  bool may_thin_meet(double dt) const;
  void add_new_counts(Counters& counters);

  FullSettings settings_;
  const MaterialTable* materials_;
  std::optional<OdeWorld> world_;
  double gone_ = 0.0;  // s, of go_on()
  std::function<bool(std::uint32_t, std::uint32_t)> pair_filter_;
  std::list<Piece> pieces_;                                                 // in the order in which they came
  std::unordered_map<std::uint32_t, std::list<Piece>::iterator> piece_of_;  // by GroundId::index
  std::unordered_map<std::uint32_t, GroundId> id_of_laid_;
  std::vector<Member> members_;
  std::vector<char> touching_;  // one of each member
  std::unordered_map<std::uint32_t, std::int32_t> index_of_id_;
  OdeCounters counted_;
};

}  // namespace lodestone
