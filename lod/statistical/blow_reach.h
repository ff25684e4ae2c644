// How far a blow goes through bodies that touch. A sleeper holds like ground: of a row of them one that is
// struck would stop the striker as a wall does, so all have to be awake that the blow sets in motion. How
// fast that is follows from bodies that stay together once they have met: the striker and those before a body
// share the striker's momentum, and several that are struck by one share its mass.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

class BlowReach {
 public:
  struct Body {
    double mass = 0.0;        ///< kg; infinite: nothing stops it
    double wake_speed = 0.0;  ///< m/s: set in motion faster, it must not sleep
    bool asleep = false;
    Vec3 ground = Vec3::Zero();  ///< normal of a plane that it touches, which a blow ends at; zero: none
  };

  void clear() { bodies_.clear(), contacts_.clear(); }
  /// Returns its number: one more with each.
  std::int32_t add_body(const Body& body);
  /// Of two bodies by number; `normal` is from the second to the first, `closing` (m/s) how fast they near
  /// each other along it, `restitution` what of that they may part with.
  void add_contact(std::int32_t first, std::int32_t second, const Vec3& normal, double closing,
                   double restitution);
  /// Who sleeps and must not, by number, ascending. Of a chain of sleepers the first one: the others follow
  /// once that is awake, with its contacts.
  std::span<const std::int32_t> find();

 private:
  struct Contact {
    std::int32_t first, second;
    Vec3 normal;
    double closing, restitution;
  };
  /// What comes at a body: so much mass at such a velocity, the body's own among it.
  struct Ram {
    std::int32_t body;
    double speed;   // m/s
    Vec3 velocity;  // m/s
    double mass;    // kg
  };
  /// One of a body's contacts.
  struct End {
    std::int32_t other;
    std::int32_t contact;
    double sign;  // of the normal, towards the other
  };
  void sort_ends();
  void strike(std::int32_t body, const Vec3& velocity, double mass);
  void pass_on(const Ram& ram);
  std::span<const End> ends_of(std::int32_t body) const {
    const auto i = std::size_t(body);
    return std::span(ends_).subspan(std::size_t(first_end_[i]),
                                    std::size_t(first_end_[i + 1] - first_end_[i]));
  }

  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
  std::vector<End> ends_;                 // by body
  std::vector<std::int32_t> first_end_;   // of each body
  std::vector<double> fastest_;           // m/s, of what came at each body so far
  std::vector<Ram> rams_;                 // in hand
  std::vector<std::int32_t> set_moving_;  // the result
};

}  // namespace lodestone
