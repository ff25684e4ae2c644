#include "scenes/trajectory.h"

#include <tiny_gltf.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <thread>

#include "tests/scenes/scene_fixture.h"

namespace lodestone {
namespace {

using TrajectoryFile = SceneFixture;

/// Two boxes (one changes rung, one sleeps from frame 10 on) and a ball that never moves.
Scene small_scene() {
  Scene scene;
  const auto box = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.1));
  scene.ground = {GroundPlane{Vec3(0, 0, 1), -0.5, 0}, GroundBox{{1, 1, 1}, {9, 0, 0}, Quat::Identity(), 0}};
  scene.bodies.resize(3);
  scene.bodies[0].name = "hero";
  scene.bodies[0].definition.shape = scene.bodies[1].definition.shape = box;
  scene.bodies[2].definition.shape = ball;
  SceneViewpoint viewpoint;
  viewpoint.path = {{0, {0, -5, 1}}, {1, {5, 0, 1}}};
  scene.viewpoints = {viewpoint};
  return scene;
}

constexpr int kFrames = 31;

RigidState pose(int frame, int body) {
  RigidState state;
  if (body == 1) frame = std::min(frame, 10);
  if (body == 2) frame = 0;
  const double angle = 0.35 * frame;  // more than a full turn, so that the quaternion's sign comes round
  state.position = {body + 0.1 * frame, -2.0 * body, 3.0 - 0.01 * frame * frame};
  state.orientation = Quat(Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()));
  return state;
}

Rung rung_of_hero(int frame) {
  if (frame >= 5 && frame < 20) return Rung::full;
  return frame < 25 ? Rung::support : Rung::tables;
}

Trajectory record() {
  Trajectory trajectory(3);
  for (int frame = 0; frame < kFrames; ++frame) {
    std::vector<RigidState> states;
    for (int body = 0; body < 3; ++body) states.push_back(pose(frame, body));
    trajectory.add_frame(frame / 30.0, states,
                         std::vector<BodyStatus>{{.rung = rung_of_hero(frame)},
                                                 {.rung = Rung::full, .asleep = frame >= 10},
                                                 {.rung = Rung::tables}});
  }
  return trajectory;
}

/// A saved file, read back by tinygltf.
struct Loaded {
  explicit Loaded(const std::filesystem::path& file) {
    tinygltf::TinyGLTF loader;
    std::string warnings;
    ok = loader.LoadBinaryFromFile(&model, &error, &warnings, file.string());
    error += warnings;
  }

  int node(const std::string& name) const {
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
      if (model.nodes[i].name == name) return int(i);
    return -1;
  }
  const tinygltf::AnimationSampler* sampler(int node_index, const std::string& path) const {
    for (const tinygltf::AnimationChannel& channel : model.animations.at(0).channels)
      if (channel.target_node == node_index && channel.target_path == path)
        return &model.animations[0].samplers.at(std::size_t(channel.sampler));
    return nullptr;
  }
  template <class Number>
  std::vector<Number> numbers(int accessor_index) const {
    const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(accessor_index));
    const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(accessor.bufferView));
    std::vector<Number> values(accessor.count *
                               std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type))));
    const std::vector<unsigned char>& data = model.buffers.at(0).data;
    EXPECT_EQ(sizeof(Number),
              std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType))));
    EXPECT_LE(accessor.byteOffset + values.size() * sizeof(Number), view.byteLength);
    std::memcpy(values.data(), data.data() + view.byteOffset + accessor.byteOffset,
                values.size() * sizeof(Number));
    return values;
  }

  tinygltf::Model model;
  std::string error;
  bool ok = false;
};

class SavedTrajectory : public SceneFixture {
 protected:
  SavedTrajectory() : scene_(small_scene()) { save_trajectory(folder() / "run.glb", record(), scene_); }
  Scene scene_;
};

TEST_F(SavedTrajectory, LoadsWithoutComplaint) {
  const Loaded loaded(folder() / "run.glb");
  EXPECT_TRUE(loaded.ok);
  EXPECT_EQ(loaded.error, "");
  EXPECT_FALSE(std::filesystem::exists(folder() / "run.glb.part"));
}

TEST_F(SavedTrajectory, HoldsPosesWithinQuantization) {
  const Loaded loaded(folder() / "run.glb");
  const int hero = loaded.node("hero");
  ASSERT_GE(hero, 0);
  const auto* translation = loaded.sampler(hero, "translation");
  const auto* rotation = loaded.sampler(hero, "rotation");
  ASSERT_TRUE(translation && rotation);
  const auto times = loaded.numbers<float>(translation->input),
             places = loaded.numbers<float>(translation->output);
  const auto turns = loaded.numbers<std::int16_t>(rotation->output);
  EXPECT_TRUE(loaded.model.accessors[std::size_t(rotation->output)].normalized);
  ASSERT_EQ(times.size(), std::size_t(kFrames));
  ASSERT_EQ(turns.size(), 4u * kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    const RigidState truth = pose(frame, 0);
    const std::size_t p = std::size_t(3 * frame), q = std::size_t(4 * frame);
    EXPECT_FLOAT_EQ(times[std::size_t(frame)], float(frame / 30.0));
    EXPECT_LT((Vec3(places[p], places[p + 1], places[p + 2]) - truth.position).norm(), 1e-6);
    const Quat turn = Quat(turns[q + 3], turns[q], turns[q + 1], turns[q + 2]).normalized();
    EXPECT_LT(turn.angularDistance(truth.orientation), 1e-4);
  }
  for (std::size_t q = 4; q < turns.size(); q += 4) {
    int dot = 0;
    for (std::size_t i = 0; i < 4; ++i) dot += turns[q + i] / 2 * (turns[q + i - 4] / 2);
    EXPECT_GT(dot, 0) << "a change of sign between neighbours spins a body the long way round";
  }
}

TEST_F(SavedTrajectory, LeavesOutWhatDoesNotMove) {
  const Loaded loaded(folder() / "run.glb");
  const auto* sleeper = loaded.sampler(loaded.node("body 1"), "translation");
  ASSERT_TRUE(sleeper);
  EXPECT_EQ(loaded.numbers<float>(sleeper->output).size(), 3u * 11);
  const int still = loaded.node("body 2");
  EXPECT_FALSE(loaded.sampler(still, "translation"));
  EXPECT_NEAR(loaded.model.nodes[std::size_t(still)].translation[1], -4.0, 1e-6);
}

TEST_F(SavedTrajectory, ShowsRungs) {
  const Loaded loaded(folder() / "run.glb");
  const auto material_of = [&](int node) {
    const auto& mesh = loaded.model.meshes.at(std::size_t(loaded.model.nodes.at(std::size_t(node)).mesh));
    return loaded.model.materials.at(std::size_t(mesh.primitives[0].material)).name;
  };
  const tinygltf::Node& sleeper = loaded.model.nodes[std::size_t(loaded.node("body 1"))];
  ASSERT_EQ(sleeper.children.size(), 2u);
  EXPECT_EQ(material_of(sleeper.children[0]), "full");
  EXPECT_EQ(material_of(sleeper.children[1]), "full asleep");
  EXPECT_FLOAT_EQ(loaded.numbers<float>(loaded.sampler(sleeper.children[1], "scale")->input)[1],
                  float(10 / 30.0));
  EXPECT_EQ(material_of(loaded.node("body 2")), "tables");
  const tinygltf::Node& hero = loaded.model.nodes[std::size_t(loaded.node("hero"))];
  EXPECT_EQ(hero.mesh, -1);
  ASSERT_EQ(hero.children.size(), 3u);
  // From frame 0, 5, 20 and 25 on.
  std::map<std::string, std::vector<float>> shown = {
      {"full", {0, 1, 0, 0}}, {"support", {1, 0, 1, 0}}, {"tables", {0, 0, 0, 1}}};
  for (int child : hero.children) {
    const auto* scale = loaded.sampler(child, "scale");
    ASSERT_TRUE(scale);
    EXPECT_EQ(scale->interpolation, "STEP");
    const auto times = loaded.numbers<float>(scale->input), scales = loaded.numbers<float>(scale->output);
    ASSERT_EQ(times.size(), 4u);
    EXPECT_FLOAT_EQ(times[1], float(5 / 30.0));
    EXPECT_FLOAT_EQ(times[2], float(20 / 30.0));
    EXPECT_FLOAT_EQ(times[3], float(25 / 30.0));
    const std::vector<float>& scale_of = shown[material_of(child)];
    for (std::size_t i = 0; i < scales.size(); ++i)
      EXPECT_EQ(scales[i], scale_of[i / 3]) << material_of(child) << ' ' << i;
    shown.erase(material_of(child));
  }
}

TEST_F(SavedTrajectory, SharesArraysOfAShape) {
  const Loaded loaded(folder() / "run.glb");
  int boxes = 0;
  std::vector<int> positions;
  for (const tinygltf::Mesh& mesh : loaded.model.meshes)
    if (mesh.name.starts_with("box")) {
      ++boxes;
      positions.push_back(mesh.primitives[0].attributes.at("POSITION"));
    }
  ASSERT_EQ(boxes, 4);  // on three rungs, and full asleep
  for (const int position : positions) EXPECT_EQ(position, positions[0]);
}

// To those who lack a kind of cone, by Machado, Oliveira and Fernandes, A physiologically-based model for
// simulation of color vision deficiency (2009), table 1: what they see of linear red, green and blue.
Vec3 seen_color(const Vec3& rgb, int lacking) {
  Mat3 sees = Mat3::Identity();
  if (lacking == 1)
    sees << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
  if (lacking == 2)
    sees << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  if (lacking == 3)
    sees << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900;
  return (sees * rgb).cwiseMax(0.0).cwiseMin(1.0);
}

// CIE 1976 L*a*b* under D65; two colours 2.3 apart are told apart side by side.
Vec3 lab_of(const Vec3& rgb) {
  Mat3 to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Vec3 xyz = (to_xyz * rgb).cwiseQuotient(Vec3(0.9505, 1.0, 1.0890));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  return {116 * f(xyz.y()) - 16, 500 * (f(xyz.x()) - f(xyz.y())), 200 * (f(xyz.y()) - f(xyz.z()))};
}

TEST_F(SavedTrajectory, RungsAreToldApartWhateverConesOneHas) {
  const Loaded loaded(folder() / "run.glb");
  std::vector<Vec3> awake, asleep;  // the ground among those awake
  for (const tinygltf::Material& material : loaded.model.materials) {
    const std::vector<double>& rgba = material.pbrMetallicRoughness.baseColorFactor;
    (material.name.ends_with("asleep") ? asleep : awake).emplace_back(rgba[0], rgba[1], rgba[2]);
  }
  ASSERT_EQ(awake.size(), 4u);
  ASSERT_EQ(asleep.size(), 3u);
  const auto nearest_two = [&](const std::vector<Vec3>& colors, int lacking) {
    double least = 1e9;
    for (std::size_t i = 0; i < colors.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        least = std::min(
            least, (lab_of(seen_color(colors[i], lacking)) - lab_of(seen_color(colors[j], lacking))).norm());
    return least;
  };
  for (int lacking = 0; lacking < 4; ++lacking) {
    EXPECT_GT(nearest_two(awake, lacking), 15.0) << lacking;
    EXPECT_GT(nearest_two(asleep, lacking), 10.0) << lacking;
  }
}

TEST_F(SavedTrajectory, HasGroundAndCamera) {
  const Loaded loaded(folder() / "run.glb");
  EXPECT_NE(loaded.node("ground"), -1);
  const int camera = loaded.node("viewpoint");
  ASSERT_NE(camera, -1);
  EXPECT_EQ(loaded.model.nodes[std::size_t(camera)].camera, 0);
  const auto* motion = loaded.sampler(camera, "translation");
  ASSERT_TRUE(motion);
  const auto places = loaded.numbers<float>(motion->output);
  EXPECT_FLOAT_EQ(places[places.size() - 3], 5.0f);
  // The camera looks along −z of its own: from (0, −5, 1) to the origin.
  const auto turn = loaded.numbers<float>(loaded.sampler(camera, "rotation")->output);
  const Vec3 forward = Quat(turn[3], turn[0], turn[1], turn[2]) * Vec3(0, 0, -1);
  EXPECT_LT((forward - Vec3(0, 5, -1).normalized()).norm(), 1e-6);
}

TEST_F(TrajectoryFile, OneFrameAndNoBodies) {
  Scene scene;
  Trajectory empty(0);
  empty.add_frame(0, {}, {});
  save_trajectory(folder() / "empty.glb", empty, scene);
  EXPECT_TRUE(Loaded(folder() / "empty.glb").ok);
}

TEST_F(TrajectoryFile, RefusesAPlaceThatCannotBeWritten) {
  EXPECT_THROW(save_trajectory(folder() / "missing" / "run.glb", record(), small_scene()), InputError);
}

// Runs into one folder: each one's file is whole, none is in another's way, and no part of one is left.
TEST_F(TrajectoryFile, WritersAtOnceDoNotMix) {
  const Trajectory trajectory = record();
  const Scene scene = small_scene();
  std::atomic<int> failures = 0;
  std::vector<std::jthread> writers;
  for (int writer = 0; writer < 4; ++writer)
    writers.emplace_back([&] {
      for (int i = 0; i < 25; ++i) try {
          save_trajectory(folder() / "run.glb", trajectory, scene);
        } catch (const InputError&) {
          ++failures;
        }
    });
  writers.clear();
  EXPECT_EQ(failures, 0);
  EXPECT_TRUE(Loaded(folder() / "run.glb").ok);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder()), {}), 1);
}

TEST_F(TrajectoryFile, ASymbolicLinkIsWrittenThrough) {
  std::filesystem::create_symlink("elsewhere.glb", folder() / "run.glb");
  save_trajectory(folder() / "run.glb", record(), small_scene());
  EXPECT_TRUE(std::filesystem::is_symlink(folder() / "run.glb"));
  EXPECT_TRUE(Loaded(folder() / "elsewhere.glb").ok);
}

TEST(Trajectory, BoundsItsSize) {
  EXPECT_GE(max_trajectory_frames(1000), 100'000);
  EXPECT_LE(20.0 * max_trajectory_frames(2'000'000) * 2'000'000, 4e9);
}

// Before a first step nobody has a rung: the first frame's are told after it.
TEST(TrajectoryFrames, TheFirstMayBeToldAnew) {
  Trajectory trajectory(2);
  const std::vector<RigidState> states(2);
  std::vector<BodyStatus> statuses(2);
  statuses[0].rung = statuses[1].rung = Rung::support;
  trajectory.add_frame(0.0, states, statuses);
  trajectory.add_frame(0.1, states, statuses);
  statuses[1].rung = Rung::full;
  trajectory.set_first_statuses(statuses);
  EXPECT_EQ(trajectory.status(0, 1).rung, Rung::full);
  EXPECT_EQ(trajectory.status(0, 0).rung, Rung::support);
  EXPECT_EQ(trajectory.status(1, 1).rung, Rung::support);
}

}  // namespace
}  // namespace lodestone
