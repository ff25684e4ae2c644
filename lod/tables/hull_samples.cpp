#include "lod/tables/hull_samples.h"

#include <algorithm>
#include <utility>

namespace lodestone {

HullSamples make_hull_samples(const Shape& shape, const RestingFaces* stands) {
  HullSamples samples;
  for (auto* array : {&samples.height, &samples.pair_height, &samples.unsteady}) array->resize(kHullHeights);
  samples.patch.resize(kHullHeights), samples.pair_face.resize(kHullHeights);
  sample_hull(shape, {samples.height, samples.pair_height, samples.patch, samples.pair_face});
  find_unsteady(stands, samples.pair_face, samples.unsteady);
  samples.rolling_levers = find_rolling_levers(shape);
  return samples;
}

void HullSampleStore::keep(const HullSamplesKey& key, HullSamples samples) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; });
  if (entries_.size() == kKept) entries_.erase(entries_.begin());
  entries_.push_back({key, std::move(samples)});
}

const HullSamples* HullSampleStore::find(const HullSamplesKey& key) const {
  const auto known = std::ranges::find(entries_, key, &Entry::key);
  return known == entries_.end() ? nullptr : &known->samples;
}

}  // namespace lodestone
