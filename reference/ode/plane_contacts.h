// Contacts of a convex polyhedron with a plane. The deepest vertex of a mesh under a plane is always a hull
// vertex, and the hull vertices under a plane are connected through the hull's edges, so a climb and a flood
// find them all without visiting the rest.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/hull/hull.h"

namespace lodestone {

/// A vertex of a hull below a plane.
struct PlaneContact {
  int vertex = 0;
  double depth = 0.0;  ///< m below the plane, > 0
};

/// Finds the vertices of a hull below a plane. Keeps its memory between calls; one to a thread.
class PlaneContactFinder {
 public:
  /// The up to `max_contacts` deepest vertices of `hull` with normal·v < offset (unit normal, both in the
  /// hull's frame), deepest first and by index where depths are equal. `start` is any vertex, best the last
  /// deepest one, and becomes the deepest one. The result, valid until the next call, does not depend on
  /// `start`. `dropped`, when given, receives how many more there were.
  std::span<const PlaneContact> find(const Hull& hull, const Vec3& normal, double offset, int max_contacts,
                                     int& start, std::int64_t* dropped = nullptr);

 private:
  void gather_by_scan(const Hull& hull, const Vec3& normal, double offset);
  void gather_by_flood(const Hull& hull, const Vec3& normal, double offset, int start);

  std::vector<PlaneContact> found_;
  std::vector<std::uint64_t> visited_;  // by vertex: the round in which it was last seen
  std::uint64_t round_ = 0;
};

}  // namespace lodestone
