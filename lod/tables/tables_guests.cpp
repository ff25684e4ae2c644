// Of stage 3d, of TablesLevel: its bodies that are moved among hulls for a step, with what contacts of
// spheres gave them, and back.
#include <algorithm>

#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

// Of `given` what bears `load`, or a part of it.
Vec3 part_against(const Vec3& load, const Vec3& given) {
  const double all = load.squaredNorm();
  return all > 0.0 ? Vec3(-std::clamp(-given.dot(load) / all, 0.0, 1.0) * load) : Vec3(Vec3::Zero());
}

}  // namespace

void TablesLevel::describe(Guest& guest) const {
  const auto i = std::int64_t(place_of(guest.slot));
  guest.resting = {spheres_.pose[std::size_t(i)]};
  const bool awake = i < spheres_.awake, touches = awake && step_.touches(i);
  guest.moved = constants_.hulls && awake && near_ground_.is_cornered(i);
  guest.on_hull = guest.moved || (scene_.is_alone(i) && !touches);
}

StatisticalBody TablesLevel::guest_body(const Guest& guest) const {
  constexpr float kPartsSlowly = 1.0f;  // s
  const auto i = std::int64_t(place_of(guest.slot));
  StatisticalBody body = spheres_.body(i);
  if (guest.on_hull) {
    body.sphere_radius = 0.0f;
    const bool awake = i < spheres_.awake;
    if (awake) body.motion = Motion::dynamic;
    if (awake && spheres_.on_hull[std::size_t(i)] != HullStand::stands)
      body.eased = std::max(body.eased, kPartsSlowly);
  } else if (constants_.hulls) {
    body.sphere_radius = radius_at_ground(body, kind_of(i));  // what it rests on it does not leave as a guest
  }
  // What turns it are hulls, at its edges: there its own edges hold it wholly. (The paper's spheres roll.)
  const auto bear = [&](const Vec3& borne) {
    body.borne = borne;
    if (constants_.hulls)
      body.rolling_resistance =
          float(borne.norm() / kRollingShare) * kinds_.mean_rolling_lever(spheres_.kind[std::size_t(i)]);
  };
  if (i < spheres_.awake && step_.touches(i)) {
    const Vec3* steady = loads_.steady_on(i);
    const Vec3 load = steady ? Vec3(settings_.gravity + *steady) : settings_.gravity;
    const Vec3 given = (step_.velocity(i) - spheres_.velocity(i)) / constants_.wide_time - load;
    bear(part_against(load, given));
    body.velocity = step_.velocity(i) - (load + body.borne) * constants_.wide_time;
    body.spin += step_.added_spin(i);
    body.position += near_ground_.above_faces(i, step_.push_out(i));
  } else if (i >= spheres_.awake && !guest.on_hull) {
    if (const Vec3* borne = loads_.borne_of_sleeper(i)) bear(*borne);
  }
  if (spheres_.clip[std::size_t(i)] >= 0) body.motion = Motion::dynamic;
  return body;
}

// Contacts with sleepers have their places, which change where others wake.
void TablesLevel::wake_guests(std::span<const Guest> guests) {
  const auto wakes = [&](const Guest& guest) { return guest.moved && asleep(guest.slot); };
  if (std::ranges::none_of(guests, wakes)) return;
  const auto were_awake = std::uint32_t(spheres_.awake);
  const auto each_sleeper = [&](const auto& visit) {
    contacts_.each_place([&](ContactArrays& c, std::size_t i, bool) {
      if (std::uint32_t& place = c.second[i]; place >= were_awake && place < kGroundPlace) visit(place);
    });
  };
  slots_of_sleepers_.clear();
  each_sleeper(
      [&](std::uint32_t place) { slots_of_sleepers_.push_back(std::uint32_t(spheres_.slot[place])); });
  for (const Guest& guest : guests)
    if (guest.moved) wake(guest.slot);
  auto slot = slots_of_sleepers_.begin();
  each_sleeper([&](std::uint32_t& place) { place = std::uint32_t(spheres_.place_of_slot[*slot++]); });
}

void TablesLevel::take_guests(std::span<const Guest> guests, std::span<const StatisticalBody> before,
                              std::span<const StatisticalBody> bodies) {
  const std::int64_t were_awake = spheres_.awake;
  wake_guests(guests);
  if (spheres_.awake > were_awake) {
    start_woken(were_awake);
    clear_added(were_awake, spheres_.awake, step_);
  }
  for (std::size_t k = 0; k < guests.size(); ++k) {
    const Guest& guest = guests[k];
    if (!guest.moved) continue;
    const std::size_t i = place_of(guest.slot);
    if (guest.carried) carried_.add_guest(std::int64_t(i));
    StatisticalBody body = bodies[k];
    const Vec3 unpressed = before[k].velocity + before[k].borne * constants_.wide_time;
    // What nothing stops would only go through it.
    if (guest.touched && !guest.carried &&
        (body.velocity.squaredNorm() > unpressed.squaredNorm() ||
         scene_.is_bound_to(scene_.way(std::int64_t(i), before[k].position, unpressed))))
      driven_.add_guest(std::int64_t(i), before[k].position, unpressed);
    if (guest.touched && !guest.on_hull && step_.touches(std::int64_t(i)))
      loads_.keep(std::int64_t(i), before[k], body);
    else if (guest.touched && !guest.on_hull && std::int64_t(i) >= were_awake)
      loads_.keep_as_it_was(std::int64_t(i));
    clips_.end(std::int64_t(i));
    if (guest.on_hull) {
      hulls_.take_from_edge(std::int64_t(i), body);
    } else {
      spheres_.on_hull[i] = HullStand::none;
      spheres_.put(std::int64_t(i), body);
      spheres_.pose[i] = std::int16_t(guest.resting.pose);
      spheres_.held[i] = 0.0f;
    }
    // It has moved: nothing is left to be added to what it has now.
    step_.p[i] = {float(body.velocity.x()), float(body.velocity.y()), float(body.velocity.z()),
                  guest.touched && !guest.on_hull ? std::max(1.0f, step_.p[i].w) : step_.p[i].w};
    if (guest.on_hull && guest.touched) {
      leaning_.push_back(std::int64_t(i));
      const double gain = body.velocity.norm() - before[k].velocity.norm();
      if (gain > RestLaw::kSettingOut * settings_.gravity.norm() * constants_.wide_time)
        set_out_.push_back(std::int64_t(i));
    }
    step_.a[i] = step_.s[i] = step_.d[i] = {};
    step_.on_ground[i] = std::uint8_t(GroundState::moved);
  }
}

}  // namespace lodestone
