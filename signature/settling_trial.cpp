#include "signature/settling_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/free_rotation.h"
#include "reference/random.h"
#include "reference/trial.h"
#include "signature/settling_clips.h"

namespace lodestone {
namespace {

constexpr double kGravity = 9.81;           // m/s²
constexpr int kSubsteps = 33;               // ODE steps of .505 ms in 1/60 s: the ground truth's
constexpr double kHorizon = 30.0;           // s: a rounded body rocks for long
constexpr double kRestEnergy = 2.5e-4;      // J/kg over g R: below it for kRestTime the body rests
constexpr double kRestTime = 0.75;          // s
constexpr double kClipEnergy = 0.06;        // J/kg over g R: kinetic energy at a contact below which a clip starts
constexpr int kSamplesPerFrame = 2;         // observations, at 60 Hz, for each frame of a clip
constexpr double kEntryGap = 0.02;          // over R: near enough to the plane to be an entry
constexpr int kEntriesPerClip = 24;
constexpr double kSamePose = 12.0 * std::numbers::pi / 180.0;

double kinetic_energy(const Shape& shape, const RigidState& s) {
  return 0.5 * (s.velocity.squaredNorm() + s.angular_velocity.dot(spin_of(s.orientation, s.angular_velocity, shape)));
}

double gap_of(const Shape& shape, const RigidState& s) {
  if (shape.sphere_radius) return s.position.z() - *shape.sphere_radius;
  const Vec3 down = s.orientation.conjugate() * Vec3(0, 0, -1);
  return s.position.z() - shape.hull.vertices[find_support(shape.hull, down)].dot(down);
}

RigidState settling_start(const Shape& shape, std::uint64_t seed, std::uint32_t trial) {
  RandomStream random(seed, trial, 3);
  const double radius = shape.radius, speed = std::sqrt(kGravity * radius);
  RigidState state;
  state.orientation = random.orientation();
  state.velocity = speed * Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.0));
  state.angular_velocity = 1.5 * speed / radius * random.uniform() * random.direction();
  state.position.z() = 0.0;
  state.position.z() = radius * random.uniform(0.1, 3.0) - gap_of(shape, state);
  return state;
}

}  // namespace

SettlingRecord simulate_settling(const std::shared_ptr<const Shape>& shape, const ContactLaw& law, std::uint64_t seed, std::uint32_t trial) {
  MaterialTable materials;
  materials.set_law(0, 0, law);
  OdeWorld world(OdeSettings{}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId body = world.add_body(
      {.shape = shape, .mass = 1.0, .material = 0, .state = settling_start(*shape, seed, trial), .geometry = OdeGeometry::trimesh, .spheres = {}});

  SettlingRecord record;
  const double energy_unit = kGravity * shape->radius;
  double quiet_since = 0.0;
  int sample = 0, started = 0;
  simulate_drop(world, body, kHorizon, kSubsteps, [&](double time, const RigidState& state) {
    const double energy = kinetic_energy(*shape, state);
    const bool low_contact = energy < kClipEnergy * energy_unit && gap_of(*shape, state) < kEntryGap * shape->radius;
    const bool starts = record.states.empty() && low_contact;
    if (starts) started = sample;
    if (starts || (!record.states.empty() && (sample - started) % kSamplesPerFrame == 0)) record.states.push_back(state);
    ++sample;
    if (energy > kRestEnergy * energy_unit) quiet_since = time;
    record.rests = !record.states.empty() && time - quiet_since >= kRestTime;
    return !record.rests;
  });
  if (record.rests) {
    const auto still = std::ptrdiff_t(kRestTime / (kSamplesPerFrame * kObservationStep)) - 3;  // a few frames of stillness are enough to end on
    if (std::ptrdiff_t(record.states.size()) > still) record.states.resize(record.states.size() - std::size_t(still));
    const RigidState& last = record.states.back();
    record.normal = last.orientation.conjugate() * Vec3::UnitZ();
    record.height = last.position.z();
  }
  return record;
}

std::vector<RestPose> find_rest_poses(std::span<const SettlingRecord> records, double radius, double frequency_min) {
  struct Cluster {
    Vec3 first, normals = Vec3::Zero();
    double heights = 0.0;
    int count = 0;
  };
  std::vector<Cluster> clusters;
  for (const SettlingRecord& r : records) {
    if (!r.rests) continue;
    auto same = std::find_if(clusters.begin(), clusters.end(), [&](const Cluster& c) { return c.first.dot(r.normal) > std::cos(kSamePose); });
    if (same == clusters.end()) same = clusters.insert(clusters.end(), {r.normal});
    same->normals += r.normal;
    same->heights += r.height;
    ++same->count;
  }
  std::stable_sort(clusters.begin(), clusters.end(), [](const Cluster& a, const Cluster& b) { return a.count > b.count; });
  std::vector<RestPose> poses;
  for (const Cluster& c : clusters) {
    const double frequency = double(c.count) / double(records.size());
    if (frequency >= frequency_min) poses.push_back({c.normals.normalized(), c.heights / c.count / radius, frequency});
  }
  return poses;
}

void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature) {
  const double radius = shape.radius, speed_unit = std::sqrt(kGravity * radius);
  signature.clip_frame_interval = float(kSamplesPerFrame * kObservationStep / std::sqrt(radius / kGravity));
  for (const SettlingRecord& record : records) {
    if (int(signature.clips.size()) >= count) return;
    if (!record.rests || record.states.size() < 2) continue;
    SettlingClip clip;
    clip.first_frame = std::uint32_t(signature.clip_frames.size());
    clip.frames = std::uint32_t(record.states.size());
    const Vec3 start(record.states.front().position.x(), record.states.front().position.y(), 0.0);
    double extent = 1e-3;
    for (const RigidState& s : record.states) extent = std::max(extent, (s.position - start).head<2>().cwiseAbs().maxCoeff() / radius);
    clip.extent = float(extent);
    std::vector<std::uint32_t> touching;  // frames where a body may join
    for (std::uint32_t i = 0; i < clip.frames; ++i) {
      const RigidState& s = record.states[i];
      signature.clip_frames.push_back(
          encode_frame({(s.position - start) / radius, s.orientation, s.velocity / speed_unit, s.angular_velocity * (radius / speed_unit)}, clip.extent));
      const double energy = kinetic_energy(shape, s) / (kGravity * radius);
      if (energy < kClipEnergy && gap_of(shape, s) < kEntryGap * radius) touching.push_back(i);
    }
    // Spread more closely at the start, where states differ most from clip to clip.
    const auto n = double(touching.size());
    for (int i = 0; i < std::min(kEntriesPerClip, int(n)); ++i) {
      const double part = double(i) / kEntriesPerClip;
      signature.clip_entries.push_back({std::uint32_t(signature.clips.size()), touching[std::size_t(std::max(double(i), n * part * part))]});
    }
    signature.clips.push_back(clip);
  }
}

}  // namespace lodestone
