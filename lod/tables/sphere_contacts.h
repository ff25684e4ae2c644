// Spheres that touch: found, and answered one after the other in an order that does not depend on threads
// (projected Gauss and Seidel), with impulses that are equal and opposite. What a contact gave in the last
// step it gives at once in this one, so that piles stand. A body's nearest plane is not here
// (sphere_ground.h), any other that it touches is.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "lod/broad_phase/cell_grid.h"
#include "lod/jobs.h"
#include "lod/tables/sphere_motion.h"
#include "reference/state_archive.h"

namespace lodestone {

/// Face on face, or on a plane: such bodies slide on each other and do not roll. Friction begins with what it
/// gave in the last step, so that stacks are carried along and hold on slopes.
struct FlushContact {
  std::size_t at = 0;      // in the other arrays
  lane::F3 friction = {};  // N s, on the first
};
inline constexpr std::int32_t kNotFlush = -1;

/// Contacts as dense arrays, of which the first `count` elements are taken.
struct ContactArrays {
  std::vector<std::uint32_t> first, second;  // places; beyond those awake: asleep, does not move
  std::vector<float> nx, ny, nz;             // from the second to the first
  std::vector<float> gap;                    // m, negative: overlap
  std::vector<float> closing;                // m/s at the start of the step, negative: nearing
  std::vector<float> impulse;                // N s
  std::vector<float> recalled;               // N s: what of it was known from the last step
  std::vector<std::int32_t> flush;           // which of the flush_contacts it is; kNotFlush: none of them
  std::vector<FlushContact> flush_contacts;
  std::vector<float> restitution, friction;  // of the two materials; empty where all bodies are of one kind
  std::size_t count = 0, lately = 0;         // taken; asked for at most, of late

  /// Calls `visit` with each array.
  template <class Visit>
  void each_array(const Visit& visit) const {
    visit(first), visit(second), visit(nx), visit(ny), visit(nz), visit(gap), visit(closing), visit(impulse),
        visit(recalled), visit(flush), visit(restitution), visit(friction);
  }
  /// Of all arrays at least.
  void make_room(std::size_t elements, bool one_kind);
  /// Takes none; where far fewer were asked for lately than there is room for, the room is given back.
  void clear();
};

/// Some of them, one after the other.
struct ContactRun {
  ContactArrays* arrays = nullptr;
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
};

/// Of a body with a plane, which is the second one under kGroundPlace.
struct PlaneTouch {
  std::uint32_t place = 0, plane = 0;
  lane::F3 normal = {};
  lane::F3 velocity = {};            // m/s, of the ground there
  float gap = 0.0f, closing = 0.0f;  // m, m/s
  bool flush = false;
  ContactLaw law = {};
};
inline constexpr std::uint32_t kGroundPlace = 1u << 31;

/// What a contact is.
struct SphereContact {
  std::uint32_t first, second;  // places; the latter from kGroundPlace on: planes
  float nx, ny, nz, gap, closing;
  float impulse;  // N s
};

/// One of a body's contacts of the last step.
struct KnownContact {
  std::uint32_t owner = 0;  // the other's
  float force = 0.0f;       // N
};

/// One of those few that are not in the part that holds all other contacts of their first body.
struct KnownApart {
  std::array<std::uint32_t, 2> owners{};
  float force = 0.0f;  // N
};

/// Of what lay face on face in the last step.
struct KnownFriction {
  std::array<std::uint32_t, 2> owners{};  // ascending
  lane::F3 force = {};                    // N, on the first
};

struct SphereContactSettings {
  int sweeps = 2,
      hull_sweeps = 6,        // rounds a step; of the paper's spheres, and of those that know their hulls
      most_hull_sweeps = 24;  // of the latter while contacts are not solved, as in a heap that lands
  float solved = 0.2f;        // over √(g R): by less a round changes all closing speeds
  float remembered = 1.0f,
        hull_remembered = 0.97f;  // the part of the last step's impulses that contacts begin with: of a body
                                  // that is wedged in, what presses from all sides would else add up for ever
  float touching = 0.01f;         // m over R: gaps up to it are contacts
  float slop = 0.002f,
        push_out = 0.5f;  // overlap that stays, over R; part of the rest that is undone in a step
  float parting = 0.1f;  // over √(g R): no faster than so where one of them is eased (parting.h), as spheres
                         // may overlap where hulls did not
  int deep_rounds = 3;  // further ones, of hulls, that undo push_out of what is deeper than
  float deep = 0.08f;   // over R
};

/// What a round of contacts left, or would have, at most.
struct SweepOutcome {
  float changed = 0.0f;  ///< m/s, of a closing speed
  float deepest = 0.0f;  ///< over R, of an overlap; of the last round alone
  void include(const SweepOutcome& other) {
    changed = std::max(changed, other.changed), deepest = std::max(deepest, other.deepest);
  }
};

class SphereContacts {
 public:
  /// Between awake bodies, with the impulses known from the last step; approaches faster than
  /// `bounce_velocity`, m/s, are impacts. Where the grid holds other balls behind the spheres, pairs with
  /// those go to `others`, part by part. `pass`, of two places: that they do not meet on their long ways.
  void find(const Spheres& spheres, const SphereKinds& kinds, const CellGrid& grid, float bounce_velocity,
            const StepConstants& constants, Simd simd, const JobRunner& jobs, std::vector<BallPairs>* others,
            const std::function<bool(std::uint32_t, std::uint32_t)>& pass = {});
  /// m/s, by place awake: what forces give in the step to come, which velocities have already; none where no
  /// force acts. Before find(); refers to it until the next call.
  void set_pushes(std::span<const Eigen::Vector3f> by_place) { pushes_ = by_place; }
  /// Of two owners: whether they may meet; empty: all. Called from several threads.
  void set_pair_filter(std::function<bool(std::uint32_t, std::uint32_t)> filter) {
    pair_filter_ = std::move(filter);
  }
  /// More, where the two touch: of an awake body with any other.
  void add(const Spheres& spheres, const SphereKinds& kinds,
           std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, float bounce_velocity,
           const StepConstants& constants, Simd simd);

  /// Those with planes. At most once a step, after find().
  void add_ground(const Spheres& spheres, std::span<const PlaneTouch> touches, float bounce_velocity,
                  const StepConstants& constants);

  /// Counts each body's contacts and gives the impulses known.
  void begin(const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials,
             const StepConstants& constants, SphereStep& step, const JobRunner& jobs);
  /// One round of all contacts; the last one has friction, moves bodies out of overlaps, and is remembered
  /// for the next step.
  SweepOutcome sweep(Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials,
                     float bounce_velocity, const StepConstants& constants, bool last, bool eased, Simd simd,
                     SphereStep& step, const JobRunner& jobs);
  /// After the last round: another look at overlaps that are too deep, in those parts that have some.
  void move_apart(const Spheres& spheres, const SphereKinds& kinds, SphereStep& step, const JobRunner& jobs);

  /// Calls `visit(run)` with runs of contacts that no other thread has bodies of at that time.
  template <class Visit>
  void each_run(const JobRunner& jobs, const Visit& visit) {
    run_by_colour(jobs, [&](const Part& part) { visit(part.run); });
  }

  void archive(StateArchive& a) { a(known_, known_apart_, known_friction_); }
  const SphereContactSettings& settings() const { return settings_; }
  std::int64_t count() const;
  bool any_near() const;                           ///< whether find() met any pair, of spheres or with others
  bool any_passed() const { return any_passed_; }  ///< whether find() asked who passes whom
  std::size_t bytes() const;
  /// Of a contact, in all its arrays.
  std::size_t bytes_each() const;
  template <class Visit>
  void each(const Visit& visit) const {
    for (std::size_t p = 0; p < used_parts_; ++p)
      for (std::size_t i = parts_[p].run.begin; i < parts_[p].run.end; ++i)
        visit(contact_of(*parts_[p].run.arrays, i));
  }
  /// Calls `visit(arrays, i, of_ground)` with where each contact is.
  template <class Visit>
  void each_place(const Visit& visit) {
    for (std::size_t p = 0; p < used_parts_; ++p)
      for (std::size_t i = parts_[p].run.begin; i < parts_[p].run.end; ++i)
        visit(*parts_[p].run.arrays, i, parts_[p].colour == kGroundColour);
  }
  void clear();

 private:
  struct Part {
    int colour = 0;
    bool any_near = false, any_passed = false;
    ContactRun run;
    std::uint32_t known_begin = 0;  // of its contacts in known_
    SweepOutcome outcome;           // of the last round
  };
  static SphereContact contact_of(const ContactArrays& c, std::size_t i) {
    return {c.first[i], c.second[i], c.nx[i], c.ny[i], c.nz[i], c.gap[i], c.closing[i], c.impulse[i]};
  }
  // A blow is none, nor what keeps two apart until they touch.
  static bool is_support(const ContactArrays& c, std::size_t i, float bounce_velocity, float time) {
    return (c.impulse[i] > 0.0f) & (c.closing[i] >= -bounce_velocity) & (c.gap[i] <= bounce_velocity * time);
  }
  float force_to_remember(const ContactArrays& c, std::size_t i, const StepConstants& constants) const;
  template <class Task>
  void run_by_colour(const JobRunner& jobs, const Task& task) {
    for (const auto& colour : of_colour_)
      if (!colour.empty())
        jobs(std::int64_t(colour.size()), TaskRef([&](std::int64_t i) {
               Part& part = parts_[colour[std::size_t(i)]];
               if (part.run.size() > 0) task(part);
             }));
  }
  ContactArrays& take_arrays();
  void put_back(ContactArrays& arrays);
  void set_laws(const ContactRun& run, const Spheres& spheres, const SphereKinds& kinds,
                const MaterialTable& materials) const;
  float known_force(const Spheres& spheres, std::uint32_t first, std::uint32_t second,
                    std::uint32_t nth) const;
  float find_known_force(const Spheres& spheres, std::uint32_t at, std::uint32_t other) const;
  float find_known_apart(std::uint32_t owner, std::uint32_t other) const;
  lane::F3 find_known_friction(std::uint32_t owner, std::uint32_t other, lane::F3 normal) const;
  float pressed(const ContactArrays& c, std::size_t i) const;
  void recall(const Spheres& spheres, float bounce_velocity, const StepConstants& constants,
              const ContactRun& run) const;
  void make_room_to_remember(Spheres& spheres);
  void remember(Spheres& spheres, float bounce_velocity, const StepConstants& constants, const Part& part);
  void remember_apart(const Spheres& spheres, float bounce_velocity, const StepConstants& constants);
  void remember_friction(const Spheres& spheres, float bounce_velocity, const StepConstants& constants);
  // Its contacts may be of first bodies that another part has contacts of, too.
  static bool is_apart(int colour) { return colour >= CellGrid::kColours - 1; }
  static constexpr int kStillColour = CellGrid::kColours, kGroundColour = CellGrid::kColours + 1;
  Part& still_part() { return parts_[used_parts_ - 2]; }
  Part& ground_part() { return parts_[used_parts_ - 1]; }
  /// A plane's is its number under kGroundPlace.
  static std::uint32_t owner_of(const Spheres& spheres, std::uint32_t place) {
    return place >= kGroundPlace ? place : spheres.owner[place];
  }

  SphereContactSettings settings_;
  std::span<const Eigen::Vector3f> pushes_;
  std::function<bool(std::uint32_t, std::uint32_t)> pair_filter_;
  std::vector<Part> parts_;  // the grid's, one for contacts that were added, and one for those with planes
  // As many arrays as parts were searched at once: room for the contacts of all parts together, not for as
  // many as each of them ever had.
  std::deque<ContactArrays> arrays_;
  std::vector<ContactArrays*> free_arrays_;
  std::mutex free_arrays_access_;
  std::size_t used_parts_ = 0;
  bool any_passed_ = false;
  std::array<std::vector<std::uint32_t>, kGroundColour + 1> of_colour_;
  std::vector<lane::Row> ground_velocities_;  // m/s, of each plane that is touched in this step
  std::vector<KnownContact> known_;
  std::vector<KnownApart> known_apart_;        // by owners
  std::vector<KnownFriction> known_friction_;  // by owners
};

}  // namespace lodestone
