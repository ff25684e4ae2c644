// What touched what: between any two rungs and the ground; when it begins, how hard it hits, when it ends;
// nothing where nobody asks.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "check.h"
#include "crate.h"

using namespace lodestone;

const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.15));

struct Told {
  int begins = 0, hits = 0, ends = 0;
  double impulse = 0.0, speed = 0.0;  // of the first hit
  Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
  bool asleep_at_end = false;
};

// What is said of a body and of what it meets, until it has lain still.
Told watch(Manager& manager, BodyId first, BodyId second, double seconds) {
  Told told;
  for (int i = 0; i < std::lround(seconds / kFrame); ++i) {
    manager.step(kFrame);
    for (const ContactEvent& event : manager.contact_events()) {
      if (event.first.body != first || event.second.body != second) continue;
      if (event.phase == ContactPhase::begin) ++told.begins;
      if (event.phase == ContactPhase::end) ++told.ends;
      if (event.phase != ContactPhase::hit) continue;
      if (told.hits++ == 0)
        told.impulse = event.impulse, told.speed = event.speed, told.point = event.point,
        told.normal = event.normal;
    }
  }
  return told;
}

ManagerSettings settings() {
  ManagerSettings s;
  s.signature_timing = SignatureTiming::in_step;
  s.events.all_bodies = true;
  return s;
}

// A ball that falls .5 m onto the ground: v = 3.13 m/s, and bounces with e = .4.
void ground(LevelChoice level, const char* what, double tolerance) {
  Manager manager(settings());
  manager.add_plane({0, 0, 1}, 0.0);
  const BodyId body = manager.add_body({.shape = ball, .state = at(0, 0.65), .level = level});
  const Told told = watch(manager, body, {}, 3.0);
  std::printf("     %s: %d begins, %d hits, %d ends\n", what, told.begins, told.hits, told.ends);
  const double speed = std::sqrt(2 * 9.81 * 0.5), impulse = manager.mass(body) * speed * 1.4;
  check::within(told.speed, speed * (1 - tolerance), speed * (1 + tolerance), "m/s at the first hit");
  check::within(told.impulse, impulse * (1 - 2 * tolerance), impulse * (1 + 2 * tolerance), "N s of it");
  check::within((told.normal - Vec3::UnitZ()).norm() + std::abs(told.point.z()), 0, 0.06,
                "off the ground and its normal");
  check::within(told.begins - told.ends, 1, 1, "begins less ends of one that lies there at last");
  check::within(told.hits, 2, 6, "hits above .5 m/s");
}

// One ball onto another that lies on the ground.
void pair(LevelChoice upper, LevelChoice lower, const char* what) {
  Manager manager(settings());
  manager.add_plane({0, 0, 1}, 0.0);
  const BodyId below = manager.add_body({.shape = crate, .state = at(0, 0.15), .level = lower}),
               above = manager.add_body({.shape = crate, .state = at(0.01, 0.75), .level = upper});
  const Told told = watch(manager, below, above, 3.0);
  std::printf("     %s: %d begins, %d hits, %d ends\n", what, told.begins, told.hits, told.ends);
  const double speed = std::sqrt(2 * 9.81 * 0.3);
  check::within(told.speed, 0.8 * speed, 1.1 * speed, "m/s at the first hit");
  check::within(told.impulse, 0.3 * manager.mass(above) * speed, 2.0 * manager.mass(above) * speed,
                "N s of it");
  check::that(told.normal.z() < -0.9, "the normal points into the first");
  check::within(told.begins - told.ends, 1, 1, "begins less ends of two that lie on each other at last");
}

void sleepers_and_removal() {
  Manager manager(settings());
  manager.add_plane({0, 0, 1}, 0.0);
  const BodyId body =
      manager.add_body({.shape = crate, .state = at(0, 0.151), .level = LevelChoice::support});
  const Told before = watch(manager, body, {}, 2.0);
  check::that(before.begins == 1 && before.ends == 0 && manager.asleep(body),
              "one that sleeps where it lies touches still");
  manager.wake(body);
  const Told woken = watch(manager, body, {}, 0.5);
  check::within(woken.begins + woken.ends, 0, 0, "and begins nothing as it wakes");
  manager.set_state(body, at(0, 3));
  const Told lifted = watch(manager, body, {}, 0.3);
  check::within(lifted.ends, 1, 1, "ends, as it is taken away");
  watch(manager, body, {}, 3.0);
  manager.remove_body(body);
  const Told gone = watch(manager, body, {}, 0.1);
  check::within(gone.ends, 1, 1, "ends, as it is removed in its sleep");
}

void only_who_asks() {
  ManagerSettings s = settings();
  s.events.all_bodies = false;
  Manager manager(s);
  manager.add_plane({0, 0, 1}, 0.0);
  const BodyId quiet = manager.add_body({.shape = crate, .state = at(0, 0.5), .level = LevelChoice::support});
  manager.add_body({.shape = crate, .state = at(2, 0.5), .level = LevelChoice::support, .events = true});
  std::size_t told = 0, of_others = 0;
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    told += manager.contact_events().size();
    for (const ContactEvent& event : manager.contact_events()) of_others += event.first.body == quiet;
  }
  check::within(double(told), 2, 20, "events of one that asks");
  check::within(double(of_others), 0, 0, "events of one that does not");
}

// The same on any number of threads.
std::vector<ContactEvent> collect(int threads) {
  ManagerSettings s = settings();
  s.threads = threads;
  Manager manager(s);
  manager.add_plane({0, 0, 1}, 0.0);
  for (int i = 0; i < 200; ++i)
    manager.add_body({.shape = crate,
                      .state = {Vec3(i % 5 * 0.31, i / 5 % 5 * 0.31, 0.3 + 0.35 * (i / 25)), Quat::Identity(),
                                Vec3::Zero(), Vec3::Zero()},
                      .level = i % 3 ? LevelChoice::support : LevelChoice::tables});
  std::vector<ContactEvent> all;
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    all.insert(all.end(), manager.contact_events().begin(), manager.contact_events().end());
  }
  return all;
}

int main() {
  ground(LevelChoice::support, "support on ground", 0.02);
  ground(LevelChoice::tables, "tables on ground", 0.1);
  ground(LevelChoice::full, "full on ground", 0.02);
  pair(LevelChoice::support, LevelChoice::support, "support on support");
  pair(LevelChoice::tables, LevelChoice::support, "tables on support");
  pair(LevelChoice::full, LevelChoice::support, "full on support");
  pair(LevelChoice::support, LevelChoice::full, "support on full");
  pair(LevelChoice::full, LevelChoice::full, "full on full");
  sleepers_and_removal();
  only_who_asks();
  const std::vector<ContactEvent> one = collect(1), two = collect(2);
  bool same = one.size() == two.size();
  for (std::size_t i = 0; same && i < one.size(); ++i)
    same = one[i].phase == two[i].phase && one[i].first.body == two[i].first.body &&
           one[i].second.body == two[i].second.body && one[i].impulse == two[i].impulse &&
           one[i].point == two[i].point;
  check::within(double(one.size()), 200, 100000,
                "events of 200 bodies that fall into a heap, on two statistical rungs");
  check::that(same, "the same on two threads");
  return check::result();
}
