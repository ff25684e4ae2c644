#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "lod/manager.h"
#include "signature/measure/measure.h"
#include "tests/hills.h"

namespace lodestone {
namespace {

// Of bodies that come down on hills of triangles, on boxes there and on each other: alone, among others and
// over edges.
std::uint64_t hash_on_hills(StatisticalModel model, int threads, const JobRunner& jobs) {
  ManagerSettings settings;
  settings.threads = threads, settings.jobs = jobs, settings.model = model;
  settings.signatures = [](const Shape& shape, const ContactLaw&) {
    SignatureSettings coarse;
    coarse.n_theta = 4, coarse.n_phi = 4, coarse.n_alpha = 6, coarse.trials_per_cell = 8;
    coarse.height_trials = 100, coarse.settling_trials = 20, coarse.clips = 10;
    static const auto measured = std::make_shared<const Signature>(measure_signature(shape, coarse, 1));
    return measured;
  };
  Manager manager(settings);
  manager.add_static_mesh(testing::make_hills(20, 20));
  for (int i = 0; i < 6; ++i)
    manager.add_static_box(Vec3(1, 1, 0.6), Vec3(2.0 * i - 5.0, 0.5, 0.2), Quat::Identity());
  const auto shape = std::make_shared<const Shape>(make_shape("box", make_box(Vec3(0.2, 0.3, 0.4))));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 120; ++i) {
    BodyDefinition body{.shape = shape, .level = LevelChoice::statistical};
    body.state.position = Vec3(0.45 * (i % 15) - 3.0, 0.45 * (i / 15) - 2.0, 1.0 + 0.1 * (i % 7));
    body.state.orientation = Quat(Eigen::AngleAxisd(0.37 * i, Vec3(1, 0.5 * (i % 3), 0.3).normalized()));
    bodies.push_back(manager.add_body(body));
  }
  for (int step = 0; step < 60; ++step) manager.step(1.0 / 60);
  return manager.state_hash();
}

TEST(NearSolids, UnevenGroundOnAnyThreadsGivesTheSameHash) {
  const JobRunner last_first = [](std::int64_t count, TaskRef task) {
    std::jthread([&] {
      for (std::int64_t i = count; i-- > 0;) task(i);
    });
  };
  for (const StatisticalModel model : {StatisticalModel::tables, StatisticalModel::support}) {
    const std::uint64_t expected = hash_on_hills(model, 1, {});
    EXPECT_EQ(hash_on_hills(model, 3, {}), expected) << int(model);
    EXPECT_EQ(hash_on_hills(model, 2, last_first), expected) << int(model);
  }
}

}  // namespace
}  // namespace lodestone
