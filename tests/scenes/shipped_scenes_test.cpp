// The scene files of scenes/: each loads, and nothing in them overlaps at the start.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>

#include "reference/error.h"
#include "scenes/camera.h"
#include "scenes/ground_heights.h"
#include "scenes/runner.h"
#include "scenes/scene_file.h"
#include "signature/measure/measure.h"
#include "tests/message_of.h"

namespace lodestone::shipped_scenes_test {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(LODESTONE_SOURCE_DIR) / "scenes";

Scene load(const std::string& name) { return load_scene(kFolder / (name + ".yaml")); }

/// Pairs of bounding spheres that overlap, by sweeping along x.
int count_overlaps(const Scene& scene) {
  std::vector<const BodyDefinition*> bodies;
  for (const SceneBody& body : scene.bodies) bodies.push_back(&body.definition);
  std::ranges::sort(bodies, {}, [](const BodyDefinition* b) { return b->state.position.x(); });
  int overlaps = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Vec3 between = bodies[j]->state.position - bodies[i]->state.position;
      if (between.x() > 1.0) break;  // no shipped shape is larger
      overlaps += between.norm() < bodies[i]->shape->radius + bodies[j]->shape->radius;
    }
  return overlaps;
}

double lowest_point(const Scene& scene) {
  double lowest = 1e9;
  for (const SceneBody& body : scene.bodies)
    lowest = std::min(lowest, body.definition.state.position.z() - body.definition.shape->radius);
  return lowest;
}

struct Shipped {
  std::string name;
  int bodies;
};
class ShippedScene : public ::testing::TestWithParam<Shipped> {};

TEST_P(ShippedScene, LoadsAndStartsApart) {
  const Scene scene = load(GetParam().name);
  EXPECT_EQ(int(scene.bodies.size()), GetParam().bodies);
  EXPECT_EQ(count_overlaps(scene), 0);
  if (GetParam().name != "hills") {  // whose ground is not at 0
    EXPECT_GE(lowest_point(scene), 0.0);
  }
  EXPECT_EQ(scene.output.trajectory, GetParam().name + ".glb");
  for (const SceneBody& body : scene.bodies) EXPECT_LT(body.definition.shape->radius, 0.5);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene,
                         ::testing::Values(Shipped{"bunnies", 1000}, Shipped{"drop", 1},
                                           Shipped{"boxes", 100}, Shipped{"l_shapes", 300},
                                           Shipped{"side_by_side", 100}, Shipped{"ten_thousand", 10000},
                                           Shipped{"forced", 1000}, Shipped{"heap", 2000},
                                           Shipped{"hills", 400}, Shipped{"landscape", 1000},
                                           Shipped{"stairs", 240}, Shipped{"bins", 296}),
                         [](const auto& test) { return test.param.name; });

TEST(ShippedScenes, TheCityHasTenThousandBodiesOfFiveShapesAndFourRagdolls) {
  const Scene scene = load("city");
  EXPECT_EQ(scene.bodies.size(), 10000u);
  EXPECT_EQ(scene.groups.size(), 4u);
  EXPECT_EQ(std::get<BudgetPolicy>(scene.lod.policy).budget_ms, 8.0);
  Scene strewn = scene;  // the limbs of a ragdoll are nearer to each other than their bounding spheres
  std::erase_if(strewn.bodies,
                [](const SceneBody& body) { return body.definition.level == LevelChoice::full; });
  EXPECT_EQ(strewn.bodies.size(), 9975u);
  EXPECT_EQ(count_overlaps(strewn), 0);
  std::set<const Shape*> shapes;
  for (const SceneBody& body : strewn.bodies) shapes.insert(body.definition.shape.get());
  EXPECT_EQ(shapes.size(), 5u);
  const GroundHeights heights(scene.ground);
  for (const SceneBody& body : strewn.bodies) {
    const Vec3& place = body.definition.state.position;
    if (body.asleep)
      EXPECT_GT(place.z(), *heights.highest_under(place, 0));
    else
      EXPECT_GE(place.z() - body.definition.shape->radius, *heights.highest_under(place, 0) - 1e-9);
  }
}

TEST(ShippedScenes, NoneIsLeftOut) {
  for (const fs::directory_entry& entry : fs::directory_iterator(kFolder)) {
    if (entry.path().extension() != ".yaml" || entry.path().stem() == "armadillo") continue;
    ASSERT_NO_THROW(EXPECT_FALSE(load(entry.path().stem().string()).viewpoints.empty())
                    << entry.path() << ": a scene is seen from somewhere")
        << entry.path();
  }
}

// What is left of their energy is how high they lie: 5,716, 5,819, 5,686 and 5,607 J at the full level
// (`build/lodestone run scenes/bins.yaml --level full --seed 1…4`), 8 s of processor time each. With
// friction bounded by the impulses as they are `support` had 6,219, 6,045, 6,084 and 6,284; while crates did
// not tip over at `tables` that had 7,133, 7,237, 7,358 and 7,306.
TEST(ShippedScenes, SmallHeapsAreAsHighAsAtTheFullLevel) {
  constexpr double kFull = 5'707.0;                                  // J, their mean
  std::map<std::string, std::shared_ptr<const Signature>> measured;  // by the shape's name
  const auto measure = [&](const Shape& shape, const ContactLaw& law) {
    std::shared_ptr<const Signature>& signature = measured[shape.name];
    if (signature) return signature;
    SignatureSettings settings;
    settings.law = law;
    settings.n_theta = 3, settings.n_phi = 3, settings.n_alpha = 4, settings.trials_per_cell = 8;
    settings.height_trials = 60, settings.settling_trials = 100, settings.clips = 20;
    return signature = std::make_shared<const Signature>(measure_signature(shape, settings, 2));
  };
  for (const auto& [model, bound] :
       {std::pair{StatisticalModel::support, 0.03}, {StatisticalModel::tables, 0.18}}) {
    double mean = 0.0;
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      Scene scene = load_scene(kFolder / "bins.yaml", {.mesh_paths = {}, .seed = seed});
      scene.default_steps = 360;  // 6 s: by the roundings one comes to rest after more than the scene's five
      const RunResult run =
          run_scene(scene, {.model = model, .level = LevelChoice::statistical, .signatures = measure});
      const int restless = model == StatisticalModel::tables ? 3 : 0;  // some wait longer in a wedge
      EXPECT_GE(run.last().asleep, run.bodies - restless) << int(model) << ", seed " << seed;
      mean += run.energy_end_j / 4.0;
    }
    EXPECT_NEAR(mean, kFull, bound * kFull) << int(model);
  }
}

TEST(ShippedScenes, SidesAreAlike) {
  const Scene scene = load("side_by_side");
  for (std::size_t i = 0; i < 50; ++i) {
    const BodyDefinition &left = scene.bodies[i].definition, &right = scene.bodies[50 + i].definition;
    EXPECT_LT((right.state.position - left.state.position - Vec3(8, 0, 0)).norm(), 1e-12);
    EXPECT_EQ(left.state.orientation.coeffs(), right.state.orientation.coeffs());
    EXPECT_EQ(left.level, LevelChoice::statistical);
    EXPECT_EQ(right.level, LevelChoice::full);
  }
}

// Where the bodies start and where they land: the camera sees those that are nearest to it, which are full.
TEST(ShippedScenes, TheBunniesNearestToTheViewpointAreInItsPicture) {
  const Scene scene = load("bunnies");
  const SceneViewpoint& viewpoint = scene.viewpoints.at(0);
  for (const double time : {0.0, 0.5, 5.0, 10.0}) {
    const Vec3 eye = viewpoint.position_at(time);
    std::vector<Vec3> places;
    for (const SceneBody& body : scene.bodies) {
      places.push_back(body.definition.state.position);
      if (time > 0.0) places.back().z() = std::max(0.1, places.back().z() - 0.5 * 9.81 * time * time);
    }
    std::ranges::sort(places, {}, [&](const Vec3& place) { return (place - eye).norm(); });
    EXPECT_LT((places[std::size_t(scene.lod.most_full) - 1] - eye).norm(),
              std::get<DistancePolicy>(scene.lod.policy).full_within)
        << time;
    const Camera camera(eye, viewpoint.look_at_m);
    EXPECT_GE(std::count_if(places.begin(), places.begin() + scene.lod.most_full,
                            [&](const Vec3& place) { return camera.sees(place); }),
              10)
        << time;
  }
}

// Every two seconds, and between jumps it stands still.
TEST(ShippedScenes, TheHeapsViewpointJumps) {
  const Scene scene = load("heap");
  EXPECT_EQ(std::get<BudgetPolicy>(scene.lod.policy).budget_ms, 8.0);
  const SceneViewpoint& viewpoint = scene.viewpoints.at(0);
  for (double time = 0.0; time < 9.0; time += 2.0) {
    EXPECT_EQ(viewpoint.position_at(time), viewpoint.position_at(time + 1.98)) << time;
    const double jump = (viewpoint.position_at(time + 2.0) - viewpoint.position_at(time)).norm();
    EXPECT_TRUE(jump > 1.0 || time == 8.0) << time;
    EXPECT_NEAR(viewpoint.position_at(time).head<2>().norm(), 1.5, 0.01) << "within the heap's edge";
  }
}

TEST(ShippedScenes, ForcedOnesAreFarAndNear) {
  const Scene scene = load("forced");
  const auto distance = [&](int i) {
    return (scene.bodies[i].definition.state.position - scene.viewpoints[0].position_m).norm();
  };
  for (int i : {0, 1})
    EXPECT_TRUE(scene.bodies[i].definition.level == LevelChoice::full && distance(i) >= 100);
  for (int i : {2, 3})
    EXPECT_TRUE(scene.bodies[i].definition.level == LevelChoice::statistical && distance(i) < 1);
}

TEST(ShippedScenes, ArmadilloSaysWhereToGetTheMesh) {
  const std::string what = testing::message_of([] { load("armadillo"); });
  EXPECT_NE(what.find("armadillo.yaml:7: shapes.armadillo.mesh: found no armadillo.obj in"),
            std::string::npos)
      << what;
  EXPECT_NE(what.find("Stanford 3D Scanning Repository"), std::string::npos) << what;
  EXPECT_NE(what.find("--mesh-path"), std::string::npos) << what;
}

}  // namespace
}  // namespace lodestone::shipped_scenes_test
