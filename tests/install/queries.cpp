// Rays, swept spheres, spheres and boxes against bodies on all three rungs and the ground: the same answers,
// wherever a body is simulated.
#include <ode/ode.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.2));
const auto l = std::make_shared<const Shape>(make_shape("l", make_l(0.4, 0.4, 0.1, 0.2)));
RigidState at(const Vec3& place) { return {place, Quat::Identity(), Vec3::Zero(), Vec3::Zero()}; }

struct Scene {
  Manager manager{{.gravity = Vec3::Zero(), .signature_timing = SignatureTiming::in_step}};
  BodyId full, support, tables, still, angle;
  Scene() {
    manager.add_plane({0, 0, 1}, 0.0);
    manager.add_static_box({1, 1, 1}, {-5, 0, 0.5}, Quat::Identity());
    full = manager.add_body({.shape = crate, .state = at({0, 0, 1}), .level = LevelChoice::full});
    support = manager.add_body({.shape = crate, .state = at({2, 0, 1}), .level = LevelChoice::support});
    tables = manager.add_body({.shape = crate, .state = at({4, 0, 1}), .level = LevelChoice::tables});
    still = manager.add_body({.shape = ball,
                              .state = at({6, 0, 1}),
                              .level = LevelChoice::support,
                              .properties = {.category = 4}});
    angle = manager.add_body({.shape = l, .state = at({8, 0, 1}), .level = LevelChoice::support});
    manager.step(1.0 / 60.0);
    manager.sleep(still);
    manager.step(1.0 / 60.0);
  }
};

void rays(Scene& s) {
  Manager& m = s.manager;
  for (const auto& [body, x] : {std::pair{s.full, 0.0}, {s.support, 2.0}, {s.tables, 4.0}}) {
    const auto hit = m.cast_ray({.from = {x + 0.05, 0.1, 5}, .direction = {0, 0, -2}});
    check::that(hit && hit->who.body == body && (hit->normal - Vec3::UnitZ()).norm() < 1e-6,
                "a ray from above meets the box on its rung");
    check::within(hit ? hit->distance : 0, 3.8 - 1e-6, 3.8 + 1e-6, "m to its upper face");
  }
  const auto floor = m.cast_ray({.from = {1, 0, 5}});
  check::that(floor && floor->who.kind == ContactSide::Kind::ground, "a ray between them meets the plane");
  const auto box = m.cast_ray({.from = {-5.2, 0.3, 5}});
  check::within(box ? box->distance : 0, 4 - 1e-9, 4 + 1e-9, "m to a static box");
  const auto across = m.cast_ray({.from = {-10, 0, 1.001}, .direction = {1, 0, 0}});
  check::that(across && across->who.body == s.full, "a ray over the static box meets the first body");
  std::vector<QueryHit> all[1];
  const Ray through{.from = {-10, 0.05, 1.001}, .direction = {1, 0, 0}, .length = 100};
  m.cast_rays_through({&through, 1}, all);
  check::within(double(all[0].size()), 5, 5, "hits of a ray through all five");
  check::that(std::is_sorted(all[0].begin(), all[0].end(),
                             [](const QueryHit& a, const QueryHit& b) { return a.distance < b.distance; }),
              "by distance");
  const auto other = m.cast_ray(through, {.except = s.full});
  check::that(other && other->who.body == s.support, "all but the one that asks");
  const auto fourth = m.cast_ray(through, {.categories = 2, .ground = false});
  check::that(fourth && fourth->who.body == s.full, "the category of others has every bit");
  m.cast_rays_through({&through, 1}, all, {.categories = 2});
  check::within(double(all[0].size()), 4, 4, "hits among those of another category than the ball's");
  // The L's hull is met where its mesh is not.
  const RigidState corner = m.state(s.angle);
  const Vec3 notch = corner.position - l->center_of_mass_in_mesh + Vec3(0.1, 0.1, 0);
  check::that(!m.cast_ray({.from = notch + Vec3(0, 0, 2), .length = 2.5}, {.ground = false}),
              "a ray through the notch of an L meets nothing");
}

void volumes(Scene& s) {
  Manager& m = s.manager;
  for (const auto& [body, x] : {std::pair{s.full, 0.0}, {s.support, 2.0}, {s.tables, 4.0}}) {
    const auto hit = m.sweep_sphere({{.from = {x, 0, 5}}, 0.5});
    check::that(hit && hit->who.body == body, "a sphere that falls meets the box below");
    check::within(hit ? hit->distance : 0, 3.3 - 1e-6, 3.3 + 1e-6, "m of its way");
    const auto edge = m.sweep_sphere({{.from = {x + 0.1 + 0.3, 0, 5}}, 0.5});
    check::within(edge ? edge->distance : 0, 3.8 - 0.4 - 1e-6, 3.8 - 0.4 + 1e-6,
                  "m of its way to an edge .3 m beside");
    const auto inside = m.sweep_sphere({{.from = {x, 0, 1}}, 0.05});
    check::that(inside && inside->who.body == body && inside->distance == 0.0,
                "one that begins inside is met at once");
  }
  const auto met = m.sweep_sphere({{.from = {6, 0, 5}}, 0.3});
  check::within(met ? met->distance : 0, 3.5 - 1e-9, 3.5 + 1e-9, "m to a ball that sleeps");
  std::vector<QueryHit> lists[3];
  const SphereVolume spheres[3] = {{{1, 0, 1}, 0.95}, {{1, 0, 1}, 0.85}, {{0, 0, 1}, 0.01}};
  m.overlap_spheres(spheres, lists);
  check::that(lists[0].size() == 2 && lists[0][0].who.body == s.full && lists[0][1].who.body == s.support,
              "a sphere of .95 m between two meets both");
  check::that(lists[1].empty(), "one of .85 m neither");
  check::that(lists[2].size() == 1 && lists[2][0].who.body == s.full,
              "a small one within a body meets that one");
  const BoxVolume boxes[3] = {{.sides = {8, 0.1, 0.1}, .position = {3, 0, 1}},
                              {.sides = {0.1, 0.1, 0.1},
                               .position = {0.175, 0, 1},
                               .orientation = Quat(Eigen::AngleAxisd(0.7853981633974483, Vec3::UnitZ()))},
                              {.sides = {0.1, 0.1, 0.1},
                               .position = {0.1725, 0, 1},
                               .orientation = Quat(Eigen::AngleAxisd(0.0, Vec3::UnitZ()))}};
  m.overlap_boxes(boxes, lists);
  check::within(double(lists[0].size()), 4, 4, "bodies in a long box");
  check::within(double(lists[1].size()), 0, 0, "bodies in one whose corner ends 4 mm before a face");
  check::within(double(lists[2].size()), 0, 0, "bodies in one whose face ends 22 mm before");
}

// Many at once, against what looking at every body gives.
void many() {
  Manager manager({.signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
  manager.add_plane({0, 0, 1}, 0.0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(-30, 30), height(0.5, 6), turn(-1, 1);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 3000; ++i)
    bodies.push_back(manager.add_body({.shape = i % 3 ? ball : crate,
                                       .state = {Vec3(side(random), side(random), height(random)),
                                                 Quat::UnitRandom(), Vec3::Zero(), Vec3::Zero()}}));
  double worst = 0.0, us = 0.0;
  int hits = 0, differ = 0;
  for (int frame = 0; frame < 30; ++frame) {
    manager.step(1.0 / 60.0);
    if (frame % 10 == 5) manager.set_state(bodies[std::size_t(frame)], at({side(random), side(random), 3}));
    std::vector<Ray> rays;
    for (int i = 0; i < 1000; ++i)
      rays.push_back({.from = {side(random), side(random), height(random)},
                      .direction = {turn(random), turn(random), 0.3 * turn(random)},
                      .length = 100});
    std::vector<std::optional<QueryHit>> firsts(rays.size());
    manager.cast_ray(rays[0]);
    const auto start = std::chrono::steady_clock::now();
    manager.cast_rays(rays, firsts);
    us += std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() /
          double(rays.size());
    for (std::size_t i = 0; i < 20; ++i) {
      // Of balls alone the distance is known in closed form.
      double nearest = 100.0;
      const Vec3 direction = rays[i].direction.normalized();
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (b % 3 == 0) continue;
        const Vec3 to = manager.state(bodies[b]).position - rays[i].from;
        const double along = to.dot(direction), square = to.squaredNorm() - along * along;
        if (to.norm() > 0.2 && along > 0 && square < 0.04)
          nearest = std::min(nearest, along - std::sqrt(0.04 - square));
      }
      const auto& hit = firsts[i];
      const bool is_ball = hit && hit->who.kind == ContactSide::Kind::body && hit->who.body.index % 3 != 0;
      if (is_ball)
        worst = std::max(worst, std::abs(hit->distance - nearest)), ++hits;
      else
        differ += (hit ? hit->distance : 100.0) > nearest + 1e-9;
    }
  }
  check::within(hits, 50, 600, "rays of 600 that met a ball first");
  check::within(worst, 0, 1e-9, "m, greatest difference to a look at every ball");
  check::within(differ, 0, 0, "rays that passed over a ball");
  std::printf("     %.2f us a ray of 100 m among 3,000 bodies\n", us / 30);
}

// A caller's own dynamic bodies, in a space of any type: a box, a capsule with an offset, a convex and a
// concave mesh.
struct Callers {
  dWorldID world = dWorldCreate();
  dSpaceID space;
  std::unique_ptr<Manager> manager;
  dBodyID box, capsule, convex, angle;
  dGeomID box_geom;
  Mesh mesh = make_l(0.4, 0.4, 0.2, 0.2);
  std::vector<double> corners;
  std::vector<dTriIndex> faces;
  dTriMeshDataID data = dGeomTriMeshDataCreate();

  explicit Callers(bool quadtree) {
    const dVector3 center = {0, 0, 0}, half = {50, 50, 50};
    space = quadtree ? dQuadTreeSpaceCreate(nullptr, center, half, 5) : dHashSpaceCreate(nullptr);
    for (int i = 0; i < 30; ++i) dGeomSetPosition(dCreateBox(space, 1, 1, 1), i, 10, 0);
    box = add(box_geom = dCreateBox(space, 0.4, 0.4, 0.4), {0, 0, 1});
    const dGeomID rod = dCreateCapsule(space, 0.1, 0.6);
    capsule = add(rod, {2, 0, 1});
    dGeomSetOffsetPosition(rod, 0, 0, 0.5);
    // An octahedron of .3 m.
    static const dReal points[] = {0.3, 0, 0, -0.3, 0, 0, 0, 0.3, 0, 0, -0.3, 0, 0, 0, 0.3, 0, 0, -0.3};
    static dReal planes[32];
    static const unsigned polygons[] = {3, 0, 2, 4, 3, 2, 1, 4, 3, 1, 3, 4, 3, 3, 0, 4,
                                        3, 2, 0, 5, 3, 1, 2, 5, 3, 3, 1, 5, 3, 0, 3, 5};
    const double part = std::sqrt(1.0 / 3.0);
    for (int i = 0; i < 8; ++i) {
      dReal* plane = planes + 4 * i;
      const unsigned* corner = polygons + 4 * i + 1;
      Vec3 normal = Vec3::Zero();
      for (int k = 0; k < 3; ++k)
        normal += Vec3(points[3 * corner[k]], points[3 * corner[k] + 1], points[3 * corner[k] + 2]);
      normal.normalize();
      for (int a = 0; a < 3; ++a) plane[a] = normal[a];
      plane[3] = 0.3 * part;
    }
    convex = add(dCreateConvex(space, planes, 8, points, 6, polygons), {4, 0, 1});
    for (const Vec3& v : mesh.vertices) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
    for (const auto& face : mesh.faces)
      faces.insert(faces.end(), {dTriIndex(face[0]), dTriIndex(face[1]), dTriIndex(face[2])});
    dGeomTriMeshDataBuildDouble(data, corners.data(), 3 * sizeof(double), int(mesh.vertices.size()),
                                faces.data(), int(faces.size()), 3 * sizeof(dTriIndex));
    angle = add(dCreateTriMesh(space, data, nullptr, nullptr, nullptr), {6, 0, 1});
    manager = std::make_unique<Manager>(world, space);
    manager->step(1.0 / 60.0);
  }
  ~Callers() {
    manager.reset();
    dSpaceDestroy(space);
    dWorldDestroy(world);
    dGeomTriMeshDataDestroy(data);
  }
  dBodyID add(dGeomID geom, const Vec3& place) {
    const dBodyID body = dBodyCreate(world);
    dMass mass;
    dMassSetSphereTotal(&mass, 5, 0.2);
    dBodySetMass(body, &mass);
    dGeomSetBody(geom, body);
    dBodySetPosition(body, place.x(), place.y(), place.z());
    return body;
  }
};

bool is(const std::optional<QueryHit>& hit, dBodyID body) {
  return hit && hit->who.kind == ContactSide::Kind::callers && hit->who.callers == body &&
         dGeomGetBody(hit->who.geom) == body;
}

void callers_bodies(bool quadtree) {
  const auto callers_body = [](const QueryHit& hit) { return hit.who.callers; };
  Callers c(quadtree);
  Manager& m = *c.manager;
  const auto down = [&](double x, double y = 0) { return m.cast_ray({.from = {x, y, 5}, .length = 8}); };
  const auto meets = [&](const std::optional<QueryHit>& hit, dBodyID body, double distance,
                         const char* what) {
    check::that(is(hit, body), what);
    check::within(hit ? hit->distance : 0, distance - 1e-6, distance + 1e-6, "m to it");
  };
  meets(down(0.1, 0.05), c.box, 3.8, "a ray meets a box of the caller's");
  check::that(down(0)->who.geom == c.box_geom, "and names its geom");
  meets(down(2), c.capsule, 5 - 1.9 - 0.1 * (2 / (1 + std::cos(std::numbers::pi / 32)) - 1),
        "a ray meets a capsule that has an offset");
  meets(down(4), c.convex, 3.7, "a ray meets a convex");
  meets(down(4.1, 0.1), c.convex, 3.9, "and its slanted face");
  const Eigen::AlignedBox3d bounds_of_l = [&] {
    Eigen::AlignedBox3d bounds;
    for (const Vec3& v : c.mesh.vertices) bounds.extend(v);
    return bounds;
  }();
  int through = 0, met = 0;
  const Vec3 size = bounds_of_l.sizes();
  for (double x : {0.25, 0.75})
    for (double y : {0.25, 0.75}) {
      const Vec3 from = Vec3(6, 0, 1) + bounds_of_l.min() + Vec3(x * size.x(), y * size.y(), 2);
      (is(m.cast_ray({.from = from, .length = 4}), c.angle) ? met : through)++;
    }
  check::within(met, 3, 3, "of four rays at the quarters of a concave mesh that meet it");
  check::within(through, 1, 1, "that pass through its notch");
  meets(m.sweep_sphere({{.from = {0, 0, 5}}, 0.5}), c.box, 3.3, "a sphere that falls meets the box");
  meets(m.sweep_sphere({{.from = {4, 0, 5}}, 0.5}), c.convex, 3.2, "and the convex");
  std::vector<QueryHit> list[1];
  const SphereVolume small[1] = {{{0, 0, 1.5}, 0.31}};
  m.overlap_spheres(small, list);
  check::that(list[0].size() == 1 && list[0][0].who.callers == c.box, "a sphere over it overlaps it");
  const BoxVolume beam[1] = {{.sides = {10, 0.1, 0.1}, .position = {3, 0, 1.27}}};
  m.overlap_boxes(beam, list);
  check::that(list[0].size() == 2 && std::ranges::count(list[0], c.capsule, callers_body) == 1 &&
                  std::ranges::count(list[0], c.convex, callers_body) == 1,
              "a beam overlaps what reaches so high, each once");
  check::that(!m.cast_ray({.from = {0, 0, 5}, .length = 8}, {.callers = false}),
              "not where the filter leaves them out");
  dGeomSetCategoryBits(c.box_geom, 4);
  m.step(1.0 / 60.0);
  check::that(!m.cast_ray({.from = {0, 0, 5}, .length = 8}, {.categories = 2}),
              "nor where it leaves out the geom's category");

  dBodySetPosition(c.box, -3, 0, 2);
  check::that(!down(0), "nothing is where it was before it was moved");
  meets(down(-3.1), c.box, 2.8, "it is where it was moved, without a step");
  m.step(1.0 / 60.0);
  meets(down(-3.1), c.box, 2.8, "and after one");
  dBodySetLinearVel(c.box, 6, 0, 0);
  m.step(1.0 / 60.0);
  const auto side = m.cast_ray({.from = {-8, 0, 2}, .direction = {1, 0, 0}});
  meets(side, c.box, 5 - 0.2 + 0.1, "one that flies is where the step took it");

  dGeomDestroy(c.box_geom), dBodyDestroy(c.box);
  check::that(!m.cast_ray({.from = {-8, 0, 2}, .direction = {1, 0, 0}, .length = 8}),
              "a destroyed one is met no more, without a step");
  meets(down(4), c.convex, 3.7, "others are");
  const dGeomID added = dCreateSphere(c.space, 0.25);
  const dBodyID late = c.add(added, {-3, 0, 1});
  m.step(1.0 / 60.0);
  meets(down(-3), late, 3.75, "one that came is, a step later");
}

int main() {
  Scene scene;
  rays(scene);
  volumes(scene);
  many();
  dInitODE2(0);
  for (const bool quadtree : {false, true}) callers_bodies(quadtree);
  return check::result();
}
