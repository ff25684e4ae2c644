// What a caller's space holds, seen anew at the start of every step: its geoms may come, go and move at any
// time, so a pointer of the last step is only ever compared with what the space holds now.
//
// Its files: space_mirror.cpp looks at the space; geom_identity_ode.h tells its geoms apart;
// space_mirror_archive.cpp finds them again for the reader of a snapshot.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "reference/geometry.h"
#include "reference/ode/geom_shape.h"

struct dxSpace;  // dSpaceID is dxSpace*
struct dxBody;

namespace lodestone {

class StateArchive;

struct MirroredGeom {
  /// Null: removed; what else is known of it stays until its slot is taken again, a refresh later or more.
  dxGeom* geom = nullptr;
  dxBody* body = nullptr;  ///< null: static
  GeomKind kind = GeomKind::other;
  bool dynamic = false;                ///< has a body that is not kinematic
  unsigned category = 0, collide = 0;  ///< bits, less those that the spaces around it lack
  Vec3 position = Vec3::Zero();        ///< m; a plane has none
  Quat orientation = Quat::Identity();
  Eigen::AlignedBox3d bounds;             ///< m
  Vec3 previous_position = Vec3::Zero();  ///< as of the refresh before; of an added one, as now
  Quat previous_orientation = Quat::Identity();
  Eigen::AlignedBox3d previous_bounds;
  double last_way = 0.0;        ///< m, to the previous place, of no point of it more
  Vec3 normal = Vec3::UnitZ();  ///< of a plane: normal·x = offset, unit length
  double offset = 0.0;          ///< m
};

/// Where a geom stands, by which the reader of a snapshot finds it again.
struct GeomPlace {
  Vec3 position = Vec3::Zero(), low = Vec3::Zero(), high = Vec3::Zero();  ///< m; of its bounds
  bool has_body = false;
};

class SpaceMirror {
 public:
  /// The caller's space (dSpaceID) must outlive the mirror. Empty until refreshed.
  explicit SpaceMirror(dxSpace* callers);
  ~SpaceMirror();
  SpaceMirror(const SpaceMirror&) = delete;
  SpaceMirror& operator=(const SpaceMirror&) = delete;

  /// From now on leaves out `space` and what is in it.
  void exclude(dxSpace* space);

  /// Looks at every geom of the space and the spaces in it, of whatever type, save rays, disabled ones and
  /// those without any category and collide bits. The caller's space may be collided and changed at any time
  /// but during this.
  void refresh();

  /// By slot; removed ones among them.
  std::span<const MirroredGeom> geoms() const;
  /// Slots, ascending, of what the last refresh found. A geom that became another (its size, mesh data, bits,
  /// body, dynamic or kinematic, of a dynamic body its offset) is removed and added, in another slot; one in
  /// the same state as before, at the same address, is taken for the same, and so is a mesh of which four
  /// triangles are the same.
  std::span<const std::uint32_t> added() const;
  std::span<const std::uint32_t> removed() const;
  std::span<const std::uint32_t> moved() const;  ///< position, orientation or bounds
  /// How far one has moved on, m: the lesser of its last two ways where it moved before each of the last two
  /// refreshes; 0 where it was put elsewhere once.
  double way_on(std::uint32_t slot) const;
  GeomPlace place_of(std::uint32_t slot) const;
  /// The slot of a geom that stood there in the last refresh, none of `but`.
  std::optional<std::uint32_t> find_at(const GeomPlace& place, std::span<const std::uint32_t> but) const;
  /// How the geoms that the last refresh found moved came there, and where it saw those with a body, which
  /// the world's step takes on. Where it reads, the last refresh found all where they were when it was
  /// written, and none moved.
  void archive(StateArchive& a);
  /// Slots, ascending, of the planes.
  std::span<const std::uint32_t> planes() const;
  /// Slots, ascending, of those that have a body.
  std::span<const std::uint32_t> bodied() const;

  /// Slots, ascending, of the geoms, save planes, whose bounds meet `box` (m).
  void find_near(const Eigen::AlignedBox3d& box, std::vector<std::uint32_t>& found) const;

  /// Appends the slots, ascending, of those of bodied() that the space holds now, at any time; nothing else
  /// changes. Costs a walk over the space's geoms, until all of them are found.
  void find_bodied_now(std::vector<std::uint32_t>& slots) const;

  /// Looks where the world's step took the geoms of bodies; geoms() and moved() stay as of the last refresh.
  void follow();
  /// Appends slots, in no order, of the geoms, save planes, whose bounds as followed last meet `box`, and of
  /// a few whose bounds do not.
  void find_followed(const Eigen::AlignedBox3d& box, std::vector<std::uint32_t>& found) const;
  /// The bounds of what the caller himself moved since the last follow() of it: of those in moved(), from
  /// where they were and where they are, and of what came or went.
  std::span<const Eigen::AlignedBox3d> disturbed() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
