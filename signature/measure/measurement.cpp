#include "signature/measure/measurement.h"

#include "reference/error.h"

namespace lodestone {
namespace {

template <class Unit>
void take(std::vector<Unit>& into, const std::vector<Unit>& from, const Share& share) {
  into.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    if (share.holds(std::int64_t(i))) into[i] = from[i];
}

void take(TableUnits& into, const TableUnits& from, const Share& share) {
  take(into.cells, from.cells, share);
  take(into.held_out, from.held_out, share);
}

}  // namespace

Measurement merge_measurements(std::span<const Measurement> shares) {
  Measurement whole;
  for (const Measurement& part : shares) {
    check_that(part.share.count == int(shares.size()), "the shares are all of one measurement");
    take(whole.heights, part.heights, part.share);
    take(whole.bouncing, part.bouncing, part.share);
    take(whole.non_bouncing, part.non_bouncing, part.share);
    take(whole.by_speed, part.by_speed, part.share);
    take(whole.settlings, part.settlings, part.share);
  }
  return whole;
}

}  // namespace lodestone
