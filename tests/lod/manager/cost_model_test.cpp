#include "lod/manager/cost_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::cost_model_test {
namespace {

using namespace testing;

constexpr auto kTables = std::size_t(Rung::tables), kSupport = std::size_t(Rung::support),
               kFull = std::size_t(Rung::full);

StepCounts a_heap(int full = 5, int support = 100, int tables = 1000) {
  StepCounts counts;
  counts.at(Rung::full, Activity::crowded) = full;
  counts.at(Rung::support, Activity::crowded) = support;
  counts.at(Rung::tables, Activity::crowded) = tables;
  return counts;
}

/// A machine on which each body takes `slower` times its work.
StepMeasurement measure(const StepCounts& counts, double slower) {
  StepReport report;
  CostModel().predict(counts, report);
  StepMeasurement measured;
  for (std::size_t rung = 0; rung < kRungs; ++rung)
    measured.rungs_ms[rung] = 1e-3 * slower * report.cost[rung].work;
  measured.others_ms = 0.05 * slower;
  return measured;
}

double predict(const CostModel& model, const StepCounts& counts) {
  StepReport report;
  model.predict(counts, report);
  return report.predicted_ms;
}

TEST(CostModel, AHigherRungAndABusierBodyCostMore) {
  for (const Activity activity : {Activity::asleep, Activity::alone, Activity::crowded}) {
    EXPECT_LE(work_of(Rung::tables, std::size_t(activity)), work_of(Rung::support, std::size_t(activity)));
    EXPECT_LT(work_of(Rung::support, std::size_t(activity)), work_of(Rung::full, std::size_t(activity)));
  }
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) {
    EXPECT_LT(work_of(rung, std::size_t(Activity::asleep)), work_of(rung, std::size_t(Activity::alone)));
    EXPECT_LT(work_of(rung, std::size_t(Activity::alone)), work_of(rung, std::size_t(Activity::crowded)));
  }
  EXPECT_EQ(work_of(Rung::tables, std::size_t(Activity::asleep)), 0.0);
}

TEST(CostModel, WorkIsTheSameWhateverWasMeasured) {
  CostModel model;
  const auto before = model.cost_of(Activity::crowded);
  const double others = model.overhead({}).others;
  for (int i = 0; i < 50; ++i) model.learn(1.0, predict(model, a_heap()), a_heap(), measure(a_heap(), 7.0));
  EXPECT_EQ(model.cost_of(Activity::crowded), before);
  EXPECT_EQ(model.overhead({}).others, others);
  EXPECT_EQ(model.overhead({}).margin, 0.0);
}

TEST(CostModel, LearnsAMachineThatIsSlowerSoonAndOneThatIsFasterInTime) {
  for (const auto& [slower, steps] : {std::pair{6.0, 12}, {0.2, 150}}) {
    CostModel model;
    model.set_unit(CostModel::Unit::milliseconds);
    const StepMeasurement measured = measure(a_heap(), slower);
    for (int i = 0; i < steps; ++i) model.learn(1.0, predict(model, a_heap()), a_heap(), measured);
    EXPECT_NEAR(predict(model, a_heap()) / measured.total_ms(), 1.0, 0.1) << slower;
    EXPECT_GT(model.cost_of(Activity::crowded)[kFull],
              0.9e-3 * slower * work_of(Rung::full, std::size_t(Activity::crowded)));
  }
}

TEST(CostModel, OneCheapStepChangesLittle) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  const double before = predict(model, a_heap());
  model.learn(1.0, predict(model, a_heap()), a_heap(), measure(a_heap(), 0.1));
  EXPECT_GT(predict(model, a_heap()), 0.8 * before);
  EXPECT_LT(predict(model, a_heap()), before);
}

TEST(CostModel, WhatABodyDoesIsTakenApartByTheSteps) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  for (int i = 0; i < 400; ++i) {  // those alone are as they should be, those in the crowd four times as dear
    StepCounts counts;
    counts.at(Rung::support, Activity::alone) = i % 2 ? 2000 : 100,
                             counts.at(Rung::support, Activity::crowded) = i % 2 ? 5 : 200;
    StepMeasurement measured;
    measured.rungs_ms[kSupport] = 1e-3 * (work_of(Rung::support, std::size_t(Activity::alone)) *
                                              counts.at(Rung::support, Activity::alone) +
                                          4.0 * work_of(Rung::support, std::size_t(Activity::crowded)) *
                                              counts.at(Rung::support, Activity::crowded));
    model.learn(1.0, predict(model, counts), counts, measured);
  }
  const auto over_work = [&](Activity activity) {
    StepCounts counts;
    counts.at(Rung::support, activity) = 1000;
    StepReport report;
    model.predict(counts, report);
    return report.cost[kSupport].predicted_ms / (1e-3 * report.cost[kSupport].work);
  };
  EXPECT_NEAR(over_work(Activity::alone), 1.0, 0.2);
  EXPECT_NEAR(over_work(Activity::crowded), 4.0, 0.6);
}

TEST(CostModel, ASleeperIsChargedForItsWaking) {
  const CostModel model;
  for (const Rung rung : {Rung::support, Rung::full})
    EXPECT_GE(model.cost_of(Activity::asleep)[std::size_t(rung)],
              0.5 * work_of(rung, std::size_t(Activity::crowded)));
  EXPECT_EQ(model.cost_of(Activity::asleep)[kTables], 0.0f);
}

// Else a pile that had slept for long woke at the price of its sleep, and many too many of it were full.
TEST(CostModel, SleepersTellNothingOfThoseAwake) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  StepCounts asleep;
  asleep.at(Rung::full, Activity::asleep) = 100, asleep.at(Rung::full, Activity::crowded) = 0.1;
  StepMeasurement measured = measure(asleep, 1.0);
  measured.rungs_ms[kFull] -= 0.95e-3 * 100 * work_of(Rung::full, std::size_t(Activity::asleep));
  const double crowded = model.ms_of_one(Rung::full, std::size_t(Activity::crowded));
  for (int i = 0; i < 600; ++i) model.learn(0.1, predict(model, asleep), asleep, measured);
  EXPECT_LT(model.ms_of_one(Rung::full, std::size_t(Activity::asleep)), 0.2e-3);
  EXPECT_GT(model.ms_of_one(Rung::full, std::size_t(Activity::crowded)), 0.7 * crowded);
  EXPECT_EQ(model.ms_of_one(Rung::full, std::size_t(Activity::alone)),
            1e-3 * work_of(Rung::full, std::size_t(Activity::alone)));
}

TEST(CostModel, AtMostOneStepInAHundredExceedsPredictionAndMargin) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  RandomStream random(3, 1, 0);
  int over = 0;
  for (int i = 0; i < 5000; ++i) {
    const double predicted = predict(model, a_heap());
    const StepMeasurement measured = measure(a_heap(), 1.0 + 0.2 * (2.0 * random.uniform() - 1.0));
    over += i >= 500 && measured.total_ms() > predicted * (1.0 + model.margin());
    model.learn(1.0, predicted, a_heap(), measured);
  }
  EXPECT_LE(over, 45);
  EXPECT_LT(model.margin(), 0.35);
}

TEST(CostModel, AStepFarBelowItsBudgetMovesNoMargin) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  const double before = model.margin();
  model.learn(1000.0, predict(model, a_heap()), a_heap(), measure(a_heap(), 5.0));
  EXPECT_EQ(model.margin(), before);
  model.learn(1.0, predict(model, a_heap()), a_heap(), measure(a_heap(), 50.0));
  EXPECT_GT(model.margin(), before);
}

TEST(CostModel, OneSpikeMakesNoPrice) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  const double before = predict(model, a_heap());
  model.learn(1.0, before, a_heap(), measure(a_heap(), 100.0));
  EXPECT_LT(predict(model, a_heap()), 1.5 * before);
  for (int i = 0; i < 60; ++i) model.learn(1.0, before, a_heap(), measure(a_heap(), 1.0));  // a second
  EXPECT_NEAR(predict(model, a_heap()) / measure(a_heap(), 1.0).total_ms(), 1.0, 0.05);
}

TEST(CostModel, WhatArrivalsCostIsToldApartFromTheBodies) {
  CostModel model;
  model.set_unit(CostModel::Unit::milliseconds);
  for (int i = 0; i < 400; ++i) {  // now and then twenty arrive, each four times as dear as at first thought
    StepCounts counts = a_heap();
    StepMeasurement measured = measure(counts, 1.0);
    if (i % 2)
      counts.rungs[kSupport][kArriving] = 20,
      measured.rungs_ms[kSupport] += 1e-3 * 20 * 4 * work_of(Rung::support, kArriving);
    model.learn(1.0, predict(model, counts), counts, measured);
  }
  EXPECT_NEAR(model.cost_of_arriving(Rung::support) / (1e-3 * work_of(Rung::support, kArriving)), 4.0, 0.8);
  EXPECT_NEAR(model.cost_of(Activity::crowded)[kSupport] /
                  (1e-3 * work_of(Rung::support, std::size_t(Activity::crowded))),
              1.0, 0.2);
}

// Under a budget in work units: what was chosen repeats exactly, and whatever the threads.
std::uint64_t hash_under_work(int threads) {
  ManagerSettings settings = unmeasured({.policy = WorkPolicy{600.0}});
  settings.threads = threads;
  static const auto signature = coarse_signature(*box_shape({0.2, 0.3, 0.24}), {});
  settings.signatures = [](const Shape&, const ContactLaw&) { return signature; };
  Manager manager = on_floor(settings);
  const auto crate = box_shape({0.2, 0.3, 0.24});
  for (int i = 0; i < 60; ++i)
    add(manager, crate, at({0.4 * (i % 4), 0.4 * (i / 4 % 4), 0.3 + 0.4 * (i / 16)}));
  double work = 0.0;
  int mixed = 0;
  for (int step = 0; step < 120; ++step) {
    view_from(manager, {step < 60 ? 0.0 : 1.5, 0, 0.5});
    const StepReport& report = manager.step(kFrame);
    for (const RungCost& cost : report.cost) work += cost.work;
    mixed += report.full > 0 && report.support > 0 && report.tables > 0;
  }
  EXPECT_GT(work, 0.0);
  EXPECT_GT(mixed, 10);
  return manager.state_hash();
}

TEST(WorkPolicy, GivesTheSameHashTwiceAndOnAnyThreads) {
  const std::uint64_t first = hash_under_work(1);
  EXPECT_EQ(hash_under_work(1), first);
  EXPECT_EQ(hash_under_work(2), first);
}

TEST(BudgetPolicy, TheReportTellsWhatAStepCost) {
  Manager manager = on_floor(unmeasured({.policy = BudgetPolicy{50.0}}));
  view_from(manager, {0, 0, 0});
  for (int i = 0; i < 8; ++i) add(manager, box_shape({0.2, 0.3, 0.24}), at({0.5 * i, 0, 0.5}));
  run(manager, 0.5);
  const StepReport& report = manager.report();
  EXPECT_GT(report.full, 0);
  EXPECT_GT(report.measured_ms, 0.0);
  EXPECT_GT(report.predicted_ms, 0.0);
  EXPECT_GT(report.cost[kFull].measured_ms, 0.0);
  EXPECT_GT(report.cost[kFull].predicted_ms, 0.0);
  EXPECT_LE(
      report.cost[kTables].measured_ms + report.cost[kSupport].measured_ms + report.cost[kFull].measured_ms,
      report.measured_ms);
}

}  // namespace
}  // namespace lodestone::cost_model_test
