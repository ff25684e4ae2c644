// Who is near whom, against a look at all pairs.
#include "lod/rungs/near_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "lod/rungs/drift.h"
#include "reference/random.h"
#include "tests/lod/rungs/rung_fixture.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

constexpr double kSearchStep = 1.0 / 60;

/// Bodies of all rungs, known by their owners; some sleep.
struct Crowd3 {
  explicit Crowd3(const StatisticalSettings& given = {}) : settings(given) {}

  struct Place {
    Rung rung;
    RigidState state;
    double radius;
    bool asleep;
    int slot;  // of statistical ones
  };

  void add(Rung rung, std::uint32_t owner, const RigidState& state, bool asleep) {
    const auto& shape = owner % 3 ? testing::box() : large();
    places.resize(std::max<std::size_t>(places.size(), owner + 1));
    const int slot = rung == Rung::tables ? tables.size() : support.size();
    places[owner] = {rung, state, shape->radius, asleep, slot};
    if (rung == Rung::full) {
      FullNeighbor& n = full.emplace_back();
      n.owner = owner, n.shape = shape.get(), n.state = state, n.asleep = asleep;
      if (asleep) n.state.velocity = Vec3::Zero();
      return;
    }
    const auto model = rung == Rung::tables ? StatisticalModel::tables : StatisticalModel::support;
    const std::uint32_t kind = kinds.take(model, shape, 0, testing::box_signature());
    if (rung == Rung::tables)
      tables.add(owner, kind, 1.0, state, asleep, false);
    else
      support.add(owner, kind, 1.0, state, asleep, false);
  }
  void search_pairs() {
    ContactTally tally;
    drift = find_drift(kSearchStep, tables, support, full);
    tables.begin_step(kSearchStep, drift, search.order_of_spheres(), tally);
    support.begin_step(kSearchStep, tally);
    search.fill(kSearchStep, drift, tables, support, full);
    search.find(tables, support, full);
    for (int slot = 0; slot < tables.size(); ++slot)  // a sphere may have been woken by another
      places[tables.owner(slot)].asleep = tables.asleep(slot);
  }
  void set_state(const Place& place) {
    if (place.rung == Rung::tables) return tables.set_state(place.slot, place.state);
    support.set_state(place.slot, place.state);
  }
  void put_to_sleep(Place& place) {
    place.asleep = true;
    if (place.rung == Rung::tables) return tables.put_to_sleep(place.slot);
    support.put_to_sleep(place.slot);
  }
  std::uint32_t owner_of(Participant p) {
    if (p.is_full()) return full[p.index()].owner;
    if (p.index() < std::size_t(support.size())) return support.body(int(p.index())).owner;
    return tables.owner(search.guests()[p.index() - std::size_t(support.size())].slot);
  }
  /// By owner, the lower one first.
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs() {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const NearPair& pair : search.pairs()) {
      const std::uint32_t a = owner_of(pair.first), b = owner_of(pair.second);
      EXPECT_NE(a, b);
      EXPECT_TRUE(pairs.insert({std::min(a, b), std::max(a, b)}).second) << a << ' ' << b << " twice";
    }
    return pairs;
  }

  static Kinds& kinds_of_all() {  // what they are made of takes long to make
    static Kinds kinds{true};
    return kinds;
  }
  static const std::shared_ptr<const Shape>& large() {
    static const auto shape = std::make_shared<const Shape>(scale_shape(*testing::box(), 1.7));
    return shape;
  }

  std::vector<Place> places;  // by owner
  Vec3 drift = Vec3::Zero();  // m/s, of the last search
  MaterialTable materials;
  Ground ground;
  Kinds& kinds = kinds_of_all();
  Sleepers sleepers;
  StatisticalSettings settings;
  JobRunner jobs = make_job_runner(1);
  SupportLevel support{settings, ground, materials, kinds, sleepers};
  TablesLevel tables{settings, ground, materials, kinds, sleepers, jobs};
  NearSearch search{settings, sleepers, jobs};
  std::vector<FullNeighbor> full;
};

/// m: how near the bounding spheres of two come within a step, at constant velocities.
double least_gap(const Crowd3::Place& a, const Crowd3::Place& b) {
  const Vec3 apart = a.state.position - b.state.position,
             closing = (a.asleep ? Vec3(Vec3::Zero()) : a.state.velocity) -
                       (b.asleep ? Vec3(Vec3::Zero()) : b.state.velocity);
  const double square = closing.squaredNorm(),
               t = square > 0.0 ? std::clamp(-apart.dot(closing) / square, 0.0, kSearchStep) : 0.0;
  return (apart + t * closing).norm() - a.radius - b.radius;
}

/// Two spheres among themselves and two full bodies are others' matter, and two sleepers nobody's.
bool concerns(const Crowd3::Place& a, const Crowd3::Place& b) {
  return !(a.asleep && b.asleep) && !(a.rung == Rung::tables && b.rung == Rung::tables) &&
         !(a.rung == Rung::full && b.rung == Rung::full);
}

void scatter(Crowd3& crowd, std::uint32_t seed, int count, const std::vector<Rung>& of, double within,
             const Vec3& common = Vec3::Zero()) {
  RandomStream random(91, seed, 0);
  for (int i = 0; i < count; ++i) {
    RigidState state;
    for (int axis = 0; axis < 3; ++axis) state.position[axis] = random.uniform(-within, within);
    state.orientation = random.orientation();
    const bool asleep = random.uniform() < 0.3;
    if (!asleep) state.velocity = common + random.uniform(0.0, i % 10 == 0 ? 30.0 : 2.0) * random.direction();
    crowd.add(of[std::size_t(random.uniform(0.0, double(of.size())))], std::uint32_t(i), state, asleep);
  }
}

void expect_all_found(Crowd3& crowd) {
  const auto pairs = crowd.pairs();
  std::size_t expected = 0;
  for (std::uint32_t a = 0; a < crowd.places.size(); ++a)
    for (std::uint32_t b = a + 1; b < crowd.places.size(); ++b) {
      const Crowd3::Place &one = crowd.places[a], &other = crowd.places[b];
      const bool found = pairs.contains({a, b});
      if (!concerns(one, other)) {
        EXPECT_FALSE(found) << a << ' ' << b;
        continue;
      }
      const double gap = least_gap(one, other);
      expected += gap < 0.0;
      if (gap < 0.0) {
        EXPECT_TRUE(found) << a << ' ' << b << " overlap by " << -gap;
      }
      // Beyond what both travel in the frame of the search, what gravity adds and a part of their sizes they
      // are not near.
      const auto speed = [&](const Crowd3::Place& p) {
        return p.asleep ? crowd.drift.norm() : (p.state.velocity - crowd.drift).norm();
      };
      const double speeds = speed(one) + speed(other);
      const auto excess = [](const Crowd3::Place& p) {
        return (p.rung == Rung::tables ? 0.5 : 0.05) * p.radius;
      };
      if (gap > excess(one) + excess(other) + speeds * kSearchStep + 0.01) {
        EXPECT_FALSE(found) << a << ' ' << b << " apart by " << gap;
      }
    }
  EXPECT_GT(expected, 3U);
}

TEST(NearSearch, FindsEachPairThatMayMeetOnceOnAnyRungs) {
  const std::initializer_list<Rung> mixes[] = {{Rung::support},
                                               {Rung::support, Rung::full},
                                               {Rung::support, Rung::tables},
                                               {Rung::tables, Rung::full},
                                               {Rung::tables, Rung::support, Rung::full}};
  for (const auto& mix : mixes)
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
      Crowd3 crowd;
      scatter(crowd, seed, 60, mix, 1.5 + 0.3 * seed);
      crowd.search_pairs();
      expect_all_found(crowd);
    }
}

// What falls together is near what sleeps beside its way, and not all that falls with it.
TEST(NearSearch, LooksFromTheFrameOfWhatFallsTogether) {
  for (const auto& mix : {std::vector{Rung::support},
                          {Rung::support, Rung::full},
                          {Rung::support, Rung::tables},
                          {Rung::tables, Rung::support, Rung::full}})
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
      Crowd3 crowd;
      scatter(crowd, seed, 60, mix, 1.5 + 0.3 * seed, {3.0, 0.0, -80.0});
      crowd.search_pairs();
      EXPECT_GT(crowd.drift.norm(), 50.0);
      expect_all_found(crowd);
      if (crowd.tables.size() > 0) continue;  // sleepers of `tables` are no matter of those woken
      std::vector<Participant> woken;
      for (int slot = 0; slot < crowd.support.size(); ++slot) {
        if (!crowd.support.asleep(slot)) continue;
        crowd.support.wake(slot);
        crowd.places[crowd.support.body(slot).owner].asleep = false;
        woken.push_back(Participant::statistical(std::size_t(slot)));
      }
      crowd.search.find_woken(0.0, crowd.support, crowd.full, woken);
      expect_all_found(crowd);
    }
}

TEST(Drift, IsWhatMostThatMovesHasInCommon) {
  const auto drift_of = [](const Vec3& common, double own, Rung rung) {
    Crowd3 crowd;
    RandomStream random(94, 0, 0);
    for (std::uint32_t i = 0; i < 30; ++i)
      crowd.add(rung, i, testing::at({2.0 * i, 0, 0}, common + own * random.direction()), false);
    crowd.search_pairs();
    return crowd.drift;
  };
  const Vec3 common(0, 4, -60);
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) {
    EXPECT_LT((drift_of(common, 2.0, rung) - common).norm(), 2.0);
    EXPECT_TRUE(drift_of(0.1 * common, 2.0, rung).isZero(0.0)) << "slow";
    EXPECT_TRUE(drift_of(common, 60.0, rung).isZero(0.0)) << "each its own way";
  }
}

// A sphere that another has just woken is in no cell and sleeps no more: hulls meet it all the same.
TEST(NearSearch, ASphereThatWasJustWokenIsMetByHulls) {
  for (const bool hull_sleeps : {false, true}) {
    Crowd3 crowd;
    crowd.add(Rung::tables, 1, testing::at({0, 0, 0}), true);
    crowd.add(Rung::tables, 2, testing::at({0.3, 0, 0}, {-10, 0, 0}), false);
    crowd.add(Rung::support, 4, testing::at({-0.3, 0, 0}), hull_sleeps);
    crowd.add(Rung::full, 5, testing::at({0, 0.3, 0}), false);
    crowd.search_pairs();
    ASSERT_FALSE(crowd.places[1].asleep);
    const auto pairs = crowd.pairs();
    EXPECT_TRUE(pairs.contains({1, 4})) << hull_sleeps;
    EXPECT_TRUE(pairs.contains({1, 5})) << hull_sleeps;
  }
}

TEST(NearSearch, FindsThemAgainAfterTheBodiesMoved) {
  Crowd3 crowd;
  scatter(crowd, 17, 60, {Rung::support, Rung::full}, 1.5);
  RandomStream random(92, 0, 0);
  for (int round = 0; round < 6; ++round) {
    for (std::uint32_t owner = 0; owner < crowd.places.size(); ++owner) {
      Crowd3::Place& place = crowd.places[owner];
      if (place.asleep) continue;
      place.state.position += 0.3 * random.direction();
      for (FullNeighbor& n : crowd.full)
        if (n.owner == owner) n.state = place.state;
      for (int slot = 0; slot < crowd.support.size(); ++slot)
        if (crowd.support.body(slot).owner == owner) crowd.support.set_state(slot, place.state);
    }
    crowd.search_pairs();
    expect_all_found(crowd);
  }
}

// While bodies rock in their places, fall asleep beside each other and wake, who knows of his sleepers finds
// the same pairs, in the same order, as who looks for the first time.
TEST(NearSearch, FindsWhatOneFindsThatNeverLookedBefore) {
  Crowd3 crowd;
  scatter(crowd, 23, 120, {Rung::support}, 1.6);
  RandomStream random(93, 0, 0);
  std::size_t pairs = 0, changes = 0;
  for (int round = 0; round < 200; ++round) {
    for (int slot = 0; slot < crowd.support.size(); ++slot) {
      if (crowd.support.asleep(slot)) {
        if (random.uniform() < 0.01) crowd.support.wake(slot), ++changes;
        continue;
      }
      if (random.uniform() < 0.01) {
        crowd.support.put_to_sleep(slot), ++changes;
        continue;
      }
      RigidState state = crowd.support.state(slot);
      state.position += (slot % 7 == 0 ? 0.03 : 0.003) * random.direction();
      state.velocity = 0.3 * random.direction();
      crowd.support.set_state(slot, state);
    }
    crowd.search_pairs();
    NearSearch fresh(crowd.settings, crowd.sleepers, crowd.jobs);
    fresh.fill(kSearchStep, crowd.drift, crowd.tables, crowd.support, crowd.full);
    fresh.find(crowd.tables, crowd.support, crowd.full);
    const auto same = [](const NearPair& a, const NearPair& b) { return a == b; };
    ASSERT_TRUE(std::ranges::equal(crowd.search.pairs(), fresh.pairs(), same)) << round;
    pairs += fresh.pairs().size();
  }
  EXPECT_GT(pairs, 10000U);
  EXPECT_GT(changes, 100U);
}

// Woken in two lots, within a step: with each lot all that a search at the step's beginning would have found
// are there, once.
TEST(NearSearch, FindsThePairsOfThoseThatAreWoken) {
  for (std::uint32_t seed = 20; seed < 26; ++seed) {
    Crowd3 crowd;
    scatter(crowd, seed, 90, {Rung::support, Rung::support, Rung::full}, 1.4);
    crowd.search_pairs();
    for (int lot = 0; lot < 2; ++lot) {
      const std::size_t before = crowd.search.pairs().size();
      std::vector<Participant> woken;
      for (int slot = 0, left = 5; slot < crowd.support.size() && left > 0; ++slot) {
        if (!crowd.support.asleep(slot)) continue;
        crowd.support.wake(slot), --left;
        crowd.places[crowd.support.body(slot).owner].asleep = false;
        woken.push_back(Participant::statistical(std::size_t(slot)));
      }
      EXPECT_EQ(woken.size(), 5u);
      for (std::size_t i = std::size_t(lot); i < crowd.full.size(); i += 3) {
        if (!std::exchange(crowd.full[i].asleep, false)) continue;
        crowd.places[crowd.full[i].owner].asleep = false;
        woken.push_back(Participant::full(i));
      }
      const auto found = crowd.search.find_woken(0.0, crowd.support, crowd.full, woken);
      EXPECT_GT(found.size(), 0u);
      EXPECT_EQ(crowd.search.pairs().size(), before + found.size());
      expect_all_found(crowd);
    }
  }
}

// Pairs and their order are the same whatever the order in which bodies were added.
TEST(NearSearch, DoesNotHangOnTheOrderOfAdding) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    Crowd3 crowd, turned;
    scatter(crowd, seed, 50, {Rung::support, Rung::tables}, 1.3);
    for (std::uint32_t owner = 50; owner-- > 0;) {
      const Crowd3::Place& place = crowd.places[owner];
      turned.add(place.rung, owner, place.state, place.asleep);
    }
    crowd.search_pairs(), turned.search_pairs();
    EXPECT_EQ(crowd.pairs(), turned.pairs());
    if (seed == 0) {
      Crowd3 hulls, hulls_turned;
      scatter(hulls, 5, 50, {Rung::support}, 1.2);
      for (std::uint32_t owner = 50; owner-- > 0;)
        hulls_turned.add(Rung::support, owner, hulls.places[owner].state, hulls.places[owner].asleep);
      hulls.search_pairs(), hulls_turned.search_pairs();
      ASSERT_EQ(hulls.search.pairs().size(), hulls_turned.search.pairs().size());
      for (std::size_t i = 0; i < hulls.search.pairs().size(); ++i) {
        const NearPair a = hulls.search.pairs()[i], b = hulls_turned.search.pairs()[i];
        EXPECT_EQ(std::minmax({hulls.owner_of(a.first), hulls.owner_of(a.second)}),
                  std::minmax({hulls_turned.owner_of(b.first), hulls_turned.owner_of(b.second)}));
      }
    }
  }
}

// A few that fly about in much space, fall asleep, are woken, laid down elsewhere and joined by others: step
// after step the pairs are those of a search that knows of no step before.
TEST(NearSearch, WhoWasFarApartIsFoundOnceHeIsNear) {
  std::size_t steps_with_pairs = 0, steps_without = 0;
  for (std::uint32_t seed = 0; seed < 18; ++seed) {
    const bool mixed = seed % 3 == 2;
    Crowd3 crowd;
    if (mixed)
      scatter(crowd, seed, 14, {Rung::support, Rung::tables}, 5.0);
    else
      scatter(crowd, seed, 14, {Rung::support}, 5.0);
    RandomStream random(93, seed, 0);
    for (int step = 0; step < 300; ++step) {
      for (Crowd3::Place& place : crowd.places) {
        const double draw = random.uniform();
        if (place.asleep) {
          if (draw > 0.01) continue;
          place.asleep = false, place.state.velocity = random.uniform(0.0, 6.0) * random.direction();
          crowd.set_state(place);
          continue;
        }
        place.state.position += kSearchStep * place.state.velocity;
        if (place.state.position.norm() > 5.0)
          place.state.velocity = -2.0 * place.state.position.normalized();
        if (draw < 0.002) place.state.position = 4.0 * random.direction();
        crowd.set_state(place);
        if (draw > 0.001 && draw < 0.006) crowd.put_to_sleep(place);
      }
      if (step % 100 == 50) {
        const RigidState state = testing::at(4.0 * random.direction());
        const Rung rung = mixed && step == 250 ? Rung::tables : Rung::support;
        crowd.add(rung, std::uint32_t(crowd.places.size()), state, step == 150);
      }
      Crowd3 anew;
      for (std::uint32_t owner = 0; owner < crowd.places.size(); ++owner) {
        const Crowd3::Place& place = crowd.places[owner];
        anew.add(place.rung, owner, place.state, place.asleep);
      }
      crowd.search_pairs();
      anew.search_pairs();
      ASSERT_EQ(crowd.pairs(), anew.pairs()) << seed << ' ' << step;
      ++(crowd.search.pairs().empty() ? steps_without : steps_with_pairs);
    }
  }
  EXPECT_GT(steps_with_pairs, 300u);
  EXPECT_GT(steps_without, 300u);
}

TEST(NearSearch, AFilterIsAskedAboutOwners) {
  StatisticalSettings odd_with_odd;
  odd_with_odd.pair_filter = [](std::uint32_t a, std::uint32_t b) { return a % 2 == b % 2; };
  Crowd3 all, some(odd_with_odd);
  for (Crowd3* crowd : {&all, &some}) {
    scatter(*crowd, 8, 60, {Rung::support, Rung::tables, Rung::full}, 1.5);
    crowd->search_pairs();
  }
  auto expected = all.pairs();
  std::erase_if(expected, [](const auto& pair) { return pair.first % 2 != pair.second % 2; });
  EXPECT_EQ(some.pairs(), expected);
  EXPECT_LT(expected.size(), all.pairs().size());
}

// Bits as ODE has them: either's category among what the other collides with.
TEST(NearSearch, BitsKeepBodiesApart) {
  OwnProperties own;
  BodyProperties alone;
  alone.category = 2u, alone.collide = 4u;
  for (std::uint32_t owner = 0; owner < 60; owner += 5) own.set(owner, alone);
  StatisticalSettings with_bits;
  with_bits.properties = &own;
  Crowd3 all, some(with_bits);
  for (Crowd3* crowd : {&all, &some}) {
    scatter(*crowd, 9, 60, {Rung::support, Rung::full}, 1.5);
    crowd->search_pairs();
  }
  auto expected = all.pairs();
  std::erase_if(expected, [](const auto& pair) { return pair.first % 5 == 0 && pair.second % 5 == 0; });
  EXPECT_EQ(some.pairs(), expected);  // with all others they meet: those collide with every category
  EXPECT_LT(expected.size(), all.pairs().size());
}

// Each sphere that is near another rung's body is a guest, once.
TEST(NearSearch, GuestsAreSpheresNearOthersAndEachIsOne) {
  Crowd3 crowd;
  scatter(crowd, 10, 80, {Rung::tables, Rung::support}, 1.5);
  crowd.search_pairs();
  std::set<std::int32_t> slots;
  for (const Guest& guest : crowd.search.guests()) EXPECT_TRUE(slots.insert(guest.slot).second);
  std::set<std::uint32_t> in_pairs;
  for (const auto& [a, b] : crowd.pairs())
    for (const std::uint32_t owner : {a, b})
      if (crowd.places[owner].rung == Rung::tables) in_pairs.insert(owner);
  EXPECT_EQ(in_pairs.size(), slots.size());
  for (const std::int32_t slot : slots) EXPECT_TRUE(in_pairs.contains(crowd.tables.owner(slot)));
}

TEST(NearSearch, ClearedThereAreNone) {
  Crowd3 crowd;
  scatter(crowd, 11, 60, {Rung::support, Rung::tables}, 1.0);
  crowd.search_pairs();
  EXPECT_FALSE(crowd.search.pairs().empty());
  crowd.search.clear();
  EXPECT_TRUE(crowd.search.pairs().empty());
  EXPECT_TRUE(crowd.search.guests().empty());
  EXPECT_TRUE(crowd.search.order_of_spheres().empty());
}

}  // namespace
}  // namespace lodestone
