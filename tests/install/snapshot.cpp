// A heap on all three rungs is stepped, kept, stepped on; restored, in the same manager and in another one,
// the same steps give the same states, to the bit.
#include <lodestone/lodestone.h>
#include <ode/ode.h>

#include <cstring>
#include <string>
#include <vector>

#include "check.h"

using namespace lodestone;

namespace {

constexpr double kStep = 1.0 / 60.0;

using Shapes = std::vector<std::shared_ptr<const Shape>>;

Shapes make_shapes() {
  return {std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4}))),
          std::make_shared<const Shape>(make_shape("letter", make_l(0.3, 0.2, 0.08, 0.1))),
          std::make_shared<const Shape>(make_sphere_shape(0.15))};
}

ManagerSettings settings_of(const decltype(PolicySettings::policy)& policy, int threads) {
  return {.seed = 7,
          .threads = threads,
          .policy = {.policy = policy, .min_dwell_frames = 10, .max_transitions_per_frame = 8},
          .signature_timing = SignatureTiming::in_step};
}

void fill(Manager& manager, const Shapes& shapes, int count) {
  for (int i = 0; i < count; ++i) {
    const double turn = 0.7 * i;
    manager.add_body(
        {.shape = shapes[std::size_t(i) % shapes.size()],
         .state = {.position = Vec3(0.42 * (i % 9) - 1.7, 0.42 * (i / 9 % 9) - 1.7, 0.5 + 0.45 * (i / 81)),
                   .orientation = Quat(std::cos(turn), 0.0, std::sin(turn), 0.0),
                   .velocity = Vec3(0.1 * (i % 5), -0.1 * (i % 7), 0.0)}});
  }
}

// What a game does to it: a camera that goes about, a body pushed, one added and one removed now and then.
void play(Manager& manager, const Shapes& shapes, const std::vector<BodyId>& pushed, int from, int steps) {
  for (int i = from; i < from + steps; ++i) {
    const Vec3 camera(2.5 * std::sin(0.02 * i), 2.5 * std::cos(0.013 * i), 0.5);
    manager.set_viewpoints({&camera, 1});
    const BodyId body = pushed[std::size_t(i) % pushed.size()];
    if (i % 11 == 0 && manager.valid(body)) manager.add_force(body, Vec3(0.0, 0.0, 400.0));
    if (i % 37 == 0)
      manager.add_body(
          {.shape = shapes[std::size_t(i) % shapes.size()], .state = {.position = Vec3(0.0, 0.0, 3.0)}});
    if (i % 53 == 0 && manager.valid(body)) manager.remove_body(body);
    manager.step(kStep);
  }
}

struct Kept {
  std::vector<std::byte> bytes;
  std::uint64_t then = 0, later = 0, last = 0;
};

template <class MakeManager>
void check_heap(const char* name, const Shapes& shapes, int count, int before, int after,
                const MakeManager& make) {
  std::vector<BodyId> ids;
  Manager manager = make(1);
  fill(manager, shapes, count);
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) ids.push_back({i, 1});
  play(manager, shapes, ids, 0, before);
  Kept kept{.bytes = manager.snapshot(), .then = manager.state_hash()};
  const StepReport report = manager.report();
  std::printf("%s: %d full, %d support, %d tables, %d asleep; %zu bytes\n", name, report.full, report.support,
              report.tables, report.asleep, kept.bytes.size());
  check::that(report.full > 0 && report.support > 0 && report.tables > 0, "bodies are on all three rungs");
  play(manager, shapes, ids, before, 1);
  kept.later = manager.state_hash();
  play(manager, shapes, ids, before + 1, after - 1);
  kept.last = manager.state_hash();
  const std::int64_t changes = manager.report().step;

  const auto repeats = [&](Manager& other, const std::string& who) {
    check::that(other.state_hash() == kept.then &&
                    other.report().counters.promotions_put_off == report.counters.promotions_put_off,
                (who + ": the state that was kept").c_str());
    play(other, shapes, ids, before, 1);
    check::that(other.state_hash() == kept.later, (who + ": the next step").c_str());
    play(other, shapes, ids, before + 1, after - 1);
    check::that(other.state_hash() == kept.last && other.report().step == changes,
                (who + ": all the steps").c_str());
  };
  manager.restore(kept.bytes);
  repeats(manager, std::string(name) + ", the same manager");
  Manager fresh = make(2);
  const Shapes own = make_shapes();
  fresh.restore(kept.bytes, own);
  repeats(fresh, std::string(name) + ", another manager, on two threads");
}

// Bodies that a ray of their own height, from above, finds where they are.
int found_where_they_are(const Manager& manager, const std::vector<BodyId>& bodies) {
  int found = 0;
  for (const BodyId body : bodies) {
    const Vec3 above = manager.state(body).position + Vec3(0, 0, 0.25);
    std::vector<QueryHit> hits[1];
    const Ray ray{.from = above, .length = 0.5};
    manager.cast_rays_through({&ray, 1}, hits);
    for (const QueryHit& hit : hits[0]) found += hit.who.body == body;
  }
  return found;
}

// What is kept of places for later questions must not outlive the places.
void check_places(const Shapes& shapes) {
  Manager manager({.policy = {.policy = DistancePolicy{.full_within = 1e3}},
                   .signature_timing = SignatureTiming::in_step});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const Vec3 camera(0, 0, 1);
  manager.set_viewpoints({&camera, 1});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 50; ++i) {
    const LevelChoice level = i < 40   ? LevelChoice::full
                              : i < 45 ? LevelChoice::support
                                       : LevelChoice::tables;
    bodies.push_back(manager.add_body({.shape = shapes[0],
                                       .state = {.position = Vec3((i < 40 ? 0.3 : 2.0) * i, 0.0, 0.2)},
                                       .level = level}));
  }
  manager.step(kStep);
  for (const BodyId body : bodies) manager.sleep(body);
  manager.step(kStep);
  check::within(found_where_they_are(manager, bodies), 50, 50, "bodies met where they are");
  const std::vector<std::byte> kept = manager.snapshot();
  for (const BodyId body : bodies) {
    RigidState there = manager.state(body);
    there.position += Vec3(0.5, 40.0, 1.0);
    manager.set_state(body, there);
  }
  manager.add_body({.shape = shapes[0], .state = {.position = Vec3(0.0, 80.0, 5.0)}});
  manager.step(kStep);
  manager.step(kStep);
  check::that(manager.moved().size() == 51, "they fall");
  check::within(found_where_they_are(manager, bodies), 50, 50, "bodies met where they fall");
  manager.set_state(bodies[0], manager.state(bodies[0]));
  manager.restore(kept);
  check::that(manager.moved().empty() && manager.woke().empty() && manager.fell_asleep().empty() &&
                  manager.rung_changes().empty(),
              "a restored manager tells of no step");
  check::within(found_where_they_are(manager, bodies), 50, 50, "bodies met where they are again");
  const Ray across{.from = {-5, 40, 1.2}, .direction = {1, 0, 0}, .length = 200};
  check::that(!manager.cast_ray(across), "none where they fell");
  check::that(manager.asleep(bodies[1]), "a restored sleeper sleeps");
  RigidState away = manager.state(bodies[0]);
  away.position.z() += 3.0;
  manager.set_state(bodies[0], away);
  check::that(!manager.asleep(bodies[1]), "it wakes when what was beside it is taken away");
  manager.step(kStep);
  check::that(manager.woke().size() == 2 && manager.fell_asleep().empty(), "both are told of, nobody else");
}

// Those whose way to rest is compared are of the world that was left.
void check_audit(const Shapes& shapes) {
  ManagerSettings settings = settings_of(DistancePolicy{.full_within = 1.2}, 1);
  settings.audit_ms = 0.01;
  Manager manager(settings);
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const std::vector<std::byte> kept = manager.snapshot();
  Vec3 camera(0, 0, 0.5);
  manager.set_viewpoints({&camera, 1});
  for (int i = 0; i < 20; ++i)
    manager.add_body(
        {.shape = shapes[0], .state = {.position = Vec3(0.5 * (i % 5) - 1.0, 0.5 * (i / 5) - 0.75, 1.0)}});
  for (int i = 0; i < 20; ++i) manager.step(kStep);
  camera = Vec3(100, 0, 0.5);
  manager.set_viewpoints({&camera, 1});
  for (int i = 0; i < 20; ++i) manager.step(kStep);
  const int watched = manager.report().audit.watched, left_out = manager.report().audit.left_out;
  check::that(watched > 0, "some are watched on their way to rest");
  manager.restore(kept);
  manager.step(kStep);
  check::within(manager.report().audit.watched, 0, 0, "watched of a world that was left");
  check::within(manager.report().audit.left_out, left_out + watched, left_out + watched,
                "left out of the comparison");
}

bool refuses(Manager& manager, std::span<const std::byte> bytes, const char* because) {
  const std::uint64_t before = manager.state_hash();
  try {
    manager.restore(bytes);
  } catch (const InputError& error) {
    const bool said = std::string(error.what()).find(because) != std::string::npos;
    if (!said) std::printf("it said: %s\n", error.what());
    return said && manager.state_hash() == before;
  }
  return false;
}

void check_refusals(const Shapes& shapes) {
  const auto make = [&](std::uint64_t seed) {
    Manager manager({.seed = seed,
                     .policy = {.policy = DistancePolicy{.full_within = 2.0}},
                     .signature_timing = SignatureTiming::in_step});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const Vec3 camera(0, 0, 1);
    manager.set_viewpoints({&camera, 1});
    return manager;
  };
  Manager manager = make(1);
  fill(manager, shapes, 12);
  for (int i = 0; i < 20; ++i) manager.step(kStep);
  const std::vector<std::byte> good = manager.snapshot();
  manager.step(kStep);

  int refused = 0;
  for (std::size_t length = 0; length < good.size(); length += 397)
    refused += refuses(manager, std::span(good).first(length), "");
  check::within(refused, double((good.size() + 396) / 397), double((good.size() + 396) / 397),
                "snapshots cut short that were refused");
  int damaged = 0, places = 0;
  for (std::size_t at = 0; at < good.size(); at += 431, ++places) {
    std::vector<std::byte> bytes = good;
    bytes[at] ^= std::byte(4);
    damaged += refuses(manager, bytes, "");
  }
  check::within(damaged, places, places, "damaged snapshots that were refused");
  Manager seeded = make(2);
  check::that(refuses(seeded, good, "seed 1, expected one with seed 2"), "another seed is named");
  Manager bare({.signature_timing = SignatureTiming::in_step});
  check::that(refuses(bare, good, "other planes"), "other ground is named");
  Manager empty = make(1);
  check::that(refuses(empty, good, "a shape that is not here"), "a missing shape is named");
  manager.restore(good);
  check::that(manager.snapshot().size() == good.size(), "the snapshot itself is taken");
}

}  // namespace

int main() {
  const Shapes shapes = make_shapes();
  const auto own_world = [&](const auto& policy) {
    return [policy](int threads) {
      Manager manager(settings_of(policy, threads));
      manager.add_plane(Vec3::UnitZ(), 0.0);
      manager.add_plane(Vec3(0.6, 0.0, 0.8), -1.5);
      manager.add_static_box({0.5, 0.5, 0.2}, {1.0, 1.0, 0.1}, Quat::Identity());
      return manager;
    };
  };
  check_heap("distance", shapes, 70, 100, 200,
             own_world(DistancePolicy{.full_within = 1.2, .support_within = 2.0}));
  check_heap("distance, late", shapes, 60, 300, 60,
             own_world(DistancePolicy{.full_within = 1.2, .support_within = 2.0}));
  check_heap("work budget", shapes, 90, 60, 60, own_world(WorkPolicy{.budget_work = 3000.0}));

  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  dCreatePlane(space, 0, 0, 1, 0);
  {
    Manager manager(world, space, settings_of(DistancePolicy{.full_within = 1.2, .support_within = 2.0}, 1));
    fill(manager, shapes, 60);
    std::vector<BodyId> ids;
    for (std::uint32_t i = 0; i < 60; ++i) ids.push_back({i, 1});
    play(manager, shapes, ids, 0, 60);
    const std::vector<std::byte> kept = manager.snapshot();
    play(manager, shapes, ids, 60, 60);
    const std::uint64_t last = manager.state_hash();
    manager.restore(kept);
    play(manager, shapes, ids, 60, 60);
    check::that(manager.state_hash() == last, "in a caller's world");
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
  check_refusals(shapes);
  check_places(shapes);
  check_audit(shapes);
  return check::result();
}
