// A heap that a camera visits: its bodies become full, meshes, and hulls again. Nobody sees it: what sleeps
// lies still, what wakes sinks slowly, what moves moves on.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr int kBodies = 24;
constexpr double kFrame = 1.0 / 60, kHalfSide = 0.27;  // s; m, of the bin
const Vec3 kNear(0, -2, 1), kFar(0, -100, 1);
constexpr double kPixel = 2.0 * 0.57735 / 1080;  // of a camera's distance: 1,080 over 60°

struct Heap {
  explicit Heap(int transitions)
      : manager({.policy = {.policy = DistancePolicy{.full_within = 5.0},
                            .min_dwell_frames = 1,
                            .max_transitions_per_frame = transitions},
                 .signatures = [](const Shape&, const ContactLaw&) {
                   return std::shared_ptr<const Signature>();
                 }}) {
    manager.add_plane(Vec3::UnitZ(), 0.0);
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
      manager.add_plane(side, -kHalfSide);
    const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2, 300));
    parting_m = 0.2 * std::sqrt(9.81 * bunny->radius) * kFrame;
    std::mt19937 random(3);
    const auto some = [&] { return std::uniform_real_distribution<double>(-0.5, 0.5)(random); };
    for (int i = 0; i < kBodies; ++i) {
      RigidState state;
      state.position = {0.24 * (i % 2) - 0.12 + 0.02 * some(), 0.24 * (i / 2 % 2) - 0.12 + 0.02 * some(),
                        0.15 + 0.24 * (i / 4)};
      state.orientation = Quat(some(), some(), some(), some()).normalized();
      bodies.push_back(manager.add_body({.shape = bunny, .state = state}));
    }
  }

  void step(const Vec3& camera) {
    std::vector<RigidState> before;
    std::vector<Rung> rungs;
    for (const BodyId body : bodies)
      before.push_back(manager.state(body)), rungs.push_back(manager.rung(body));
    manager.set_viewpoints({&camera, 1});
    manager.step(kFrame);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const RigidState now = manager.state(bodies[i]);
      const Vec3 way = now.position - before[i].position;
      // What is left of the way beyond some velocity between those before and after.
      const Vec3 from = before[i].velocity * kFrame, to = now.velocity * kFrame, along = to - from;
      const double part = along.squaredNorm() > 0.0
                              ? std::clamp((way - from).dot(along) / along.squaredNorm(), 0.0, 1.0)
                              : 0.0;
      const double beyond_m = (way - from - part * along).norm();
      leap_m = std::max(leap_m, beyond_m);
      if (manager.rung(bodies[i]) != rungs[i])
        beyond_px.push_back(beyond_m / (kPixel * (now.position - camera).norm()));
    }
  }

  void steps(int count, const Vec3& camera) {
    for (int i = 0; i < count; ++i) step(camera);
  }
  int awake() const { return kBodies - manager.report().asleep; }
  double mean_height() const {
    double sum = 0.0;
    for (const BodyId body : bodies) sum += manager.state(body).position.z() / kBodies;
    return sum;
  }
  BodyId lowest() const {
    return *std::ranges::min_element(bodies, {},
                                     [this](BodyId body) { return manager.state(body).position.z(); });
  }

  Manager manager;
  std::vector<BodyId> bodies;
  double parting_m = 0.0;         // in a frame
  double leap_m = 0.0;            // the longest way in a frame beyond its own motion
  std::vector<double> beyond_px;  // at each change of rung
};

void sleepers() {
  Heap heap(4);
  for (int i = 0; i < 1800 && (i < 60 || heap.awake() > 0); ++i) heap.step(kFar);
  heap.steps(10, kFar);
  check::within(heap.awake(), 0, 0, "awake once the heap has settled, at support");
  const double height = heap.mean_height();
  double most = 0.0;
  int full = kBodies, woke = 0;
  heap.leap_m = 0.0;
  for (int visit = 0; visit < 4; ++visit) {
    heap.steps(40, kNear);
    full = std::min(full, heap.manager.report().full),
    most = std::max(most, std::abs(heap.mean_height() - height)), woke = std::max(woke, heap.awake());
    heap.steps(40, kFar);
    most = std::max(most, std::abs(heap.mean_height() - height)), woke = std::max(woke, heap.awake());
  }
  check::within(full, 18, kBodies, "of 24 sleepers full while the camera is there");
  check::within(1e3 * most, 0.0, 1.0,
                "mm that the mean height of a sleeping heap changed by, over four visits");
  check::within(1e3 * heap.leap_m, 0.0, 1.0, "mm, longest leap in a frame meanwhile");
  check::within(woke, 0, 0, "woken by the visits");

  heap.steps(40, kNear);
  const BodyId lowest = heap.lowest();
  heap.leap_m = 0.0;
  heap.manager.set_state(lowest, heap.manager.state(lowest));  // wakes it and what it carries
  for (int i = 0; i < 200 && (i < 10 || heap.awake() > 0); ++i) heap.step(kNear);
  check::within(heap.leap_m / heap.parting_m, 0.0, 1.0,
                "longest leap in a frame beyond motion, over parting speed, as the full heap comes down onto "
                "its meshes");
  heap.leap_m = 0.0;
  heap.steps(40, kFar);
  heap.manager.set_state(lowest, heap.manager.state(lowest));
  heap.steps(180, kFar);
  check::within(heap.leap_m / heap.parting_m, 0.0, 1.0, "over parting speed, as hulls part again");
}

void pouring() {
  Heap heap(kBodies);
  for (int frame = 0; frame < 180; ++frame) heap.step(frame / 12 % 2 ? kNear : kFar);
  std::ranges::sort(heap.beyond_px);
  const auto changes = heap.beyond_px.size();
  check::within(double(changes), 100.0, 1e6, "changes of rung as a heap is poured");
  check::within(heap.beyond_px[changes * 99 / 100], 0.0, 1.0,
                "pixels at 1080p that 99 % of these move a body beyond its motion, at most");
}

}  // namespace

int main() {
  dInitODE2(0);
  sleepers();
  pouring();
  return check::result();
}
