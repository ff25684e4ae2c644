#include "lod/manager/query_scene.h"

#include <algorithm>

namespace lodestone {
namespace {

// Which bodies a thread has looked at for its question.
class Seen {
 public:
  explicit Seen(std::size_t bodies) {
    if (marks().size() < bodies) marks().resize(bodies, 0);
    ++question();
  }
  bool first_time(std::uint32_t body) {
    std::uint64_t& mark = marks()[body];
    return mark != question() && (mark = question(), true);
  }

 private:
  static std::vector<std::uint64_t>& marks() {
    thread_local std::vector<std::uint64_t> of_bodies;
    return of_bodies;
  }
  static std::uint64_t& question() {
    thread_local std::uint64_t number = 0;
    return number;
  }
};

bool comes_before(const QueryHit& a, const QueryHit& b) {
  if (a.distance != b.distance) return a.distance < b.distance;
  if (a.who.kind != b.who.kind) return a.who.kind < b.who.kind;
  return a.who.body.index < b.who.body.index;
}

QueryHit hit_of(const ContactSide& who, const SurfaceHit& hit) {
  return {who, hit.point, hit.normal, hit.distance};
}

}  // namespace

void QueryScene::finish(std::span<const BodyId> fell_asleep, std::span<const BodyId> moved_and_slept) {
  stale_ = true, under_way_ = false;
  for (const auto& list : {fell_asleep, moved_and_slept})
    for (const BodyId body : list) lay_down(body.index);
}

// Where nobody asks for long it is cheaper to begin anew.
void QueryScene::lay_down(std::uint32_t body) {
  stale_ = true;
  if (!in_use_) return;
  slept_.push_back(body);
  if (slept_.size() > levels_.bodies.indices()) forget_all();
}

void QueryScene::put(std::uint32_t body) {
  if (levels_.bodies.alive(body))
    grid_.put(body, levels_.state(body).position, levels_.bodies.shape(body)->radius);
}

QueryScene::Asked QueryScene::prepare(const QueryFilter& filter) {
  const std::lock_guard lock(
      access_);  // also to the caller's space, in which a look at its geoms keeps its place
  update_grid();
  Asked asked{.filter = filter, .callers = {}};
  if (filter.callers) asked.callers = levels_.callers_parts();
  return asked;
}

void QueryScene::update_grid() {
  if (!stale_) return;
  if (in_use_) {
    std::vector<std::uint32_t> moved = std::move(slept_);
    if (levels_.statistical) levels_.statistical->find_awake(moved);
    for (const FullLevel::Member& member : levels_.full.members()) moved.push_back(member.owner);
    for (std::size_t i = 0; i < levels_.bodies.newcomers().size(); ++i)
      if (levels_.bodies.waits_at(i)) moved.push_back(levels_.bodies.newcomers()[i].index);
    for (const std::uint32_t body : moved) put(body);
  } else {
    for (std::uint32_t body = 0; body < levels_.bodies.indices(); ++body) put(body);
  }
  slept_.clear();
  in_use_ = true;
  stale_ = under_way_;
}

bool QueryScene::passes(std::uint32_t body, const QueryFilter& filter) const {
  return (levels_.bodies.properties(body).category & filter.categories) != 0 &&
         levels_.bodies.id(body) != filter.except;
}

PosedSurface QueryScene::surface_of(std::uint32_t body, const Vec3& position, const Quat& orientation) {
  const std::shared_ptr<const Shape>& shape = levels_.bodies.shape(body);
  if (shape->sphere_radius) return {nullptr, *shape->sphere_radius, position, orientation};
  return {&trees_.of(shape), 0.0, position, orientation};
}

std::optional<QueryHit> QueryScene::meet_body(std::uint32_t body, const Sweep& sweep) {
  const RigidState state = levels_.state(body);
  const double reach = levels_.bodies.shape(body)->radius + sweep.radius;
  if (!meet_sphere(sweep.from, sweep.direction, sweep.length, state.position, reach)) return {};
  const auto hit = meet(surface_of(body, state.position, state.orientation), sweep);
  if (!hit) return {};
  return hit_of({.kind = ContactSide::Kind::body,
                 .body = levels_.bodies.id(body),
                 .material = levels_.bodies[body].material},
                *hit);
}

std::optional<QueryHit> QueryScene::overlap_body(std::uint32_t body, const Volume& volume) {
  const RigidState state = levels_.state(body);
  if ((state.position - volume.center).norm() > levels_.bodies.shape(body)->radius + volume.reach) return {};
  const auto hit = overlap(surface_of(body, state.position, state.orientation), volume);
  if (!hit) return {};
  return hit_of({.kind = ContactSide::Kind::body,
                 .body = levels_.bodies.id(body),
                 .material = levels_.bodies[body].material},
                *hit);
}

std::optional<QueryHit> QueryScene::first(const Sweep& sweep, const Asked& asked) {
  std::optional<QueryHit> nearest;
  Sweep left = sweep;
  const auto take = [&](const QueryHit& hit) {
    if (!nearest || comes_before(hit, *nearest)) nearest = hit, left.length = hit.distance;
  };
  if (asked.filter.ground) ground_.meet(sweep, take);
  callers_.meet(asked.callers, asked.filter.categories, left, take);
  if (!asked.filter.bodies) return nearest;
  Seen seen(levels_.bodies.indices());
  grid_.find_along(sweep.from, sweep.direction, left.length, sweep.radius, [&](std::uint32_t body) {
    if (seen.first_time(body) && passes(body, asked.filter))
      if (const auto hit = meet_body(body, left)) take(*hit);
    return left.length;
  });
  return nearest;
}

void QueryScene::all(const Sweep& sweep, const Asked& asked, std::vector<QueryHit>& hits) {
  const auto before = std::ptrdiff_t(hits.size());
  if (asked.filter.ground) ground_.meet(sweep, [&](const QueryHit& hit) { hits.push_back(hit); });
  callers_.meet(asked.callers, asked.filter.categories, sweep,
                [&](const QueryHit& hit) { hits.push_back(hit); });
  if (asked.filter.bodies) {
    Seen seen(levels_.bodies.indices());
    grid_.find_along(sweep.from, sweep.direction, sweep.length, sweep.radius, [&](std::uint32_t body) {
      if (seen.first_time(body) && passes(body, asked.filter))
        if (const auto hit = meet_body(body, sweep)) hits.push_back(*hit);
      return sweep.length;
    });
  }
  std::sort(hits.begin() + before, hits.end(), comes_before);
}

void QueryScene::overlaps(const Volume& volume, const Asked& asked, std::vector<QueryHit>& hits) {
  const auto before = std::ptrdiff_t(hits.size());
  if (asked.filter.ground) ground_.overlap(volume, [&](const QueryHit& hit) { hits.push_back(hit); });
  callers_.overlap(asked.callers, asked.filter.categories, volume,
                   [&](const QueryHit& hit) { hits.push_back(hit); });
  if (asked.filter.bodies) {
    Seen seen(levels_.bodies.indices());
    const Vec3 reach = Vec3::Constant(volume.reach);
    grid_.find_near({volume.center - reach, volume.center + reach}, [&](std::uint32_t body) {
      if (seen.first_time(body) && passes(body, asked.filter))
        if (const auto hit = overlap_body(body, volume)) hits.push_back(*hit);
    });
  }
  std::sort(hits.begin() + before, hits.end(), comes_before);
}

}  // namespace lodestone
