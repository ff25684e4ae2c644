// Bodies that come and go all the time, as level streaming has it: nothing is left of those that are gone.
#include <malloc.h>
#include <ode/ode.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr int kBodies = 3000, kChurned = 167;

double milliseconds() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double heap_mib() {
  const auto held = mallinfo2();
  return double(held.uordblks + held.hblkhd) / 1048576.0;
}

struct Streaming {
  explicit Streaming(LevelChoice rung)
      : rung_(rung),
        manager_({.policy = {.policy = DistancePolicy{.full_within = 1.0, .support_within = 100.0}},
                  .signature_timing = SignatureTiming::in_step}) {
    manager_.add_plane(Vec3::UnitZ(), 0.0);
    for (int i = 0; i < kBodies; ++i) bodies_.push_back(add(i));
    manager_.step(1.0 / 60);
  }

  // Every body of a shape, a size and a mass that no other ever has.
  BodyId add(int place) {
    ++added_;
    const auto shape = added_ % 7 == 0
                           ? std::make_shared<const Shape>(scale_shape(*crate_, 1.0 + 1e-5 * double(added_)))
                           : crate_;
    return manager_.add_body({.shape = shape,
                              .state = {.position = Vec3(1.5 * (place % 60), 1.5 * (place / 60), 0.3)},
                              .mass = 1.0 + 1e-3 * double(added_),
                              .level = rung_});
  }

  void stream(int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      const double start = milliseconds();
      for (int i = 0; i < kChurned; ++i) manager_.remove_body(bodies_[std::size_t((at_ + i) % kBodies)]);
      for (int i = 0; i < kChurned; ++i) bodies_[std::size_t((at_ + i) % kBodies)] = add((at_ + i) % kBodies);
      longest_ms_ = std::max(longest_ms_, milliseconds() - start);
      at_ += kChurned;
      manager_.step(1.0 / 60);
    }
  }

  LevelChoice rung_;
  std::shared_ptr<const Shape> crate_ =
      std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  Manager manager_;
  std::vector<BodyId> bodies_;
  std::int64_t added_ = 0;
  int at_ = 0;
  double longest_ms_ = 0.0;
};

void measure(LevelChoice rung, const char* memory, const char* time) {
  Streaming world(rung);
  world.stream(60);
  const double before = heap_mib();
  world.stream(180);  // 30,060 more
  check::within(heap_mib() - before, -100.0, 1.0, memory);
  check::within(world.longest_ms_, 0.0, 1000.0, time);
  const StepReport& report = world.manager_.report();
  check::within(report.statistical + report.full, kBodies, kBodies, "bodies");
  double lowest = 1.0;
  for (const BodyId body : world.bodies_) lowest = std::min(lowest, world.manager_.state(body).position.z());
  check::within(lowest, 0.05, 0.5, "m, lowest centre of mass");
}

}  // namespace

int main() {
  dInitODE2(0);
  measure(LevelChoice::support, "MiB that the heap grew by, support",
          "ms in which 167 were removed and added, at most, support");
  measure(LevelChoice::tables, "MiB that the heap grew by, tables",
          "ms in which 167 were removed and added, at most, tables");
  return check::result();
}
