// What is done to a manager is recorded and done again: the same to the bit, or else the first step and body
// that come out otherwise are named.
#include <lodestone/lodestone.h>

#include <string>
#include <vector>

#include "check.h"

using namespace lodestone;

namespace {

using Bytes = std::vector<std::byte>;
using Shapes = std::vector<std::shared_ptr<const Shape>>;

constexpr double kStep = 1.0 / 60.0;
constexpr int kSteps = 120;

Shapes make_shapes() {
  return {std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4}))),
          std::make_shared<const Shape>(make_shape("letter", make_l(0.3, 0.2, 0.08, 0.1)))};
}

Manager make_manager(int threads) {
  Manager manager({.seed = 3,
                   .threads = threads,
                   .policy = {.policy = DistancePolicy{.full_within = 1.2, .support_within = 2.5},
                              .max_transitions_per_frame = 8},
                   .signature_timing = SignatureTiming::in_step});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  return manager;
}

// Of every kind of call some.
void play(Manager& manager, const Shapes& shapes) {
  std::vector<BodyId> bodies;
  for (int i = 0; i < 60; ++i)
    bodies.push_back(manager.add_body(
        {.shape = shapes[std::size_t(i) % 2],
         .state = {.position = Vec3(0.45 * (i % 6) - 1.2, 0.45 * (i / 6 % 5) - 1.0, 0.6 + 0.5 * (i / 30)),
                   .orientation = Quat(0.7 + 1e-3 * i, 0.3, -0.2, 0.1 * (i % 7)).normalized()},
         .importance = 1.0 + 0.1 * (i % 3)}));
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 camera(std::sin(0.03 * i), std::cos(0.03 * i), 0.5);
    const BodyId body = bodies[std::size_t(7 * i) % bodies.size()];
    manager.set_viewpoints({&camera, 1});
    if (i % 5 == 0) manager.add_force(body, Vec3(0, 0, 300), Vec3(1, 0, 0));
    if (i % 7 == 0) manager.add_impulse(body, Vec3(2, 0, 0), manager.state(body).position);
    if (i % 17 == 0) manager.set_state(body, {.position = Vec3(0, 0, 2.0 + 0.01 * i)});
    if (i % 19 == 0) manager.set_level(body, LevelChoice::support);
    if (i == 40) manager.add_static_box({0.5, 0.5, 0.1}, {0.5, 0.5, 0.05}, Quat::Identity());
    if (i == 50) manager.add_body({.shape = shapes[1], .state = {.position = Vec3(0, 0, 2)}, .mass = 5.0});
    if (i == 60) manager.remove_body(bodies.back()), bodies.pop_back();
    if (i == 70) manager.sleep(body);
    if (i == 75)
      manager.set_policy({.policy = DistancePolicy{.full_within = 0.9, .support_within = 1.8},
                          .max_transitions_per_frame = 8});
    if (i == 80) manager.wake(body);
    if (i == 90) manager.set_full_substeps(3);
    if (i == 95) manager.set_importance(body, 3.0);
    if (i == 100) manager.set_gravity({0, 0, -5});
    manager.step(kStep);
  }
}

}  // namespace

int main() {
  const Shapes shapes = make_shapes();
  Bytes recording;
  Manager manager = make_manager(1);
  for (int i = 0; i < 3; ++i) manager.step(kStep);
  manager.set_record([&](std::span<const std::byte> bytes) {
    recording.insert(recording.end(), bytes.begin(), bytes.end());
  });
  play(manager, shapes);
  manager.set_record({});
  const std::size_t length = recording.size();
  manager.step(kStep);
  check::that(recording.size() == length, "once it has ended nothing is recorded");
  check::within(double(length) / kSteps, 100, 2000, "bytes recorded for a step");

  Manager again = make_manager(2);
  const Shapes own = make_shapes();
  const ReplayResult same = again.replay(recording, own);
  check::that(same.same && same.text == "all 120 steps are as they were recorded", same.text.c_str());
  check::within(same.steps, kSteps, kSteps, "steps that were done again, on two threads");
  again.step(kStep);
  check::that(again.state_hash() == manager.state_hash(), "and the state is the same");

  // As from a program that ended in the middle of it.
  Manager partly = make_manager(1);
  const ReplayResult cut = partly.replay(std::span(recording).first(length * 2 / 3), own);
  check::that(cut.same, "a recording that ends early is done again as far as it goes");
  check::within(cut.steps, 30, kSteps - 1, "steps of it");

  // Another policy, which no snapshot has.
  Manager other = make_manager(1);
  other.set_policy(
      {.policy = DistancePolicy{.full_within = 0.5, .support_within = 2.5}, .max_transitions_per_frame = 8});
  const ReplayResult differs = other.replay(recording, own);
  std::printf("%s\n", differs.text.c_str());
  check::that(!differs.same && differs.body, "where it comes out otherwise a body is named");
  check::within(differs.steps, 1, 40, "the step at which the first body is on another rung");

  // A policy with a function, which the reader must bring.
  Bytes with_function;
  const PolicySettings significant = {.policy = DistancePolicy{.full_within = 1.0},
                                      .significance = [](BodyId) { return 0.5; }};
  manager.set_record([&](std::span<const std::byte> bytes) {
    with_function.insert(with_function.end(), bytes.begin(), bytes.end());
  });
  manager.set_policy(significant);
  for (int i = 0; i < 10; ++i) manager.step(kStep);
  manager.set_record({});
  again.set_policy(significant);
  check::that(again.replay(with_function, own).same, "the function is the reader's");
  again.set_policy({});

  for (const auto& [bytes, because] : {std::pair(with_function, "a function for `significance`"),
                                       std::pair(Bytes(20), "no LODEREC3 at its beginning"),
                                       {Bytes(recording.begin(), recording.begin() + 8), "no beginning"}}) {
    std::string said;
    try {
      again.replay(bytes, own);
    } catch (const InputError& error) {
      said = error.what();
    }
    check::that(said.find(because) != std::string::npos, (std::string("refused: ") + because).c_str());
  }
  return check::result();
}
