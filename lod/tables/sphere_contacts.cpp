#include "lod/tables/sphere_contacts.h"

#include <algorithm>

#include "lod/tables/contact_loops.h"

namespace lodestone {

using namespace lane;

namespace {

// Kept by each thread, so that a warm step allocates nothing.
BallPairs& empty_pairs() {
  thread_local BallPairs pairs;
  pairs.clear();
  return pairs;
}

// Pairs of which one is no sphere.
void set_apart(BallPairs& pairs, std::uint32_t spheres, BallPairs& others) {
  others.clear();
  pairs.filter([&](std::uint32_t first, std::uint32_t second) {
    if (first < spheres && second < spheres) return true;
    others.add(first, second);
    return false;
  });
}

}  // namespace

void ContactArrays::make_room(std::size_t elements, bool one_kind) {
  lately = std::max(lately, elements);
  if (elements + kContactChunk > first.size()) {
    const std::size_t size = elements + elements / 16 + 2 * kContactChunk;
    const auto grow = [&](auto& array) {
      array.reserve(size), array.resize(size);
    };  // not twice as long, as a resize by itself would
    grow(first), grow(second), grow(flush);
    for (auto* array : {&nx, &ny, &nz, &gap, &closing, &impulse, &recalled}) grow(*array);
  }
  if (!one_kind) restitution.resize(first.size()), friction.resize(first.size());
}

void ContactArrays::clear() {
  lately = std::max(count, lately - lately / 64);
  count = 0;
  flush_contacts.clear();
  if (first.size() < lately + lately / 2 + 8192) return;
  const std::size_t kept = lately;
  *this = {};
  make_room(kept + kept / 8, true);
  lately = kept;
}

void SphereContacts::clear() {
  for (std::size_t i = 0; i < used_parts_; ++i)
    parts_[i].any_near = parts_[i].any_passed = false, parts_[i].run = {};
  used_parts_ = 0;
  for (auto& colour : of_colour_) colour.clear();
  free_arrays_.clear();
  for (ContactArrays& arrays : arrays_) arrays.clear(), free_arrays_.push_back(&arrays);
}

std::int64_t SphereContacts::count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < used_parts_; ++i) count += parts_[i].run.size();
  return std::int64_t(count);
}

bool SphereContacts::any_near() const {
  return std::ranges::any_of(std::span(parts_).first(used_parts_), &Part::any_near);
}

ContactArrays& SphereContacts::take_arrays() {
  const std::lock_guard lock(free_arrays_access_);
  if (free_arrays_.empty()) return arrays_.emplace_back();
  ContactArrays& arrays = *free_arrays_.back();
  free_arrays_.pop_back();
  return arrays;
}

void SphereContacts::put_back(ContactArrays& arrays) {
  const std::lock_guard lock(free_arrays_access_);
  free_arrays_.push_back(&arrays);
}

void SphereContacts::find(const Spheres& spheres, const SphereKinds& kinds, const CellGrid& grid,
                          float bounce_velocity, const StepConstants& constants, Simd simd,
                          const JobRunner& jobs, std::vector<BallPairs>* others,
                          const std::function<bool(std::uint32_t, std::uint32_t)>& pass) {
  constexpr std::int64_t kManyPairs = 4;  // a body: on long ways alone they have more, in one part
  clear();
  if (others && others->size() < std::size_t(grid.parts())) others->resize(std::size_t(grid.parts()));
  used_parts_ = std::size_t(grid.parts()) + 2;
  if (parts_.size() < used_parts_) parts_.resize(used_parts_);
  for (std::size_t i = 0; i < used_parts_; ++i) {
    parts_[i].colour = i < std::size_t(grid.parts()) ? grid.colour_of(std::int64_t(i))
                       : i + 1 < used_parts_         ? kStillColour
                                                     : kGroundColour;
    of_colour_[std::size_t(parts_[i].colour)].push_back(std::uint32_t(i));
  }
  jobs(grid.parts(), TaskRef([&](std::int64_t i) {
         BallPairs& pairs = empty_pairs();
         grid.find_pairs(i, pairs);
         parts_[std::size_t(i)].any_near = pairs.size() > 0;
         if (others) set_apart(pairs, std::uint32_t(spheres.awake), (*others)[std::size_t(i)]);
         if (pass && pairs.size() > kManyPairs * spheres.awake) {
           parts_[std::size_t(i)].any_passed = true;
           pairs.filter([&](std::uint32_t first, std::uint32_t second) { return !pass(first, second); });
         }
         if (pair_filter_)
           pairs.filter([&](std::uint32_t first, std::uint32_t second) {
             return pair_filter_(spheres.owner[first], spheres.owner[second]);
           });
         ContactArrays& arrays = take_arrays();
         parts_[std::size_t(i)].run =
             find_touching(pairs, spheres, kinds, constants, settings_.touching, simd, arrays);
         recall(spheres, bounce_velocity, constants, parts_[std::size_t(i)].run);
         put_back(arrays);
       }));
  any_passed_ = std::ranges::any_of(std::span(parts_).first(used_parts_), &Part::any_passed);
}

void SphereContacts::add(const Spheres& spheres, const SphereKinds& kinds,
                         std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs,
                         float bounce_velocity, const StepConstants& constants, Simd simd) {
  BallPairs& near = empty_pairs();
  for (const auto& [first, second] : pairs) near.add(first, second);
  ContactArrays& arrays = take_arrays();
  still_part().run = find_touching(near, spheres, kinds, constants, settings_.touching, simd, arrays);
  recall(spheres, bounce_velocity, constants, still_part().run);
  put_back(arrays);
}

void SphereContacts::add_ground(const Spheres& spheres, std::span<const PlaneTouch> touches,
                                float bounce_velocity, const StepConstants& constants) {
  ContactArrays& c = take_arrays();
  const std::size_t begin = c.count;
  c.make_room(begin + touches.size(), false);
  for (const PlaneTouch& touch : touches) {
    const std::size_t at = c.count++;
    c.first[at] = touch.place, c.second[at] = kGroundPlace | touch.plane;
    c.nx[at] = touch.normal.x, c.ny[at] = touch.normal.y, c.nz[at] = touch.normal.z;
    if (touch.plane >= ground_velocities_.size()) ground_velocities_.resize(touch.plane + 1);
    ground_velocities_[touch.plane] = {touch.velocity.x, touch.velocity.y, touch.velocity.z, 0.0f};
    c.gap[at] = touch.gap, c.closing[at] = touch.closing;
    c.flush[at] = touch.flush ? 0 : kNotFlush;
    c.restitution[at] = float(touch.law.restitution), c.friction[at] = float(touch.law.friction);
  }
  ground_part().run = {&c, begin, c.count};
  recall(spheres, bounce_velocity, constants, ground_part().run);
  put_back(c);
}

float SphereContacts::find_known_force(const Spheres& spheres, std::uint32_t at, std::uint32_t other) const {
  const std::uint32_t begin = spheres.known_begin[at], end = begin + spheres.known_count[at];
  for (std::uint32_t i = begin; i < end; ++i)
    if (known_[i].owner == spheres.owner[other]) return known_[i].force;
  return 0.0f;
}

float SphereContacts::find_known_apart(std::uint32_t owner, std::uint32_t other) const {
  const auto found =
      std::ranges::lower_bound(known_apart_, std::array{owner, other}, {}, &KnownApart::owners);
  return found != known_apart_.end() && found->owners == std::array{owner, other} ? found->force : 0.0f;
}

// N, on the first of the two, along the plane of that normal.
F3 SphereContacts::find_known_friction(std::uint32_t owner, std::uint32_t other, F3 normal) const {
  const std::array owners{std::min(owner, other), std::max(owner, other)};
  const auto found = std::ranges::lower_bound(known_friction_, owners, {}, &KnownFriction::owners);
  if (found == known_friction_.end() || found->owners != owners) return {};
  const F3 force = (owners[0] == owner ? 1.0f : -1.0f) * found->force;
  return force - dot(force, normal) * normal;
}

// Contacts mostly come in the order of the last step: `nth`, of those of the first body, is where it should
// be.
float SphereContacts::known_force(const Spheres& spheres, std::uint32_t first, std::uint32_t second,
                                  std::uint32_t nth) const {
  if (nth < spheres.known_count[first]) {
    const KnownContact& expected = known_[spheres.known_begin[first] + nth];
    if (expected.owner == owner_of(spheres, second)) return expected.force;
  }
  if (second >= kGroundPlace) return find_known_apart(spheres.owner[first], second);
  if (const float force = find_known_force(spheres, first, second); force != 0.0f) return force;
  if (const float force = find_known_force(spheres, second, first); force != 0.0f) return force;
  if (known_apart_.empty()) return 0.0f;
  const float force = find_known_apart(spheres.owner[first], spheres.owner[second]);
  return force != 0.0f ? force : find_known_apart(spheres.owner[second], spheres.owner[first]);
}

// m/s: by how much forces press the two together, which is no impact.
float SphereContacts::pressed(const ContactArrays& c, std::size_t i) const {
  const Eigen::Vector3f normal(c.nx[i], c.ny[i], c.nz[i]);
  const auto push_on = [&](std::uint32_t place) {
    return place < pushes_.size() ? pushes_[place].dot(normal) : 0.0f;
  };
  return std::max(0.0f, push_on(c.second[i]) - push_on(c.first[i]));
}

void SphereContacts::recall(const Spheres& spheres, float bounce_velocity, const StepConstants& constants,
                            const ContactRun& run) const {
  ContactArrays& c = *run.arrays;
  const bool none = known_.empty() && known_apart_.empty();
  std::uint32_t last = ~0u, nth = 0;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    nth = c.first[i] == last ? nth + 1 : 0;
    last = c.first[i];
    if (!pushes_.empty()) c.closing[i] += pressed(c, i);
    const bool impact = c.closing[i] < -bounce_velocity;  // is no support
    c.impulse[i] = impact || none ? 0.0f
                                  : constants.remembered * constants.time *
                                        known_force(spheres, c.first[i], c.second[i], nth);
    c.recalled[i] = c.impulse[i];
    if (c.flush[i] == kNotFlush) continue;
    c.flush[i] = std::int32_t(c.flush_contacts.size());
    const bool is_new = impact || c.second[i] >= kGroundPlace;
    const F3 force = is_new ? F3{}
                            : find_known_friction(spheres.owner[c.first[i]], spheres.owner[c.second[i]],
                                                  {c.nx[i], c.ny[i], c.nz[i]});
    c.flush_contacts.push_back({i, constants.rubbed * constants.time * force});
  }
}

void SphereContacts::set_laws(const ContactRun& run, const Spheres& spheres, const SphereKinds& kinds,
                              const MaterialTable& materials) const {
  ContactArrays& c = *run.arrays;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    const ContactLaw law =
        materials.law(kinds.material[spheres.kind[c.first[i]]], kinds.material[spheres.kind[c.second[i]]]);
    c.restitution[i] = float(law.restitution), c.friction[i] = float(law.friction);
  }
}

void SphereContacts::begin(const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials,
                           const StepConstants& constants, SphereStep& step, const JobRunner& jobs) {
  const auto awake = std::uint32_t(spheres.awake);
  step.clear_still(awake);
  run_by_colour(jobs, [&](Part& part) {
    if (!constants.one_kind && part.colour != kGroundColour) set_laws(part.run, spheres, kinds, materials);
    const ContactArrays& c = *part.run.arrays;
    for (std::size_t i = part.run.begin; i < part.run.end; ++i) {
      const std::uint32_t a = c.first[i], b = c.second[i];
      const float impulse = c.impulse[i];
      const RowLanes normal{c.nx[i], c.ny[i], c.nz[i], 0.0f}, one{0.0f, 0.0f, 0.0f, 1.0f};
      add_to(step.p[a], impulse * float(spheres.inverse_mass[a]) * normal + one);
      if (b < awake) add_to(step.p[b], -impulse * float(spheres.inverse_mass[b]) * normal + one);
      if (c.flush[i] == kNotFlush) continue;
      const F3& f = c.flush_contacts[std::size_t(c.flush[i])].friction;
      const RowLanes friction{f.x, f.y, f.z, 0.0f};
      add_to(step.p[a], float(spheres.inverse_mass[a]) * friction);
      if (b < awake) add_to(step.p[b], -float(spheres.inverse_mass[b]) * friction);
    }
  });
}

SweepOutcome SphereContacts::sweep(Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials,
                                   float bounce_velocity, const StepConstants& constants, bool last,
                                   bool eased, Simd simd, SphereStep& step, const JobRunner& jobs) {
  const ContactLaw only_law = materials.law(kinds.material[0], kinds.material[0]);
  const bool remembers = last && constants.remembers;
  if (remembers) make_room_to_remember(spheres);
  run_by_colour(jobs, [&](Part& part) {
    const bool one_law = constants.one_kind && part.colour != kGroundColour;
    part.outcome =
        sweep_contacts({settings_, ground_velocities_, one_law, only_law, bounce_velocity, last, eased},
                       spheres, kinds, constants, simd, part.run, step);
    if (remembers && !is_apart(part.colour)) remember(spheres, bounce_velocity, constants, part);
  });
  if (remembers) remember_apart(spheres, bounce_velocity, constants);
  if (remembers) remember_friction(spheres, bounce_velocity, constants);
  SweepOutcome outcome;
  for (std::size_t p = 0; p < used_parts_; ++p)
    if (parts_[p].run.size() > 0) outcome.include(parts_[p].outcome);
  return outcome;
}

void SphereContacts::move_apart(const Spheres& spheres, const SphereKinds& kinds, SphereStep& step,
                                const JobRunner& jobs) {
  run_by_colour(jobs, [&](const Part& part) {
    if (part.outcome.deepest > settings_.deep)
      lodestone::move_apart(settings_, spheres, kinds, part.run, step);
  });
}

void SphereContacts::make_room_to_remember(Spheres& spheres) {
  std::fill(spheres.known_count.begin(), spheres.known_count.begin() + spheres.awake, std::uint8_t(0));
  std::uint32_t begin = 0;
  for (std::size_t p = 0; p < used_parts_; ++p) {
    parts_[p].known_begin = begin;
    if (!is_apart(parts_[p].colour)) begin += std::uint32_t(parts_[p].run.size());
  }
  if (begin > known_.capacity()) known_.reserve(begin + begin / 16);
  known_.resize(begin);
}

// N. A load grows step by step as bodies come to rest on each other; what a contact gave all at once passed a
// blow on, and given again it would be one out of nothing.
float SphereContacts::force_to_remember(const ContactArrays& c, std::size_t i,
                                        const StepConstants& constants) const {
  const float force = c.impulse[i] / constants.time;
  if (!constants.hulls) return force;
  return std::min(force, kLoadGrowth * c.recalled[i] / constants.time +
                             kLoadAtOnce * constants.pressing * constants.heaviest);
}

// All contacts of a first body are in one part, one after the other.
void SphereContacts::remember(Spheres& spheres, float bounce_velocity, const StepConstants& constants,
                              const Part& part) {
  const ContactArrays& c = *part.run.arrays;
  std::uint32_t at = part.known_begin, last = ~0u;
  for (std::size_t i = part.run.begin; i < part.run.end; ++i) {
    const std::uint32_t a = c.first[i];
    if (a != last) spheres.known_begin[a] = at;
    last = a;
    known_[at] = {owner_of(spheres, c.second[i]), force_to_remember(c, i, constants)};
    const bool kept = is_support(c, i, bounce_velocity, constants.time) & (spheres.known_count[a] < 255);
    spheres.known_count[a] += kept;
    at += kept;
  }
}

void SphereContacts::remember_apart(const Spheres& spheres, float bounce_velocity,
                                    const StepConstants& constants) {
  known_apart_.clear();
  for (std::size_t p = 0; p < used_parts_; ++p) {
    if (!is_apart(parts_[p].colour) || parts_[p].run.size() == 0) continue;
    const ContactArrays& c = *parts_[p].run.arrays;
    for (std::size_t i = parts_[p].run.begin; i < parts_[p].run.end; ++i)
      if (is_support(c, i, bounce_velocity, constants.time))
        known_apart_.push_back({{spheres.owner[c.first[i]], owner_of(spheres, c.second[i])},
                                force_to_remember(c, i, constants)});
  }
  std::ranges::sort(known_apart_, {}, &KnownApart::owners);
}

void SphereContacts::remember_friction(const Spheres& spheres, float bounce_velocity,
                                       const StepConstants& constants) {
  known_friction_.clear();
  const float per_time = 1.0f / constants.time;
  for (const ContactArrays& c : arrays_)
    for (const FlushContact& flush : c.flush_contacts) {
      const std::uint32_t second = c.second[flush.at];
      if (second >= kGroundPlace || !is_support(c, flush.at, bounce_velocity, constants.time)) continue;
      const std::uint32_t owner = spheres.owner[c.first[flush.at]], other = spheres.owner[second];
      known_friction_.push_back({{std::min(owner, other), std::max(owner, other)},
                                 (owner < other ? per_time : -per_time) * flush.friction});
    }
  std::ranges::sort(known_friction_, {}, &KnownFriction::owners);
}

std::size_t SphereContacts::bytes() const {
  std::size_t bytes = known_.capacity() * sizeof(KnownContact) +
                      known_apart_.capacity() * sizeof(KnownApart) +
                      known_friction_.capacity() * sizeof(KnownFriction) +
                      ground_velocities_.capacity() * sizeof(Row) + parts_.capacity() * sizeof(Part);
  for (const ContactArrays& arrays : arrays_) {
    arrays.each_array([&](const auto& array) { bytes += array.capacity() * sizeof array[0]; });
    bytes += arrays.flush_contacts.capacity() * sizeof(FlushContact);
  }
  return bytes;
}

std::size_t SphereContacts::bytes_each() const {
  std::size_t bytes = 0;
  if (!arrays_.empty())
    arrays_.front().each_array([&](const auto& array) { bytes += array.empty() ? 0 : sizeof array[0]; });
  return bytes;
}

}  // namespace lodestone
