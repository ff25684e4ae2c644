// The dynamic bodies of a caller's space, as statistical bodies meet them: with their own mass and the shape
// of their geoms. They take impulses and give them. Those without geoms that joints tie to them, or to full
// bodies, meet nobody, but pull and weigh.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "lod/callers/body_forms.h"
#include "lod/ground/ground.h"
#include "lod/statistical/full_neighbor.h"
#include "reference/ode/space_mirror.h"
#include "reference/state_archive.h"

namespace lodestone {

/// A geom of one of them that is made of solids, where it is.
struct CallersPart {
  dxBody* body = nullptr;
  dxGeom* geom = nullptr;
  unsigned category = 0;
  std::shared_ptr<const GroundSolids> solids;  ///< in the geom's frame
  Vec3 position = Vec3::Zero();                ///< m, world
  Quat orientation = Quat::Identity();
};

class CallersBodies {
 public:
  /// Takes in what the mirror saw in its last refresh. Calls left(box) with the bounds (m, world) that a geom
  /// had which is no more, or is not there any more: what slept on it has lost its hold. Calls
  /// tell(owner, bits) where a body's bits, those of all of its geoms together, may have changed; all of them
  /// where it is gone.
  void follow(const SpaceMirror& mirror, const std::function<void(const Eigen::AlignedBox3d&)>& left,
              const std::function<void(std::uint32_t, const GroundBits&)>& tell);
  /// After it: takes in which bodies without geoms hang by joints, through each other too, on `jointed`,
  /// those of the full level that have joints, or on his that have geoms. To be called outside of ODE's step.
  void follow_tied(std::span<dxBody* const> jointed,
                   const std::function<void(std::uint32_t, const GroundBits&)>& tell);
  std::size_t size() const { return bodies_.size(); }
  bool contains(dxBody* body) const { return place_of_.contains(body); }

  /// Appends them as neighbours, as they are now, and what holds them up: `first` is the index that the first
  /// of them has there.
  void gather(const Ground& ground, const Vec3& gravity, std::vector<FullNeighbor>& neighbors,
              std::vector<FullContact>& contacts) const;
  /// ODE's, of each neighbour that gather() appends.
  void append_ode_bodies(std::vector<dxBody*>& bodies) const;
  /// Gives each what came back, for a step of `dt` s in `substeps`. `neighbors` are those that gather()
  /// appended, under the same gravity.
  void hand_over(std::span<const FullNeighbor> neighbors, const Vec3& gravity, double dt, int substeps) const;
  /// Not the bodies themselves, of those that `mirror` (null: no space) has still, but their order and by
  /// what numbers their contacts are remembered: of those that the reader has in the same places, and of
  /// others in their order; not of those without geoms.
  void archive(StateArchive& a, const SpaceMirror* mirror);
  /// Calls visit(shape, state) for each whose ball meets that of `radius` m about `center`, and whose bits
  /// meet `own`.
  void each_near(const Vec3& center, double radius, const BodyProperties& own,
                 const std::function<void(const Shape&, const RigidState&)>& visit) const;
  struct Placed {
    std::uint32_t owner = 0;
    GroundBits bits;
    const Shape* shape = nullptr;
    RigidState state;
  };
  /// Those that have shapes, as they are now.
  std::vector<Placed> find_placed() const;
  /// Their geoms as they are now, at any time; of those that the mirror saw in its last refresh.
  std::vector<CallersPart> find_parts(const SpaceMirror& mirror) const;
  /// Whose geom the mirror has in that slot; null where it is none of a dynamic body.
  dxBody* body_of_slot(std::size_t slot) const {
    return slot < body_of_slot_.size() ? body_of_slot_[slot] : nullptr;
  }
  /// The body that a neighbour's owner names (FullNeighbor::owner); null where it is none of the caller's.
  dxBody* body_of(std::uint32_t owner) const;
  /// None where it is none of the caller's.
  std::optional<RigidState> state_of(std::uint32_t owner) const;

 private:
  struct Entry {
    dxBody* body = nullptr;
    std::vector<std::uint32_t> slots;  // of its geoms in the mirror, ascending; none: it is tied
    std::vector<std::shared_ptr<const GroundSolids>> solids;  // of each geom; null: it has none
    std::shared_ptr<const Shape> shape;  // null: to be made anew, or none of its geoms is a solid
    std::uint32_t owner = 0;
    GroundBits bits;     // of all its geoms
    bool stale = true;   // a geom came or went
    bool untold = true;  // its bits
    bool is_tied() const { return slots.empty(); }
  };
  static void follow_inertia(Entry& entry);
  void note_places();
  Entry& add(dxBody* body);
  void make_shape(const SpaceMirror& mirror, Entry& entry);
  std::vector<dxBody*> find_tied(std::span<dxBody* const> jointed) const;
  std::vector<const Entry*> find_living(const SpaceMirror& mirror) const;

  std::vector<Entry> bodies_;                             // in the order in which they came
  std::unordered_map<dxBody*, std::size_t> place_of_;     // among them
  std::unordered_map<std::uint32_t, dxBody*> of_number_;  // by their owners
  std::vector<dxBody*> body_of_slot_;
  struct MadeShape {
    std::shared_ptr<const Shape> form, shape;  // without inertia, and with that of such a body
  };
  BodyForms forms_;
  std::vector<MadeShape> made_;  // the last few that were made: bodies that are alike have one
  std::uint32_t owners_ = 0;
};

}  // namespace lodestone
