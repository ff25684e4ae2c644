// What the last step changed, body by body: who moved, fell asleep, woke, changed rung. Costs in proportion
// to those concerned, never to all bodies.
#pragma once

#include <mutex>
#include <span>
#include <vector>

#include "lod/manager/levels.h"
#include "reference/state_archive.h"

namespace lodestone {

class StepChanges {
 public:
  explicit StepChanges(Levels& levels) : levels_(levels) {}

  /// A step begins: nothing has changed yet.
  void begin();
  /// After the changes of rung of a part, before anything moves.
  void note_promoted();
  /// After each part of a step that is divided.
  void take_part();
  void finish();
  /// Of a new body.
  void add(std::uint32_t body);
  /// The caller laid it to sleep, or woke it.
  void note(std::uint32_t body) { noted_.push_back(body); }

  /// Forgets the last step where it reads.
  void archive(StateArchive& a) {
    a(slept_, noted_, lies_at_, levels_.rung_changes);
    if (a.reading()) noted_changes_ = 0, begin();
  }

  std::span<const BodyId> moved() const;
  /// Before anything is woken, laid to sleep, added or removed between steps.
  void keep_moved() const { moved(); }
  std::span<const BodyId> fell_asleep() const { return fell_asleep_; }
  std::span<const BodyId> woke() const { return woke_; }
  std::span<const BodyId> moved_and_slept() const {
    return moved_and_slept_;
  }  ///< woke in the step and fell asleep again
  std::span<const RungChange> rung_changes() const { return rung_changes_; }

 private:
  void find_moved() const;

  Levels& levels_;
  std::vector<char> slept_;    // at the end of the last step, by index
  std::vector<Vec3> lies_at_;  // m, by index: where full ones were; ODE may wake one within the step, and lay
                               // it to sleep again
  std::size_t noted_changes_ = 0;       // of rung, by note_promoted()
  std::vector<std::uint32_t> noted_;    // who may have woken or fallen asleep since
  std::vector<std::uint32_t> settled_;  // who fell asleep in some part of the step
  std::vector<BodyId> fell_asleep_, woke_;
  std::vector<BodyId> moved_and_slept_;
  std::vector<RungChange> rung_changes_;
  // Found when first asked for.
  mutable std::mutex access_;
  mutable bool moved_known_ = true;
  mutable std::vector<BodyId> moved_;
};

}  // namespace lodestone
