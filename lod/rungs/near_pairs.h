// Stage 3d: which of the bodies that may meet in a step do touch: of `support`, full ones, and those of
// `tables` near them. What is known of a pair is kept from step to step. Bodies meet as their hulls, whatever
// their rung: spheres are for two of `tables`, which meet by themselves (tables/).
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/crowd.h"
#include "lod/contact/pair_memory.h"
#include "lod/jobs.h"
#include "lod/rungs/near_marks.h"
#include "reference/state_archive.h"

namespace lodestone {

using NearPair = std::pair<Participant, Participant>;

/// Two bodies, in the order in which the search looks at them.
struct PlacedPair {
  ContactKey key = 0;
  Participant first = Participant::ground(), second = Participant::ground();
};

/// What is known of a near pair. A gap is known to remain until the bodies have moved by as much, so for most
/// near pairs no hulls are searched (conservative advancement; Mirtich, Impulse-based dynamic simulation of
/// rigid body systems, 1996). A contact is kept while the bodies move little.
struct FoundPair : PlacedPair {
  double gap = 0.0;  ///< m, lower bound when it was found: holds while find_motion_since(*when) is less
  std::optional<PairPose> when;              ///< how the bodies lay then; none: it was never looked for
  HullGap whole = {.normal = Vec3::Zero()};  ///< see find_pair_contacts
  std::vector<KnownGap> of_pieces;           ///< see find_pair_contacts
  std::vector<HeldContact> contacts;

  void archive(StateArchive& a) { a(key, first, second, gap, when, whole, of_pieces, contacts); }
  void stand_for(const PlacedPair& pair) { static_cast<PlacedPair&>(*this) = pair; }
  void forget() {
    when.reset();
    whole = {.normal = Vec3::Zero()};
    of_pieces.clear();
    contacts.clear();
  }
};

class NearPairs {
 public:
  explicit NearPairs(JobRunner jobs) : jobs_(std::move(jobs)) {}

  /// Takes the pairs of a step, and keeps what is known of those that were near before.
  void take(const ContactScene& scene, std::span<const NearPair> pairs);
  /// Adds pairs in the same step, of which nothing is known, for find_more_contacts().
  void add(const ContactScene& scene, std::span<const NearPair> pairs);
  void clear();
  void archive(StateArchive& a);
  void make_room(std::size_t bodies) { turning_.resize(std::max(turning_.size(), bodies)); }
  std::size_t size() const { return found_.size(); }
  const FoundPair& operator[](std::size_t i) const { return all_[found_[i]]; }

  /// Computes how fast each of these bodies (indices) turns: before its contacts are looked for.
  void find_turning(const ContactScene& scene, std::span<const std::int32_t> bodies);
  /// For a body that was just woken.
  void clear_turning(Participant p) { turning_[p.index()] = {}; }
  /// Chooses the pairs for find_contacts(): those of which a body moves at `pace`.
  void choose(const NearMarks& near, Pace pace);
  /// Finds the contacts of the chosen pairs that may close within `time` seconds. Bodies of these pairs must
  /// move at `pace` or sleep. Marks the bodies of a contact as crowded, and gives them the pace; other bodies
  /// of `movers` are then not crowded.
  void find_contacts(const ContactScene& scene, double time, std::span<const std::int32_t> movers,
                     NearMarks& near, Pace pace);
  /// Does the same for pairs that were added since.
  void find_more_contacts(const ContactScene& scene, double time, NearMarks& near, Pace pace);
  /// The contacts that these two found.
  std::span<const CrowdContact> contacts() const { return std::span(contacts_).subspan(kept_contacts_); }
  /// Keeps the contacts of islands that have gone through their substeps, while those of others are found.
  void keep_contacts() { kept_contacts_ = contacts_.size(); }
  /// The contacts of all islands, as their last substeps left them.
  std::span<const CrowdContact> all_contacts() const { return contacts_; }
  void forget_contacts() { contacts_.clear(), kept_contacts_ = 0; }

  /// m: by how much at most the gap of a pair can shrink in `time` seconds, if nothing strikes the two.
  double find_approach(const ContactScene& scene, const FoundPair& pair, double time) const;
  /// m: a lower bound of the gap of a pair now; 0 if it was never looked for.
  double gap_left(const ContactScene& scene, const FoundPair& pair) const;
  /// rad/s, world: angular velocity.
  Vec3 turning_of(const ContactScene& scene, Participant p) const;
  /// m/s, of a point that goes with the body.
  Vec3 point_velocity(const ContactScene& scene, Participant p, const Vec3& point) const;

 private:
  static constexpr std::int64_t kBlock = 64;  // pairs or bodies of a job

  /// How fast a body turns.
  struct Turning {
    Vec3 angular_velocity = Vec3::Zero();  // rad/s, world
    double rim_speed = 0.0;                // m/s: of the point farthest from the centre about it
  };

  static PlacedPair place(const ContactScene& scene, const NearPair& pair);
  std::uint32_t take_place();
  void put_in_order();
  void find_contact(const ContactScene& scene, double time, Pace pace, FoundPair& pair) const;
  void follow_contacts(const ContactScene& scene, double time, std::span<const std::uint32_t> pairs,
                       NearMarks& near, Pace pace);
  Enough find_reach(const ContactScene& scene, double time, const FoundPair& pair) const;
  static bool stay_apart(const FoundPair& pair, const PairBody& first, const PairBody& second,
                         const Enough& reach);
  double find_approach_by_turning(const ContactScene& scene, const FoundPair& pair, double time) const;
  bool closes(const ContactScene& scene, const FoundPair& pair, const PairContact& contact,
              double time) const;

  JobRunner jobs_;
  PairMemory memory_;           // places in before_
  std::vector<FoundPair> all_;  // in no order; a pair stays where it is while its bodies are near
  std::vector<std::uint32_t> found_,
      before_;  // places in all_ of the pairs of this step and, while it takes its own, of the last one
  std::vector<std::uint32_t> spare_;      // places in all_ of none: what these have allocated serves others
  std::vector<PlacedPair> placed_;        // those of this step, in order
  std::vector<std::uint32_t> newcomers_;  // of this step, those that were not near in the last one
  std::vector<Turning> turning_;          // by index; of those awake
  std::vector<std::uint32_t> chosen_;     // places in all_
  std::size_t looked_at_ = 0;             // the first of them: whose contacts are among these
  std::vector<CrowdContact> contacts_;
  std::size_t kept_contacts_ = 0;             // the first of them
  std::vector<std::uint32_t> first_contact_;  // of each pair, among those that are looked at
  std::vector<char> may_close_;               // of each of these
};

/// m.
inline double least_radius(const ContactScene& scene, const FoundPair& pair) {
  return std::min(scene.shape(pair.first).radius, scene.shape(pair.second).radius);
}

}  // namespace lodestone
