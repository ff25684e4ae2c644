// The bodies of the tables model as dense arrays, one element a body, by place: those awake first, roughly in
// the order of their cells, then those asleep. A slot is what a body is known by outside; slots are dense
// too. What flight conserves or adds up for long is double, the rest float.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lod/statistical/statistical_body.h"
#include "reference/state_archive.h"

namespace lodestone {

/// Whether a body moves over the ground on its hull's height, or is the sphere that others meet.
enum class HullStand : std::uint8_t {
  none,  ///< a sphere
  stands,
  rises,  ///< out of the ground that its hull was in when it was a sphere
};

constexpr std::uint16_t kWholeCredit = 65535;

struct Spheres {
  std::vector<double> x, y, z;       // m
  std::vector<double> vx, vy, vz;    // m/s
  std::vector<double> lx, ly, lz;    // spin: angular momentum over mass, m²/s, world
  std::vector<double> inverse_mass;  // 1/kg
  std::vector<float> qw, qx, qy, qz;
  std::vector<float> radius;        // m, of the colliding sphere
  std::vector<float> quiet;         // s below the sleeping threshold
  std::vector<float> twice_energy;  // J/kg, of its turning at the start of its flight (free_turn.h)
  std::vector<float> held;          // m/s: what the ground gave in the last step against what presses on it
  std::vector<std::int32_t> slot;
  std::vector<std::uint32_t> owner, events;
  std::vector<std::uint32_t> known_begin;  // of its run of contacts known from the last step
  std::vector<std::uint8_t> known_count;
  std::vector<std::uint32_t> kind;
  std::vector<std::int16_t> pose;  // of the resting record (3.4), −1: none
  std::vector<Motion> motion;
  std::vector<std::uint8_t> since_crowded;  // ms since it last touched another body, at most 255
  std::vector<std::uint8_t> crowded_for;    // ms for which it has without a break, at most 255

  std::vector<std::int32_t> support_hint;  // hull vertex last found lowest
  std::vector<std::int32_t> clip;          // of the settling clips under way, −1: none
  std::vector<HullStand> on_hull;
  std::vector<std::uint16_t>
      tipping_credit;  // over kWholeCredit: of the work that tipping may yet take (tipping.h)

  std::vector<std::uint8_t>
      eased;  // 8 ms awake in which overlaps that it brought from another rung are undone slowly (parting.h)

  std::vector<std::uint32_t> place_of_slot;
  std::int64_t awake = 0;  // places below it

  std::int64_t size() const { return std::int64_t(x.size()); }

  /// Calls `visit` with each array that goes by place.
  template <class Visit>
  void each_array(const Visit& visit) {
    visit(x), visit(y), visit(z), visit(vx), visit(vy), visit(vz), visit(lx), visit(ly), visit(lz),
        visit(inverse_mass);
    visit(qw), visit(qx), visit(qy), visit(qz), visit(radius), visit(quiet), visit(held), visit(twice_energy);
    visit(slot), visit(owner), visit(events), visit(known_begin), visit(known_count);
    visit(kind), visit(pose), visit(motion), visit(since_crowded), visit(crowded_for), visit(eased);
    visit(support_hint), visit(clip), visit(on_hull), visit(tipping_credit);
  }

  template <class Visit>
  void each_array(const Visit& visit) const {
    const_cast<Spheres*>(this)->each_array([&](auto& array) { visit(std::as_const(array)); });
  }

  void archive(StateArchive& a) {
    each_array([&](auto& array) { a(array); });
    a(place_of_slot, awake);
  }

  Vec3 position(std::int64_t place) const { return {x[place], y[place], z[place]}; }
  void set_position(std::int64_t place, const Vec3& at) {
    x[place] = at.x(), y[place] = at.y(), z[place] = at.z();
  }
  Vec3 velocity(std::int64_t place) const { return {vx[place], vy[place], vz[place]}; }
  Vec3 spin(std::int64_t place) const { return {lx[place], ly[place], lz[place]}; }
  Quat orientation(std::int64_t place) const {
    return Quat(qw[place], qx[place], qy[place], qz[place]).normalized();
  }

  void set_orientation(std::int64_t place, const Quat& q) {
    qw[place] = float(q.w()), qx[place] = float(q.x()), qy[place] = float(q.y()), qz[place] = float(q.z());
  }

  /// The body at `place` as those functions take it that treat one body at a time, and back.
  StatisticalBody body(std::int64_t place) const;
  void put(std::int64_t place, const StatisticalBody& body);

  /// A new body, awake; returns its place.
  std::int64_t add(std::uint32_t owner);
  /// Frees the body's place and slot. The body of the last slot takes over that slot.
  void remove(std::uint32_t slot);
  void wake(std::uint32_t slot);
  void put_to_sleep(std::int64_t place);
  void swap(std::int64_t a, std::int64_t b);
  /// Place i of those awake gets what is at `order[i]` now. `scratch` has eight bytes a body, aligned as
  /// doubles are.
  void reorder_awake(std::span<const std::uint32_t> order, void* scratch);
};

}  // namespace lodestone
