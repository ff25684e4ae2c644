#include "reference/ode/space_mirror.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "reference/ode/box_tree.h"
#include "reference/ode/geometry_ode.h"
#include "reference/state_archive.h"

namespace lodestone {

using namespace ode;

namespace {

constexpr double kEverywhere = 1e30;  // m
constexpr double kRounding = 1e-9;    // m, of places that a caller puts his geoms back to

/// What tells one geom from another, in ODE's own numbers.
struct Identity {
  dGeomID geom = nullptr;
  dBodyID body = nullptr;
  int geom_class = 0;
  bool dynamic = false;
  unsigned category = 0, collide = 0;
  std::array<dReal, 4> sizes{};   // m; of a plane, its parameters
  std::array<dReal, 7> offset{};  // of a dynamic body's: m, and a quaternion
  const void* data = nullptr;     // of a trimesh or height field
  std::uint64_t content = 0;      // of a trimesh: a print of some of its triangles
  friend bool operator==(const Identity&, const Identity&) = default;
};

struct Pose {
  std::array<dReal, 3> position{};
  std::array<dReal, 6> bounds{};
  std::array<dReal, 12> rotation{};
  friend bool operator==(const Pose&, const Pose&) = default;
};

// Where the last refresh saw a geom with a body, and where it is now: the world's step takes it on.
struct Sighting {
  GeomPlace now;
  Pose pose;
  Quat orientation = Quat::Identity();
  GeomPlace from;  // the refresh before
  Quat turned_from = Quat::Identity();
  double last_way = 0.0;
  GeomPlace followed;  // as of the last follow(), with bounds alone
  bool has_moved = false;
};

// In the order in which the space gives its geoms out.
struct Given {
  dGeomID geom = nullptr;
  dBodyID body = nullptr;
  std::uint64_t print = 0;  // of all that tells whether it changed
  std::uint32_t slot = 0;
};

struct Seen {
  Identity identity;
  Pose pose;
};

struct Sight {
  std::uint64_t at = 0;     // the refresh that saw it last
  std::uint32_t place = 0;  // in the order in which the space gave its geoms out
};

/// Four sums side by side, as each waits for its last product. A change of one word always changes it.
class Print {
 public:
  void add(std::uint64_t word) {
    std::uint64_t& sum = sums_[next_++ % sums_.size()];
    sum = std::rotl((sum ^ word) * kOdd, 29);
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const void* pointer) { add(std::uint64_t(reinterpret_cast<std::uintptr_t>(pointer))); }
  std::uint64_t value() const {
    std::uint64_t all = 0;
    for (const std::uint64_t sum : sums_) all = std::rotl((all ^ sum) * kOdd, 29);
    return all;
  }

 private:
  static constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;
  std::array<std::uint64_t, 4> sums_{1, 2, 3, 4};
  unsigned next_ = 0;
};

std::array<dReal, 4> sizes_of(dGeomID geom, int geom_class) {
  std::array<dReal, 4> sizes{};
  switch (geom_class) {
    case dSphereClass:
      sizes[0] = dGeomSphereGetRadius(geom);
      break;
    case dBoxClass:
      dGeomBoxGetLengths(geom, sizes.data());
      break;
    case dCapsuleClass:
      dGeomCapsuleGetParams(geom, &sizes[0], &sizes[1]);
      break;
    case dCylinderClass:
      dGeomCylinderGetParams(geom, &sizes[0], &sizes[1]);
      break;
    case dPlaneClass:
      dGeomPlaneGetParams(geom, sizes.data());
      break;
    default:
      break;
  }
  sizes[3] = geom_class == dPlaneClass ? sizes[3] : 0.0;  // a box's fourth is ODE's padding
  return sizes;
}

/// Whether the caller made something of it that is no number. Such a geom is left alone.
bool is_spoilt(dGeomID geom, int geom_class, bool placeable) {
  const auto sum = [](const dReal* v) { return v[0] + v[1] + v[2]; };
  const std::array<dReal, 4> sizes = sizes_of(geom, geom_class);
  dReal all = sum(sizes.data()) + sizes[3];
  if (!placeable) return !std::isfinite(all);
  all += sum(dGeomGetPosition(geom));
  const dReal* rotation = dGeomGetRotation(geom);
  for (const int row : {0, 4, 8}) all += sum(rotation + row);
  if (const dBodyID body = dGeomGetBody(geom))
    all += sum(dBodyGetLinearVel(body)) + sum(dBodyGetAngularVel(body));
  return !std::isfinite(all);
}

// What a trimesh or a height field has its form from.
const void* data_of(dGeomID geom, int geom_class) {
  if (geom_class == dTriMeshClass) return dGeomTriMeshGetData(geom);
  return geom_class == dHeightfieldClass ? dGeomHeightfieldGetHeightfieldData(geom) : nullptr;
}

std::array<dReal, 7> offset_of(dGeomID geom) {
  std::array<dReal, 7> offset{};
  std::copy_n(dGeomGetOffsetPosition(geom), 3, offset.begin());
  dQuaternion turn;
  dGeomGetOffsetQuaternion(geom, turn);
  std::copy_n(turn, 4, offset.begin() + 3);
  return offset;
}

Identity identity_of(dGeomID geom, int geom_class, unsigned category, unsigned collide,
                     std::uint64_t content) {
  const dBodyID body = dGeomGetBody(geom);
  const bool dynamic = body && !dBodyIsKinematic(body);
  return {.geom = geom,
          .body = body,
          .geom_class = geom_class,
          .dynamic = dynamic,
          .category = category,
          .collide = collide,
          .sizes = sizes_of(geom, geom_class),
          .offset = dynamic ? offset_of(geom) : std::array<dReal, 7>{},
          .data = data_of(geom, geom_class),
          .content = content};
}

Pose pose_of(dGeomID geom, bool placeable) {
  Pose pose;
  dGeomGetAABB(geom, pose.bounds.data());
  if (!placeable) return pose;
  std::copy_n(dGeomGetPosition(geom), 3, pose.position.begin());
  std::copy_n(dGeomGetRotation(geom), 12, pose.rotation.begin());
  return pose;
}

// What keeps its place and has other bounds is of another form.
bool changes_within(const Pose& before, const Pose& now) {
  return before.position == now.position && before.rotation == now.rotation && before.bounds != now.bounds;
}

// The bounds of the first few follow from their place and sizes.
std::uint64_t print_of(dGeomID geom, int geom_class, bool placeable, unsigned category, unsigned collide,
                       std::uint64_t content) {
  Print print;
  const dBodyID body = dGeomGetBody(geom);
  print.add(body);
  print.add(std::uint64_t(geom_class) << 1 | (body && !dBodyIsKinematic(body)));
  print.add(std::uint64_t(category) << 32 | collide);
  for (const dReal size : sizes_of(geom, geom_class)) print.add(size);
  if (geom_class == dPlaneClass) return print.value();
  if (placeable) {
    const dReal *position = dGeomGetPosition(geom), *rotation = dGeomGetRotation(geom);
    for (const int i : {0, 1, 2}) print.add(position[i]);
    for (const int i : {0, 1, 2, 4, 5, 6, 8, 9, 10}) print.add(rotation[i]);
  }
  if (geom_class == dSphereClass || geom_class == dBoxClass || geom_class == dCapsuleClass ||
      geom_class == dCylinderClass)
    return print.value();
  print.add(data_of(geom, geom_class)), print.add(content);
  std::array<dReal, 6> bounds;
  dGeomGetAABB(geom, bounds.data());
  for (const dReal side : bounds) print.add(side);
  return print.value();
}

constexpr std::size_t kAhead = 4;  // so many geoms before one is looked at, its memory is asked for

// What ODE has of a geom and of its place beside it. Of one that is gone it does nothing.
void fetch(dGeomID geom) {
  const char* const at = reinterpret_cast<const char*>(geom);
  for (int line = 0; line < 6; ++line) __builtin_prefetch(at + 64 * line);
}

bool is_space(int geom_class) { return geom_class >= dFirstSpaceClass && geom_class <= dLastSpaceClass; }

Eigen::AlignedBox3d box_of(const std::array<dReal, 6>& b) {
  return {Vec3(b[0], b[2], b[4]), Vec3(b[1], b[3], b[5])};
}

void place(const Seen& seen, MirroredGeom& geom) {
  geom.bounds = box_of(seen.pose.bounds);
  if (!is_placeable(seen.identity.geom)) return;
  geom.position = to_vec3(seen.pose.position.data());
  dQuaternion q;
  dGeomGetQuaternion(seen.identity.geom, q);
  geom.orientation = to_quat(q);
}

// m, since the refresh before: no point of it has come farther.
double way_of(const MirroredGeom& geom) {
  const double turn = geom.previous_orientation.angularDistance(geom.orientation),
               rim = (geom.bounds.center() - geom.position).norm() + 0.5 * geom.bounds.sizes().norm();
  return (geom.position - geom.previous_position).norm() + (turn > 0.0 ? turn * rim : 0.0);
}

MirroredGeom mirror(const Seen& seen) {
  const Identity& is = seen.identity;
  MirroredGeom geom;
  geom.geom = is.geom, geom.body = is.body, geom.dynamic = is.dynamic;
  geom.kind = kind_of(is.geom);
  geom.category = is.category, geom.collide = is.collide;
  if (geom.kind == GeomKind::plane) geom.normal = to_vec3(is.sizes.data()), geom.offset = is.sizes[3];
  place(seen, geom);
  geom.previous_position = geom.position, geom.previous_orientation = geom.orientation,
  geom.previous_bounds = geom.bounds;
  return geom;
}

}  // namespace

struct SpaceMirror::Impl {
  explicit Impl(dSpaceID callers)
      : space(callers),
        probe(dCreateBox(nullptr, kEverywhere, kEverywhere, kEverywhere)),
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
  std::uint64_t content_of(dGeomID mesh) const;
  void look_at(dGeomID geom, int geom_class, unsigned category, unsigned collide);
  const Given* find_last(dGeomID geom);
  void note(const Given& given);
  void add(const Seen& found, std::uint64_t print);
  void drop_unseen();
  void update_tree();
  void note_disturbed();
  void update_bodied();
  void follow(std::size_t index);
  std::vector<Sighting> find_sightings(const SpaceMirror& self) const;
  void take(const Sighting& sighting, std::uint32_t slot);
  std::size_t place_in_bodied(std::uint32_t slot) const {
    return std::size_t(std::ranges::lower_bound(bodied, slot) - bodied.begin());
  }

  dSpaceID space;
  dGeomID probe;       // meets everything
  dGeomID mesh_probe;  // at the origin
  std::vector<dSpaceID> excluded;
  std::vector<MirroredGeom> geoms;
  std::vector<Seen> seen;     // one of each slot
  std::vector<Sight> sights;  // likewise
  std::unordered_map<dGeomID, std::uint32_t> slots;
  std::vector<Given> order, last_order;
  std::size_t cursor = 0;  // in last_order: which is expected next
  std::vector<std::uint32_t> added, removed, moved, moved_before, planes, bodied, free;
  std::vector<Eigen::AlignedBox3d> followed;  // one of each in bodied
  std::vector<Eigen::AlignedBox3d> disturbed;
  BoxTree tree;
  std::uint64_t refreshes = 0;
};

SpaceMirror::SpaceMirror(dxSpace* callers) {
  prepare();
  impl_ = std::make_unique<Impl>(callers);
}

SpaceMirror::~SpaceMirror() = default;

void SpaceMirror::exclude(dxSpace* space) { impl_->excluded.push_back(space); }

void SpaceMirror::refresh() {
  prepare();
  impl_->forget_moves();
  impl_->walk(impl_->space, ~0u, ~0u,
              [this](dGeomID geom, int geom_class, unsigned category, unsigned collide) {
                return impl_->look_at(geom, geom_class, category, collide), true;
              });
  impl_->drop_unseen();
  impl_->note_disturbed();
  impl_->update_tree();
  impl_->update_bodied();
}

void SpaceMirror::Impl::forget_moves() {
  for (const std::uint32_t slot : moved) {
    MirroredGeom& geom = geoms[slot];
    geom.last_way = way_of(geom);
    geom.previous_position = geom.position, geom.previous_orientation = geom.orientation,
    geom.previous_bounds = geom.bounds;
  }
  free.insert(free.end(), removed.rbegin(), removed.rend());
  std::swap(moved, moved_before);
  added.clear(), removed.clear(), moved.clear();
  std::swap(order, last_order);
  order.clear();
  cursor = 0;
  ++refreshes;
}

// Visits every geom that may meet another, with its bits less those that the spaces around it lack, until a
// visit returns false. dSpaceGetGeom fails an assertion on a quadtree; what a box without end meets there is
// all that a body could.
template <class Visit>
bool SpaceMirror::Impl::walk(dSpaceID in, unsigned category, unsigned collide, const Visit& visit) const {
  if (std::ranges::find(excluded, in) != excluded.end()) return true;
  const auto self = reinterpret_cast<dGeomID>(in);
  category &= unsigned(dGeomGetCategoryBits(self)), collide &= unsigned(dGeomGetCollideBits(self));
  if (in != space && (!dGeomIsEnabled(self) || (category | collide) == 0)) return true;
  const auto enter = [&](dGeomID geom) {
    const int geom_class = dGeomGetClass(geom);
    if (is_space(geom_class)) return walk(reinterpret_cast<dSpaceID>(geom), category, collide, visit);
    const unsigned own_category = category & unsigned(dGeomGetCategoryBits(geom)),
                   own_collide = collide & unsigned(dGeomGetCollideBits(geom));
    return geom_class == dRayClass || !dGeomIsEnabled(geom) || (own_category | own_collide) == 0 ||
           visit(geom, geom_class, own_category, own_collide);
  };
  if (dSpaceGetClass(in) != dQuadTreeSpaceClass) {
    const int count = dSpaceGetNumGeoms(in);
    for (int i = 0; i < count; ++i)
      if (!enter(dSpaceGetGeom(in, i))) return false;
    return true;
  }
  struct Found {
    dGeomID probe;
    std::vector<dGeomID> geoms;
  } found{probe, {}};
  dSpaceCollide2(self, probe, &found, [](void* data, dGeomID a, dGeomID b) {
    auto& all = *static_cast<Found*>(data);
    all.geoms.push_back(a == all.probe ? b : a);
  });
  return std::ranges::all_of(found.geoms, enter);
}

// A mesh that a caller makes where he destroyed another often has all its addresses. Of its triangles, in
// their own axes, the first, the last and some between tell it from that.
std::uint64_t SpaceMirror::Impl::content_of(dGeomID mesh) const {
  constexpr int kSamples = 4;
  dGeomTriMeshSetData(mesh_probe, dGeomTriMeshGetData(mesh));
  const int count = dGeomTriMeshGetTriangleCount(mesh_probe);
  Print print;
  print.add(std::uint64_t(count));
  for (int i = 0; i < std::min(kSamples, count); ++i) {
    std::array<dVector3, 3> corners;
    dGeomTriMeshGetTriangle(mesh_probe, int(std::int64_t(count - 1) * i / std::max(1, kSamples - 1)),
                            &corners[0], &corners[1], &corners[2]);
    for (const dVector3& corner : corners)
      for (const int axis : {0, 1, 2}) print.add(corner[axis]);
  }
  return print.value();
}

void SpaceMirror::Impl::look_at(dGeomID geom, int geom_class, unsigned category, unsigned collide) {
  if (cursor + kAhead < last_order.size()) fetch(last_order[cursor + kAhead].geom);
  const bool placeable = is_placeable(geom);
  if (is_spoilt(geom, geom_class, placeable)) return;
  const std::uint64_t content = geom_class == dTriMeshClass ? content_of(geom) : 0,
                      print = print_of(geom, geom_class, placeable, category, collide, content);
  const Given* last = find_last(geom);
  if (last && last->print == print) return note(*last);
  const Seen found{identity_of(geom, geom_class, category, collide, content), pose_of(geom, placeable)};
  if (!last || seen[last->slot].identity != found.identity ||
      changes_within(seen[last->slot].pose, found.pose))
    return add(found, print);
  const std::uint32_t slot = last->slot;
  note({geom, last->body, print, slot});
  if (seen[slot].pose == found.pose) return;
  seen[slot].pose = found.pose;
  lodestone::place(seen[slot], geoms[slot]);
  moved.push_back(slot);
}

// As it was given out the last time; null: it was not. A space mostly gives its geoms out in the same order;
// one that was moved or is new may come earlier.
const Given* SpaceMirror::Impl::find_last(dGeomID geom) {
  if (cursor == last_order.size() || last_order[cursor].geom != geom) {
    const auto found = slots.find(geom);
    if (found == slots.end() || sights[found->second].at == refreshes) return nullptr;
    cursor = sights[found->second].place;
  }
  return &last_order[cursor++];
}

void SpaceMirror::Impl::note(const Given& given) {
  sights[given.slot] = {refreshes, std::uint32_t(order.size())};
  order.push_back(given);
}

void SpaceMirror::Impl::add(const Seen& found, std::uint64_t print) {
  std::uint32_t slot = std::uint32_t(seen.size());
  if (free.empty()) {
    seen.emplace_back();
    sights.emplace_back();
    geoms.emplace_back();
  } else {
    slot = free.back();
    free.pop_back();
  }
  seen[slot] = found;
  geoms[slot] = mirror(found);
  slots[found.identity.geom] = slot;
  note({found.identity.geom, found.identity.body, print, slot});
  added.push_back(slot);
}

void SpaceMirror::Impl::drop_unseen() {
  const bool all_seen = added.empty() && order.size() == last_order.size();
  for (const auto& [geom, body, print, slot] : last_order) {
    if (all_seen) break;
    if (sights[slot].at == refreshes) continue;
    const auto entry = slots.find(geom);
    if (entry->second == slot) slots.erase(entry);  // else another has its address
    seen[slot].identity.geom = geoms[slot].geom = nullptr;
    geoms[slot].body = nullptr;
    removed.push_back(slot);
  }
  std::ranges::sort(added), std::ranges::sort(removed), std::ranges::sort(moved);
}

// What has a body and is where the world's step left it was not disturbed.
void SpaceMirror::Impl::note_disturbed() {
  disturbed.clear();
  const auto last_known = [this](std::uint32_t slot) {
    const auto found = std::ranges::lower_bound(bodied, slot);
    return found != bodied.end() && *found == slot ? followed[std::size_t(found - bodied.begin())]
                                                   : geoms[slot].previous_bounds;
  };
  for (const std::uint32_t slot : added) disturbed.push_back(geoms[slot].bounds);
  for (const std::uint32_t slot : removed) disturbed.push_back(last_known(slot));
  for (const std::uint32_t slot : moved) {
    const Eigen::AlignedBox3d before = last_known(slot), &now = geoms[slot].bounds;
    if (geoms[slot].body && before.min() == now.min() && before.max() == now.max()) continue;
    disturbed.insert(disturbed.end(), {before, now});
  }
}

void SpaceMirror::Impl::update_bodied() {
  if (!added.empty() || !removed.empty()) {
    std::erase_if(bodied, [this](std::uint32_t slot) { return !geoms[slot].geom; });
    for (const std::uint32_t slot : added)
      if (geoms[slot].body) bodied.push_back(slot);
    std::ranges::sort(bodied);
  }
  followed.resize(bodied.size());
  for (std::size_t i = 0; i < bodied.size(); ++i) followed[i] = geoms[bodied[i]].bounds;
}

void SpaceMirror::Impl::update_tree() {
  const auto is_plane = [this](std::uint32_t slot) { return geoms[slot].kind == GeomKind::plane; };
  std::vector<BoxTree::Entry> entries;
  for (const std::uint32_t slot : removed) {
    if (is_plane(slot))
      std::erase(planes, slot);
    else
      tree.remove(slot);
  }
  for (const std::uint32_t slot : added) {
    if (is_plane(slot))
      planes.push_back(slot);
    else
      entries.push_back({slot, geoms[slot].bounds});
  }
  std::ranges::sort(planes);
  if (!entries.empty()) tree.add(entries);
  for (const std::uint32_t slot : moved)
    if (!is_plane(slot)) tree.move(slot, geoms[slot].previous_bounds, geoms[slot].bounds);
}

std::span<const MirroredGeom> SpaceMirror::geoms() const { return impl_->geoms; }
std::span<const std::uint32_t> SpaceMirror::added() const { return impl_->added; }
std::span<const std::uint32_t> SpaceMirror::removed() const { return impl_->removed; }
std::span<const std::uint32_t> SpaceMirror::moved() const { return impl_->moved; }
double SpaceMirror::way_on(std::uint32_t slot) const {
  const bool moves_on =
      std::ranges::binary_search(impl_->moved, slot) && std::ranges::binary_search(impl_->moved_before, slot);
  return moves_on ? std::min(impl_->geoms[slot].last_way, way_of(impl_->geoms[slot])) : 0.0;
}

GeomPlace SpaceMirror::place_of(std::uint32_t slot) const {
  const MirroredGeom& geom = impl_->geoms[slot];
  return {geom.position, geom.bounds.min(), geom.bounds.max(), geom.body != nullptr};
}

std::optional<std::uint32_t> SpaceMirror::find_at(const GeomPlace& place,
                                                  std::span<const std::uint32_t> but) const {
  const auto alike = [](const Vec3& a, const Vec3& b) {  // to rounding, and where both are without end
    return (a.array() == b.array() || (a - b).array().abs() <= kRounding).all();
  };
  for (std::uint32_t slot = 0; slot < impl_->geoms.size(); ++slot) {
    const MirroredGeom& geom = impl_->geoms[slot];
    if (geom.geom && (geom.body != nullptr) == place.has_body && alike(geom.position, place.position) &&
        alike(geom.bounds.min(), place.low) && alike(geom.bounds.max(), place.high) &&
        std::ranges::find(but, slot) == but.end())
      return slot;
  }
  return std::nullopt;
}

void SpaceMirror::archive(StateArchive& a) {
  struct Course {
    GeomPlace at, from;
    Quat turned_from = Quat::Identity();
  };
  std::vector<Course> courses;
  std::vector<Sighting> sightings;
  std::vector<MirroredGeom>& geoms = impl_->geoms;
  if (!a.reading()) sightings = impl_->find_sightings(*this);
  for (const std::uint32_t slot : impl_->moved) {
    const MirroredGeom& geom = geoms[slot];
    if (!geom.body)
      courses.push_back({place_of(slot),
                         {geom.previous_position, geom.previous_bounds.min(), geom.previous_bounds.max()},
                         geom.previous_orientation});
  }
  a(courses, sightings);
  if (!a.reading()) return;
  impl_->moved.clear();
  for (const Course& course : courses) {
    const std::optional<std::uint32_t> slot = find_at(course.at, impl_->moved);
    if (!slot) continue;
    impl_->moved.push_back(*slot);
    geoms[*slot].previous_position = course.from.position,
    geoms[*slot].previous_orientation = course.turned_from,
    geoms[*slot].previous_bounds = {course.from.low, course.from.high};
  }
  std::vector<std::uint32_t> taken;
  for (const Sighting& sighting : sightings)
    if (const std::optional<std::uint32_t> slot = find_at(sighting.now, taken)) {
      taken.push_back(*slot);
      impl_->take(sighting, *slot);
    }
  std::ranges::sort(impl_->moved);
}

// Of those that the space has still: of the others the caller may have destroyed any.
std::vector<Sighting> SpaceMirror::Impl::find_sightings(const SpaceMirror& self) const {
  std::vector<std::uint32_t> there;
  self.find_bodied_now(there);
  std::vector<Sighting> found;
  for (const std::uint32_t slot : there) {
    const MirroredGeom& geom = geoms[slot];
    const std::size_t place = place_in_bodied(slot);
    const Pose now = lodestone::pose_of(geom.geom, true);
    const bool has_moved = std::ranges::binary_search(moved, slot);
    if (!has_moved && now == seen[slot].pose) continue;
    const Eigen::AlignedBox3d bounds = box_of(now.bounds);
    found.push_back({.now = {to_vec3(now.position.data()), bounds.min(), bounds.max(), true},
                     .pose = seen[slot].pose,
                     .orientation = geom.orientation,
                     .from = {geom.previous_position, geom.previous_bounds.min(), geom.previous_bounds.max()},
                     .turned_from = geom.previous_orientation,
                     .last_way = geom.last_way,
                     .followed = {Vec3::Zero(), followed[place].min(), followed[place].max()},
                     .has_moved = has_moved});
  }
  return found;
}

// The next refresh is to find it moved from there.
void SpaceMirror::Impl::take(const Sighting& sighting, std::uint32_t slot) {
  MirroredGeom& geom = geoms[slot];
  seen[slot].pose = sighting.pose;
  ++order[sights[slot].place].print;
  geom.position = to_vec3(sighting.pose.position.data()), geom.orientation = sighting.orientation,
  geom.bounds = box_of(sighting.pose.bounds);
  geom.previous_position = sighting.from.position, geom.previous_orientation = sighting.turned_from,
  geom.previous_bounds = {sighting.from.low, sighting.from.high};
  geom.last_way = sighting.last_way;
  followed[place_in_bodied(slot)] = {sighting.followed.low, sighting.followed.high};
  if (sighting.has_moved) moved.push_back(slot);
}

std::span<const std::uint32_t> SpaceMirror::planes() const { return impl_->planes; }
std::span<const std::uint32_t> SpaceMirror::bodied() const { return impl_->bodied; }
std::span<const Eigen::AlignedBox3d> SpaceMirror::disturbed() const { return impl_->disturbed; }

void SpaceMirror::follow() {
  for (std::size_t i = 0; i < impl_->bodied.size(); ++i)
    if (dBodyIsEnabled(impl_->geoms[impl_->bodied[i]].body)) impl_->follow(i);
}

void SpaceMirror::Impl::follow(std::size_t index) {
  const std::uint32_t slot = bodied[index];
  std::array<dReal, 6> bounds;
  dGeomGetAABB(geoms[slot].geom, bounds.data());
  const Eigen::AlignedBox3d now = box_of(bounds);
  if (geoms[slot].kind != GeomKind::plane) tree.move(slot, followed[index], now);
  followed[index] = now;
}

void SpaceMirror::find_bodied_now(std::vector<std::uint32_t>& slots) const {
  const Impl& all = *impl_;
  std::size_t cursor = 0, left = all.bodied.size();  // these are mostly the first that a space gives out, as
                                                     // they came last or move
  if (left > 0)
    all.walk(all.space, ~0u, ~0u, [&](dGeomID geom, int, unsigned, unsigned) {
      if (cursor == all.order.size() || all.order[cursor].geom != geom) {
        const auto known = all.slots.find(geom);
        if (known == all.slots.end()) return true;
        cursor = all.sights[known->second].place;
      }
      const Given& given = all.order[cursor++];
      if (given.body && dGeomGetBody(geom) == given.body) slots.push_back(given.slot), --left;
      return left > 0;
    });
  std::ranges::sort(slots);
}

void SpaceMirror::find_followed(const Eigen::AlignedBox3d& box, std::vector<std::uint32_t>& found) const {
  impl_->tree.find(box, found);
}

void SpaceMirror::find_near(const Eigen::AlignedBox3d& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  impl_->tree.find(box, found);
  std::erase_if(found, [&](std::uint32_t slot) { return !impl_->geoms[slot].bounds.intersects(box); });
  std::ranges::sort(found);
}

}  // namespace lodestone
