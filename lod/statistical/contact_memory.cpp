#include "lod/statistical/contact_memory.h"

#include <algorithm>

namespace lodestone {
namespace {

// Calls `visit(begin, end)` for each run of equal keys.
template <class Visit>
void each_run(std::span<const ContactKey> keys, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    while (end < keys.size() && keys[end] == keys[begin]) ++end;
    visit(begin, end);
  }
}

}  // namespace

void ContactMemory::recall(std::span<const ContactKey> keys, std::span<SolverContact> contacts, double step) const {
  each_run(keys, [&](std::size_t begin, std::size_t end) {
    const auto run = std::ranges::lower_bound(runs_, keys[begin], {}, &Run::key);
    if (run == runs_.end() || run->key != keys[begin]) return;
    const auto before = std::span(forces_).subspan(run->begin, run->count);
    if (run->count == end - begin) {
      for (std::size_t i = begin; i < end; ++i) contacts[i].guess = step * before[i - begin];
      return;
    }
    Vec3 sum = Vec3::Zero();
    for (const Vec3& force : before) sum += force;
    for (std::size_t i = begin; i < end; ++i) contacts[i].guess = step / double(end - begin) * sum;
  });
}

void ContactMemory::remember(std::span<const ContactKey> keys, std::span<const SolverContact> contacts, double step) {
  runs_.clear();
  forces_.clear();
  for (const SolverContact& contact : contacts) forces_.push_back(impulse_of(contact) / step);
  each_run(keys, [&](std::size_t begin, std::size_t end) {
    runs_.push_back({keys[begin], std::uint32_t(begin), std::uint32_t(end - begin)});
  });
  std::ranges::sort(runs_, {}, &Run::key);
}

}  // namespace lodestone
