// Stage 3b, the broad phase: who is near whom, on all rungs. One set of cells holds the balls of all that
// move: awake spheres, awake bodies of `support`, full ones; those that sleep are looked up in their store.
// Pairs of spheres stay with the tables level; all others are near pairs of hulls, and spheres among them
// become guests there.
//
// Its files: near_search.cpp has the cells and the pairs of all that moves; near_search_sleepers.cpp those
// with sleepers; near_search_rooms.cpp the steps in which nobody can be near anybody; near_search_woken.cpp
// those who wake within the step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/broad_phase/ball_way.h"
#include "lod/broad_phase/cell_grid.h"
#include "lod/rungs/known_sleepers.h"
#include "lod/rungs/lone_rooms.h"
#include "lod/rungs/near_pairs.h"
#include "lod/statistical/full_neighbor.h"
#include "lod/statistical/sleepers.h"
#include "lod/support/support_level.h"
#include "lod/tables/tables_level.h"
#include "reference/state_archive.h"

namespace lodestone {

class NearSearch {
 public:
  /// `sleepers` must outlive it.
  NearSearch(const StatisticalSettings& settings, const Sleepers& sleepers, const JobRunner& jobs)
      : gravity_(settings.gravity),
        properties_(settings.properties),
        pair_filter_(settings.pair_filter),
        sleepers_(sleepers),
        threads_(settings.threads),
        jobs_(jobs),
        cells_(settings.simd),
        woken_cells_(settings.simd) {}

  /// Puts all that move into cells, for a step of `dt` s. `drift` (m/s): see find_drift(); the tables
  /// level began its step with the same.
  void fill(double dt, const Vec3& drift, TablesLevel& tables, const SupportLevel& support,
            std::span<const FullNeighbor> neighbors);
  /// The contacts of spheres, then the near pairs of all others; spheres among these are guests().
  void find(TablesLevel& tables, SupportLevel& support, std::span<const FullNeighbor> neighbors);
  /// Of bodies that were woken, or left their balls, `elapsed` s after the step's beginning: the near pairs
  /// that were not known before. Guests stay who they are. Adds them to pairs().
  std::span<const NearPair> find_woken(double elapsed, const SupportLevel& support,
                                       std::span<const FullNeighbor> neighbors,
                                       std::span<const Participant> woken);
  struct Ball {
    Vec3 center;                   // m
    float reach;                   // m
    Vec3 half_way = Vec3::Zero();  // m: of what is at the centre halfway
    BallWay way() const { return {center, half_way, double(reach) - half_way.norm()}; }
  };
  /// Within which a hull stays until the step ends, if nothing strikes it, in the frame that goes with the
  /// drift from the step's beginning on: with whoever may come there it is near. How the hull is `elapsed` s
  /// after that.
  Ball ball_of(const Vec3& position, const Vec3& velocity, double radius, double elapsed) const;
  Ball ball_of(const FullNeighbor& body, double elapsed) const;
  const Vec3& drift() const { return drift_; }     ///< m/s
  bool any_passed() const { return any_passed_; }  ///< two on long ways that are not near each other for that
  void clear();
  void set_gravity(const Vec3& gravity) { gravity_ = gravity; }
  void set_threads(int threads) { threads_ = threads; }
  /// Spheres that one plane of the ground does not hold become guests, too; after find() or clear().
  void invite_cornered(const TablesLevel& tables, const SupportLevel& support);

  std::span<const NearPair> pairs() const { return pairs_; }
  std::span<Guest> guests() { return guests_; }
  std::span<const Guest> guests() const { return guests_; }
  /// Of the awake spheres, in the cells; none where nobody was near another.
  std::span<const std::uint32_t> order_of_spheres() const {
    if (!any_near_) return {};
    return mixed_ ? order_ : cells_.order();
  }
  std::size_t bytes() const { return cells_.bytes(); }
  /// Of what it found only the order of spheres counts for the next step.
  void archive(StateArchive& a) {
    std::vector<std::uint32_t> order(order_of_spheres().begin(), order_of_spheres().end());
    a(order);
    if (!a.reading()) return;
    order_ = std::move(order);
    mixed_ = any_near_ = true;
    rooms_.give_up(), known_sleepers_.clear(), lone_spheres_.clear();
  }

 private:
  static constexpr double kBall = 1.02;   // over R: of the ball about a hull
  static constexpr int kMostShares = 16;  // into which the work of filling the cells is divided

  /// A body by its place, which is how they are put in order.
  struct Placed {
    double x, y, z;  // m
    std::int32_t index;
    friend bool operator<(const Placed& a, const Placed& b) {
      if (a.x != b.x) return a.x < b.x;
      if (a.y != b.y) return a.y < b.y;
      return a.z != b.z ? a.z < b.z : a.index < b.index;
    }
  };
  static void sort_nearly_sorted(std::vector<Placed>& placed);
  void add_hull_balls(std::span<const StatisticalBody> bodies, const SupportLevel& support,
                      std::span<const FullNeighbor> neighbors);
  Ball at_rest(const Ball& ball) const;
  Ball ball_at_rest(std::size_t ball) const {
    return at_rest({Vec3(x_[ball], y_[ball], z_[ball]), reach_[ball]});
  }
  void add_ball(const Ball& ball);
  void fill_cells(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                  std::span<const float> reach, const CellGrid::Lent& lent);
  void fill_mixed(const TablesLevel& tables, const SupportLevel& support,
                  std::span<const FullNeighbor> neighbors);
  void take_movers(const SupportLevel& support);
  void sort_movers(std::span<const StatisticalBody> bodies);
  void sort_by_place(std::span<const StatisticalBody> bodies, std::vector<std::int32_t>& indices) const;
  static double hull_reach(const TablesLevel& tables, std::int64_t place, double reach);
  bool stay_apart(const TablesLevel& tables, const SupportLevel& support);
  bool find_rooms(const TablesLevel& tables, const SupportLevel& support);
  bool is_near_sleepers(const Vec3& center, double reach, const TablesLevel& tables,
                        const SupportLevel& support) const;
  void note_order(std::size_t spheres);
  void find_ball_pairs();
  void add_pair(std::uint32_t first, std::uint32_t second, const TablesLevel& tables);
  bool meet(std::uint32_t first, std::uint32_t second) const;
  bool pass(std::uint32_t first, std::uint32_t second) const;
  bool lets_meet(std::uint32_t first, std::uint32_t second) const;
  // Those from that one on that may not meet, by owner(participant), are none.
  template <class Owner>
  void filter_pairs(std::size_t from, const Owner& owner) {
    if (!pair_filter_ && (!properties_ || properties_->empty())) return;
    const auto kept = std::remove_if(
        pairs_.begin() + std::ptrdiff_t(from), pairs_.end(),
        [&](const NearPair& pair) { return !lets_meet(owner(pair.first), owner(pair.second)); });
    pairs_.erase(kept, pairs_.end());
  }
  void find_partners(const Ball& ball, const SupportLevel& support);
  Participant participant(std::uint32_t ball, const TablesLevel& tables);
  Participant guest(std::int32_t slot);
  void forget_guests();
  void find_sleeper_pairs(const SupportLevel& support, std::span<const FullNeighbor> neighbors,
                          const TablesLevel& tables);
  /// Calls `found` for the sleepers of `support` whose balls meet this one.
  template <class Found>
  void each_sleeping_hull(const Vec3& center, double reach, const SupportLevel& support,
                          const Found& found) const {
    const std::span<const StatisticalBody> bodies = support.bodies();
    sleepers_.of(StatisticalModel::support).find_near(center, reach, [&](std::uint32_t slot) {
      const double limit = reach + kBall * support.kind_of(bodies[slot]).shape->radius;
      if ((bodies[slot].position - center).squaredNorm() < limit * limit) found(std::int32_t(slot));
    });
  }
  /// The same for the sleepers of `tables`.
  template <class Found>
  void each_sleeping_sphere(const Vec3& center, double reach, const TablesLevel& tables,
                            const Found& found) const {
    sleepers_.of(StatisticalModel::tables).find_near(center, reach, [&](std::uint32_t slot) {
      const double limit = reach + kBall * tables.radius(int(slot));
      if ((tables.position(int(slot)) - center).squaredNorm() < limit * limit) found(std::int32_t(slot));
    });
  }
  bool add_known_sleeper_pairs(std::size_t ball, const SupportLevel& support);
  void add_sleeper_pairs(Participant self, std::span<const StatisticalBody> bodies);
  void find_pairs_of_woken_spheres(const TablesLevel& tables);
  void find_sleeping_hulls_near_spheres(const SupportLevel& support, const TablesLevel& tables);

  Vec3 gravity_;
  const OwnProperties* properties_;
  std::function<bool(std::uint32_t, std::uint32_t)> pair_filter_;
  const Sleepers& sleepers_;
  int threads_;
  JobRunner jobs_;
  CellGrid cells_;

  double dt_ = 0.0;            // s
  Vec3 drift_ = Vec3::Zero();  // m/s

  // Balls, in the frame of the drift: the awake spheres by place, then movers_, then full neighbours.
  std::vector<double> x_, y_, z_;   // m
  std::vector<float> reach_;        // m: how far its hull may reach in this step
  std::vector<float> drawn_reach_;  // m: of its ball in the cells
  std::vector<Vec3> half_way_;      // m: of those in movers_
  std::size_t spheres_ = 0;
  std::vector<std::int32_t> movers_;  // indices of bodies that move, by place
  std::vector<Placed> placed_;        // the same
  std::vector<char> kept_;            // of those awake: whether they moved before
  LoneRooms rooms_;
  std::vector<std::int32_t> lone_spheres_;  // slots: of those with rooms that have not fallen asleep in them
  KnownSleepers known_sleepers_;
  bool apart_ = false;  // in this step no mover is near anybody, by rooms_
  bool any_passed_ = false;
  bool any_near_ = false;          // movers whose balls meet, in the step before until find()
  bool mixed_ = false;             // spheres and others
  std::vector<BallPairs> others_;  // of parts of the cells: pairs that are not of two spheres
  BallPairs ball_pairs_;
  std::vector<std::uint32_t> order_;
  std::vector<NearPair> pairs_;
  std::vector<Guest> guests_;
  std::vector<std::int32_t> guest_of_slot_;  // of spheres; −1: none
  std::size_t own_bodies_ = 0;               // of `support`: guests follow these
  std::vector<std::int32_t> sleepers_near_;  // slots, of the body at hand

  // Woken in this step, all of them, and their balls.
  std::vector<Participant> woken_;
  std::vector<double> woken_x_, woken_y_, woken_z_;  // m
  std::vector<float> woken_reach_;                   // m
  CellGrid woken_cells_;
  // Of those at hand.
  std::vector<Participant> new_, partners_;
  std::vector<NearPair> known_;  // with these, the lower one first
};

}  // namespace lodestone
