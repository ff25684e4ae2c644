// save_trajectory: motion as one glTF animation. A body that changes its rung or falls asleep has a mesh for
// each below its node, all but one of them at the scale 0 (STEP keys), since glTF 2.0 cannot animate colours.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <set>

#include "reference/error.h"
#include "reference/output_file.h"
#include "scenes/camera.h"
#include "scenes/framing.h"
#include "scenes/gltf_stage.h"
#include "scenes/trajectory.h"
#include "signature/file_bytes.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class TrajectoryWriter {
 public:
  TrajectoryWriter(const Trajectory& trajectory, const Scene& scene)
      : trajectory_(trajectory), scene_(scene), buffer_(model_), stage_(model_, buffer_) {
    model_.asset.version = "2.0";
    model_.asset.generator = "Lodestone";
    model_.animations.resize(1);
    model_.animations[0].name = "run";
    for (const SceneGround& ground : scene_.ground) stage_.add_ground(ground, extent());
    add_views();
    for (int body = 0; body < trajectory_.bodies(); ++body) add_body(body);
    add_viewpoint(scene_.viewpoints.empty() ? frame_bodies(trajectory_, scene_) : scene_.viewpoints[0]);
    // glTF allows neither an empty animation nor an empty buffer.
    if (model_.animations[0].channels.empty()) model_.animations.clear();
    if (model_.buffers[0].data.empty()) model_.buffers.clear();
  }
  const tinygltf::Model& model() const { return model_; }

 private:
  /// How far the ground is drawn: well beyond where the bodies start.
  double extent() const {
    double farthest = 5.0;
    for (const SceneBody& body : scene_.bodies)
      farthest = std::max(farthest, body.definition.state.position.norm());
    return 3.0 * farthest;
  }

  /// One view for all positions and one for all orientations, track after track; and one on the times, which
  /// tracks of any length share.
  void add_views() {
    std::vector<Trajectory::Position> positions;
    std::vector<Trajectory::Orientation> orientations;
    for (int body = 0; body < trajectory_.bodies(); ++body) {
      const int frames = trajectory_.moving_frames(body);
      first_key_.push_back(positions.size());
      if (frames < 2) continue;  // still from the start: no track
      for (int frame = 0; frame < frames; ++frame) {
        positions.push_back(trajectory_.position(frame, body));
        orientations.push_back(trajectory_.orientation(frame, body));
      }
    }
    first_key_.push_back(positions.size());
    if (positions.empty()) return;
    position_view_ = buffer_.add_view(std::as_bytes(std::span(positions)));
    orientation_view_ = buffer_.add_view(std::as_bytes(std::span(orientations)));
    time_view_ = buffer_.add_view(std::as_bytes(trajectory_.times_s()));
  }

  int time_accessor(std::size_t count) {
    const auto known = time_accessors_.find(count);
    if (known != time_accessors_.end()) return known->second;
    const int accessor =
        buffer_.add_accessor(time_view_, 0, count, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT);
    model_.accessors.back().minValues = {trajectory_.times_s().front()};
    model_.accessors.back().maxValues = {trajectory_.times_s()[count - 1]};
    return time_accessors_[count] = accessor;
  }

  void add_channel(int node, const char* path, int times, int values, const char* interpolation = "LINEAR") {
    tinygltf::Animation& animation = model_.animations[0];
    tinygltf::AnimationSampler sampler;
    sampler.input = times;
    sampler.output = values;
    sampler.interpolation = interpolation;
    tinygltf::AnimationChannel channel;
    channel.sampler = int(animation.samplers.size());
    channel.target_node = node;
    channel.target_path = path;
    animation.samplers.push_back(std::move(sampler));
    animation.channels.push_back(std::move(channel));
  }

  void add_body(int body) {
    const SceneBody& given = scene_.bodies[std::size_t(body)];
    tinygltf::Node node;
    node.name = given.name.empty() ? fmt::format("body {}", body) : given.name;
    const Trajectory::Position& p = trajectory_.position(0, body);
    const Trajectory::Orientation& q = trajectory_.orientation(0, body);
    node.translation = {p[0], p[1], p[2]};
    node.rotation = gltf_rotation(Quat(q[3], q[0], q[1], q[2]).normalized());
    const std::vector<int> changes = look_changes(body);
    const Shape& shape = *given.definition.shape;
    if (changes.empty()) node.mesh = stage_.body_mesh(shape, look(0, body));
    const int index = stage_.add_node(std::move(node));
    add_tracks(body, index);
    if (changes.empty()) return;
    std::set<BodyLook> looks{look(0, body)};
    for (const int frame : changes) looks.insert(look(frame, body));
    for (const BodyLook part : looks) add_part(body, index, part, changes);
  }

  BodyLook look(int frame, int body) const {
    const BodyStatus& status = trajectory_.status(frame, body);
    return {status.rung, status.asleep};
  }

  void add_tracks(int body, int node) {
    const std::size_t first = first_key_[std::size_t(body)], keys = first_key_[std::size_t(body) + 1] - first;
    if (keys == 0) return;
    const int times = time_accessor(keys);
    add_channel(node, "translation", times,
                buffer_.add_accessor(position_view_, first * sizeof(Trajectory::Position), keys,
                                     TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT));
    add_channel(node, "rotation", times,
                buffer_.add_accessor(orientation_view_, first * sizeof(Trajectory::Orientation), keys,
                                     TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_SHORT, true));
  }

  std::vector<int> look_changes(int body) const {
    std::vector<int> frames;
    for (int frame = 1; frame < trajectory_.frames(); ++frame)
      if (look(frame, body) != look(frame - 1, body)) frames.push_back(frame);
    return frames;
  }

  /// The mesh that shows `part`, visible while the body looks so.
  void add_part(int body, int parent, BodyLook part, const std::vector<int>& changes) {
    std::vector<float> times{trajectory_.times_s()[0]};
    std::vector<std::array<float, 3>> scales;
    const auto scale_at = [&](int frame) { return look(frame, body) == part ? 1.0f : 0.0f; };
    scales.push_back({scale_at(0), scale_at(0), scale_at(0)});
    for (int frame : changes) {
      times.push_back(trajectory_.times_s()[std::size_t(frame)]);
      scales.push_back({scale_at(frame), scale_at(frame), scale_at(frame)});
    }
    tinygltf::Node node;
    node.mesh = stage_.body_mesh(*scene_.bodies[std::size_t(body)].definition.shape, part);
    node.scale = {scales[0][0], scales[0][1], scales[0][2]};
    const int index = stage_.add_child(parent, std::move(node));
    add_channel(index, "scale", buffer_.add_scalars(times), buffer_.add_vectors(scales, 0), "STEP");
  }

  void add_viewpoint(const SceneViewpoint& viewpoint) {
    const int node = stage_.add_camera(viewpoint);
    if (viewpoint.path.empty() || trajectory_.frames() < 2) return;
    std::vector<std::array<float, 3>> positions;
    std::vector<std::array<float, 4>> rotations;
    for (float time : trajectory_.times_s()) {
      const Vec3 p = viewpoint.position_at(time);
      const Quat q = camera_rotation(p, viewpoint.look_at_m);
      positions.push_back({float(p.x()), float(p.y()), float(p.z())});
      rotations.push_back({float(q.x()), float(q.y()), float(q.z()), float(q.w())});
    }
    const int times = buffer_.add_scalars(trajectory_.times_s());
    add_channel(node, "translation", times, buffer_.add_vectors(positions, 0));
    const int view = buffer_.add_view(std::as_bytes(std::span(rotations)));
    add_channel(
        node, "rotation", times,
        buffer_.add_accessor(view, 0, rotations.size(), TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_FLOAT));
  }

  const Trajectory& trajectory_;
  const Scene& scene_;
  tinygltf::Model model_;
  GltfBuffer buffer_;
  GltfStage stage_;
  int position_view_ = -1, orientation_view_ = -1, time_view_ = -1;
  std::vector<std::size_t> first_key_;  // of each body's track; one past the last at the end
  std::map<std::size_t, int> time_accessors_;
};

}  // namespace

void save_trajectory(const fs::path& file, const Trajectory& trajectory, const Scene& scene) {
  check_that(trajectory.frames() > 0 && trajectory.bodies() == int(scene.bodies.size()),
             "a recorded trajectory of this scene");
  const TrajectoryWriter writer(trajectory, scene);
  write_atomically(file, [&](const fs::path& place) {
    errno = 0;
    std::ofstream out(place, std::ios::binary);
    if (!out || !tinygltf::TinyGLTF().WriteGltfSceneToStream(&writer.model(), out, false, true) ||
        !out.flush())
      throw_file_error(place, errno == 0 ? EIO : errno, "room for the trajectory");
  });
}

}  // namespace lodestone
