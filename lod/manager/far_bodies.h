// Sleeping bodies that are too far from every viewpoint for a policy to want another level for them, by how
// far the viewpoints must travel before that can change. So a step looks at those few whose turn it is, and
// at no others.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "reference/state_archive.h"

namespace lodestone {

class FarBodies {
 public:
  /// Puts `body` in, or elsewhere: its turn comes at `due` or a little before (m of travel).
  void put(std::uint32_t body, double due);
  void forget(std::uint32_t body);
  void clear();
  void archive(StateArchive& a) { a(places_, place_of_, entries_, bodies_); }

  /// m: no body is due before.
  double next_due() const { return places_.empty() ? 1e300 : places_.begin()->first * kWidth; }
  /// Moves those that are due first, about a quarter of a metre's worth, to the end of `bodies`. Returns what
  /// they were due before.
  double take_next(std::vector<std::uint32_t>& bodies);

 private:
  static constexpr double kWidth = 0.25;  // m
  static constexpr std::int32_t kNowhere = INT32_MIN;
  void drop_stale();

  std::map<std::int32_t, std::vector<std::uint32_t>>
      places_;                          // some entries are stale: the body is elsewhere now
  std::vector<std::int32_t> place_of_;  // of each body
  std::size_t entries_ = 0, bodies_ = 0;
};

}  // namespace lodestone
