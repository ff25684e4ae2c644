// Signatures on first use: while a shape's signature is measured its bodies are at `support` without settling
// clips, and the budget holds.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

}  // namespace

int main() {
  // A cache of its own, empty: nothing has been measured yet.
  const auto cache =
      std::filesystem::temp_directory_path() / ("lodestone-first-use-" + std::to_string(::getpid()));
  ::setenv("XDG_CACHE_HOME", cache.c_str(), 1);
  std::vector<double> ms;
  double leap_m = 0.0;
  int waited = 0, most_full = 0;
  {
    Manager manager({.policy = {.policy = BudgetPolicy{4.0}}});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2));
    std::vector<BodyId> bodies;
    for (int i = 0; i < 300; ++i)
      bodies.push_back(manager.add_body(
          {.shape = bunny, .state = {.position = {0.5 * (i % 20), 0.5 * (i / 20), 0.5 + 0.01 * (i % 40)}}}));
    const Vec3 camera(5, 4, 1);
    manager.set_viewpoints({&camera, 1});
    bool come = false;
    for (int frame = 0; frame < 300; ++frame) {
      std::vector<Vec3> before, velocities;
      for (const BodyId body : bodies)
        before.push_back(manager.state(body).position), velocities.push_back(manager.state(body).velocity);
      const double start = thread_ms();
      const StepReport& report = manager.step(1.0 / 60.0);
      ms.push_back(thread_ms() - start);
      most_full = std::max(most_full, report.full);
      for (std::size_t i = 0; i < bodies.size(); ++i)
        leap_m = std::max(
            leap_m, (manager.state(bodies[i]).position - before[i]).norm() - velocities[i].norm() / 60.0);
      if (report.counters.signatures_loaded == 0) {
        ++waited;
        std::this_thread::sleep_for(std::chrono::milliseconds(16));  // the rest of a frame
      }
      come = report.counters.signatures_loaded > 0;
    }
    std::printf("     %d frames until the signature came: %s\n", waited, come ? "yes" : "not yet");
  }
  std::filesystem::remove_all(cache);
  std::vector<double> later(ms.begin() + 60, ms.end());
  std::ranges::sort(later);
  const double median = later[later.size() / 2], p99 = later[later.size() * 99 / 100],
               longest = *std::ranges::max_element(ms);
  std::printf(
      "     a step, ms of the thread: median %.3f, 99 %% %.3f after the first second, longest of all %.3f\n",
      median, p99, longest);
  check::within(waited, 1, 300, "frames in which the signature was being measured");
  check::within(most_full, 1, 299, "bodies full at most, of 300: not all of them");
  check::within(leap_m, 0.0, 0.02, "m, greatest leap of a body beyond its velocity in a frame");
  return check::result();
}
