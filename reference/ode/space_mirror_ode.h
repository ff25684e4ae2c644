// What a space mirror keeps: of each geom what the last refresh knew of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "reference/ode/box_tree.h"
#include "reference/ode/geom_identity_ode.h"
#include "reference/ode/space_mirror.h"

namespace lodestone {
namespace ode {

// For a snapshot: where the last refresh saw a geom that has a body, and where it is now, as the world's step
// moves it on.
struct Sighting {
  GeomPlace now;
  GeomPose pose;
  Quat orientation = Quat::Identity();
  GeomPlace from;  // the refresh before
  Quat turned_from = Quat::Identity();
  double last_way = 0.0;
  GeomPlace followed;  // as of the last follow(), with bounds alone
  bool has_moved = false;
};

// A geom in the order in which the space gives them out.
struct ListedGeom {
  dGeomID geom = nullptr;
  dBodyID body = nullptr;
  std::uint64_t print = 0;  // fingerprint_of it
  std::uint32_t slot = 0;
};

struct KnownGeom {
  GeomIdentity identity;
  GeomPose pose;
};

struct LastSeen {
  std::uint64_t at = 0;     // the refresh that saw it last
  std::uint32_t place = 0;  // in the order in which the space gave its geoms out
};

inline Eigen::AlignedBox3d bounding_box_of(const std::array<dReal, 6>& b) {
  return {Vec3(b[0], b[2], b[4]), Vec3(b[1], b[3], b[5])};
}

inline constexpr double kEverywhere = 1e30;  // m: a box that has all in it

}  // namespace ode

struct SpaceMirror::Impl {
  explicit Impl(dSpaceID callers)
      : space(callers),
        probe(dCreateBox(nullptr, ode::kEverywhere, ode::kEverywhere, ode::kEverywhere)),
        mesh_probe(dCreateTriMesh(nullptr, nullptr, nullptr, nullptr, nullptr)) {}
  ~Impl() {
    dGeomDestroy(probe);
    dGeomDestroy(mesh_probe);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void forget_moves();
  template <class Visit>
  bool walk(dSpaceID in, unsigned category, unsigned collide, const Visit& visit) const;
  void look_at(dGeomID geom, int geom_class, unsigned category, unsigned collide);
  const ode::ListedGeom* find_last(dGeomID geom);
  void note(const ode::ListedGeom& given);
  void add(const ode::KnownGeom& found, std::uint64_t print);
  void drop_unseen();
  void update_tree();
  void note_disturbed();
  void update_bodied();
  void follow(std::size_t index);
  std::vector<ode::Sighting> find_sightings(const SpaceMirror& self) const;
  void take(const ode::Sighting& sighting, std::uint32_t slot);
  std::size_t place_in_bodied(std::uint32_t slot) const {
    return std::size_t(std::ranges::lower_bound(bodied, slot) - bodied.begin());
  }

  dSpaceID space;
  dGeomID probe;       // meets everything
  dGeomID mesh_probe;  // at the origin
  std::vector<dSpaceID> excluded;
  std::vector<MirroredGeom> geoms;
  std::vector<ode::KnownGeom> known;     // one of each slot
  std::vector<ode::LastSeen> last_seen;  // likewise
  std::unordered_map<dGeomID, std::uint32_t> slots;
  std::vector<ode::ListedGeom> order, last_order;  // of the refresh under way, or the last; of the one before
  std::size_t cursor = 0;                          // in last_order: which is expected next
  std::vector<std::uint32_t> added, removed, moved, moved_before, planes, bodied, free;  // slots
  std::vector<Eigen::AlignedBox3d> followed;   // one of each in bodied
  std::vector<Eigen::AlignedBox3d> disturbed;  // see SpaceMirror::disturbed
  BoxTree tree;
  std::uint64_t refreshes = 0;  // so far
};

}  // namespace lodestone
