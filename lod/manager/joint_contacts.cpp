#include "lod/manager/joint_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "reference/ode/body_joints.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

constexpr double kReach = 0.5;      // over R
constexpr double kToOneSide = 0.1;  // of that: along its normal, so that loads are remembered for each

// Rows are counted from the oldest joint on, which ODE lists last: those that come change no number.
constexpr std::uint32_t kMotors = 1U << 16, kStops = 1U << 18, kByHolders = 1U << 20;

class JointContacts {
 public:
  JointContacts(std::span<const FullNeighbor> neighbors, std::span<dxBody* const> bodies,
                std::vector<FullContact>& contacts)
      : neighbors_(neighbors), bodies_(bodies), contacts_(contacts) {}

  void add_all() {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!has_joints(bodies_[i])) continue;
      if (index_of_.empty())
        for (std::size_t k = 0; k < bodies_.size(); ++k) index_of_.emplace(bodies_[k], std::int32_t(k));
      add_of(i);
      for (dxBody* const other : joined_bodies(bodies_[i]))
        if (other && holds_fast(other, bodies_[i]) && !std::ranges::count(holders_, other))
          holders_.push_back(other);
    }
    for (dxBody* const body : holders_) add_of_holder(body);
  }

 private:
  // Of joints whose first body it is, or the only one; of those by which it holds others fast it is the
  // holder.
  void add_of(std::size_t i) {
    find(bodies_[i], reach_of(i));
    const auto is_holders = [&](dxBody* second) { return second && holds_fast(bodies_[i], second); };
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if (!is_holders(rows_[r].second))
        add(i, rows_[r].second, rows_[r].point, rows_[r].direction, std::uint32_t(rows_.size() - r), nullptr);
    for (std::size_t m = 0; m < motors_.size(); ++m)
      if (!is_holders(motors_[m].second))
        add(i, motors_[m].second, motors_[m].point, motors_[m].direction,
            kMotors + std::uint32_t(motors_.size() - m), &motors_[m]);
    for (std::size_t s = 0; s < stops_.size(); ++s)
      if (!is_holders(stops_[s].second))
        add_one_way(i, stops_[s].second, stops_[s].point, stops_[s].direction, stops_[s].gap,
                    2 * (kStops + std::uint32_t(stops_.size() - s)));
  }

  // Of joints whose first body it is; those that it is the second of are their first body's.
  void add_of_holder(dxBody* body) {
    find(body, reach_about(body));
    each_held(body, rows_, [&](std::size_t held, const JointRow& row, std::uint32_t number) {
      add(held, body, row.point, row.direction, kByHolders + number, nullptr);
    });
    each_held(body, motors_, [&](std::size_t held, const JointMotor& motor, std::uint32_t number) {
      add(held, body, motor.point, -motor.direction, kByHolders + kMotors + number, &motor);
    });
    each_held(body, stops_, [&](std::size_t held, const JointStop& stop, std::uint32_t number) {
      add_one_way(held, body, stop.point, -stop.direction, stop.gap, 2 * (kByHolders + kStops + number));
    });
  }

  /// Of those of `holder`: `visit(held, of it, number)` where the second is a neighbour that it holds.
  template <class Of, class Visit>
  void each_held(dxBody* holder, const std::vector<Of>& all, const Visit& visit) const {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (const auto held = index_of_.find(all[i].second);
          held != index_of_.end() && holds_fast(holder, all[i].second))
        visit(std::size_t(held->second), all[i], std::uint32_t(all.size() - i));
  }

  void find(dxBody* body, double reach) {
    rows_.clear(), motors_.clear(), stops_.clear();
    find_joint_rows(body, reach, rows_);
    find_joint_motors(body, reach, motors_);
    find_joint_stops(body, reach, stops_);
  }

  // What holds fast does so as ground that moves; others that are no neighbours are of no shape that is
  // known.
  void add(std::size_t first, dxBody* other, const Vec3& point, const Vec3& direction, std::uint32_t number,
           const JointMotor* motor) {
    for (const double sign : {1.0, -1.0}) {
      FullContact* const contact = add_one_way(first, other, point, sign * direction, 0.0,
                                               sign > 0.0 ? 2 * number + 1 : 2 * number + 2);
      if (contact && motor) contact->drive = Drive{.speed = sign * motor->speed, .force = motor->force};
    }
  }

  FullContact* add_one_way(std::size_t first, dxBody* other, const Vec3& point, const Vec3& direction,
                           double gap, std::uint32_t row) {
    const auto second = other ? index_of_.find(other) : index_of_.end();
    const bool holds = other && holds_fast(other, bodies_[first]),
               is_known = second != index_of_.end() && !holds;
    Vec3 velocity = Vec3::Zero();
    if (other && !is_known) {
      if (!holds) return nullptr;
      const RigidState state = callers::state(other);
      velocity = state.velocity + state.angular_velocity.cross(point - state.position);
    }
    return &contacts_.emplace_back(FullContact{.first = std::int32_t(first),
                                               .second = is_known ? second->second : -1,
                                               .point = point + kToOneSide * reach_of(first) * direction,
                                               .normal = direction,
                                               .gap = gap,
                                               .friction = 0.0,
                                               .velocity = velocity,
                                               .row = row});
  }

  double reach_of(std::size_t i) const { return kReach * neighbors_[i].shape->radius; }

  // Of the smallest that a holder holds.
  double reach_about(dxBody* holder) const {
    double reach = std::numeric_limits<double>::infinity();
    for (dxBody* const other : joined_bodies(holder))
      if (const auto held = index_of_.find(other); held != index_of_.end() && holds_fast(holder, other))
        reach = std::min(reach, reach_of(std::size_t(held->second)));
    return std::isfinite(reach) ? reach : 0.0;
  }

  std::span<const FullNeighbor> neighbors_;
  std::span<dxBody* const> bodies_;
  std::vector<FullContact>& contacts_;
  std::unordered_map<dxBody*, std::int32_t> index_of_;
  std::vector<JointRow> rows_;
  std::vector<JointMotor> motors_;
  std::vector<JointStop> stops_;
  std::vector<dxBody*> holders_;
};

}  // namespace

void add_joint_contacts(std::span<const FullNeighbor> neighbors, std::span<dxBody* const> bodies,
                        std::vector<FullContact>& contacts) {
  JointContacts(neighbors, bodies, contacts).add_all();
}

}  // namespace lodestone
