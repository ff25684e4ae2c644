#include "reference/ode/space_mirror.h"

#include <algorithm>

#include "reference/ode/geometry_ode.h"
#include "reference/ode/space_mirror_ode.h"

namespace lodestone {

using namespace ode;

namespace {

constexpr std::size_t kAhead = 4;  // memory of a geom is asked for so many geoms before it is looked at

// Asks for the memory of a geom and of its pose, which ODE keeps beside it. Harmless for one that is gone.
void prefetch(dGeomID geom) {
  const char* const at = reinterpret_cast<const char*>(geom);
  for (int line = 0; line < 6; ++line) __builtin_prefetch(at + 64 * line);
}

bool is_space(int geom_class) { return geom_class >= dFirstSpaceClass && geom_class <= dLastSpaceClass; }

void copy_pose(const KnownGeom& known, MirroredGeom& geom) {
  geom.bounds = bounding_box_of(known.pose.bounds);
  if (!is_placeable(known.identity.geom)) return;
  geom.position = to_vec3(known.pose.position.data());
  dQuaternion q;
  dGeomGetQuaternion(known.identity.geom, q);
  geom.orientation = to_quat(q);
}

// m, since the refresh before: no point of it has come farther.
double way_of(const MirroredGeom& geom) {
  const double turn = geom.previous_orientation.angularDistance(geom.orientation),
               rim = (geom.bounds.center() - geom.position).norm() + 0.5 * geom.bounds.sizes().norm();
  return (geom.position - geom.previous_position).norm() + (turn > 0.0 ? turn * rim : 0.0);
}

MirroredGeom mirror(const KnownGeom& known) {
  const GeomIdentity& is = known.identity;
  MirroredGeom geom;
  geom.geom = is.geom, geom.body = is.body, geom.dynamic = is.dynamic;
  geom.kind = kind_of(is.geom);
  geom.category = is.category, geom.collide = is.collide;
  if (geom.kind == GeomKind::plane) geom.normal = to_vec3(is.sizes.data()), geom.offset = is.sizes[3];
  copy_pose(known, geom);
  geom.previous_position = geom.position, geom.previous_orientation = geom.orientation,
  geom.previous_bounds = geom.bounds;
  return geom;
}

}  // namespace

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

void SpaceMirror::Impl::look_at(dGeomID geom, int geom_class, unsigned category, unsigned collide) {
  if (cursor + kAhead < last_order.size()) prefetch(last_order[cursor + kAhead].geom);
  const bool placeable = is_placeable(geom);
  if (is_spoilt(geom, geom_class, placeable)) return;
  const std::uint64_t content = geom_class == dTriMeshClass ? content_of(geom, mesh_probe) : 0,
                      print = fingerprint_of(geom, geom_class, placeable, category, collide, content);
  const ListedGeom* last = find_last(geom);
  if (last && last->print == print) return note(*last);
  const KnownGeom found{geom_identity_of(geom, geom_class, category, collide, content),
                        geom_pose_of(geom, placeable)};
  if (!last || known[last->slot].identity != found.identity ||
      is_reshaped(known[last->slot].pose, found.pose))
    return add(found, print);
  const std::uint32_t slot = last->slot;
  note({geom, last->body, print, slot});
  if (known[slot].pose == found.pose) return;
  known[slot].pose = found.pose;
  copy_pose(known[slot], geoms[slot]);
  moved.push_back(slot);
}

// As it was given out the last time; null: it was not. A space mostly gives its geoms out in the same order;
// one that was moved or is new may come earlier.
const ListedGeom* SpaceMirror::Impl::find_last(dGeomID geom) {
  if (cursor == last_order.size() || last_order[cursor].geom != geom) {
    const auto found = slots.find(geom);
    if (found == slots.end() || last_seen[found->second].at == refreshes) return nullptr;
    cursor = last_seen[found->second].place;
  }
  return &last_order[cursor++];
}

void SpaceMirror::Impl::note(const ListedGeom& given) {
  last_seen[given.slot] = {refreshes, std::uint32_t(order.size())};
  order.push_back(given);
}

void SpaceMirror::Impl::add(const KnownGeom& found, std::uint64_t print) {
  std::uint32_t slot = std::uint32_t(known.size());
  if (free.empty()) {
    known.emplace_back();
    last_seen.emplace_back();
    geoms.emplace_back();
  } else {
    slot = free.back();
    free.pop_back();
  }
  known[slot] = found;
  geoms[slot] = mirror(found);
  slots[found.identity.geom] = slot;
  note({found.identity.geom, found.identity.body, print, slot});
  added.push_back(slot);
}

void SpaceMirror::Impl::drop_unseen() {
  const bool all_seen = added.empty() && order.size() == last_order.size();
  for (const auto& [geom, body, print, slot] : last_order) {
    if (all_seen) break;
    if (last_seen[slot].at == refreshes) continue;
    const auto entry = slots.find(geom);
    if (entry->second == slot) slots.erase(entry);  // else another has its address
    known[slot].identity.geom = geoms[slot].geom = nullptr;
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
  const Eigen::AlignedBox3d now = bounding_box_of(bounds);
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
        cursor = all.last_seen[known->second].place;
      }
      const ListedGeom& given = all.order[cursor++];
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
