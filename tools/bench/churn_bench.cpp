#include "tools/bench/churn_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lod/manager.h"
#include "reference/random.h"
#include "tools/bench/settled_bench.h"
#include "tools/interrupt.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr double kChurnFrame = 1.0 / 60, kChurnApart = 2.0;  // s, m
constexpr int kChurnSettlingMost = 120, kTimedBefore = 30;   // steps
const Vec3 kChurnSides(0.2, 0.3, 0.24);                      // m, of a crate

LevelChoice choice_of(Rung rung) {
  return rung == Rung::full      ? LevelChoice::full
         : rung == Rung::support ? LevelChoice::support
                                 : LevelChoice::tables;
}

template <class Act>
double time_ms(const Act& act) {
  const auto begin = std::chrono::steady_clock::now();
  act();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

class ChurnedWorld {
 public:
  ChurnedWorld(const ChurnSettings& settings, Rung rung, bool asleep, std::shared_ptr<const Shape> shape,
               std::shared_ptr<const Signature> signature)
      : settings_(settings),
        shape_(std::move(shape)),
        manager_(make_manager(settings, asleep, std::move(signature))),
        random_(settings.seed, 0, 0) {
    row_.rung = rung, row_.asleep = asleep;
    row_.bodies = rung == Rung::full ? settings.full_bodies : settings.bodies;
    row_.churned = std::clamp(int(std::lround(settings.per_second * kChurnFrame)), 1, row_.bodies);
    side_ = int(std::ceil(std::sqrt(double(row_.bodies))));
    manager_.add_plane(Vec3::UnitZ(), 0.0);
    for (int place = 0; place < row_.bodies; ++place) bodies_.push_back(add(place));
  }

  ChurnRow measure() {
    row_.first_step_ms = time_ms([this] { manager_.step(kChurnFrame); });
    settle();
    row_.step_ms = median_of(steps(kTimedBefore));
    std::vector<double> removals, additions, whole;
    std::vector<int> places;
    for (int frame = 0; frame < settings_.frames; ++frame) {
      if (settings_.progress)
        settings_.progress(fmt::format("{}{}", name_of(row_.rung), row_.asleep ? " asleep" : ""),
                           double(frame) / settings_.frames);
      choose_places(places);
      removals.push_back(1e3 / row_.churned * time_ms([&] {
                           for (const int place : places) manager_.remove_body(bodies_[std::size_t(place)]);
                         }));
      additions.push_back(1e3 / row_.churned * time_ms([&] {
                            for (const int place : places) bodies_[std::size_t(place)] = add(place);
                          }));
      whole.push_back(time_ms([this] { manager_.step(kChurnFrame); }));
      settle();
    }
    row_.removal_us = median_of(removals), row_.addition_us = median_of(additions),
    row_.churned_step_ms = median_of(whole);
    return row_;
  }

 private:
  // Without gravity what moves goes on for good.
  static Manager make_manager(const ChurnSettings& settings, bool asleep,
                              std::shared_ptr<const Signature> signature) {
    ManagerSettings manager;
    manager.seed = settings.seed, manager.threads = settings.threads, manager.full_substeps = 1;
    if (!asleep) manager.gravity = Vec3::Zero();
    manager.signatures = [signature](const Shape&, const ContactLaw&) { return signature; };
    return Manager(manager);
  }

  BodyId add(int place) {
    RigidState state;
    state.position = {kChurnApart * (place % side_), kChurnApart * (place / side_),
                      row_.asleep ? 0.5 * kChurnSides.z() : 1.0};
    if (!row_.asleep) state.velocity = {0, 0, 0.3};
    return manager_.add_body({.shape = shape_,
                              .state = state,
                              .mass = 10.0 + 1e-3 * double(added_++),
                              .level = choice_of(row_.rung)});
  }

  void settle() {
    for (int step = 0; row_.asleep && step < kChurnSettlingMost && manager_.report().asleep < row_.bodies;
         ++step)
      manager_.step(kChurnFrame);
  }

  // Each once.
  void choose_places(std::vector<int>& places) {
    places.clear();
    const auto first = int(random_.uniform(0.0, double(row_.bodies)));
    const int stride = row_.bodies / row_.churned;
    for (int i = 0; i < row_.churned; ++i) places.push_back((first + i * stride) % row_.bodies);
  }

  std::vector<double> steps(int count) {
    std::vector<double> ms;
    for (int i = 0; i < count; ++i) ms.push_back(time_ms([this] { manager_.step(kChurnFrame); }));
    return ms;
  }

  const ChurnSettings& settings_;
  std::shared_ptr<const Shape> shape_;
  Manager manager_;
  RandomStream random_;
  std::vector<BodyId> bodies_;  // by place
  std::int64_t added_ = 0;
  int side_ = 1;
  ChurnRow row_;
};

}  // namespace

std::vector<ChurnRow> bench_churn(const ChurnSettings& settings) {
  const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box(kChurnSides)));
  const auto signature = make_coarse_signature(*shape);
  std::vector<ChurnRow> rows;
  until_interrupted([&] {
    for (const Rung rung : {Rung::support, Rung::tables, Rung::full})
      for (const bool asleep : {false, true})
        rows.push_back(ChurnedWorld(settings, rung, asleep, shape, signature).measure());
  });
  return rows;
}

}  // namespace lodestone
