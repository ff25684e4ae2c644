// Fast bodies. One whose centre goes farther in a substep than the body is thick can pass through another
// between two looks at it. Rays along its way, relative to what else moves, find that; the body then ends the
// substep where it touches, its velocity untouched, for the next one's contacts. The centre and a ring of six
// places around it are looked along: what only the outer tenth of a body would have grazed is missed.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "reference/ode/bodies_ode.h"
#include "reference/ode/broad_phase_ode.h"

namespace lodestone::ode {

class Sweep {
 public:
  Sweep();
  ~Sweep();
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  /// Notes where every body is, before a substep.
  void begin(Bodies& bodies);
  /// After the substep: stops the bodies that passed through something. Those held by a joint are left alone,
  /// and planes are no concern: they have no other side. `contacts`: of the substep. Returns how many were
  /// stopped.
  int stop_passing(Bodies& bodies, BroadPhase& broad_phase, std::span<const OdeContact> contacts);

 private:
  /// From the start of a substep to its end, in the frame of what may be in the way.
  struct Way {
    Vec3 from, direction;
    double length, thickness;  // m
    bool touches;              // what may be in the way, at the start
  };

  /// What a body covers in the substep along the axis on which bodies are farthest apart, m.
  struct Reach {
    double from, to;
    Body* body;
  };

  void sort_by_reach(Bodies& bodies);
  Reach reach_of(Body& body) const;
  double free_part(Body& body, BroadPhase& broad_phase, std::span<const OdeContact> contacts);
  double free_part(const Body& body, const Body& other, std::span<const OdeContact> contacts);
  double free_part(const Way& way, dGeomID geom);
  std::optional<double> distance_to(dGeomID geom, const Vec3& from, const Way& way);
  std::optional<double> distance_to_mesh(dGeomID mesh, const Vec3& from, const Way& way);
  bool is_behind(dGeomID geom, const Vec3& point, const Vec3& direction);
  std::optional<double> cast(dGeomID geom, const Vec3& from, const Vec3& direction, double length);

  dGeomID ray_, mesh_;
  int axis_ = 0;
  std::vector<Reach> reaches_;  // by where they begin
  double longest_ = 0.0;        // m, of those
  std::vector<Body*> fast_;
  std::vector<std::pair<Body*, double>> stopped_;  // with the part of their way that is free
};

}  // namespace lodestone::ode
