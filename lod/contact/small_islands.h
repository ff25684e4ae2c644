// Few bodies that hang together, each island of them by itself: with friction bounded as in ODE, by the
// normal impulses that there would be without any, to a result that hangs on no other body.
#pragma once

#include <memory>

#include "lod/contact/crowd_islands.h"
#include "lod/jobs.h"
#include "lod/simd/wide_loop.h"

namespace lodestone {

struct CrowdContacts;

class SmallIslands {
 public:
  explicit SmallIslands(Simd simd);
  ~SmallIslands();

  /// The settings say what bounces, and how many sweeps there are at least. Of the points of other islands
  /// nothing changes.
  void solve(const CrowdContacts& contacts, const CrowdIslands& islands, const JobRunner& jobs);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lodestone
