// Signatures that take their time: the bodies that need them are at `support` without settling clips
// meanwhile.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "reference/error.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/temporary_folder.h"

namespace lodestone::testing {
namespace {

std::shared_ptr<const Signature> empty_signature(const Shape& shape) {
  Signature signature;
  signature.shape_hash = shape.content_hash;
  signature.mesh_vertices = std::uint32_t(shape.mesh.vertices.size()),
  signature.mesh_faces = std::uint32_t(shape.mesh.faces.size());
  return std::make_shared<const Signature>(std::move(signature));
}

// Until it is let go.
struct SlowSource {
  bool measured = false;  // else an empty one: no clips, and nothing that `tables` could use
  std::atomic<bool> done = false;
  std::atomic<int> asked = 0;
  std::atomic<std::thread::id> thread = {};
  SignatureFunction function() {
    return [this](const Shape& shape, const ContactLaw& law) -> std::shared_ptr<const Signature> {
      thread = std::this_thread::get_id();
      ++asked;
      while (!done) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return measured ? coarse_signature(shape, law) : empty_signature(shape);
    };
  }
};

ManagerSettings with(SlowSource& source, SignatureTiming timing) {
  return {.signatures = source.function(), .signature_timing = timing};
}

// Steps until the thread is done: how many steps that takes differs from run to run.
void step_until_loaded(Manager& manager) {
  while (manager.report().counters.signatures_loaded == 0) {
    manager.step(kFrame);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(SignatureTiming, BodiesAreAtSupportUntilTheThreadIsDone) {
  SlowSource source{.measured = true};
  Manager manager = on_floor(with(source, SignatureTiming::in_background));
  const auto box = box_shape({0.2, 0.3, 0.4});
  const BodyId far = add(manager, box, at({0, 0, 1})),
               forced = add(manager, box, at({3, 0, 1}), LevelChoice::tables);
  run(manager, 0.1);  // returns, though the source does not
  for (const BodyId body : {far, forced}) EXPECT_EQ(manager.rung(body), Rung::support);
  EXPECT_EQ(manager.why(forced), "support: its signature is still being measured");
  while (source.asked == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the thread may only just have begun
  EXPECT_EQ(source.asked, 1);
  EXPECT_NE(source.thread.load(), std::this_thread::get_id());
  source.done = true;
  step_until_loaded(manager);
  run(manager, 0.1);
  EXPECT_EQ(manager.rung(far), Rung::support);
  EXPECT_EQ(manager.rung(forced), Rung::tables);
  EXPECT_EQ(source.asked, 1);
  const BodyId late = add(manager, box, at({6, 0, 1}));
  manager.step(kFrame);
  EXPECT_EQ(manager.level(late), Level::statistical);
}

TEST(SignatureTiming, ANearBodyIsFullAllTheSame) {
  SlowSource source;
  Manager manager = on_floor(with(source, SignatureTiming::in_background));
  view_from(manager, Vec3::Zero());
  const BodyId near = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 1}));
  run(manager, 0.1);
  EXPECT_EQ(manager.level(near), Level::full);
  source.done = true;
}

// Nothing of a body changes when its signature comes: it moves as if it had waited on.
TEST(SignatureTiming, ASignatureThatComesMovesNoBody) {
  SlowSource source;
  Manager waits = on_floor(with(source, SignatureTiming::in_background)), never = on_floor();
  const auto box = box_shape({0.2, 0.3, 0.4});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 200; ++i) {
    const RigidState state = at({2.0 * i, 0, 1.0 + 0.01 * i});
    bodies.push_back(add(waits, box, state)), add(never, box, state);
  }
  run(waits, 0.5), run(never, 0.5);
  source.done = true;
  while (waits.report().counters.signatures_loaded == 0) {
    waits.step(kFrame), never.step(kFrame);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  waits.step(kFrame), never.step(kFrame);  // the source's signature has no clips
  // But for rounding: who touches the ground as it comes is handed over by its angular velocity.
  for (const BodyId body : bodies)
    ASSERT_LT((waits.state(body).position - never.state(body).position).norm(), 1e-12);
  EXPECT_EQ(waits.report().promotions + waits.report().demotions, 0);
}

TEST(SignatureTiming, ABodyThatWasFullForGoodWaitsToo) {
  SlowSource source{.measured = true};
  Manager manager = on_floor(with(source, SignatureTiming::in_background));
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 1}), LevelChoice::full);
  run(manager, 0.1);
  EXPECT_EQ(source.asked, 0);
  manager.set_level(body, LevelChoice::tables);
  run(manager, 0.1);
  EXPECT_EQ(manager.rung(body), Rung::support);
  source.done = true;
  step_until_loaded(manager);
  run(manager, 0.1);
  EXPECT_EQ(manager.rung(body), Rung::tables);
}

TEST(SignatureTiming, InStepTheStepWaits) {
  SlowSource source;
  source.done = true;
  for (const SignatureTiming timing : {SignatureTiming::in_step, SignatureTiming::automatic}) {
    Manager manager = on_floor(with(source, timing));
    const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 1}));
    manager.step(kFrame);
    EXPECT_EQ(manager.level(body), Level::statistical);
    EXPECT_EQ(source.thread, std::this_thread::get_id());
  }
}

TEST(SignatureTiming, ASignatureThatCannotBeHadIsSaidByTheStep) {
  ManagerSettings settings{
      .signatures = [](const Shape&, const ContactLaw&) -> std::shared_ptr<const Signature> {
        throw InputError("no room");
      },
      .signature_timing = SignatureTiming::in_background};
  Manager manager = on_floor(settings);
  add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 1}));
  EXPECT_THROW(
      for (int i = 0; i < 10'000; ++i) {
        manager.step(kFrame);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      },
      InputError);
}

// Both come in one step, one after the other: who waited for the first has its clips, as soon as the other is
// gone.
TEST(SignatureTiming, OneThatCannotBeHadTakesNoOtherFromThoseWhoWait) {
  const auto box = box_shape({0.2, 0.3, 0.4}), ball = sphere_shape(0.2);
  std::atomic<bool> go = false;
  std::atomic<int> answered = 0;
  const auto source = [&](const Shape& shape, const ContactLaw& law) {
    while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (++answered == 2) throw InputError("no room");
    return coarse_signature(shape, law);
  };
  Manager manager = on_floor({.signatures = source, .signature_timing = SignatureTiming::in_background}),
          without_clips = on_floor();
  std::vector<BodyId> bodies, others;
  BodyId bad;
  for (int i = 0; i < 40; ++i) {
    const RigidState state = at({2.0 * i, 0, 1.0 + 0.02 * i}, {0, 0, 0}, {0.1 * i, 3, 0});
    bodies.push_back(add(manager, box, state));
    // Asked about last: the places of those who wait no longer are filled from the back.
    if (i == 0) bad = add(manager, ball, at({0, 9, 1}));
  }
  for (const BodyId body : bodies) others.push_back(add(without_clips, box, manager.state(body)));
  add(manager, box_shape({0.5, 0.5, 0.1}), at({0, 20, 1}));
  manager.step(kFrame), without_clips.step(kFrame);
  go = true;
  while (answered < 3)  // one after the other: then both answers are there
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_THROW(manager.step(kFrame), InputError);
  manager.remove_body(bad);
  run(manager, 3.0), run(without_clips, 3.0);
  int with_clips = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    with_clips += (manager.state(bodies[i]).position - without_clips.state(others[i]).position).norm() > 1e-3;
  EXPECT_GT(with_clips, 0);
}

// The default source, which measures: the manager goes away in the middle of it, soon, and without a
// signature in the cache.
TEST(SignatureTiming, AManagerDoesNotWaitForWhatItMeasures) {
  const TemporaryFolder cache;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before ? before : "";
  ::setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  {
    Manager manager = on_floor({});
    const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 1}));
    manager.step(kFrame);
    EXPECT_EQ(manager.rung(body), Rung::support);
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(cache.path()))
    EXPECT_NE(entry.path().extension(), ".sig");
  if (before)
    ::setenv("XDG_CACHE_HOME", kept.c_str(), 1);
  else
    ::unsetenv("XDG_CACHE_HOME");
}

// The ground's law changes, for which nothing is measured yet. `has_first`: under the first law there was
// one; else the body comes to `tables` only under the second.
void change_law(bool has_first) {
  const std::thread::id stepping = std::this_thread::get_id();
  std::atomic<bool> done = false, asked_in_step = false;
  std::atomic<double> first = -1.0;  // friction
  ManagerSettings settings{
      .policy = {.policy = DistancePolicy{.full_within = 0.0}, .min_dwell_frames = 0},
      .signatures = [&](const Shape& shape, const ContactLaw& law) -> std::shared_ptr<const Signature> {
        if (first < 0.0) first = law.friction;
        if (law.friction == first) return has_first ? coarse_signature(shape, law) : nullptr;
        if (std::this_thread::get_id() == stepping) asked_in_step = true;
        while (!done && !asked_in_step) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return coarse_signature(shape, law);
      },
      .signature_timing = SignatureTiming::in_background};
  const PolicySettings three_rungs{.policy = DistancePolicy{.full_within = 0.0, .support_within = 10.0},
                                   .min_dwell_frames = 0};
  if (has_first) settings.policy = three_rungs;
  Manager manager(settings);
  const MaterialId ice = manager.materials().add({.friction = 0.1});
  const GroundId floor = manager.add_plane(Vec3::UnitZ(), 0.0);
  view_from(manager, {1000, 0, 0});
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 0.5}));
  const auto comes_to = [&](Rung rung) {
    for (int i = 0; i < 60'000 && manager.rung(body) != rung; ++i) {
      manager.step(kFrame);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return manager.rung(body) == rung;
  };
  if (has_first)
    ASSERT_TRUE(comes_to(Rung::tables));
  else
    for (int i = 0; i < 50 || first < 0.0; ++i)  // the source has answered before the last of them
      manager.step(kFrame), std::this_thread::sleep_for(std::chrono::milliseconds(1));
  manager.remove_ground(floor);
  manager.add_plane(Vec3::UnitZ(), 0.0, ice);
  if (has_first) {
    view_from(manager, {1, 0, 0});
    run(manager, 0.2);
    EXPECT_EQ(manager.rung(body), Rung::support);
  } else {
    manager.set_policy(three_rungs);
    run(manager, 0.2);
    EXPECT_EQ(manager.rung(body), Rung::support);
    done = true;
    EXPECT_TRUE(comes_to(Rung::tables));
  }
  EXPECT_FALSE(asked_in_step);
  done = true;
}

TEST(SignatureTiming, NoStepWaitsWhereTheGroundsLawHasChanged) { change_law(true); }

TEST(SignatureTiming, NoStepWaitsToKnowWhetherTablesIsOpen) { change_law(false); }

}  // namespace
}  // namespace lodestone::testing
