// A statistical level whose bodies are all on one rung, known by their slots there.
#pragma once

#include "lod/rungs/statistical_level.h"

namespace lodestone::testing {

class OneRung {
 public:
  OneRung(StatisticalModel model, const StatisticalSettings& settings, const StaticGround& ground, const MaterialTable& materials)
      : model_(model), level_(settings, ground, materials) {}

  int add(std::uint32_t owner, std::shared_ptr<const Shape> shape, double mass, MaterialId material, const RigidState& state, bool asleep,
          std::shared_ptr<const Signature> signature) {
    return level_.add(model_, owner, std::move(shape), mass, material, state, asleep, std::move(signature)).slot;
  }
  std::optional<std::uint32_t> remove(int slot) { return level_.remove(at(slot)); }
  void step(double dt, std::span<FullNeighbor> neighbors, StepReport& report, std::span<const FullContact> full_contacts = {}) {
    level_.step(dt, neighbors, report, full_contacts);
  }
  std::size_t bytes() const { return level_.bytes(); }
  int size() const { return level_.size(); }
  int asleep_count() const { return level_.asleep_count(); }
  RigidState state(int slot) const { return level_.state(at(slot)); }
  Vec3 position(int slot) const { return level_.position(at(slot)); }
  double sphere_radius(int slot) const { return level_.sphere_radius(at(slot)); }
  bool asleep(int slot) const { return level_.asleep(at(slot)); }
  void wake(int slot) { level_.wake(at(slot)); }

 private:
  StatisticalPlace at(int slot) const { return {model_, slot}; }
  StatisticalModel model_;
  StatisticalLevel level_;
};

}  // namespace lodestone::testing
