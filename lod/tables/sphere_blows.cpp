#include "lod/tables/sphere_blows.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr std::uint8_t kStruck = 1, kHeld = 2;  // of a body: in a heap, or no ball

}  // namespace

// Whether a ball that is struck touches another with nothing between them yet.
bool SphereBlows::find() {
  const auto awake = std::uint32_t(spheres_.awake);
  const float bounce = scene_.bounce_velocity();
  const auto is_ball = [&](std::uint32_t place) {
    return place >= awake || kinds_.is_ball(spheres_.kind[place]);
  };
  bool any = false;
  contacts_.each([&](const SphereContact& c) {
    any |= c.closing < -bounce && c.second < awake && is_ball(c.first) && is_ball(c.second);
  });
  if (!any) return false;
  struck_.resize(std::size_t(awake));
  for (std::uint32_t i = 0; i < awake; ++i) struck_[i] = is_ball(i) ? 0 : kHeld;
  contacts_.each([&](const SphereContact& c) {
    if (c.closing >= -bounce) return;
    for (const std::uint32_t place : {c.first, c.second})
      if (place < awake && struck_[place] != kHeld) struck_[place] = kStruck;
  });
  // Heaps, whose bodies bear each other, take blows as a whole.
  contacts_.each([&](const SphereContact& c) {
    if (c.second >= kGroundPlace || c.closing < -bounce || scene_.is_unloaded(c.first, c.second, c.impulse))
      return;
    struck_[c.first] = kHeld;
    if (c.second < awake) struck_[c.second] = kHeld;
  });
  bool goes_on = false;
  contacts_.each([&](const SphereContact& c) {
    const int first = struck_[c.first], second = c.second < awake ? struck_[c.second] : 0;
    if (c.closing < -bounce || first == kHeld || second == kHeld) return;
    goes_on |= (first == kStruck || second == kStruck) && scene_.is_unloaded(c.first, c.second, c.impulse);
  });
  return goes_on;
}

// m/s: what the ground is known to give one that bears others. Who takes part in a blow bears nobody in this
// step, and would leave the ground by it.
Vec3 SphereBlows::given_by_ground(std::uint32_t place) const {
  const auto state = GroundState(step_.on_ground[place]);
  if (state != GroundState::lies && state != GroundState::settles) return Vec3::Zero();
  return double(step_.a[place].w) * near_ground_.plane(step_.plane[place]).normal;
}

// Contacts that strike or carry nothing, between spheres with the inertia under which an impulse at their
// surface changes most (as in contact_loops.h).
void SphereBlows::gather_open_contacts() {
  const auto awake = std::uint32_t(spheres_.awake);
  const float bounce = scene_.bounce_velocity();
  const ContactLaw only_law = materials_.law(kinds_.material[0], kinds_.material[0]);
  bodies_.clear(), manifolds_.clear(), points_.clear();
  found_.clear(), places_.clear();
  numbered_.assign(std::size_t(awake), -1);
  const auto number_of = [&](std::uint32_t place) {
    if (place >= awake) return std::int32_t(-1);
    std::int32_t& number = numbered_[place];
    if (number >= 0) return number;
    number = std::int32_t(bodies_.size());
    places_.push_back(std::int64_t(place));
    const lane::Row &p = step_.p[place], &u = step_.u[place];
    const double radius = double(spheres_.radius[place]);
    SolverBody& body = bodies_.emplace_back();
    body.velocity = Vec3(double(p.x), double(p.y), double(p.z)) - given_by_ground(place);
    body.angular_velocity = Vec3(double(u.x), double(u.y), double(u.z)) / radius;
    body.inverse_mass = spheres_.inverse_mass[place];
    body.inverse_inertia = body.inverse_mass * (double(u.w) - 1.0) / (radius * radius) * Mat3::Identity();
    return number;
  };
  // What moves is a body that nothing moves; what stands, as sleepers do, is none.
  const auto number_of_ground = [&](std::uint32_t plane) {
    const Vec3 velocity = near_ground_.planes().velocity(plane);
    if (velocity.isZero(0.0)) return std::int32_t(-1);
    places_.push_back(-1);
    bodies_.emplace_back().velocity = velocity;
    return std::int32_t(bodies_.size()) - 1;
  };
  contacts_.each_place([&](ContactArrays& c, std::size_t i, bool of_ground) {
    const bool has_own_law = of_ground || !constants_.one_kind;
    const std::uint32_t a = c.first[i], b = c.second[i];
    if (struck_[a] == kHeld || (b < awake && struck_[b] == kHeld)) return;
    if (c.closing[i] >= -bounce && !scene_.is_unloaded(a, b, c.impulse[i])) return;
    CrowdManifold& m = manifolds_.emplace_back();
    m.normal = Vec3(double(c.nx[i]), double(c.ny[i]), double(c.nz[i]));
    m.law = has_own_law
                ? ContactLaw{.restitution = double(c.restitution[i]), .friction = double(c.friction[i])}
                : only_law;
    m.begin = std::uint32_t(points_.size()), m.count = 1;
    m.first = number_of(a), m.second = of_ground ? number_of_ground(b - kGroundPlace) : number_of(b);
    CrowdPoint& point = points_.emplace_back();
    point.arm_first = -double(spheres_.radius[a]) * m.normal;
    const bool on_body = m.second >= 0 && !of_ground;
    if (on_body) point.arm_second = double(spheres_.radius[b]) * m.normal;
    // Contacts that a blow closes but for what is a touch bounce, too.
    const float own = kinds_.radius[spheres_.kind[a]],
                size = on_body ? std::min(own, kinds_.radius[spheres_.kind[b]]) : own;
    point.gap = double(c.gap[i] - contacts_.settings().touching * size);
    found_.emplace_back(&c, i);
  });
}

void SphereBlows::pass_on() {
  passed_.clear();
  if (!constants_.hulls || !kinds_.any_balls() || !find()) return;
  gather_open_contacts();
  bodies_before_ = bodies_;
  waves_.pass_on(bodies_, manifolds_, points_, constants_.wide_time,
                 {.bounce_velocity = double(scene_.bounce_velocity())});
  if (waves_.struck().empty()) return;
  waves_.add_impulses(points_);
  give_to_bodies();
  note_passed();
}

void SphereBlows::give_to_bodies() {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (places_[k] < 0) continue;
    const auto i = std::size_t(places_[k]);
    const double radius = double(spheres_.radius[i]), softness = double(step_.u[i].w) - 1.0;
    const Vec3 by = bodies_[k].velocity - bodies_before_[k].velocity,
               turns = radius * (bodies_[k].angular_velocity - bodies_before_[k].angular_velocity);
    const auto add = [](lane::Row& row, const Vec3& v) {
      row.x += float(v.x()), row.y += float(v.y()), row.z += float(v.z());
    };
    add(step_.p[i], by), add(step_.u[i], turns);
    if (softness > 0.0) add(step_.s[i], radius / softness * turns);
  }
}

// And what is left of the speed at which contacts close in.
void SphereBlows::note_passed() {
  for (const std::uint32_t k : waves_.struck()) {
    const auto [c, i] = found_[k];
    passed_.push_back({c->first[i], c->second[i], c->nx[i], c->ny[i], c->nz[i], c->gap[i], c->closing[i],
                       float(points_[k].impulse.dot(manifolds_[k].normal))});
  }
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const CrowdManifold& m = manifolds_[k];
    const auto velocity_of = [&](std::int32_t body) {
      return body < 0 ? Vec3(Vec3::Zero()) : bodies_[std::size_t(body)].velocity;
    };
    const auto [c, i] = found_[k];
    const double speed = (velocity_of(m.first) - velocity_of(m.second)).dot(m.normal);
    const bool meet = points_[k].gap + speed * constants_.wide_time <= 0.0;  // else it is held apart
    c->closing[i] = float(meet ? speed : std::max(0.0, speed));
  }
}

}  // namespace lodestone
