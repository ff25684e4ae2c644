// Islands with bodies of which one weighs many times another that it touches: with ODE's bound on friction
// and as many sweeps as carry a weight through a light body.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "lod/jobs.h"
#include "lod/simd/wide_loop.h"

namespace lodestone {

struct CrowdContacts;

class UnevenIslands {
 public:
  explicit UnevenIslands(Simd simd);
  ~UnevenIslands();

  /// The manifolds `which` of the contacts; `ratio`: of masses that touch, the greatest.
  void solve(const CrowdContacts& contacts, std::span<const std::uint32_t> which, double ratio,
             const JobRunner& jobs);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lodestone
