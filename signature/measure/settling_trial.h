// Drops to rest under ODE: rest poses (3.2.3) and settling clips.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "reference/hull/resting_faces.h"
#include "reference/ode/ode_world.h"
#include "signature/signature.h"

namespace lodestone {

inline constexpr double kSettlingGravity = 9.81;  ///< m/s²
/// J/kg over g R: kinetic energy at a contact below which a record starts.
inline constexpr double kClipEnergy = 0.2;
inline constexpr double kEntryGap = 0.02;  ///< over R: near enough to the plane to be such a contact
/// Below this friction a body that slides and spins about the vertical without tipping counts as at rest in
/// its pose: it would slide on for long. (So little friction tips no body that stands: its moment about the
/// edge, μ m g h, is less than that of the weight.) Such a body leaves no clip.
inline constexpr double kSlipperyFriction = 0.05;

/// Of the lowest point over the plane z = 0, m.
double gap_over_ground(const Shape& shape, const RigidState& state);

/// What is kept of one drop.
struct SettlingRecord {
  bool rests = false;
  Vec3 normal = Vec3::UnitZ();  ///< of the plane at rest, in body axes
  double height = 0.0;          ///< of the centre of mass at rest, m
  /// From the first low-energy contact to rest, kObservationStep apart; empty where only the pose was asked
  /// for.
  std::vector<RigidState> states;
};

/// A world with one body and the plane z = 0 under gravity 9.81 m/s², used again for every drop of a thread.
class SettlingTrial {
 public:
  SettlingTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law);

  /// Drops the body and follows it to rest (at most 30 s at R = .2 m). Orientation and velocities are drawn
  /// from (seed, trial), over heights up to 3 R and speeds up to what a fall from there gives. Without
  /// `whole` the drop ends where the body has no longer the energy to leave the pose that it is bound for. A
  /// ball, which rolls on for ever under ODE, is not dropped at all: it has no pose, and its record is that
  /// of a body that never rests.
  SettlingRecord run(std::uint64_t seed, std::uint32_t trial, bool whole);

 private:
  bool note_certain_pose(const RigidState& state, double gap, double energy, SettlingRecord& record) const;

  std::shared_ptr<const Shape> shape_;
  double friction_ = 0.0;
  std::optional<RestingFaces> faces_;  // none for a sphere
  std::unique_ptr<MaterialTable> materials_;
  OdeWorld world_;
  OdeBodyId body_;
};

}  // namespace lodestone
