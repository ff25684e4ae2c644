// The bodies of a manager: stable ids, and for each body what the policy reads apart from what only a change
// of level needs. What few bodies have at a time is kept for those alone.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lod/body.h"
#include "lod/manager/choose_levels.h"
#include "lod/rungs/statistical_level.h"
#include "lod/statistical/own_properties.h"
#include "reference/ode/ode_world.h"
#include "reference/state_archive.h"

namespace lodestone {

/// What is kept of a body besides its state, which its rung holds: on one of the statistical rungs, at the
/// full level, or nowhere yet.
struct BodyRecord {
  double mass = 0.0;             ///< kg
  std::uint64_t birth = 0;       ///< bodies added before it; 0 in a free index
  std::uint32_t generation = 0;  ///< of the id; a free index keeps that of its last body
  std::uint32_t shape = 0;       ///< number of its shape
  MaterialId material = 0;
  std::int32_t newcomer = -1;         ///< its place among the newcomers; −1: it is on a rung
  StatisticalPlace statistical = {};  ///< nowhere while it is full
  OdeBodyId ode = {};                 ///< at the full level, else null
  std::uintptr_t user_data = 0;
};

/// What the policy goes by, besides where the body is.
struct BodyLevel {
  static constexpr std::int64_t kLongAgo = -(std::int64_t(1) << 30);
  double importance = 1.0;
  std::int64_t changed_at = kLongAgo;  ///< step
  std::int64_t woke_at = kLongAgo;     ///< step, or the last in which it was seen asleep; under a budget
  std::int64_t looked_at = -1;         ///< step in which the policy last thought of it
  LevelChoice choice = LevelChoice::statistical;
  Rung rung = Rung::support;
  Rung least = Rung::tables, greatest = Rung::full;
  Rule reason = Rule::forced;
  bool newcomer = false;  ///< on no rung yet
  bool put_off = false;   ///< its promotion was put off lately
  /// Until that is there it is at `support` without settling clips, or full.
  bool waits_for_signature = false;
  bool own_properties = false;  ///< that `tables` knows nothing of
  /// Whether it has the signature that `tables` needs; −1: that was not asked for yet.
  std::int8_t tables_open = -1;
};

class BodyTable {
 public:
  BodyId add(const BodyDefinition& definition, double mass);
  /// Its index is given again only once reuse_indices() was called: until a step has been done without the
  /// body, what is remembered of its contacts goes by the index.
  void remove(BodyId id);
  void reuse_indices();

  bool valid(BodyId id) const {
    return id && id.index < records_.size() && records_[id.index].generation == id.generation &&
           records_[id.index].birth;
  }
  /// The index of a body; throws InputError where the id is not valid.
  std::uint32_t index_of(BodyId id) const;
  BodyId id(std::uint32_t index) const { return {index, records_[index].generation}; }
  bool alive(std::uint32_t index) const { return records_[index].birth != 0; }

  BodyRecord& operator[](std::uint32_t index) { return records_[index]; }
  const BodyRecord& operator[](std::uint32_t index) const { return records_[index]; }
  /// That of a free index asks for nothing.
  BodyLevel& level(std::uint32_t index) { return levels_[index]; }
  const BodyLevel& level(std::uint32_t index) const { return levels_[index]; }
  const std::shared_ptr<const Shape>& shape(std::uint32_t index) const {
    return shapes_[records_[index].shape].shape;
  }

  void set_choice(std::uint32_t index, LevelChoice choice);
  /// Bodies of a choice.
  int count(LevelChoice choice) const { return counts_[std::size_t(choice)]; }
  void set_importance(std::uint32_t index, double importance);
  const BodyProperties& properties(std::uint32_t index) const { return properties_.of(index); }
  void set_properties(std::uint32_t index, const BodyProperties& properties);
  const OwnProperties& own_properties() const { return properties_; }
  /// Of a body of the caller's, which is none of these.
  void set_bits(std::uint32_t owner, const GroundBits& bits) {
    BodyProperties properties;
    properties.category = bits.category, properties.collide = bits.collide;
    properties_.set(owner, properties);
  }
  /// The greatest that any body had.
  double greatest_importance() const { return greatest_importance_; }

  /// Bodies on no rung yet, in order of creation, as they were given; and places of some that are gone
  /// (waits_at).
  struct Newcomer {
    std::uint32_t index = 0;
    RigidState state;
    Rung rung = Rung::support;  // that it shall have where it is not full
    bool asleep = false;
  };
  const std::vector<Newcomer>& newcomers() const { return newcomers_; }
  Newcomer& newcomer(std::uint32_t index) { return newcomers_[std::size_t(records_[index].newcomer)]; }
  const Newcomer& newcomer(std::uint32_t index) const {
    return newcomers_[std::size_t(records_[index].newcomer)];
  }
  bool waits_at(std::size_t place) const {
    return records_[newcomers_[place].index].newcomer == std::int32_t(place);
  }  ///< not if it was placed since
  void remove_newcomer(std::uint32_t index);
  void forget_last_newcomer() { newcomers_.pop_back(); }  ///< once it is on a rung
  void forget_newcomers();                                ///< those that are on a rung

  /// Over the next step; held here so that a change of level carries it.
  struct Force {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  // N, N m
  };
  /// Throws InputError where the sum would not be finite.
  void add_force(std::uint32_t index, const Force& force);
  void drop_force(std::uint32_t index);
  Force force(std::uint32_t index) const;
  /// Bodies with a force, in the order in which they got the first.
  std::vector<std::uint32_t> pushed() const;
  void clear_forces();
  /// All that are held, to be held again for the next part of a step that is divided.
  struct Forces {
    std::vector<std::pair<std::uint32_t, Force>> held;
  };
  Forces forces() const;
  void hold(const Forces& forces);

  void archive(StateArchive& a);

  int size() const { return int(records_.size() - free_.size() - removed_.size()); }
  std::uint32_t indices() const { return std::uint32_t(records_.size()); }
  std::vector<std::uint32_t> in_order_of_creation() const;

 private:
  struct SharedShape {
    std::shared_ptr<const Shape> shape;
    std::uint32_t bodies = 0;
    void archive(StateArchive& a) { a(shape, bodies); }
  };
  std::uint32_t share(const std::shared_ptr<const Shape>& shape);
  void give_back(std::uint32_t shape);

  std::vector<BodyRecord> records_;
  std::vector<BodyLevel> levels_;
  std::vector<std::uint32_t> free_, removed_;  // indices; `removed_`: free after the next step
  std::vector<SharedShape> shapes_;
  std::vector<std::uint32_t> free_shapes_;
  std::unordered_map<const Shape*, std::uint32_t> number_of_shape_;
  std::vector<Newcomer> newcomers_;
  std::size_t newcomers_gone_ = 0;  // of these, removed since
  struct Held {
    Force sum;
    std::size_t place = 0;  // in pushed_
    void archive(StateArchive& a) { a(sum); }
  };
  static constexpr std::uint32_t kDropped = ~std::uint32_t(0);
  std::unordered_map<std::uint32_t, Held> forces_;
  std::vector<std::uint32_t> pushed_;  // bodies with a force, and kDropped where one was dropped
  OwnProperties properties_;
  std::uint64_t births_ = 0;
  std::array<int, 5> counts_{};  // of each choice
  double greatest_importance_ = 1.0;
};

}  // namespace lodestone
