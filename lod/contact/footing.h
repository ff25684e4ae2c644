// Which bodies of a crowd stand: over an area of what they touch below them. One on an edge may be slow, as
// where it rocks and turns back, and is not at rest.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_manifold.h"

namespace lodestone {

class Footing {
 public:
  /// From contacts as they were solved. `up`: against gravity, unit. `radii`: m, of each body; 0: it is firm.
  void find(std::span<const SolverBody> bodies, std::span<const double> radii,
            std::span<const CrowdManifold> manifolds, std::span<const CrowdPoint> points, const Vec3& up);
  /// Whether the body stands on an area that its centre of mass is over, and so does what it stands on.
  bool is_firm(std::size_t body) const { return !tips_[body]; }

 private:
  static constexpr std::size_t kWays = 16;  // directions around

  void hand_on(std::span<const SolverBody> bodies, std::span<const double> radii,
               std::span<const CrowdManifold> manifolds, const Vec3& up);

  std::vector<std::array<float, kWays>> reach_;  // m, of what each body stands on, from below its centre
  std::vector<char> tips_;
  std::vector<char> carries_;  // of each manifold
};

}  // namespace lodestone
