#include "tools/methods/bullet_world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "reference/error.h"

#ifdef LODESTONE_BULLET
#include <btBulletDynamicsCommon.h>

namespace lodestone {
namespace {

// A margin goes around the hull that is given; Bullet's own of 4 cm suits bodies of metres.
constexpr double kMargin = 1e-3;  // × size

btVector3 to_bullet(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }
btQuaternion to_bullet(const Quat& q) {
  return {btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())};
}
Vec3 to_vec3(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
Quat to_quat(const btQuaternion& q) { return Quat(q.w(), q.x(), q.y(), q.z()).normalized(); }

btScalar lower_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return std::min(a->getRestitution(), b->getRestitution());
}
btScalar mean_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return std::sqrt(a->getFriction() * b->getFriction());
}

/// Bullet's bodies have diagonal inertias: `axes` turns the principal axes into the shape's.
struct Principal {
  Quat axes;
  Vec3 inertia_per_mass;
};

Principal principal_of(const Shape& shape) {
  const PrincipalAxes found = find_principal_axes(shape.inertia_per_mass);
  return {Quat(found.axes), found.moments};
}

/// Of one shape, shared by its bodies.
struct Geometry {
  std::shared_ptr<const Shape> shape;
  Principal principal;
  std::unique_ptr<btConvexShape> collision;
};

// Of `points` those farthest in so many directions, evenly spread along a spiral over the sphere by the
// golden angle; all of them where there are no more than that.
std::vector<Vec3> find_outermost(const std::vector<Vec3>& points, int directions) {
  if (int(points.size()) <= directions) return points;
  constexpr double kGoldenAngle = std::numbers::pi * (3.0 - 2.2360679774997896);
  std::set<std::size_t> chosen;
  for (int i = 0; i < directions; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / directions, across = std::sqrt(1.0 - z * z);
    const Vec3 direction(across * std::cos(kGoldenAngle * i), across * std::sin(kGoldenAngle * i), z);
    const auto reach = [&](const Vec3& point) { return point.dot(direction); };
    chosen.insert(std::size_t(std::ranges::max_element(points, {}, reach) - points.begin()));
  }
  std::vector<Vec3> outermost;
  for (const std::size_t index : chosen) outermost.push_back(points[index]);
  return outermost;
}

std::unique_ptr<btConvexShape> make_collision(const Shape& shape, BulletGeometry geometry, const Quat& axes) {
  if (geometry == BulletGeometry::sphere || shape.sphere_radius)
    return std::make_unique<btSphereShape>(
        btScalar(std::cbrt(shape.volume * 3.0 / (4.0 * std::numbers::pi))));
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& vertex :
       geometry == BulletGeometry::hull40 ? find_outermost(shape.hull.vertices, 40) : shape.hull.vertices)
    hull->addPoint(to_bullet(Vec3(axes.conjugate() * vertex)), false);
  hull->recalcLocalAabb();
  hull->setMargin(btScalar(kMargin * shape.size));
  return hull;
}

struct Body {
  std::unique_ptr<btRigidBody> body;
  Quat axes;
};

}  // namespace

bool bullet_available() { return true; }

struct BulletWorld::Impl {
  explicit Impl(const BulletSettings& s) : settings(s) {
    world.setGravity(to_bullet(s.gravity));
    world.getSolverInfo().m_numIterations = s.solver_iterations;
    world.getSolverInfo().m_restitutionVelocityThreshold = btScalar(s.bounce_velocity);
    gCalculateCombinedRestitutionCallback = lower_restitution;
    gCalculateCombinedFrictionCallback = mean_friction;
  }
  ~Impl() {
    for (Body& body : bodies)
      if (body.body) world.removeRigidBody(body.body.get());
    for (const auto& plane : planes) world.removeRigidBody(plane.get());
  }

  const Geometry& geometry_of(const BulletBodyDefinition& definition) {
    auto& geometry = geometries[{definition.shape.get(), definition.geometry}];
    if (!geometry.shape) {
      geometry.shape = definition.shape;
      geometry.principal = principal_of(*definition.shape);
      geometry.collision = make_collision(*definition.shape, definition.geometry, geometry.principal.axes);
    }
    return geometry;
  }
  const Body& find(int body) const {
    check_that(body >= 0 && body < int(bodies.size()) && bodies[body].body,
               "the number is of a body in this world");
    return bodies[body];
  }

  BulletSettings settings;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
  std::map<std::pair<const Shape*, BulletGeometry>, Geometry> geometries;
  std::vector<std::unique_ptr<btStaticPlaneShape>> plane_shapes;
  std::vector<std::unique_ptr<btRigidBody>> planes;
  std::vector<Body> bodies;
};

BulletWorld::BulletWorld(const BulletSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
BulletWorld::~BulletWorld() = default;
BulletWorld::BulletWorld(BulletWorld&&) noexcept = default;
BulletWorld& BulletWorld::operator=(BulletWorld&&) noexcept = default;

void BulletWorld::add_plane(const Vec3& normal, double offset, const Material& material) {
  impl_->plane_shapes.push_back(std::make_unique<btStaticPlaneShape>(to_bullet(normal), btScalar(offset)));
  btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, impl_->plane_shapes.back().get());
  info.m_restitution = btScalar(material.restitution);
  info.m_friction = btScalar(material.friction);
  impl_->planes.push_back(std::make_unique<btRigidBody>(info));
  impl_->world.addRigidBody(impl_->planes.back().get());
}

int BulletWorld::add_body(const BulletBodyDefinition& definition) {
  const Geometry& geometry = impl_->geometry_of(definition);
  const Vec3 inertia = definition.mass * geometry.principal.inertia_per_mass;
  btRigidBody::btRigidBodyConstructionInfo info(btScalar(definition.mass), nullptr, geometry.collision.get(),
                                                to_bullet(inertia));
  info.m_restitution = btScalar(definition.material.restitution);
  info.m_friction = btScalar(definition.material.friction);
  const Quat orientation = definition.state.orientation * geometry.principal.axes;
  info.m_startWorldTransform = btTransform(to_bullet(orientation), to_bullet(definition.state.position));
  auto body = std::make_unique<btRigidBody>(info);
  body->setLinearVelocity(to_bullet(definition.state.velocity));
  body->setAngularVelocity(to_bullet(definition.state.angular_velocity));
  if (!impl_->settings.sleeping) body->setActivationState(DISABLE_DEACTIVATION);
  impl_->world.addRigidBody(body.get());
  impl_->bodies.push_back({std::move(body), geometry.principal.axes});
  return int(impl_->bodies.size()) - 1;
}

void BulletWorld::remove_body(int body) {
  impl_->world.removeRigidBody(impl_->find(body).body.get());
  impl_->bodies[body].body.reset();
}

void BulletWorld::step(double dt) {
  check_that(dt > 0.0 && std::isfinite(dt), "a step is positive and finite");
  impl_->world.stepSimulation(btScalar(dt), 0);
}

RigidState BulletWorld::state(int body) const {
  const Body& found = impl_->find(body);
  const btTransform& pose = found.body->getWorldTransform();
  return {to_vec3(pose.getOrigin()), (to_quat(pose.getRotation()) * found.axes.conjugate()).normalized(),
          to_vec3(found.body->getLinearVelocity()), to_vec3(found.body->getAngularVelocity())};
}

bool BulletWorld::asleep(int body) const { return !impl_->find(body).body->isActive(); }

}  // namespace lodestone

#else

namespace lodestone {

struct BulletWorld::Impl {};

bool bullet_available() { return false; }

BulletWorld::BulletWorld(const BulletSettings&) { check_that(false, "this build has Bullet"); }
BulletWorld::~BulletWorld() = default;
BulletWorld::BulletWorld(BulletWorld&&) noexcept = default;
BulletWorld& BulletWorld::operator=(BulletWorld&&) noexcept = default;
void BulletWorld::add_plane(const Vec3&, double, const Material&) {}
int BulletWorld::add_body(const BulletBodyDefinition&) { return 0; }
void BulletWorld::remove_body(int) {}
void BulletWorld::step(double) {}
RigidState BulletWorld::state(int) const { return {}; }
bool BulletWorld::asleep(int) const { return false; }

}  // namespace lodestone
#endif
