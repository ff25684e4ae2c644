// What a caller passes at run time, looked at before anything is changed. Each throws InputError, saying what
// was found and what was expected.
#pragma once

#include <span>
#include <string_view>

#include "lod/manager.h"

namespace lodestone {

/// m/s and rad/s: faster, a body is taken to move so fast in the same direction.
inline constexpr double kGreatestSpeed = 1e6;

void check_finite(const Vec3& value, std::string_view what);
void check_positive(double value, std::string_view what);
void check_step(double dt);
void check_policy(const PolicySettings& policy);
void check_level_choice(LevelChoice choice);
void check_rung_range(Rung least, Rung greatest);
Viewpoint checked(const Viewpoint& viewpoint);
void check_properties(const BodyProperties& properties);
const EventSettings& checked(const EventSettings& settings);
/// As a constructor can use them.
const ManagerSettings& checked(const ManagerSettings& settings);

/// As every rung can take it: finite, within 1e8 m of the origin, its orientation within 1e-3 of unit length
/// and normalised, no faster than kGreatestSpeed.
RigidState checked(RigidState state);
/// Of unit length within 1e-3, normalised.
Vec3 checked_normal(const Vec3& normal, std::string_view what);
Quat checked(const Quat& orientation, std::string_view what);
/// kg, of a body that can be made.
double checked_mass(const BodyDefinition& definition, const MaterialTable& materials);
/// Of a static box: the longest 1e-4 … 1e6 m, none below 2e-6 of it.
void check_box_sides(const Vec3& sides);
/// A mesh that can be ground: vertices within 1e6 m, faces that name them, one at least with an area.
void check_ground_mesh(const Mesh& mesh);

}  // namespace lodestone
