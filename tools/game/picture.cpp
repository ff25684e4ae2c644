#include "tools/game/picture.h"

#include <cmath>
#include <numbers>

#include "tools/game/overlay.h"

namespace game {
namespace {

using namespace lodestone;

constexpr DebugColor kSky{0.70f, 0.79f, 0.88f};

void normal(const Vec3& n) { glNormal3d(n.x(), n.y(), n.z()); }
void vertex(const Vec3& v) { glVertex3d(v.x(), v.y(), v.z()); }

void multiply(const Vec3& position, const Quat& orientation) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = orientation.toRotationMatrix();
  pose.topRightCorner<3, 1>() = position;
  glMultMatrixd(pose.data());
}

void set_camera(const Camera& camera, double aspect) {
  const double near_m = 0.1, far_m = 120.0, top = near_m * std::tan(0.5 * Picture::kVerticalFov);
  glMatrixMode(GL_PROJECTION), glLoadIdentity();
  glFrustum(-top * aspect, top * aspect, -top, top, near_m, far_m);
  glMatrixMode(GL_MODELVIEW), glLoadIdentity();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<1, 3>(0, 0) = camera.right().transpose(), view.block<1, 3>(1, 0) = camera.up().transpose(),
                      view.block<1, 3>(2, 0) = -camera.direction().transpose();
  view.topRightCorner<3, 1>() = -view.topLeftCorner<3, 3>() * camera.position;
  glLoadMatrixd(view.data());
}

void set_light() {
  const float sun[] = {0.45f, -0.55f, 0.75f, 0.0f}, bright[] = {0.80f, 0.78f, 0.72f, 1.0f},
              dim[] = {0.42f, 0.44f, 0.48f, 1.0f}, fog[] = {kSky.red, kSky.green, kSky.blue, 1.0f};
  glEnable(GL_DEPTH_TEST), glEnable(GL_LIGHTING), glEnable(GL_LIGHT0), glEnable(GL_COLOR_MATERIAL),
      glEnable(GL_CULL_FACE), glEnable(GL_FOG);
  glColorMaterial(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE);
  glLightfv(GL_LIGHT0, GL_POSITION, sun), glLightfv(GL_LIGHT0, GL_DIFFUSE, bright);
  glLightModelfv(GL_LIGHT_MODEL_AMBIENT, dim);
  glFogi(GL_FOG_MODE, GL_LINEAR), glFogf(GL_FOG_START, 20.0f), glFogf(GL_FOG_END, 75.0f),
      glFogfv(GL_FOG_COLOR, fog);
}

Vec3 terrain_point(int column, int row) {
  const double x = Terrain::coordinate(column), y = Terrain::coordinate(row);
  return {x, y, Terrain::height(x, y)};
}

void compile_terrain() {
  glBegin(GL_TRIANGLES);
  for (int row = 0; row + 1 < Terrain::kSamples; ++row)
    for (int column = 0; column + 1 < Terrain::kSamples; ++column) {
      const Vec3 a = terrain_point(column, row), b = terrain_point(column + 1, row),
                 c = terrain_point(column + 1, row + 1), d = terrain_point(column, row + 1);
      const float shade = (column / 2 + row / 2) % 2 ? 1.0f : 0.93f;  // squares of a metre
      glColor3f(0.70f * shade, 0.66f * shade, 0.56f * shade);
      normal((c - a).cross(d - b).normalized());
      for (const Vec3& corner : {a, b, c, a, c, d}) vertex(corner);
    }
  glEnd();
}

void draw_box(const Vec3& sides) {
  static const Vec3 axes[] = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  glBegin(GL_QUADS);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 n = side * axes[axis], u = axes[(axis + 1) % 3], v = n.cross(u), half = 0.5 * sides;
      normal(n);
      for (const Vec3& corner : {Vec3(n - u - v), Vec3(n + u - v), Vec3(n + u + v), Vec3(n - u + v)})
        vertex(corner.cwiseProduct(half));
    }
  glEnd();
}

void draw_block(const Block& block) {
  const dReal* position = dGeomGetPosition(block.geom);
  dQuaternion q;
  dGeomGetQuaternion(block.geom, q);
  glPushMatrix();
  multiply({position[0], position[1], position[2]}, Quat(q[0], q[1], q[2], q[3]));
  draw_box(block.sides);
  glPopMatrix();
}

// A dark disc on the ground, fainter the higher the body is.
void draw_shadow(const QueryHit& ground, double radius) {
  const double strength = 0.42 / (1.0 + 2.0 * std::max(0.0, ground.distance - radius));
  const Vec3 u = ground.normal.unitOrthogonal(), v = ground.normal.cross(u),
             center = ground.point + 0.015 * ground.normal;
  glBegin(GL_TRIANGLE_FAN);
  glColor4f(0.0f, 0.0f, 0.0f, float(strength));
  vertex(center);
  glColor4f(0.0f, 0.0f, 0.0f, 0.0f);
  for (int i = 0; i <= 10; ++i)
    vertex(center +
           radius * (std::cos(0.2 * std::numbers::pi * i) * u + std::sin(0.2 * std::numbers::pi * i) * v));
  glEnd();
}

// What the manager itself shows: hulls, spheres, contacts.
void draw_debug(const Manager& manager) {
  struct Mark {
    Vec3 at;
    DebugColor color;
  };
  std::vector<Mark> lines, points;
  manager.draw({.line =
                    [&](const Vec3& from, const Vec3& to, DebugColor color) {
                      lines.push_back({from, color}), lines.push_back({to, color});
                    },
                .point =
                    [&](const Vec3& at, DebugColor color) {
                      points.push_back({at, color});
                    }},
               {.colors = kRungColors});
  glDisable(GL_LIGHTING);
  glPointSize(4.0f);
  for (const auto& [mode, marks] : {std::pair(GL_LINES, &lines), std::pair(GL_POINTS, &points)}) {
    glBegin(GLenum(mode));
    for (const Mark& mark : *marks)
      glColor3f(mark.color.red, mark.color.green, mark.color.blue), vertex(mark.at);
    glEnd();
  }
  glEnable(GL_LIGHTING);
}

}  // namespace

Picture::Picture() : terrain_list_(glGenLists(1)) {
  glNewList(terrain_list_, GL_COMPILE);
  compile_terrain();
  glEndList();
}

Picture::~Picture() {
  glDeleteLists(terrain_list_, 1);
  for (const auto& [shape, list] : shape_lists_) glDeleteLists(list, 1);
}

GLuint Picture::list_of(const Shape& shape) {
  GLuint& list = shape_lists_[&shape];
  if (list) return list;
  list = glGenLists(1);
  glNewList(list, GL_COMPILE);
  glBegin(GL_TRIANGLES);
  for (const auto& [a, b, c] : shape.mesh.faces) {
    const auto& v = shape.mesh.vertices;
    normal((v[b] - v[a]).cross(v[c] - v[a]).normalized());
    vertex(v[a]), vertex(v[b]), vertex(v[c]);
  }
  glEnd();
  glEndList();
  return list;
}

void Picture::read_poses(const GameWorld& world, const Manager& manager) {
  positions_.resize(3 * world.bodies().size()), orientations_.resize(4 * world.bodies().size());
  manager.read_poses(world.bodies(), positions_, orientations_);
}

void Picture::draw_bodies(const GameWorld& world, const Manager& manager) {
  const std::vector<BodyId>& bodies = world.bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const DebugColor& color = kRungColors[std::size_t(manager.rung(bodies[i]))];
    const float shade = manager.asleep(bodies[i]) ? 0.65f : 1.0f;
    glColor3f(shade * color.red, shade * color.green, shade * color.blue);
    const float *at = &positions_[3 * i], *q = &orientations_[4 * i];
    glPushMatrix();
    multiply({at[0], at[1], at[2]}, Quat(q[0], q[1], q[2], q[3]));
    glCallList(list_of(manager.shape(bodies[i])));
    glPopMatrix();
  }
}

void Picture::draw_shadows(const GameWorld& world, const Manager& manager) {
  rays_.clear();
  for (std::size_t i = 0; i < world.bodies().size(); ++i)
    rays_.push_back(
        {.from = {positions_[3 * i], positions_[3 * i + 1], positions_[3 * i + 2]}, .length = 6.0});
  grounds_.resize(rays_.size());
  manager.cast_rays(rays_, grounds_, {.bodies = false});
  glDisable(GL_LIGHTING), glDepthMask(GL_FALSE), glEnable(GL_BLEND), glDisable(GL_CULL_FACE),
      glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (std::size_t i = 0; i < rays_.size(); ++i)
    if (grounds_[i]) draw_shadow(*grounds_[i], 1.3 * manager.shape(world.bodies()[i]).radius);
  glEnable(GL_LIGHTING), glDepthMask(GL_TRUE), glDisable(GL_BLEND), glEnable(GL_CULL_FACE);
}

void Picture::draw(GameWorld& world, const Camera& camera, int width, int height, bool hulls) {
  glViewport(0, 0, width, height);
  glClearColor(kSky.red, kSky.green, kSky.blue, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  set_camera(camera, double(width) / height);
  set_light();
  glCallList(terrain_list_);
  glColor3f(0.58f, 0.56f, 0.60f);
  for (const Block& block : world.blocks()) draw_block(block);
  glColor3f(0.45f, 0.25f, 0.14f);
  draw_block(world.door());
  const Manager& manager = world.manager();
  read_poses(world, manager);
  hulls ? draw_debug(manager) : draw_bodies(world, manager);
  draw_shadows(world, manager);
}

}  // namespace game
