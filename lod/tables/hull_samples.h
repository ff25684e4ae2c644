// What `tables` knew of hulls that no body has any more, kept for a while: it takes milliseconds to find, and
// shapes come and go.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/tables/hull_heights.h"

namespace lodestone {

/// Of kHullHeights directions each: see HullMaps, find_unsteady() and find_rolling_levers().
struct HullSamples {
  std::vector<float> height, pair_height, unsteady;
  std::vector<SupportPatch> patch;
  std::vector<lane::Row> pair_face;
  Mat3 rolling_levers = Mat3::Zero();
};
HullSamples make_hull_samples(const Shape& shape, const RestingFaces* stands);

/// Of what they are: a shape of a size, and whether its resting faces are known.
struct HullSamplesKey {
  std::uint64_t shape_hash = 0;
  double radius = 0.0;  ///< m
  bool stands = false;
  friend bool operator==(const HullSamplesKey&, const HullSamplesKey&) = default;
};

class HullSampleStore {
 public:
  void keep(const HullSamplesKey& key, HullSamples samples);
  /// None: null. Valid until the next call.
  const HullSamples* find(const HullSamplesKey& key) const;

 private:
  static constexpr std::size_t kKept = 64;  // those kept last: 40 kB each
  struct Entry {
    HullSamplesKey key;
    HullSamples samples;
  };
  std::vector<Entry> entries_;  // those kept last at the end
};

}  // namespace lodestone
