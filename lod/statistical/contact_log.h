// What touched what in a step, written down where somebody asked for it: every touch of every substep, with
// what it gave.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "lod/ground_id.h"
#include "reference/geometry.h"
#include "reference/material.h"

struct dxGeom;  // dGeomID is dxGeom*

namespace lodestone {

/// A touch of a body with another, or with the ground.
struct ContactRecord {
  static constexpr std::uint32_t kGround = 0xffffffff;
  std::uint32_t first = 0, second = kGround;  ///< owners
  GroundId ground = {};  ///< where the second is the ground; null where it is not known which piece
  MaterialId ground_material = 0;
  dxGeom* callers_geom = nullptr;  ///< where a full body met one
  Vec3 point = Vec3::Zero();       ///< m
  Vec3 normal = Vec3::UnitZ();     ///< into the first
  double impulse = 0.0;            ///< N s along the normal, ≥ 0
  double approach = 0.0;           ///< m/s along the normal before, ≥ 0
};

class ContactLog {
 public:
  /// From any thread. Records of one pair of bodies come from one thread at a time and keep their order; that
  /// of different pairs may differ from run to run.
  void add(const ContactRecord& record) {
    const std::lock_guard lock(access_);
    records_.push_back(record);
  }
  std::vector<ContactRecord>& records() { return records_; }

 private:
  std::mutex access_;
  std::vector<ContactRecord> records_;
};

}  // namespace lodestone
