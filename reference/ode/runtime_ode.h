// ODE as a process-wide thing: started once, its data made for each thread, its messages counted, its shared
// state locked. Headers named *_ode.h are the only ones that include ODE; no header outside this family
// includes them.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <mutex>
#include <string>

namespace lodestone::ode {

/// Starts ODE on the first call of the process and makes its data for the calling thread on the first call of
/// each thread. From then on ODE's messages are counted and no longer printed; where the caller had set a
/// handler it is still called.
void prepare();

/// Messages that ODE raised on the calling thread since the process began. A world steps on its caller's
/// thread alone, so the difference over a step is that world's own.
std::int64_t messages_of_this_thread();
/// Also where the caller has set a handler of his own since: that goes on to be told.
void count_messages();

/// Debian's ODE keeps one process-wide cache for its trimesh colliders (ODE_EXT_mt_collisions is off): hold
/// this around every dCollide that involves a trimesh, with a plane too, whose collider notes there which
/// vertices it has used.
std::mutex& trimesh_mutex();

/// Thrown out of ODE by one of its own assertions or errors, while a RecoverableScope of the thread lasts.
struct AssertionFailed {
  std::string message;  ///< ODE's
};

/// While it lasts, an assertion or error inside ODE on this thread throws AssertionFailed instead of ending
/// the process. For calls that leave nothing half-changed, such as dCollide of two trimeshes, or after which
/// the world is used no more.
class RecoverableScope {
 public:
  RecoverableScope();
  ~RecoverableScope();
  RecoverableScope(const RecoverableScope&) = delete;
  RecoverableScope& operator=(const RecoverableScope&) = delete;

 private:
  const bool before_;  // one may lie within another
};

/// Whether a geom has a place of its own. Planes have none, nor height fields that were made without, which
/// are at the origin and not turned: ODE has no word for those, but an assertion where one asks for their
/// place.
bool is_placeable(dGeomID geom);

/// Holds ODE's process-wide random generator for one scope, seeded by `seed`, and gives it back as it was
/// found.
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed);
  ~SeededRandom();

 private:
  std::scoped_lock<std::mutex> lock_;
  unsigned long before_;
};

/// A world's step runs on its caller's thread alone, with nothing shared with other worlds.
class StepThreading {
 public:
  explicit StepThreading(dWorldID world);
  ~StepThreading();
  /// After a step that was left half-way, whose jobs it still has: ODE would not have it freed, and it is
  /// left behind.
  void abandon() { threading_ = nullptr; }
  StepThreading(const StepThreading&) = delete;
  StepThreading& operator=(const StepThreading&) = delete;

 private:
  dWorldID world_;
  dThreadingImplementationID threading_;
};

}  // namespace lodestone::ode
