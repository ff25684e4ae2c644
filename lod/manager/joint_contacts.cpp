#include "lod/manager/joint_contacts.h"

#include <unordered_map>

#include "reference/ode/body_joints.h"

namespace lodestone {

void add_joint_contacts(std::span<const FullNeighbor> neighbors, std::span<dxBody* const> bodies,
                        std::vector<FullContact>& contacts) {
  constexpr double kReach = 0.5;      // over R
  constexpr double kToOneSide = 0.1;  // of that: along its normal, so that loads are remembered for each
  std::unordered_map<dxBody*, std::int32_t> index_of;
  std::vector<JointRow> rows;
  std::vector<JointMotor> motors;
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    const double reach = kReach * neighbors[i].shape->radius;
    rows.clear(), motors.clear();
    find_joint_rows(bodies[i], reach, rows);
    find_joint_motors(bodies[i], reach, motors);
    if (rows.empty() && motors.empty()) continue;
    if (index_of.empty())
      for (std::size_t k = 0; k < bodies.size(); ++k) index_of.emplace(bodies[k], std::int32_t(k));
    const auto add = [&](dxBody* other, const Vec3& point, const Vec3& direction, std::uint32_t number,
                         const JointMotor* motor) {
      const auto second = other ? index_of.find(other) : index_of.end();
      if (other && second == index_of.end()) return;  // without geoms: of no shape that is known
      for (const double sign : {1.0, -1.0}) {
        FullContact& contact =
            contacts.emplace_back(FullContact{.first = std::int32_t(i),
                                              .second = other ? second->second : -1,
                                              .point = point + sign * kToOneSide * reach * direction,
                                              .normal = sign * direction,
                                              .gap = 0.0,
                                              .friction = 0.0,
                                              .row = sign > 0.0 ? 2 * number + 1 : 2 * number + 2});
        if (motor) contact.drive = Drive{.speed = sign * motor->speed, .force = motor->force};
      }
    };
    // Counted from the oldest joint on, which ODE lists last: those that come change no number.
    constexpr std::uint32_t kMotors = 1U << 16;
    for (std::size_t r = 0; r < rows.size(); ++r)
      add(rows[r].second, rows[r].point, rows[r].direction, std::uint32_t(rows.size() - r), nullptr);
    for (std::size_t m = 0; m < motors.size(); ++m)
      add(motors[m].second, motors[m].point, motors[m].direction, kMotors + std::uint32_t(motors.size() - m),
          &motors[m]);
  }
}

}  // namespace lodestone
