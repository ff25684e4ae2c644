// What most hard cases are made of.
#pragma once

#include <cmath>
#include <memory>

#include "lod/manager.h"
#include "reference/ode/ode_world.h"
#include "reference/shape.h"
#include "scenes/run_measures.h"

namespace lodestone {

inline constexpr double kCaseGravity = 9.81;  // m/s²

inline std::shared_ptr<const Shape> share(Shape shape) {
  return std::make_shared<const Shape>(std::move(shape));
}
inline std::shared_ptr<const Shape> box_of(const Vec3& sides_m) {
  return share(make_shape("box", make_box(sides_m)));
}
inline std::shared_ptr<const Shape> ball_of(double radius_m) { return share(make_sphere_shape(radius_m)); }

/// One material for everything.
inline MaterialTable materials_of(double restitution, double friction) {
  MaterialTable materials;
  materials.replace(0, {.restitution = restitution, .friction = friction});
  return materials;
}

/// Signatures are not measured: statistical bodies are those of `support` without settling clips.
inline Manager make_unmeasured_manager() {
  return Manager({.policy = {}, .signatures = [](const Shape&, const ContactLaw&) {
                    return std::shared_ptr<const Signature>();
                  }});
}

/// kg m²/s, about the body's own centre of mass, in the world.
inline Vec3 angular_momentum(const Shape& shape, double mass, const RigidState& state) {
  return mass * (state.orientation *
                 (shape.inertia_per_mass * (state.orientation.conjugate() * state.angular_velocity)));
}

/// The greater, the lesser, or NaN once there was one: a figure that must not hide that it is none.
inline double worse(double worst, double value) {
  return std::isnan(worst) || value <= worst ? worst : value;
}
inline double lesser(double least, double value) {
  return std::isnan(least) || value >= least ? least : value;
}

}  // namespace lodestone
