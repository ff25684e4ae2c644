// For tests of the statistical rungs: a box with a signature of few trials, and a level whose bodies are all
// on one rung, known by their slots there.
#pragma once

#include "lod/rungs/statistical_level.h"
#include "signature/measure/measure.h"

namespace lodestone::testing {

inline std::shared_ptr<const Shape> box() {
  static const auto shape = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  return shape;
}

inline std::shared_ptr<const Signature> box_signature() {
  static const auto signature = [] {
    SignatureSettings settings;
    settings.n_theta = 4, settings.n_phi = 4, settings.n_alpha = 6, settings.trials_per_cell = 16;
    settings.held_out_conditions = 4;  // they certify the tables, which nobody reads here
    settings.height_trials = 200, settings.settling_trials = 60, settings.clips = 30;
    return std::make_shared<const Signature>(measure_signature(*box(), settings, 2));
  }();
  return signature;
}

class OneRung {
 public:
  OneRung(StatisticalModel model, const StatisticalSettings& settings, const Ground& ground,
          const MaterialTable& materials)
      : model_(model), level_(settings, ground, materials) {}

  int add(std::uint32_t owner, std::shared_ptr<const Shape> shape, double mass, MaterialId material,
          const RigidState& state, bool asleep, std::shared_ptr<const Signature> signature) {
    return level_.add(model_, owner, std::move(shape), mass, material, state, asleep, std::move(signature))
        .slot;
  }
  std::optional<std::uint32_t> remove(int slot) { return level_.remove(at(slot)); }
  void step(double dt, std::span<FullNeighbor> neighbors, StepReport& report,
            std::span<const FullContact> full_contacts = {}) {
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
  void set_state(int slot, const RigidState& state) { level_.set_state(at(slot), state); }

 private:
  StatisticalPlace at(int slot) const { return {model_, slot}; }
  StatisticalModel model_;
  StatisticalLevel level_;
};

}  // namespace lodestone::testing
