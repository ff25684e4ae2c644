// Collision detection of one OdeWorld: bodies against planes, the other bodies, the ground and the caller's
// geoms. collision_ode.cpp has who meets whom, collision_ground_ode.cpp the planes, boxes and meshes of the
// ground.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "reference/ode/bodies_ode.h"
#include "reference/ode/broad_phase_ode.h"
#include "reference/ode/callers_shapes_ode.h"
#include "reference/ode/height_field_contacts.h"
#include "reference/ode/joints_ode.h"
#include "reference/ode/narrow_phase_ode.h"
#include "reference/ode/plane_phase_ode.h"

namespace lodestone::ode {

/// A box or mesh that nothing can push.
struct Ground {
  OdeGroundId id{};  ///< null: removed
  dGeomID geom = nullptr;
  MaterialId material = 0;
  std::shared_ptr<const Shape> solid = {};  ///< null for a mesh that is none (exact_solid.h), and see sides
  RigidState put = {};                      ///< where it was put, and how it moves
  RigidState state = {};                    ///< the same in this substep: where it has moved to from there
  std::unique_ptr<TrimeshData> mesh = {};
  std::optional<Vec3> sides = {};  ///< m, of a box whose solid is not made yet
  RigidState before = {};          ///< where it was put at the end of the step before
  double last_way = 0.0;           ///< m, by which it was moved before that step
  bool moved = false;              ///< before this step
  bool goes = false;               ///< was moved before it, or before the step that it is a part of: no belt
  bool moves = false;              ///< its state has a velocity

  double way() const;  ///< m, by which it was moved before this step, no point of it more
};

class Collision {
 public:
  /// `callers`: null in a world of its own. `trimeshes`: those of the bodies.
  Collision(const SpaceMirror* callers, TrimeshCache& trimeshes, const OdeSettings& settings);
  ~Collision();
  Collision(const Collision&) = delete;
  Collision& operator=(const Collision&) = delete;

  OdeGroundId add_plane(const Vec3& normal, double offset, MaterialId material);
  OdeGroundId add_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material);
  OdeGroundId add_mesh(const Mesh& mesh, MaterialId material);
  void move_ground(OdeGroundId id, const RigidState& state, Bodies& bodies);
  void remove_ground(OdeGroundId id, Bodies& bodies);
  void archive(StateArchive& a);  ///< by what ground was moved, not the ground itself

  /// After the mirror was refreshed: wakes what the caller disturbed.
  void note_changes(Bodies& bodies);
  /// Wakes what ground that was moved comes to within a step of `dt` s.
  void begin_step(Bodies& bodies, double dt);
  /// Puts ground that moves where it is `after` s from the step's beginning.
  void move_on(double after);
  /// The next steps are parts of one that began `gone` s ago: what was moved for that has gone on since.
  void go_on(double gone);
  /// Ground that is not moved again stands where it was put.
  void end_step();
  /// Finds the contacts of every awake body and gives them to `joints`; `h` is the step to come, s.
  void collide(Bodies& bodies, ContactJoints& joints, double h);

  BroadPhase& broad_phase() { return broad_phase_; }
  std::int64_t contacts_dropped() const { return plane_phase_.dropped() + dropped_; }
  std::int64_t swallowed() const { return swallowed_; }
  std::int64_t ground_trimeshes() const { return ground_meshes_; }

 private:
  void put(Ground& ground, const RigidState& state);
  void put_after(Ground& ground, double after);
  void mark_company(Bodies& bodies, std::span<const Candidate> candidates);
  void note_callers_planes();
  void collide_plane(Body& body, const Plane& plane, ContactJoints& joints);
  void collide_candidates(Bodies& bodies, std::span<const Candidate> candidates, ContactJoints& joints);
  void collide_woken(Bodies& bodies, ContactJoints& joints);
  void note_joined(Bodies& bodies, const Body& body, const ContactGraph& contacts);
  void note_woken(Bodies& bodies, const Body* body);
  void find_pair_points(const Body& body, const Body* other, std::span<const Candidate> parts);
  void find_swallowed_ball(const Body& body, const Body& other);
  void find_filtered_points(const Body& body, const Body& other, const Candidate& pair, double size);
  Pieces pieces_of_other(const Candidate& candidate, const Body* other);
  void drop_beyond(int kept);
  OdeGroundId add_ground(Ground ground);
  Ground& find_ground(OdeGroundId id);
  std::shared_ptr<const Shape> box_of(const Vec3& sides);
  const Shape* solid_of(Ground& ground);
  ContactSide side_of(const Candidate& candidate, const Body* other) const;

  OdeSettings settings_;
  BroadPhase broad_phase_;
  NarrowPhase narrow_phase_;
  PlanePhase plane_phase_;
  HeightFieldContacts height_field_contacts_;
  std::vector<Plane> planes_;
  std::vector<Plane> callers_planes_;
  std::vector<Ground> ground_;  // by the ground geom's number (dGeomGetData)
  std::vector<std::uint32_t> free_ground_;
  std::unordered_map<std::uint32_t, std::size_t> number_of_;  // of ground, by OdeGroundId::value
  std::uint32_t last_ground_id_ = 0;
  std::int64_t ground_meshes_ = 0;
  std::map<std::array<double, 3>, std::weak_ptr<const Shape>> ground_boxes_;  // by their sides
  std::vector<ContactPoint> points_;                                          // of the pair at hand
  enum class Waking : char { no, to_meet, met };
  std::vector<Waking> waking_;      // by slot: sleepers that touch one that is awake, in this substep
  std::vector<std::size_t> woken_;  // their slots
  const SpaceMirror* callers_;
  CallersShapes callers_shapes_;
  TrimeshCache& trimeshes_;
  PlaneStep step_;     // the one to come
  double gone_ = 0.0;  // s, since the beginning of the step that the next one is a part of
  std::int64_t dropped_ = 0, swallowed_ = 0;
};

}  // namespace lodestone::ode
