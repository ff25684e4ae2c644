// What does not move of itself, and everything rests on: planes, and parts, which are made of convex solids
// (ground_solids.h) or known only by rays. Parts come and go, and can be moved; then they carry what lies on
// them (ground_motion.cpp).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lod/ground/ground_solids.h"
#include "lod/ground/half_space.h"
#include "lod/ground_id.h"
#include "reference/body_properties.h"
#include "reference/mesh/box_hierarchy.h"
#include "reference/state_archive.h"

namespace lodestone {

/// Where a ray meets the surface of a part, whose outward normal is `normal`.
struct GroundHit {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  ///< world
  double distance = 0.0;                              ///< m, from the ray's start
};

/// Casts a ray from `from` along `direction` (unit), at most `length` m.
using GroundProbe =
    std::function<std::optional<GroundHit>(const Vec3& from, const Vec3& direction, double length)>;

/// What a part of the ground is. One that has no `make` is known by `probe`, from above: a height field.
struct GroundShape {
  Eigen::AlignedBox3d bounds;               ///< m, in the part's own frame
  std::function<GroundSolids()> make = {};  ///< called when a body first comes near
  GroundProbe probe = {};
  Vec3 up = Vec3::UnitZ();  ///< of `probe`: rays are cast against it, in the part's own frame
  GroundBits bits = {};
};

/// Where a part stands, and how it moves in this step.
struct GroundPose {
  Vec3 position = Vec3::Zero();  ///< m
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();  ///< m/s, rad/s: carries what lies on it
  /// s, for which it moves on from there: the next step; 0: it stands there during the step, too.
  double goes_on_s = 0.0;
  bool comes_back = false;  ///< after each step it is where it was put again
};

/// `to` with the velocities of a part that moved there from `from` in `dt` s; none of its points is farther
/// from its position than `rim` m. Without velocities if it went faster than 50 m/s, or turned by more than
/// half a radian with a rim as fast: then it was put elsewhere, and carries nothing along.
GroundPose put_from(const GroundPose& from, const GroundPose& to, double rim, double dt);
/// The pose from which a part with the velocities of `put` comes to stand at `put` within `dt` s, so that
/// what lies on it goes along.
GroundPose coming_to(const GroundPose& put, double dt);
/// The same at the beginning of a divided step of `dt` s, whose first part takes `part` s.
GroundPose coming_to(const GroundPose& put, double dt, double part);

/// `pose` as it is `after` seconds into the step.
GroundPose pose_after(const GroundPose& pose, double after);

/// The motion of a part that its caller puts elsewhere step by step, without a velocity.
struct InferredMotion {
  GroundPose from;          ///< where it was put before
  bool moved = true;        ///< it was put elsewhere since the last step began
  double last_speed = 0.0;  ///< m/s, in the last step: greatest speed of any of its points
};

struct GroundPart {
  GroundId id;
  GroundShape shape;
  GroundPose pose;
  std::optional<InferredMotion> inferred = {};  ///< none: it was not put elsewhere lately
  MaterialId material = 0;
  std::optional<GroundSolids> solids;  ///< once made
  std::uint32_t first_number = 0;      ///< of its solids, for what is remembered of contacts with them

  bool moves() const { return !pose.velocity.isZero(0.0) || !pose.angular_velocity.isZero(0.0); }
  Vec3 velocity_at(const Vec3& point) const {
    return pose.velocity + pose.angular_velocity.cross(point - pose.position);
  }
  /// m/s, along the chord of the arc on which it carries a body whose centre is `center` in `time` s.
  Vec3 carrying_velocity(const Vec3& center, double time) const {
    const Quat half_way = rotation_from_vector(0.5 * time * pose.angular_velocity);
    return pose.velocity + pose.angular_velocity.cross(half_way * (center - pose.position));
  }
  /// m, from its position to its farthest point, at most.
  double rim() const { return shape.bounds.center().norm() + 0.5 * shape.bounds.sizes().norm(); }
  /// m/s, of any of its points.
  double greatest_speed() const { return pose.velocity.norm() + pose.angular_velocity.norm() * rim(); }
};

/// A solid of a part, where it stands.
struct PlacedSolid {
  const GroundSolid* solid = nullptr;
  const GroundPart* part = nullptr;
  Vec3 position = Vec3::Zero();  ///< m, world, of the solid's own frame
  Quat orientation = Quat::Identity();
  std::uint32_t number = 0;  ///< the same for as long as the part is there
};

/// The plane of a part that is known by rays, below (or a little above) `center`. None if a ray of three
/// times `reach` m meets nothing, and for other parts.
std::optional<HalfSpace> probe_below(const GroundPart& part, const Vec3& center, double reach);

/// Appends the solids of `part` that may come within `reach` of `center`, as they stand `after` seconds from
/// the beginning of the step.
void find_solids(const GroundPart& part, const Vec3& center, double reach, double after,
                 std::vector<PlacedSolid>& found);

class Ground {
 public:
  GroundId add_plane(const HalfSpace& plane);
  /// Its solids are made at once where `eager`, so that errors show here.
  GroundId add_part(const GroundShape& shape, const GroundPose& pose, MaterialId material,
                    bool eager = false);
  GroundId add_mesh(const Mesh& mesh, MaterialId material);  ///< vertices in the world frame
  GroundId add_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material);

  bool valid(GroundId id) const;
  bool is_plane(GroundId id) const { return entries_[id.index].plane >= 0; }
  void remove(GroundId id);
  void move_plane(GroundId id, const HalfSpace& plane);
  void move_part(GroundId id, const GroundPose& pose);
  /// For a part that is known by rays: the direction from which they come.
  void set_up(GroundId id, const Vec3& up) { parts_[std::size_t(entries_[id.index].part)]->shape.up = up; }
  /// Begins a step of `dt` s, in which parts with a velocity move on. Parts that were put elsewhere without a
  /// velocity, in the last `since` s and in the step before, move with an inferred velocity; `stands_again`
  /// is called with the bounds of those that have stopped doing so. `since` 0: this is a later part of a
  /// divided step, and they go on.
  void begin_step(double dt, double since,
                  const std::function<void(const Eigen::AlignedBox3d&)>& stands_again);
  /// Before a later part of a divided step: parts that were moved for that step go on from where they came in
  /// the part before. Belts, which are not moved, begin anew.
  void go_on();
  /// After the last part of a divided step: what comes back is where it was put again.
  void come_back();
  /// Takes back begin_step(), as the step failed. Possible until keep_step().
  void undo_step();
  void keep_step() { inferred_before_.clear(), began_ = false; }
  const GroundPart& part(GroundId id) const { return *parts_[std::size_t(entries_[id.index].part)]; }
  const HalfSpace& plane(GroundId id) const { return planes_[std::size_t(entries_[id.index].plane)]; }
  /// Of a part, where it stands now.
  Eigen::AlignedBox3d bounds(GroundId id) const;
  GroundId id_of_plane(std::size_t index) const { return plane_ids_[index]; }

  std::span<const HalfSpace> planes() const { return planes_; }
  std::size_t parts() const { return parts_used_; }
  /// Not the ground itself, but the numbers by which its solids are remembered, and inferred motion, as far
  /// as the reader has the same parts.
  void archive(StateArchive& a);
  bool has_parts() const { return parts_used_ > 0; }
  bool any_moves() const { return moving_ > 0; }
  /// Appends the parts whose bounding boxes come within `reach` of `center`, in the order of their making.
  /// Not for several threads at once, as it makes solids, but where MadeOnly is.
  void find_parts(const Vec3& center, double reach, std::vector<const GroundPart*>& found) const;
  /// The same of those whose boxes come within `margin` m of a ray of unit `direction` before `length` m.
  void find_parts_along(const Vec3& from, const Vec3& direction, double length, double margin,
                        std::vector<const GroundPart*>& found) const;
  /// Makes the solids of those parts. Returns whether any is known by rays, which only one thread may cast.
  bool make_near(const Vec3& center, double reach) const;
  /// While it exists several threads may call find_parts, which passes over parts whose solids are not made
  /// yet: call make_near() before for all that may be asked about.
  class MadeOnly {
   public:
    /// `by_rays`: one thread alone is at work, which may cast them.
    MadeOnly(const Ground& ground, bool by_rays) : ground_(ground) {
      ground_.prepare_tree(), ground_.made_only_ = true, ground_.without_rays_ = !by_rays;
    }
    ~MadeOnly() { ground_.made_only_ = ground_.without_rays_ = false; }
    MadeOnly(const MadeOnly&) = delete;
    MadeOnly& operator=(const MadeOnly&) = delete;

   private:
    const Ground& ground_;
  };

 private:
  struct Entry {
    std::uint32_t generation = 0;
    std::int32_t plane = -1, part = -1;
  };
  /// A part with an inferred motion, as it was at some time.
  struct Noted {
    GroundId id;
    InferredMotion inferred;
    GroundPose pose;  // with the velocity, of which its caller knows nothing
  };
  GroundId new_id(Entry entry);
  void note_repositioned(GroundPart& part, const GroundPose& pose);
  void stand(std::size_t part, const GroundPose& pose);
  void note_inferred();
  void take_inferred(std::vector<Noted> inferred);
  void go_as_inferred(double dt, double since,
                      const std::function<void(const Eigen::AlignedBox3d&)>& stands_again);
  void hold(std::int32_t part);
  void let_go(std::int32_t part);
  void hold_anew(std::int32_t part);
  template <class Meets>
  void find_parts_in(const Meets& meets, std::vector<const GroundPart*>& found) const;
  void take_bounds(std::int32_t part);
  void prepare_tree() const;
  const GroundSolids& solids_of(std::int32_t part) const;

  std::vector<Entry> entries_;
  std::vector<std::uint32_t> free_entries_;
  std::vector<HalfSpace> planes_;
  std::vector<GroundId> plane_ids_;
  std::vector<std::unique_ptr<GroundPart>> parts_;  // null: free
  std::vector<Eigen::AlignedBox3d> bounds_;         // of each part, world
  std::vector<std::int32_t> free_parts_;
  std::size_t parts_used_ = 0, moving_ = 0;
  std::vector<GroundId> inferred_;       // parts with an inferred motion
  std::vector<Noted> inferred_before_;   // as it was before begin_step()
  bool began_ = false;                   // a step that may be undone
  std::vector<GroundId> moved_, going_;  // with a velocity: for the step to come, and for this one
  std::vector<std::pair<GroundId, GroundPose>> was_put_;  // what has gone on and comes back
  mutable std::uint32_t numbers_ = 0;

  mutable std::size_t unmade_ = 0, probed_ = 0;  // parts without their solids; known by rays
  mutable bool made_only_ = false, without_rays_ = false;

  // Most parts stand in a tree, built now and then; those that came or moved since are looked at one by one.
  mutable BoxHierarchy tree_;
  mutable std::vector<std::int32_t> standing_;  // which parts
  mutable std::vector<char> in_tree_;           // of each part
  mutable std::vector<std::int32_t> loose_;
};

}  // namespace lodestone
