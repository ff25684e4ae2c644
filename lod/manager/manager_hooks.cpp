#include <array>
#include <cmath>
#include <numbers>

#include "lod/manager/manager_impl.h"

namespace lodestone {
namespace {

constexpr int kCircleParts = 16;

void draw_circle(const DebugDrawer& drawer, const Vec3& center, const Vec3& first, const Vec3& second,
                 DebugColor color) {
  Vec3 from = center + first;
  for (int i = 1; i <= kCircleParts; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCircleParts;
    const Vec3 to = center + std::cos(angle) * first + std::sin(angle) * second;
    drawer.line(from, to, color);
    from = to;
  }
}

void draw_sphere(const DebugDrawer& drawer, const RigidState& state, double radius, DebugColor color) {
  const Mat3 axes = radius * state.orientation.toRotationMatrix();
  for (int i = 0; i < 3; ++i) draw_circle(drawer, state.position, axes.col(i), axes.col((i + 1) % 3), color);
}

void draw_hull(const DebugDrawer& drawer, const Hull& hull, const RigidState& state, DebugColor color) {
  const auto place = [&](int vertex) -> Vec3 {
    return state.position + state.orientation * hull.vertices[std::size_t(vertex)];
  };
  for (int vertex = 0; vertex < int(hull.vertices.size()); ++vertex)
    for (const int neighbor : hull.neighbors(vertex))
      if (vertex < neighbor) drawer.line(place(vertex), place(neighbor), color);
}

void draw_box(const DebugDrawer& drawer, const Eigen::AlignedBox3d& box, DebugColor color) {
  for (int corner = 0; corner < 8; ++corner)
    for (const int axis : {1, 2, 4})
      if (!(corner & axis))
        drawer.line(box.corner(Eigen::AlignedBox3d::CornerType(corner)),
                    box.corner(Eigen::AlignedBox3d::CornerType(corner | axis)), color);
}

Eigen::AlignedBox3d bounds_of(const Shape& shape, const RigidState& state) {
  if (shape.sphere_radius)
    return {state.position.array() - *shape.sphere_radius, state.position.array() + *shape.sphere_radius};
  Eigen::AlignedBox3d bounds;
  for (const Vec3& vertex : shape.hull.vertices) bounds.extend(state.position + state.orientation * vertex);
  return bounds;
}

void draw_contact(const DebugDrawer& drawer, const Vec3& point, const Vec3& normal,
                  const DrawSettings& settings) {
  if (drawer.point) drawer.point(point, settings.contact_color);
  if (drawer.line) drawer.line(point, point + settings.normal_length * normal, settings.contact_color);
}

void draw_body(const Levels& levels, std::uint32_t body, const DebugDrawer& drawer,
               const DrawSettings& settings) {
  const RigidState state = levels.state(body);
  const Shape& shape = *levels.bodies.shape(body);
  DebugColor color = settings.colors[std::size_t(levels.bodies.level(body).rung)];
  if (levels.asleep(body)) color = {0.5f * color.red, 0.5f * color.green, 0.5f * color.blue};
  const StatisticalPlace place = levels.bodies[body].statistical;
  const double sphere = place ? levels.statistical->sphere_radius(place) : 0.0;
  if (drawer.point && settings.bodies) drawer.point(state.position, color);
  if (!drawer.line) return;
  if (settings.bodies && (sphere > 0.0 || shape.sphere_radius))
    draw_sphere(drawer, state, sphere > 0.0 ? sphere : *shape.sphere_radius, color);
  else if (settings.bodies)
    draw_hull(drawer, shape.hull, state, color);
  if (settings.bounds) draw_box(drawer, bounds_of(shape, state), settings.bounds_color);
}

void draw_contacts(const Levels& levels, const DebugDrawer& drawer, const DrawSettings& settings) {
  if (levels.full.world())
    for (const OdeContact& contact : levels.full.world()->contacts())
      draw_contact(drawer, contact.point, contact.normal, settings);
  std::vector<PairContact> contacts;
  if (levels.statistical) levels.statistical->find_contacts(contacts);
  for (const PairContact& contact : contacts)
    for (int i = 0; i < contact.manifold.count; ++i)
      draw_contact(drawer, contact.manifold.points[std::size_t(i)].point, contact.normal, settings);
}

}  // namespace

void Manager::set_log(LogFunction log) {
  impl_->levels.signatures.set_log(log);
  impl_->step_log.set(std::move(log));
}

void Manager::set_profile(ProfileHooks hooks) { impl_->profile = std::move(hooks); }

void Manager::set_events(const EventSettings& settings) { impl_->events.set(checked(settings)); }
void Manager::set_events(BodyId body, bool events) {
  impl_->events.ask(impl_->index_of(body), events);
  impl_->recorder.note(Call::set_body_events, body, events);
}
std::span<const ContactEvent> Manager::contact_events() const { return impl_->events.events(); }

void Manager::draw(const DebugDrawer& drawer, const DrawSettings& settings) const {
  const Levels& levels = impl_->levels;
  for (const std::uint32_t body : levels.bodies.in_order_of_creation())
    draw_body(levels, body, drawer, settings);
  if (settings.contacts) draw_contacts(levels, drawer, settings);
}

}  // namespace lodestone
