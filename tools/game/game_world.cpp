#include "tools/game/game_world.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tools/game/ragdoll.h"

namespace game {
namespace {

using namespace lodestone;

constexpr double kFrame = 1.0 / 60.0;  // s
constexpr double kPi = std::numbers::pi;
constexpr double kDoorSpring = 20.0;  // N m/rad

double thread_time_ms() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

std::shared_ptr<const Shape> shape_of(const char* name, const Mesh& mesh) {
  return std::make_shared<const Shape>(make_shape(name, mesh));
}

}  // namespace

void PolicyChoice::turn(bool up) {
  const double factor = up ? 1.25 : 0.8;
  switch (kind) {
    case PolicyKind::distance:
      full_within_m = std::clamp(full_within_m * factor, 0.5, 60.0);
      break;
    case PolicyKind::projected_size:
      full_above_px = std::clamp(full_above_px * factor, 5.0, 1000.0);
      break;
    default:
      budget_ms = std::clamp(budget_ms * factor, 0.25, 30.0);
  }
}

std::string PolicyChoice::text() const {
  char line[80];
  switch (kind) {
    case PolicyKind::distance:
      std::snprintf(line, sizeof line, "distance: full within %.1f m", full_within_m);
      break;
    case PolicyKind::projected_size:
      std::snprintf(line, sizeof line, "size in picture: full above %.0f px", full_above_px);
      break;
    case PolicyKind::budget:
      std::snprintf(line, sizeof line, "budget %.2f ms: nearest first", budget_ms);
      break;
    case PolicyKind::error_budget:
      std::snprintf(line, sizeof line, "error budget %.2f ms", budget_ms);
  }
  return line;
}

PolicySettings PolicyChoice::settings() const {
  PolicySettings settings{.policy = BudgetPolicy{.budget_ms = budget_ms},
                          .min_dwell_frames = 20,
                          .max_transitions_per_frame = 8,
                          .out_of_view_factor = 3.0,
                          .look_ahead_s = 0.2};
  if (kind == PolicyKind::distance)
    settings.policy = DistancePolicy{.full_within = full_within_m, .support_within = 2.5 * full_within_m};
  if (kind == PolicyKind::projected_size)
    settings.policy =
        ProjectedSizePolicy{.full_above_px = full_above_px, .support_above_px = 0.4 * full_above_px};
  if (kind == PolicyKind::error_budget) settings.policy = ErrorBudgetPolicy{.budget_ms = budget_ms};
  return settings;
}

GameWorld::GameWorld() : world_(dWorldCreate()), space_(dHashSpaceCreate(nullptr)), terrain_(space_) {
  dWorldSetGravity(world_, 0, 0, -9.81);
  add_buildings();
  add_door();
  manager_ = std::make_unique<Manager>(
      world_, space_,
      ManagerSettings{.policy = policy_.settings(), .signature_timing = SignatureTiming::in_background});
  cloth_ = manager_->materials().add({.restitution = 0.05, .friction = 0.8, .density = 800.0});
  shapes_ = {shape_of("box", make_box({0.42, 0.32, 0.26})), shape_of("l", make_l(0.5, 0.4, 0.16, 0.14)),
             shape_of("needle", make_needle(0.8, 0.07)), shape_of("plate", make_box({0.5, 0.5, 0.09}))};
  ball_ = std::make_shared<const Shape>(make_sphere_shape(0.18));
  for (const Vec3& heap : {Vec3(-4.5, -4.0, 0.5), Vec3(4.5, -4.5, 0.5), Vec3(6.4, 3.5, 2.0),
                           Vec3(-6.0, 4.5, 1.8), Vec3(1.0, 13.0, 0.5), Vec3(-15.0, -2.0, 0.5)})
    add_heap(heap.x(), heap.y(), heap.z());
  drop_ragdoll({0.9, -1.9, 1.6});
}

GameWorld::~GameWorld() {
  manager_.reset();
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
}

void GameWorld::add_block(const Vec3& sides, const Vec3& position) {
  const dGeomID geom = dCreateBox(space_, sides.x(), sides.y(), sides.z());
  dGeomSetPosition(geom, position.x(), position.y(), position.z());
  blocks_.push_back({geom, sides});
}

// A wall with a doorway, stairs and a platform.
void GameWorld::add_buildings() {
  for (const double side : {-1.0, 1.0}) add_block({3.0, 0.3, 2.4}, {side * 2.25, 0.0, 1.2});
  add_block({1.5, 0.3, 0.3}, {0.0, 0.0, 2.25});
  for (int i = 0; i < 6; ++i) add_block({0.5, 2.6, 0.25 * (i + 1)}, {4.8 + 0.5 * i, 2.6, 0.125 * (i + 1)});
  add_block({2.6, 2.6, 1.2}, {-6.0, 4.5, 0.6});
}

// The game's own body, which falls shut by a spring.
void GameWorld::add_door() {
  const Vec3 sides(1.40, 0.08, 2.0);
  const dBodyID body = dBodyCreate(world_);
  dMass mass;
  dMassSetBoxTotal(&mass, 25.0, sides.x(), sides.y(), sides.z());
  dBodySetMass(body, &mass);
  dBodySetPosition(body, 0.0, 0.0, 1.06);
  door_ = {dCreateBox(space_, sides.x(), sides.y(), sides.z()), sides};
  dGeomSetBody(door_.geom, body);
  door_hinge_ = dJointCreateHinge(world_, nullptr);
  dJointAttach(door_hinge_, body, nullptr);
  dJointSetHingeAnchor(door_hinge_, -0.5 * sides.x(), 0.0, 1.06);
  dJointSetHingeAxis(door_hinge_, 0, 0, 1);
  dJointSetHingeParam(door_hinge_, dParamLoStop, -0.6 * kPi);
  dJointSetHingeParam(door_hinge_, dParamHiStop, 0.6 * kPi);
  dJointSetHingeParam(door_hinge_, dParamFMax, 3.0);  // N m, friction
}

// Eighty bodies of all shapes, in five layers.
void GameWorld::add_heap(double x, double y, double above) {
  std::uniform_real_distribution<double> turn(-kPi, kPi);
  for (int i = 0; i < 80; ++i) {
    const Vec3 position(x + 0.65 * (i % 4 - 1.5), y + 0.65 * (i / 4 % 4 - 1.5),
                        Terrain::height(x, y) + above + 0.7 * (i / 16));
    const double a = turn(random_), b = turn(random_), c = turn(random_);
    bodies_.push_back(manager_->add_body(
        {.shape = shapes_[i % shapes_.size()],
         .state = {.position = position, .orientation = rotation_from_vector({0.5 * a, 0.5 * b, 0.5 * c})}}));
  }
}

void GameWorld::set_policy(const PolicyChoice& choice) {
  policy_ = choice;
  manager_->set_policy(choice.settings());
}

void GameWorld::throw_ball(const Camera& camera) {
  bodies_.push_back(manager_->add_body({.shape = ball_,
                                        .state = {.position = camera.position + camera.direction(),
                                                  .velocity = 16.0 * camera.direction() + Vec3(0, 0, 1.5)},
                                        .importance = 3.0}));
}

void GameWorld::drop_ragdoll(const Vec3& pelvis) {
  std::uniform_real_distribution<double> turn(-kPi, kPi);
  const double z = turn(random_), x = 0.2 * turn(random_);
  std::ranges::copy(add_ragdoll(*manager_, world_, pelvis,
                                rotation_from_vector({0, 0, z}) * rotation_from_vector({x, 0, 0}), cloth_),
                    std::back_inserter(bodies_));
}

// Over the edge of the world.
void GameWorld::remove_lost() {
  std::erase_if(bodies_, [&](BodyId body) {
    if (manager_->state(body).position.z() > -20.0) return false;
    manager_->remove_body(body);
    return true;
  });
}

double GameWorld::step(const Camera& camera, double height_px, double aspect) {
  manager_->set_viewpoints({Viewpoint{.position = camera.position,
                                      .direction = camera.direction(),
                                      .height_px = height_px,
                                      .aspect = aspect}});
  dJointAddHingeTorque(door_hinge_, -kDoorSpring * dJointGetHingeAngle(door_hinge_));
  const double before = thread_time_ms();
  manager_->step(kFrame);
  const double spent = thread_time_ms() - before;
  remove_lost();
  return spent;
}

}  // namespace game
