// The bodies of a manager: stable ids, and for each body what the policy reads every step apart from what only a change of level needs.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/body.h"
#include "lod/policy.h"
#include "reference/ode/ode_world.h"

namespace lodestone {

/// What is kept of a body besides its state, which its level holds.
struct BodyRecord {
  BodyDefinition definition;         ///< `state` is current only while the body is at no level yet
  double mass = 0.0;                 ///< kg
  std::uint32_t generation = 0;      ///< of the id; a free index keeps that of its last body
  std::uint64_t birth = 0;           ///< bodies added before it; 0 in a free index
  int slot = -1;                     ///< in the statistical level, else −1
  OdeBodyId ode = {};                ///< at the full level, else null
  Vec3 force = Vec3::Zero();         ///< N, over the next step; held here so that a change of level carries it
  Vec3 torque = Vec3::Zero();        ///< N m
  double still_s = 0.0;              ///< how long it has been still at the full level, held up by statistical bodies
  int frames_to_retry = 0, retry_after = 0;  ///< of a promotion that was put off: left to wait, and the whole wait
};

class BodyTable {
 public:
  BodyId add(const BodyDefinition& definition, double mass);
  void remove(BodyId id);

  bool valid(BodyId id) const { return id && id.index < records_.size() && records_[id.index].generation == id.generation && records_[id.index].birth; }
  /// The index of a body; aborts where the id is not valid.
  std::uint32_t index_of(BodyId id) const;
  bool alive(std::uint32_t index) const { return records_[index].birth != 0; }

  BodyRecord& operator[](std::uint32_t index) { return records_[index]; }
  const BodyRecord& operator[](std::uint32_t index) const { return records_[index]; }
  /// One per index; that of a free index asks for nothing.
  std::vector<LevelCandidate>& candidates() { return candidates_; }
  const std::vector<LevelCandidate>& candidates() const { return candidates_; }

  int size() const { return int(records_.size() - free_.size()); }
  std::uint32_t indices() const { return std::uint32_t(records_.size()); }
  std::vector<std::uint32_t> in_order_of_creation() const;

 private:
  std::vector<BodyRecord> records_;
  std::vector<LevelCandidate> candidates_;
  std::vector<std::uint32_t> free_;
  std::uint64_t births_ = 0;
};

}  // namespace lodestone
