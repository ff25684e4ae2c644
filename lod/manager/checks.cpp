#include "lod/manager/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lod/ground/surface_solids.h"
#include "reference/error.h"
#include "reference/mass_bounds.h"

namespace lodestone {
namespace {

constexpr double kUnitWithin = 1e-3;  // of 1: by so much a length may be off that should be 1
constexpr double kFarthest = 1e8;     // m, from the origin
constexpr double kLongestStep = 10.0,
                 kShortestStep = 1e-9;  // s; over a shorter one solvers divide by what is no longer a number
constexpr double kFarthestVertex = 1e6, kShortestSide = 1e-4, kLongestSide = 1e6;  // m, of ground
// m, from the origin: beyond, the squares of distances lose what is near.
constexpr double kFarthestView = 1e12;

std::string text(const Vec3& v) { return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()); }

bool is_unit(double length) { return std::abs(length - 1.0) <= kUnitWithin; }  // not so for NaN

Vec3 bounded(const Vec3& velocity, std::string_view what) {
  check_finite(velocity, what);
  const double speed = velocity.stableNorm();  // does not overflow
  return speed > kGreatestSpeed ? Vec3((velocity / speed).normalized() * kGreatestSpeed) : velocity;
}

void check_number(double value, double least, std::string_view what) {
  if (!(value >= least))
    throw_input_error(what, fmt::format("{:g}", value), fmt::format("{:g} or more", least));
}

}  // namespace

void check_finite(const Vec3& value, std::string_view what) {
  if (!value.allFinite()) throw_input_error(what, text(value), "finite numbers");
}

void check_positive(double value, std::string_view what) {
  if (!(value > 0.0 && std::isfinite(value)))
    throw_input_error(what, fmt::format("{:g}", value), "a positive, finite number");
}

void check_step(double dt) {
  if (!(dt >= 0.0 && dt <= kLongestStep))
    throw_input_error("time step", fmt::format("{:g} s", dt), fmt::format("0 … {:g} s", kLongestStep));
  if (dt > 0.0 && dt < kShortestStep)
    throw_input_error("time step", fmt::format("{:g} s", dt),
                      fmt::format("0, or {:g} s or more", kShortestStep));
}

void check_policy(const PolicySettings& policy) {
  check_number(policy.hysteresis, 0.0, "hysteresis");
  check_number(policy.min_dwell_frames, 0.0, "min_dwell_frames");
  check_number(policy.max_transitions_per_frame, 0.0, "max_transitions_per_frame");
  check_number(policy.most_full, 0.0, "most_full");
  check_number(policy.most_support, 0.0, "most_support");
  if (const auto* distance = std::get_if<DistancePolicy>(&policy.policy)) {
    check_number(distance->full_within, 0.0, "full_within");
    check_number(distance->support_within, 0.0, "support_within");
    if (distance->support_within < distance->full_within)
      throw_input_error("support_within", fmt::format("{:g}", distance->support_within),
                        fmt::format("full_within ({:g}) or more", distance->full_within));
  }
  if (const auto* budget = std::get_if<BudgetPolicy>(&policy.policy))
    check_number(budget->budget_ms, 0.0, "budget_ms");
  if (const auto* budget = std::get_if<WorkPolicy>(&policy.policy))
    check_number(budget->budget_work, 0.0, "budget_work");
  if (const auto* budget = std::get_if<ErrorBudgetPolicy>(&policy.policy)) {
    check_number(budget->budget_ms, 0.0, "budget_ms");
    if (budget->budget_work) check_number(*budget->budget_work, 0.0, "budget_work");
  }
  if (const auto* size = std::get_if<ProjectedSizePolicy>(&policy.policy)) {
    check_number(size->full_above_px, 0.0, "full_above_px");
    check_number(size->support_above_px, 0.0, "support_above_px");
    if (size->support_above_px > size->full_above_px)
      throw_input_error("support_above_px", fmt::format("{:g}", size->support_above_px),
                        fmt::format("full_above_px ({:g}) or less", size->full_above_px));
  }
  check_number(policy.out_of_view_factor, 1.0, "out_of_view_factor");
  check_number(policy.look_ahead_s, 0.0, "look_ahead_s");
  if (policy.look_ahead_s > 10.0)
    throw_input_error("look_ahead_s", fmt::format("{:g}", policy.look_ahead_s), "10 s or less");
}

void check_level_choice(LevelChoice choice) {
  if (choice > LevelChoice::tables)
    throw_input_error("level choice", fmt::format("{}", int(choice)),
                      fmt::format("0 … {}", int(LevelChoice::tables)));
}

void check_rung_range(Rung least, Rung greatest) {
  for (const Rung rung : {least, greatest})
    if (rung > Rung::full)
      throw_input_error("rungs", fmt::format("{}", int(rung)), fmt::format("0 … {}", int(Rung::full)));
  if (least > greatest)
    throw_input_error("rungs",
                      fmt::format("{} as the least, {} as the greatest", name_of(least), name_of(greatest)),
                      "a least one no higher than the greatest");
}

Viewpoint checked(const Viewpoint& viewpoint) {
  check_finite(viewpoint.position, "viewpoint");
  if (viewpoint.position.lpNorm<Eigen::Infinity>() > kFarthestView)
    throw_input_error("viewpoint", text(viewpoint.position),
                      fmt::format("a place within {:g} m of the origin", kFarthestView));
  const auto check_vector = [](const Vec3& vector, std::string_view what) {
    check_finite(vector, what);
    if (!(vector.squaredNorm() > 0.0)) throw_input_error(what, text(vector), "a vector other than 0");
  };
  if (viewpoint.direction) check_vector(*viewpoint.direction, "direction of a viewpoint");
  check_vector(viewpoint.up, "up of a viewpoint");
  check_positive(viewpoint.vertical_fov_rad, "vertical_fov_rad");
  if (viewpoint.vertical_fov_rad >= std::numbers::pi)
    throw_input_error("vertical_fov_rad", fmt::format("{:g}", viewpoint.vertical_fov_rad), "less than π");
  check_positive(viewpoint.height_px, "height_px");
  check_positive(viewpoint.aspect, "aspect");
  return viewpoint;
}

void check_properties(const BodyProperties& properties) {
  const auto check_damping = [](double damping, std::string_view what) {
    if (!(damping >= 0.0 && std::isfinite(damping)))
      throw_input_error(what, fmt::format("{:g} 1/s", damping), "a finite number of 0 or more");
  };
  check_damping(properties.linear_damping, "linear damping");
  check_damping(properties.angular_damping, "angular damping");
  if (!(properties.max_angular_speed > 0.0))
    throw_input_error("maximal angular speed", fmt::format("{:g} rad/s", properties.max_angular_speed),
                      "a positive number");
}

const EventSettings& checked(const EventSettings& settings) {
  check_number(settings.least_speed, 0.0, "least_speed");
  check_number(settings.least_impulse, 0.0, "least_impulse");
  return settings;
}

const ManagerSettings& checked(const ManagerSettings& settings) {
  check_finite(settings.gravity, "gravity");
  check_number(settings.threads, 1.0, "threads");
  check_number(settings.full_substeps, 1.0, "full_substeps");
  check_positive(settings.sleep.speed, "sleep speed");
  check_number(settings.sleep.time, 0.0, "sleep time");
  check_policy(settings.policy);
  check_number(settings.tables.radius_update_interval, 1.0, "radius_update_interval");
  check_number(settings.audit_ms, 0.0, "audit_ms");
  checked(settings.events);
  return settings;
}

Vec3 checked_normal(const Vec3& normal, std::string_view what) {
  if (!is_unit(normal.norm())) throw_input_error(what, text(normal), "a vector of unit length");
  return normal.normalized();
}

Quat checked(const Quat& orientation, std::string_view what) {
  if (!is_unit(orientation.norm()))
    throw_input_error(what, fmt::format("a quaternion of length {:g}", orientation.norm()), "unit length");
  return orientation.normalized();
}

RigidState checked(RigidState state) {
  check_finite(state.position, "position");
  if (state.position.lpNorm<Eigen::Infinity>() > kFarthest)
    throw_input_error("position", text(state.position),
                      fmt::format("a place within {:g} m of the origin", kFarthest));
  state.orientation = checked(state.orientation, "orientation");
  state.velocity = bounded(state.velocity, "velocity");
  state.angular_velocity = bounded(state.angular_velocity, "angular velocity");
  return state;
}

double checked_mass(const BodyDefinition& definition, const MaterialTable& materials) {
  if (!definition.shape) throw_input_error("shape", "none", "one");
  materials.check_known(definition.material);
  check_positive(definition.importance, "importance");
  check_level_choice(definition.level);
  check_rung_range(definition.least_rung, definition.greatest_rung);
  const double mass =
      definition.mass.value_or(materials[definition.material].density * definition.shape->volume);
  check_positive(mass, "mass");
  check_mass(mass);
  check_inertia(*definition.shape);
  return mass;
}

void check_box_sides(const Vec3& sides) {
  constexpr double kThinnest = 2e-6;  // of the longest: thinner than so it has no volume, to rounding
  for (const double side : sides) check_positive(side, "side of a static box");
  const double longest = sides.maxCoeff();
  if (!(longest >= kShortestSide && longest <= kLongestSide))
    throw_input_error("longest side of a static box", fmt::format("{:g} m", longest),
                      fmt::format("{:g} … {:g} m (beyond, a plane)", kShortestSide, kLongestSide));
  if (sides.minCoeff() < kThinnest * longest)
    throw_input_error("shortest side of a static box", fmt::format("{:g} m", sides.minCoeff()),
                      fmt::format("{:g} of the longest, {:g} m, or more", kThinnest, longest));
}

void check_ground_mesh(const Mesh& mesh) {
  const auto vertices = int(mesh.vertices.size());
  bool any_area = false;
  for (const Vec3& vertex : mesh.vertices) {
    check_finite(vertex, "vertex of a static mesh");
    if (vertex.cwiseAbs().maxCoeff() > kFarthestVertex)  // ODE's triangles are of floats
      throw_input_error("vertex of a static mesh", text(vertex),
                        fmt::format("coordinates within {:g} m", kFarthestVertex));
  }
  for (const auto& face : mesh.faces) {
    for (const int i : face)
      if (i < 0 || i >= vertices)
        throw_input_error("face of a static mesh", fmt::format("vertex {}", i),
                          fmt::format("0 … {}", vertices - 1));
    any_area = any_area || has_area(mesh, face);
  }
  if (mesh.faces.size() < 2 || !any_area)
    throw_input_error("static mesh",
                      fmt::format("{} faces{}", mesh.faces.size(), any_area ? "" : " without area"),
                      "two or more, with an area");
}

}  // namespace lodestone
