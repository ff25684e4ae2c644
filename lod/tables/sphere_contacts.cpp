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

}  // namespace

void ContactArrays::make_room(std::size_t elements, bool one_kind) {
  if (elements + kContactChunk > first.size()) {
    const std::size_t size = elements + elements / 8 + 2 * kContactChunk;
    const auto grow = [&](auto& array) { array.reserve(size), array.resize(size); };  // not twice as long, as a resize by itself would
    grow(first), grow(second);
    for (auto* array : {&nx, &ny, &nz, &gap, &closing, &impulse}) grow(*array);
  }
  if (!one_kind) restitution.resize(first.size()), friction.resize(first.size());
}

void SphereContacts::clear() {
  for (std::size_t i = 0; i < used_parts_; ++i) parts_[i].contacts.count = 0;
  used_parts_ = 0;
  for (auto& colour : of_colour_) colour.clear();
}

std::int64_t SphereContacts::count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < used_parts_; ++i) count += parts_[i].contacts.count;
  return std::int64_t(count);
}

void SphereContacts::find(const Spheres& spheres, const SphereKinds& kinds, const CellGrid& grid, const StepConstants& constants, Simd simd,
                          const JobRunner& jobs) {
  clear();
  used_parts_ = std::size_t(grid.parts()) + 1;
  if (parts_.size() < used_parts_) parts_.resize(used_parts_);
  for (std::size_t i = 0; i < used_parts_; ++i) {
    parts_[i].colour = i + 1 < used_parts_ ? grid.colour_of(std::int64_t(i)) : CellGrid::kColours;
    of_colour_[std::size_t(parts_[i].colour)].push_back(std::uint32_t(i));
  }
  jobs(grid.parts(), TaskRef([&](std::int64_t i) {
    Part& part = parts_[std::size_t(i)];
    BallPairs& pairs = empty_pairs();
    grid.find_pairs(i, pairs);
    find_touching(pairs, spheres, kinds, constants, settings_.touching, simd, part.contacts);
  }));
}

void SphereContacts::add(const Spheres& spheres, const SphereKinds& kinds, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs,
                         const StepConstants& constants, Simd simd) {
  BallPairs& near = empty_pairs();
  for (const auto& [first, second] : pairs) near.add(first, second);
  find_touching(near, spheres, kinds, constants, settings_.touching, simd, parts_[used_parts_ - 1].contacts);
}

template <class Task>
void SphereContacts::run_by_colour(const JobRunner& jobs, const Task& task) {
  for (const auto& colour : of_colour_)
    if (!colour.empty()) jobs(std::int64_t(colour.size()), TaskRef([&](std::int64_t i) { task(parts_[colour[std::size_t(i)]]); }));
}

float SphereContacts::find_known_force(const Spheres& spheres, std::uint32_t at, std::uint32_t other) const {
  const std::uint32_t begin = spheres.known_begin[at], end = begin + spheres.known_count[at];
  for (std::uint32_t i = begin; i < end; ++i)
    if (known_[i].owner == spheres.owner[other]) return known_[i].force;
  return 0.0f;
}

// Contacts mostly come in the order of the last step: `nth`, of those of the first body, is where it should be.
float SphereContacts::known_force(const Spheres& spheres, std::uint32_t first, std::uint32_t second, std::uint32_t nth) const {
  if (nth < spheres.known_count[first]) {
    const KnownContact& expected = known_[spheres.known_begin[first] + nth];
    if (expected.owner == spheres.owner[second]) return expected.force;
  }
  const float force = find_known_force(spheres, first, second);
  return force != 0.0f || std::int64_t(second) >= spheres.awake ? force : find_known_force(spheres, second, first);
}

void SphereContacts::set_laws(ContactArrays& c, const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials) const {
  for (std::size_t i = 0; i < c.count; ++i) {
    const ContactLaw law = materials.law(kinds.kinds[spheres.kind[c.first[i]]].material, kinds.kinds[spheres.kind[c.second[i]]].material);
    c.restitution[i] = float(law.restitution), c.friction[i] = float(law.friction);
  }
}

void SphereContacts::begin(const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials, float bounce_velocity,
                           const StepConstants& constants, SphereStep& step, const JobRunner& jobs) {
  const auto awake = std::uint32_t(spheres.awake);
  step.clear_still(awake);
  run_by_colour(jobs, [&](Part& part) {
    ContactArrays& c = part.contacts;
    if (!constants.one_kind) set_laws(c, spheres, kinds, materials);
    std::uint32_t last = ~0u, nth = 0;
    for (std::size_t i = 0; i < c.count; ++i) {
      const std::uint32_t a = c.first[i], b = c.second[i];
      nth = a == last ? nth + 1 : 0;
      last = a;
      const bool impact = c.closing[i] < -bounce_velocity;  // is no support
      const float impulse = impact || known_.empty() ? 0.0f : known_force(spheres, a, b, nth) * constants.time;
      c.impulse[i] = impulse;
      const RowLanes normal{c.nx[i], c.ny[i], c.nz[i], 0.0f}, one{0.0f, 0.0f, 0.0f, 1.0f};
      add_to(step.p[a], impulse * kinds.inverse_mass[spheres.kind[a]] * normal + one);
      if (b < awake) add_to(step.p[b], -impulse * kinds.inverse_mass[spheres.kind[b]] * normal + one);
    }
  });
}

void SphereContacts::sweep(const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials, float bounce_velocity,
                           const StepConstants& constants, bool last, Simd simd, SphereStep& step, const JobRunner& jobs) {
  const SweepSettings settings{settings_, materials.law(kinds.kinds[0].material, kinds.kinds[0].material), bounce_velocity, last};
  run_by_colour(jobs, [&](Part& part) { sweep_contacts(settings, spheres, kinds, constants, simd, part.contacts, step); });
}

void SphereContacts::remember(Spheres& spheres, float bounce_velocity, const StepConstants& constants, const JobRunner& jobs) {
  std::fill(spheres.known_count.begin(), spheres.known_count.begin() + spheres.awake, std::uint8_t(0));
  known_.resize(std::size_t(count()));
  const bool together = std::ranges::all_of(std::span(of_colour_).last(2), [&](const auto& colour) {
    return std::ranges::all_of(colour, [&](std::uint32_t part) { return parts_[part].contacts.count == 0; });
  });
  if (together) remember_parts(spheres, bounce_velocity, constants, jobs);
  else remember_sorted(spheres, bounce_velocity, constants);
}

// All contacts of a first body are in one part, one after the other.
void SphereContacts::remember_parts(Spheres& spheres, float bounce_velocity, const StepConstants& constants, const JobRunner& jobs) {
  std::uint32_t begin = 0;
  for (std::size_t p = 0; p < used_parts_; ++p) parts_[p].known_begin = begin, begin += std::uint32_t(parts_[p].contacts.count);
  const float per_time = 1.0f / constants.time;
  jobs(std::int64_t(used_parts_), TaskRef([&](std::int64_t p) {
    const ContactArrays& c = parts_[std::size_t(p)].contacts;
    std::uint32_t at = parts_[std::size_t(p)].known_begin, last = ~0u;
    for (std::size_t i = 0; i < c.count; ++i) {
      const std::uint32_t a = c.first[i];
      if (a != last) spheres.known_begin[a] = at;
      last = a;
      known_[at] = {spheres.owner[c.second[i]], c.impulse[i] * per_time};
      const bool kept = is_support(c, i, bounce_velocity) & (spheres.known_count[a] < 255);
      spheres.known_count[a] += kept;
      at += kept;
    }
  }));
}

// A counting sort by the first body: its contacts come from several parts.
void SphereContacts::remember_sorted(Spheres& spheres, float bounce_velocity, const StepConstants& constants) {
  const auto each_kept = [&](const auto& visit) {
    for (std::size_t p = 0; p < used_parts_; ++p)
      for (std::size_t i = 0; i < parts_[p].contacts.count; ++i)
        if (is_support(parts_[p].contacts, i, bounce_velocity)) visit(parts_[p].contacts, i);
  };
  each_kept([&](const ContactArrays& c, std::size_t i) { spheres.known_count[c.first[i]] += spheres.known_count[c.first[i]] < 255; });
  std::uint32_t begin = 0;
  for (std::int64_t i = 0; i < spheres.awake; ++i) {
    spheres.known_begin[i] = begin;
    begin += spheres.known_count[i];
    spheres.known_count[i] = 0;
  }
  const float per_time = 1.0f / constants.time;
  each_kept([&](const ContactArrays& c, std::size_t i) {
    const std::uint32_t a = c.first[i];
    if (spheres.known_count[a] == 255) return;
    known_[spheres.known_begin[a] + spheres.known_count[a]++] = {spheres.owner[c.second[i]], c.impulse[i] * per_time};
  });
}

std::size_t SphereContacts::bytes() const {
  std::size_t bytes = known_.capacity() * sizeof(KnownContact) + parts_.capacity() * sizeof(Part);
  for (const Part& part : parts_) part.contacts.each_array([&](const auto& array) { bytes += array.capacity() * sizeof array[0]; });
  return bytes;
}

std::size_t SphereContacts::bytes_each() const {
  std::size_t bytes = 0;
  if (!parts_.empty()) parts_.front().contacts.each_array([&](const auto& array) { bytes += array.empty() ? 0 : sizeof array[0]; });
  return bytes;
}

}  // namespace lodestone
