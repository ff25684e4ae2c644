// Collision detection of one OdeWorld: bodies against planes, the other bodies, the ground and the caller's geoms.
#pragma once

#include <memory>
#include <vector>

#include "reference/ode/bodies_ode.h"
#include "reference/ode/broad_phase_ode.h"
#include "reference/ode/joints_ode.h"
#include "reference/ode/narrow_phase_ode.h"
#include "reference/ode/plane_phase_ode.h"

namespace lodestone::ode {

/// A static box or mesh.
struct Ground {
  MaterialId material = 0;
  std::shared_ptr<const Shape> box = {};  ///< null for a mesh
  RigidState state = {};                  ///< of the box
};

class Collision {
 public:
  Collision(dSpaceID around, const OdeSettings& settings);
  ~Collision();
  Collision(const Collision&) = delete;
  Collision& operator=(const Collision&) = delete;

  void add_plane(const Vec3& normal, double offset, MaterialId material);
  void add_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material);
  void add_mesh(const Mesh& mesh, MaterialId material);

  /// Finds the contacts of every awake body and gives them to `joints`; `h` is the step to come, s.
  void collide(Bodies& bodies, ContactJoints& joints, double h);

  BroadPhase& broad_phase() { return broad_phase_; }
  std::int64_t contacts_dropped() const { return plane_phase_.dropped() + dropped_; }
  std::int64_t swallowed() const { return swallowed_; }
  std::int64_t ground_trimeshes() const { return std::int64_t(ground_meshes_.size()); }

 private:
  void mark_company(Bodies& bodies, std::span<const Candidate> candidates);
  void collide_plane(Body& body, const Plane& plane, ContactJoints& joints);
  void collide_candidates(Bodies& bodies, std::span<const Candidate> candidates, ContactJoints& joints);
  void find_pair_points(const Body& body, const Body* other, std::span<const Candidate> parts);
  void find_filtered_points(const Body& body, const Body& other, const Candidate& pair, double size);
  const Ground* ground_of(dGeomID geom) const;
  void drop_beyond(int kept);
  void add_ground(dGeomID geom, Ground ground);
  ContactSide side_of(Bodies& bodies, dGeomID geom) const;

  OdeSettings settings_;
  BroadPhase broad_phase_;
  NarrowPhase narrow_phase_;
  PlanePhase plane_phase_;
  std::vector<Plane> planes_;
  std::vector<Ground> ground_;                // by the ground geom's number (dGeomGetData)
  std::vector<std::unique_ptr<TrimeshData>> ground_meshes_;
  std::vector<ContactPoint> points_;          // of the pair at hand
  bool attached_;
  PlaneStep step_;                            // the one to come
  std::int64_t dropped_ = 0, swallowed_ = 0;
};

}  // namespace lodestone::ode
