// From what a step wrote down of its touches to events. Pairs of which both sleep are set aside and cost
// nothing until one of them wakes.
#pragma once

#include <compare>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "lod/events.h"
#include "lod/manager/levels.h"
#include "lod/statistical/contact_log.h"
#include "reference/state_archive.h"

namespace lodestone {

class ContactEvents {
 public:
  ContactEvents(const Levels& levels, const EventSettings& settings) : levels_(levels), settings_(settings) {}

  void set(const EventSettings& settings) { settings_ = settings; }
  /// Whether a body's contacts make events though not all do.
  void ask(std::uint32_t body, bool asks);
  void forget(std::uint32_t body);
  bool wanted() const { return settings_.all_bodies || !asking_.empty(); }
  /// Where the step shall write; null where nobody wants to know.
  ContactLog* log() { return wanted() ? &log_ : nullptr; }

  /// A step begins.
  void begin() { events_.clear(); }
  /// Writes down, where anybody wants to know, what full bodies touched among themselves, of the ground and
  /// of the caller's in the full level's last step, in which touches were recorded.
  void take_full_touches();
  /// After a step of `dt` seconds, in which these woke.
  void finish(double dt, std::span<const BodyId> woke);
  std::span<const ContactEvent> events() const { return events_; }
  /// Of the last step, and of what touches still, but not with what is the caller's: he may have other things
  /// where it is read, and contacts with them begin anew there.
  void archive(StateArchive& a);

 private:
  /// Who touch. The second is a body, something of the caller's by number, or a piece of the ground.
  struct Key {
    std::uint32_t first = 0;
    enum class Second : std::uint32_t { body, callers, ground } kind = Second::ground;
    std::uint32_t second = 0, generation = 0;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  struct Pair {
    Key key;
    ContactEvent last;     // what is known of it
    double since_s = 0.0;  // that they touched
    bool touches = false;  // in this step
  };

  Key key_of(const ContactRecord& record);
  /// What of the caller's it is: a geom that stands still or is moved by him, or a dynamic body; both null:
  /// neither.
  std::pair<dxGeom*, dxBody*> callers_of(const ContactRecord& record) const;
  bool is_own(std::uint32_t owner) const { return owner < levels_.bodies.indices(); }
  void take_touches();
  void bring_back(std::uint32_t body);
  bool bring_back(const Key& key, Pair& pair);
  ContactSide body_side(std::uint32_t body) const;
  ContactSide second_side(const ContactRecord& record) const;
  bool rests(const ContactSide& side) const;
  void tell(ContactPhase phase, const Pair& pair);
  void set_aside(const Pair& pair);
  void take_from(std::uint32_t body, const Key& key);

  const Levels& levels_;
  EventSettings settings_;
  ContactLog log_;
  std::unordered_set<std::uint32_t> asking_;
  std::unordered_map<const void*, std::uint32_t>
      number_of_callers_;  // of geoms and bodies, in the order in which they were first touched
  std::vector<std::pair<Key, std::uint32_t>> order_;            // of this step's records
  std::vector<Pair> touches_;                                   // of this step, by key
  std::vector<Pair> live_, kept_;                               // by key; what is left of them
  std::unordered_map<std::uint32_t, std::vector<Pair>> aside_;  // of each body that sleeps on something
  std::vector<ContactEvent> events_;
};

}  // namespace lodestone
