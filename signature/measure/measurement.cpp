#include "signature/measure/measurement.h"

#include "reference/error.h"
#include "signature/measure/cell_trials.h"
#include "signature/measure/response_grid.h"

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

Measurement make_empty_measurement(const SignatureSettings& settings, const Share& share) {
  Measurement m;
  m.share = share;
  m.heights.resize(std::size_t(settings.height_samples));
  const auto make_room = [&](TableUnits& units, std::int64_t cells) {
    units.cells.resize(std::size_t(cells));
    units.held_out.resize(std::size_t(settings.held_out_conditions));
  };
  if (settings.paper_grid)
    make_room(m.by_speed, make_speed_grid(settings).size());
  else
    for (TableUnits* units : {&m.bouncing, &m.non_bouncing})
      make_room(*units, make_response_grid(settings).size());
  m.settlings.resize(std::size_t(settings.settling_trials));
  return m;
}

std::uint64_t trials_of(const HeldOutUnit&, const SignatureSettings&) { return kHeldOutTrials; }

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
