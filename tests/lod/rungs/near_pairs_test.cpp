#include "lod/rungs/near_pairs.h"

#include <gtest/gtest.h>

#include <set>

#include "lod/rungs/substep_plan.h"
#include "reference/random.h"
#include "tests/lod/contact/crowd_scene.h"

namespace lodestone {
namespace {

using testing::at;
using testing::box_shape;

constexpr double kPairStep = 1.0 / 60;

// Whichever comes first.
ContactKey pair_key(Participant a, Participant b) {
  return contact_key(std::uint32_t(std::min(a.index(), b.index())),
                     std::uint32_t(std::max(a.index(), b.index())));
}

struct PairScene : testing::CrowdScene {
  explicit PairScene(Pace all = 3) : pace(all) { near.begin(0); }

  std::vector<std::int32_t> everybody() const {
    std::vector<std::int32_t> all;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i].motion != Motion::asleep) all.push_back(std::int32_t(i));
    return all;
  }
  void find(NearPairs& pairs, std::span<const NearPair> of) {
    const std::vector<std::int32_t> awake = everybody();
    near.begin(bodies.size());
    for (const std::int32_t i : awake) near.set_pace(Participant::statistical(std::size_t(i)), pace);
    near.set_full_pace(pace);
    pairs.forget_contacts();
    pairs.take(scene(), of);
    pairs.choose(near, pace);
    pairs.find_turning(scene(), awake);
    pairs.find_contacts(scene(), kPairStep, awake, near, pace);
  }
  double true_gap(const FoundPair& pair) {
    const auto contact =
        find_hull_contact(scene().pair_body(pair.first), scene().pair_body(pair.second), 10.0);
    return contact ? contact->gap : 1e9;
  }
  void move() {
    for (StatisticalBody& body : bodies) {
      const Shape& shape = *kinds[body.kind].shape;
      body.position += kPairStep * body.velocity;
      body.orientation = advance_orientation(body.orientation, body.spin, shape, kPairStep).normalized();
    }
  }
  Pace pace;
  NearMarks near;
};

class NearPairsAt : public ::testing::TestWithParam<Pace> {};

// What is remembered of a gap is never more than is there, and who meets within the step has a contact: as
// bodies fly about among each other for a second. At whichever pace they move: long substeps look for
// contacts in another way.
TEST_P(NearPairsAt, AGapKeptIsNeverTooWideAndNoMeetingIsMissed) {
  PairScene scene(GetParam());
  RandomStream random(31, 0, 0);
  const auto crate = box_shape({0.2, 0.3, 0.4});
  std::vector<NearPair> all;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 place = random.uniform(0.6, 1.2) * random.direction();  // and through the middle
    scene.add(crate, 1.0, at(place, -1.5 * place, 3.0 * random.direction(), random.orientation()));
    for (std::size_t k = 0; k < i; ++k)
      all.emplace_back(Participant::statistical(i), Participant::statistical(k));
  }
  NearPairs pairs(make_job_runner(1));
  int met = 0, kept = 0;
  std::set<ContactKey> apart, answered;  // in the step before: by a gap; that had a contact
  for (int step = 0; step < 60; ++step) {
    scene.find(pairs, all);
    ASSERT_EQ(pairs.size(), all.size());
    std::set<ContactKey> now_apart;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const FoundPair& pair = pairs[i];
      const double gap = scene.true_gap(pair);
      EXPECT_LE(pairs.gap_left(scene.scene(), pair), std::max(0.0, gap) + 1e-6);
      kept += pairs.gap_left(scene.scene(), pair) > 0.05;
      const ContactKey key = pair_key(pair.first, pair.second);
      if (gap > 0.0) now_apart.insert(key);
      if (gap > -1e-4 || !apart.contains(key)) continue;
      ++met;
      EXPECT_TRUE(answered.contains(key)) << "overlap of " << -gap;
    }
    apart = now_apart;
    answered.clear();
    for (const CrowdContact& contact : pairs.contacts())
      answered.insert(pair_key(contact.first, contact.second));
    scene.move();
  }
  EXPECT_GT(met, 5);
  EXPECT_GT(kept, 200);
}
INSTANTIATE_TEST_SUITE_P(Pace, NearPairsAt, ::testing::Values(Pace(1), Pace(3)));

// A box that lies on an edge 5 mm above another and turns down onto it by 2 rad/s: its corner is there within
// the step, though its centre comes no nearer. In long substeps the contact is there beforehand; in short
// ones three tenths of such a way are reckoned with, which is enough here, and too little for twice the gap.
TEST(NearPairs, InLongSubstepsWhoTurnsTowardsAnotherMeetsIt) {
  const auto contacts = [](Pace pace, double gap) {
    PairScene scene(pace);
    const auto plank = box_shape({0.8, 0.2, 0.1}), cube = box_shape({0.2, 0.2, 0.2});
    const NearPair one[] = {{scene.add(plank, 1.0, at({0, 0, 0}, {0, 0, 0}, {0, 2, 0})),
                             scene.add(cube, 1.0, at({0.3, 0, -0.15 - gap}))}};
    NearPairs pairs(make_job_runner(1));
    scene.find(pairs, one);
    return pairs.contacts().size();
  };
  EXPECT_EQ(contacts(1, 0.005), 1U);
  EXPECT_EQ(contacts(3, 0.005), 1U);
  EXPECT_EQ(contacts(1, 0.010), 1U);
  EXPECT_EQ(contacts(3, 0.010), 0U);
}

// Whichever is named first, and whatever came before: by place.
TEST(NearPairs, AContactDoesNotHangOnTheOrderOfItsBodies) {
  for (const bool turned_round : {false, true}) {
    PairScene scene;
    const auto cube = box_shape({0.2, 0.2, 0.2});
    const Participant a = scene.add(cube, 1.0, at({0.1, 0, 0})),
                      b = scene.add(cube, 1.0, at({-0.1, 0.05, 0}));
    NearPairs pairs(make_job_runner(1));
    const NearPair one = turned_round ? NearPair(a, b) : NearPair(b, a);
    scene.find(pairs, {&one, 1});
    ASSERT_EQ(pairs.contacts().size(), 1U);
    EXPECT_EQ(pairs.contacts()[0].first, b);  // the smaller x
    EXPECT_LT((pairs.contacts()[0].contact.normal - Vec3(-1, 0, 0)).norm(), 1e-6);
  }
}

TEST(NearPairs, OfSleepersAndOfFullBodiesAmongThemselvesThereAreNone) {
  PairScene scene;
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const Participant a = scene.add(cube, 1.0, at({0, 0, 0})), b = scene.add(cube, 1.0, at({0.2, 0, 0})),
                    f = scene.add_full(cube, 1.0, at({0, 0.2, 0})),
                    g = scene.add_full(cube, 1.0, at({0.2, 0.2, 0}));
  scene.bodies[0].motion = scene.bodies[1].motion = Motion::asleep;
  NearPairs pairs(make_job_runner(1));
  const NearPair asleep[] = {{a, b}}, full[] = {{f, g}}, mixed[] = {{a, f}};
  scene.find(pairs, asleep);
  EXPECT_TRUE(pairs.contacts().empty());
  scene.find(pairs, full);
  EXPECT_TRUE(pairs.contacts().empty());
  scene.find(pairs, mixed);  // a sleeper and a full body that is awake
  EXPECT_EQ(pairs.contacts().size(), 1U);
  EXPECT_TRUE(scene.bodies[0].crowded);
}

TEST(NearPairs, ASnapshotGoesOnAlike) {
  PairScene scene;
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const Participant a = scene.add(cube, 1.0, at({0, 0, 0}, {0.1, 0, 0})),
                    b = scene.add(cube, 1.0, at({0.3, 0, 0}));
  const NearPair one[] = {{a, b}};
  NearPairs pairs(make_job_runner(1)), copy(make_job_runner(1));
  scene.find(pairs, one);
  StateArchive writer;
  pairs.archive(writer);
  StateArchive reader(writer.bytes(), {});
  copy.archive(reader);
  EXPECT_TRUE(reader.at_end());
  ASSERT_EQ(copy.size(), 1U);
  EXPECT_EQ(copy[0].key, pairs[0].key);
  EXPECT_EQ(copy[0].gap, pairs[0].gap);
  EXPECT_TRUE(copy[0].when.has_value());
}

// The approach: what two that close in at 2 m/s, one of which turns, may come nearer by, and the fall.
TEST(NearPairs, ApproachIsOfCentresRimsAndTheFall) {
  PairScene scene;
  scene.world.gravity = {0, 0, -testing::kGravity};
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const Participant a = scene.add(cube, 1.0, at({0, 0, 0}, {1, 0, 0}, {0, 0, 5})),
                    b = scene.add(cube, 1.0, at({3, 0, 0}, {-1, 0, 0}));
  NearPairs pairs(make_job_runner(1));
  const NearPair one[] = {{a, b}};
  scene.find(pairs, one);
  const double expected = (2.0 + 5.0 * cube->radius) * 0.1 + 0.5 * testing::kGravity * 0.01;
  EXPECT_NEAR(pairs.find_approach(scene.scene(), pairs[0], 0.1), expected, 1e-12);
  EXPECT_NEAR(pairs.gap_left(scene.scene(), pairs[0]), 2.8 - 0.01 * cube->radius, 1e-3);
}

// Three substeps where two touch slowly, more the faster they close in, a dozen at most; none where nobody is
// near.
TEST(SubstepPlan, IsByHowFarTheyCloseInOverTheirSize) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const auto substeps = [&](double speed, double gap) {
    PairScene scene;
    const Participant a = scene.add(cube, 1.0, at({0, 0, 0}, {speed, 0, 0})),
                      b = scene.add(cube, 1.0, at({0.2 + gap, 0, 0}));
    NearPairs pairs(make_job_runner(1));
    const NearPair one[] = {{a, b}};
    scene.find(pairs, one);
    NearMarks near;
    near.begin(2);
    SubstepPlan plan(make_job_runner(1));
    plan.make(scene.scene(), pairs, {}, {}, kPairStep, near);
    EXPECT_EQ(near.pace(a), near.pace(b));
    EXPECT_EQ(plan.paces().size(), near[0] ? 1 : 0);
    return int(near.pace(a));
  };
  EXPECT_EQ(substeps(0.1, 0.001), 3);
  EXPECT_EQ(substeps(4.0, 0.001), int(std::ceil(4.0 / 60 / (0.07 * cube->radius))));
  EXPECT_EQ(substeps(40.0, 0.001), 12);
  EXPECT_EQ(substeps(1.0, 0.5), 0);
}

// Two pairs of one island, through the one in the middle, and a slow pair elsewhere; with what sleeps or is
// full between them, all are one.
TEST(SubstepPlan, IsAnIslandsOwn) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const auto paces = [&](bool beside_sleepers) {
    PairScene scene;
    const auto add = [&](double x, double speed) {
      return scene.add(cube, 1.0, at({x, 0, 0}, {speed, 0, 0}));
    };
    const Participant fast = add(0.0, 4.0), middle = add(0.201, 0.0), right = add(0.402, 0.0),
                      slow = add(10.0, 0.1), other = add(10.201, 0.0), sleeper = add(0.603, 0.0),
                      far_sleeper = add(10.402, 0.0);
    std::vector<NearPair> near_pairs = {{fast, middle}, {middle, right}, {slow, other}};
    if (beside_sleepers) near_pairs.insert(near_pairs.end(), {{right, sleeper}, {other, far_sleeper}});
    for (const Participant p : {sleeper, far_sleeper}) scene.bodies[p.index()].motion = Motion::asleep;
    NearPairs pairs(make_job_runner(1));
    scene.find(pairs, near_pairs);
    NearMarks near;
    near.begin(scene.bodies.size());
    SubstepPlan plan(make_job_runner(1));
    plan.make(scene.scene(), pairs, {}, {}, kPairStep, near);
    EXPECT_EQ(near.pace(fast), near.pace(right));
    EXPECT_TRUE(std::ranges::is_sorted(plan.paces()));
    EXPECT_EQ(plan.paces().size(), beside_sleepers ? 1u : 2u);
    return std::pair(int(near.pace(fast)), int(near.pace(slow)));
  };
  const int quick = int(std::ceil(4.0 / 60 / (0.07 * cube->radius)));
  EXPECT_EQ(paces(false), std::pair(quick, 3));
  EXPECT_EQ(paces(true), std::pair(quick, quick));
}

// A stream of cubes, one behind the other at one speed: none gains on another, but once the first strikes the
// ground all may meet, in whatever order they were added.
TEST(SubstepPlan, WhoFollowsOneThatStrikesTheGroundMayMeetIt) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  for (const double lowest : {0.15, 5.0})
    for (const int stride : {1, -1, 7}) {
      PairScene scene;
      const HalfSpace floor{Vec3::UnitZ(), 0.0};
      scene.world.planes = {&floor, 1};
      constexpr int kCubes = 20;
      std::vector<int> place(kCubes);
      for (int i = 0; i < kCubes; ++i) {
        const int rank = (stride * i % kCubes + kCubes) % kCubes;
        place[std::size_t(rank)] = i;
        scene.add(cube, 1.0, at({0, 0, lowest + 0.3 * rank}, {0, 0, -10}));
      }
      std::vector<NearPair> column;
      for (int i = 1; i < kCubes; ++i)
        column.emplace_back(Participant::statistical(std::size_t(place[std::size_t(i)])),
                            Participant::statistical(std::size_t(place[std::size_t(i - 1)])));
      NearPairs pairs(make_job_runner(1));
      scene.find(pairs, column);
      NearMarks near;
      near.begin(scene.bodies.size());
      SubstepPlan plan(make_job_runner(1));
      plan.make(scene.scene(), pairs, {}, {}, kPairStep, near);
      for (std::size_t i = 0; i < kCubes; ++i) EXPECT_EQ(near[i], lowest < 1.0) << lowest << " " << stride;
    }
}

// A row of cubes that touch, of which one closes in at `speed`: the pace of all. A heap that is slow takes
// the step at once, or a longer one in steps of 1/60 s; few bodies, and such as differ in mass by much, never
// do.
TEST(SubstepPlan, ASlowHeapTakesAStepAtOnce) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const auto pace = [&](int bodies, double speed, double dt = kPairStep, double mass_of_last = 1.0) {
    PairScene scene;
    std::vector<NearPair> row;
    for (int i = 0; i < bodies; ++i) {
      const Participant p = scene.add(cube, i + 1 == bodies ? mass_of_last : 1.0,
                                      at({0.2001 * i, 0, 0}, {i == 0 ? speed : 0.0, 0, 0}));
      if (i > 0) row.emplace_back(Participant::statistical(p.index() - 1), p);
    }
    NearPairs pairs(make_job_runner(1));
    scene.find(pairs, row);
    NearMarks near;
    near.begin(scene.bodies.size());
    SubstepPlan plan(make_job_runner(1));
    plan.make(scene.scene(), pairs, {}, {}, dt, near);
    EXPECT_EQ(plan.paces().size(), 1U);
    return int(near.pace(Participant::statistical(0)));
  };
  EXPECT_EQ(pace(40, 0.1), 1);
  EXPECT_EQ(pace(40, 0.1, 1.0 / 30), 2);
  EXPECT_EQ(pace(40, 0.1, 1.0 / 240), 1);
  EXPECT_EQ(pace(40, 1.0), 2);
  EXPECT_EQ(pace(40, 4.0), pace(3, 4.0));
  EXPECT_EQ(pace(20, 0.1), 3);
  EXPECT_EQ(pace(40, 0.1, kPairStep, 20.0), 3);
  EXPECT_EQ(pace(40, 0.1, kPairStep, 19.0), 1);
}

// Sweeps of a step are the same three times ten at least, however it is divided.
TEST(SubstepPlan, SweepsAreThoseOfThreeSubsteps) {
  for (Pace pace = 1; pace <= 12; ++pace) EXPECT_GE(pace * sweeps_of(pace), 30);
  EXPECT_EQ(sweeps_of(1), 30);
  EXPECT_EQ(sweeps_of(12), 10);
}

}  // namespace
}  // namespace lodestone
