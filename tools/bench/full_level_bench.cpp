#include "tools/bench/full_level_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "reference/argument_error.h"
#include "tools/interrupt.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr int kFallingSteps = 8;    // of drops from .3 m and more over a body's size of .2 m
constexpr double kFarApart = 60.0;  // sizes of a body: farther than any drop goes

class BenchWorld {
 public:
  BenchWorld(const DropJob& job, const OdeMethod& way, const FullLevelBenchSettings& settings)
      : materials_(make_materials(job)), world_(way.settings, materials_), substeps_(way.substeps) {
    world_.add_plane(Vec3::UnitZ(), 0.0, 0);
    const int side = int(std::ceil(std::sqrt(double(settings.bodies))));
    for (int i = 0; i < settings.bodies; ++i) {
      RigidState state = drop_state(*job.shape, job.conditions, settings.seed, i);
      state.position += kFarApart * job.shape->size * Vec3(i % side - side / 2, i / side - side / 2, 0.0);
      world_.add_body({.shape = way.collision_shape,
                       .mass = job.material.density * job.shape->volume,
                       .state = state,
                       .geometry = way.geometry,
                       .spheres = way.spheres});
    }
  }

  double time_step_ms() {
    const auto start = std::chrono::steady_clock::now();
    world_.step(kStep, substeps_);
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  static MaterialTable make_materials(const DropJob& job) {
    MaterialTable materials;
    materials.replace(0, job.material);
    return materials;
  }

  MaterialTable materials_;
  OdeWorld world_;
  int substeps_;
};

struct StepTimes {
  std::vector<double> falling_ms, all_ms;
};

void time_steps(const DropJob& job, const OdeMethod& way, const FullLevelBenchSettings& settings,
                StepTimes& times) {
  BenchWorld world(job, way, settings);
  for (int step = 0; step < settings.steps; ++step) {
    const double ms = world.time_step_ms();
    if (step > 0 && step < kFallingSteps)
      times.falling_ms.push_back(ms);  // the first one builds what later ones keep
    times.all_ms.push_back(ms);
  }
}

const OdeMethod& ode_of(const DropMethod& method) {
  const auto* way = std::get_if<OdeMethod>(&method.way);
  if (!way) throw ArgumentError(fmt::format("--methods: found '{}', expected methods of ODE", method.name));
  return *way;
}

}  // namespace

std::vector<FullLevelBenchRow> bench_full_level(const DropJob& job, const FullLevelBenchSettings& settings) {
  const auto methods = make_drop_methods(settings.methods, job, {}, 1, settings.progress);
  std::vector<StepTimes> times(methods.size());
  until_interrupted([&] {
    for (int repeat = 0; repeat < settings.repeats; ++repeat)
      for (std::size_t i = 0; i < methods.size(); ++i) {
        if (settings.progress)
          settings.progress(methods[i].name,
                            (repeat + double(i) / double(methods.size())) / settings.repeats);
        if (methods[i].left_out.empty()) time_steps(job, ode_of(methods[i]), settings, times[i]);
      }
  });
  std::vector<FullLevelBenchRow> rows;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    FullLevelBenchRow row{
        .method = methods[i].name, .substeps = methods[i].substeps(), .left_out = methods[i].left_out};
    if (row.left_out.empty() && times[i].falling_ms.empty()) row.left_out = "interrupted";
    if (row.left_out.empty()) {
      row.falling_ms = median_of(times[i].falling_ms);
      row.step_ms = median_of(times[i].all_ms);
      row.times_less = rows.empty() ? 1.0 : rows.front().step_ms / row.step_ms;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lodestone
