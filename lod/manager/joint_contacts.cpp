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
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    const double reach = kReach * neighbors[i].shape->radius;
    rows.clear();
    find_joint_rows(bodies[i], reach, rows);
    if (rows.empty()) continue;
    if (index_of.empty())
      for (std::size_t k = 0; k < bodies.size(); ++k) index_of.emplace(bodies[k], std::int32_t(k));
    for (const JointRow& row : rows) {
      const auto second = row.second ? index_of.find(row.second) : index_of.end();
      if (row.second && second == index_of.end()) continue;  // without geoms: of no shape that is known
      for (const Vec3& normal : {row.direction, Vec3(-row.direction)})
        contacts.push_back({.first = std::int32_t(i),
                            .second = row.second ? second->second : -1,
                            .point = row.point + kToOneSide * reach * normal,
                            .normal = normal,
                            .gap = 0.0,
                            .friction = 0.0});
    }
  }
}

}  // namespace lodestone
