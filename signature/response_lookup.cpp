#include "signature/response_lookup.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace lodestone {
namespace {

// Where a value lies on an axis: two neighbouring places and the weight of the second.
struct Place {
  int first = 0, second = 0;
  float weight = 0.0f;
};

Place between(int lower, int upper, double part, bool interpolate) {
  if (interpolate) return {lower, upper, float(part)};
  const int nearest = part < 0.5 ? lower : upper;
  return {nearest, nearest, 0.0f};
}

// Between the centres of `n` cells over [0, range].
Place place_of(double value, double range, int n, bool interpolate) {
  const double at = value / range * n - 0.5;
  if (!(at > 0.0)) return {};
  if (at >= n - 1) return {n - 1, n - 1, 0.0f};
  const int cell = int(at);
  return between(cell, cell + 1, at - cell, interpolate);
}

// Around the circle; place 0 is at 0.
Place place_around(double angle, int n, bool interpolate) {
  if (n == 1 || !std::isfinite(angle)) return {};
  const double turns = angle / (2.0 * std::numbers::pi), at = (turns - std::floor(turns)) * n;
  const int cell = std::min(int(at), n - 1);
  return between(cell, (cell + 1) % n, at - cell, interpolate);
}

// Between rising samples.
Place place_among(double value, std::span<const float> samples, bool interpolate) {
  const auto n = int(samples.size());
  if (!(value > samples.front())) return {};
  if (value >= samples.back()) return {n - 1, n - 1, 0.0f};
  const int upper = int(std::upper_bound(samples.begin(), samples.end(), float(value)) - samples.begin());
  const int lower = std::clamp(upper - 1, 0, n - 2);
  const double part = (value - samples[lower]) / (samples[lower + 1] - samples[lower]);
  return between(lower, lower + 1, std::clamp(part, 0.0, 1.0), interpolate);
}

// The corners of the places on four axes, those of weight 0 left out.
CellBlend blend_of(const std::array<Place, 4>& places, const std::array<int, 4>& sizes) {
  CellBlend blend;
  for (int corner = 0; corner < 16; ++corner) {
    float weight = 1.0f;
    std::int32_t cell = 0;
    for (int axis = 0; axis < 4; ++axis) {
      const Place& p = places[axis];
      const bool second = corner >> axis & 1;
      weight *= second ? p.weight : 1.0f - p.weight;
      cell = cell * sizes[axis] + (second ? p.second : p.first);
    }
    if (weight == 0.0f) continue;
    blend.cell[blend.count] = cell;
    blend.weight[blend.count++] = weight;
  }
  return blend;
}

template <class Value>
Value weighted(const std::vector<Value>& values, const CellBlend& blend) {
  Value sum = blend.weight[0] * values[blend.cell[0]];
  for (int i = 1; i < blend.count; ++i) sum += blend.weight[i] * values[blend.cell[i]];
  return sum;
}

Approach weighted(const std::vector<Approach>& values, const CellBlend& blend) {
  Approach sum;
  for (int i = 0; i < blend.count; ++i) {
    sum.mean += blend.weight[i] * values[blend.cell[i]].mean;
    sum.deviation += blend.weight[i] * values[blend.cell[i]].deviation;
  }
  return sum;
}

// What bounces of a response if only approaches above `least` do: a bounce adds e times the approach to the
// response, so it is the part of the approach (a Gaussian) that lies above, E[u; u > least]/E[u]. Of a
// Gaussian (m, σ), with z = (least − m)/σ, Q the upper tail and φ the density of the standard normal one,
// E[u; u > least] = m Q(z) + σ φ(z) (mean of a truncated normal).
float bouncing_part(const Approach& approach, double least) {
  if (least <= 0.0 || approach.mean - 4.0f * approach.deviation > least) return 1.0f;
  if (approach.deviation <= 0.0f || approach.mean <= 0.0f) return approach.mean > least ? 1.0f : 0.0f;
  constexpr double kNone = 40.0;  // deviations beyond which no double holds what is left
  if (least > approach.mean + kNone * approach.deviation) return 0.0f;
  const double z = (least - approach.mean) / approach.deviation;
  const double above = 0.5 * std::erfc(z / std::numbers::sqrt2),
               density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
  return float(std::clamp(above + approach.deviation / approach.mean * density, 0.0, 1.0));
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

FoundResponse find_by_speed(const SpeedTable& table, const CollisionConfiguration& c, bool interpolate) {
  FoundResponse found;
  found.bouncing = &table.cells;
  found.blend = blend_of(
      {place_of(c.theta, std::numbers::pi / 2, table.n_theta, interpolate),
       place_of(c.phi, std::numbers::pi, table.n_phi, interpolate),
       place_among(c.speed, table.speeds, interpolate), place_among(c.spin, table.spins, interpolate)},
      {table.n_theta, table.n_phi, int(table.speeds.size()), int(table.spins.size())});
  found.extrapolated = !(within(c.theta, 0.0, std::numbers::pi / 2) && within(c.phi, 0.0, std::numbers::pi) &&
                         within(c.speed, table.speeds.front(), table.speeds.back()) &&
                         within(c.spin, table.spins.front(), table.spins.back()));
  found.mean = weighted(table.cells.mean, found.blend);
  found.deviation = weighted(table.cells.deviation, found.blend);
  return found;
}

FoundResponse find_scale_free(const Signature& signature, const CollisionConfiguration& c,
                              double bounce_velocity, bool interpolate) {
  const ResponseTable& table = signature.bouncing;
  const double alpha = c.alpha();
  FoundResponse found;
  found.bouncing = &table.cells;
  found.blend = blend_of({place_of(c.theta, std::numbers::pi / 2, table.n_theta, interpolate),
                          place_of(c.phi, std::numbers::pi, table.n_phi, interpolate),
                          place_of(alpha, std::numbers::pi / 2, table.n_alpha, interpolate),
                          place_around(c.psi, table.n_psi, interpolate)},
                         {table.n_theta, table.n_phi, table.n_alpha, table.n_psi});
  found.extrapolated = !(within(c.theta, 0.0, std::numbers::pi / 2) && within(c.phi, 0.0, std::numbers::pi) &&
                         within(alpha, 0.0, std::numbers::pi / 2));
  found.mean = weighted(table.cells.mean, found.blend);
  found.deviation = weighted(table.cells.deviation, found.blend);
  const double s = c.speed_unit();
  found.least_bouncing_approach = s > 0.0 ? bounce_velocity / s : 1e300;
  found.bouncing_part =
      bouncing_part(weighted(table.cells.approach, found.blend), found.least_bouncing_approach);
  if (!(found.bouncing_part < 1.0f)) return found;
  found.slow = &signature.non_bouncing.cells;
  const float slow_part = 1.0f - found.bouncing_part;
  found.mean = found.bouncing_part * found.mean + slow_part * weighted(found.slow->mean, found.blend);
  found.deviation =
      found.bouncing_part * found.deviation + slow_part * weighted(found.slow->deviation, found.blend);
  return found;
}

// A draw of the six numbers, and the part of the restitution that its V_particle has.
struct Draw {
  Response response;
  double restitution_part;
  bool trial = false;  // one that was measured
};

Draw draw_independent(const FoundResponse& found, RandomStream& random) {
  Response normal;
  for (float& x : normal) x = float(random.normal());
  return {found.mean + found.deviation.cwiseProduct(normal), found.bouncing_part};
}

Response times_factor(const ResponseCells& cells, const CellBlend& blend, const Response& normal) {
  std::array<float, 21> factor{};
  for (int i = 0; i < blend.count; ++i)
    for (int k = 0; k < 21; ++k) factor[k] += blend.weight[i] * cells.factor[blend.cell[i]][k];
  Response sum = Response::Zero();
  for (int row = 0, k = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column, ++k) sum[row] += factor[k] * normal[column];
  return sum;
}

Draw draw_correlated(const FoundResponse& found, RandomStream& random) {
  Response normal;
  for (float& x : normal) x = float(random.normal());
  Response spread = times_factor(*found.bouncing, found.blend, normal);
  if (found.slow)
    spread = found.bouncing_part * spread +
             (1.0f - found.bouncing_part) * times_factor(*found.slow, found.blend, normal);
  return {found.mean + spread, found.bouncing_part};
}

std::int32_t choose_cell(const CellBlend& blend, double uniform) {
  for (int i = 0; i + 1 < blend.count; ++i)
    if ((uniform -= double(blend.weight[i])) < 0.0) return blend.cell[i];
  return blend.cell[blend.count - 1];
}

Response decode(const ResponseSample& sample, float range) {
  Response response;
  for (int i = 0; i < 6; ++i) response[i] = float(sample.response[i]) * (range / 32767.0f);
  return response;
}

// Trial `number` of a cell, counted round; none where the cell has none.
const ResponseSample* trial_of(const ResponseCells& cells, std::int32_t cell, std::uint32_t number) {
  const std::uint32_t first = cells.first_sample[cell], count = cells.first_sample[cell + 1] - first;
  return count ? &cells.sample[first + number % count] : nullptr;
}

// A trial of one of the cells around. The same trial of the companion table had the same start, so one that
// is too slow to bounce is taken there.
Draw draw_empirical(const FoundResponse& found, RandomStream& random) {
  const std::int32_t cell = choose_cell(found.blend, random.uniform());
  const auto number = std::uint32_t(random.uniform() * 0x1p32);
  const ResponseSample* sample = trial_of(*found.bouncing, cell, number);
  if (!sample) return {found.mean, found.bouncing_part};
  if (found.slow && sample->approach * (2.0 / 65535.0) < found.least_bouncing_approach)
    if (const ResponseSample* slow = trial_of(*found.slow, cell, number))
      return {decode(*slow, found.slow->sample_range), 0.0, true};
  return {decode(*sample, found.bouncing->sample_range), 1.0, true};
}

Draw draw_once(const FoundResponse& found, ResponseDraw draw, RandomStream& random) {
  if (draw == ResponseDraw::empirical && !found.bouncing->sample.empty())
    return draw_empirical(found, random);
  if (draw == ResponseDraw::correlated && !found.bouncing->factor.empty())
    return draw_correlated(found, random);
  return draw_independent(found, random);
}

// A Gaussian number made lognormal, mean m and deviation σ kept, where it might be negative: m exp(τ x −
// τ²/2) of a standard normal x has the mean m, and with τ² = ln(1 + σ²/m²) (`square`) the deviation σ.
double keep_out(double drawn, double mean, double deviation) {
  constexpr double kSafe = 3.0;  // deviations
  if (deviation <= 0.0 || mean >= kSafe * deviation) return drawn;
  if (mean <= 0.0) return 0.0;
  const double square = std::log1p((deviation / mean) * (deviation / mean));
  return mean * std::exp(std::sqrt(square) * (drawn - mean) / deviation - 0.5 * square);
}

}  // namespace

FoundResponse find_response(const Signature& signature, const CollisionConfiguration& c,
                            double bounce_velocity, bool interpolate) {
  if (signature.by_speed.size() > 0) return find_by_speed(signature.by_speed, c, interpolate);
  return find_scale_free(signature, c, bounce_velocity, interpolate);
}

DrawnVelocities draw_response(const FoundResponse& found, const CollisionConfiguration& c, double restitution,
                              ResponseDraw draw, RandomStream& random) {
  const double s = c.speed_unit(), speed = s > 0.0 ? c.speed / s : 0.0;
  const Draw d = draw_once(found, draw, random);
  const Vec3 particle(d.restitution_part * restitution * speed * std::cos(c.theta), speed * std::sin(c.theta),
                      0.0);
  DrawnVelocities drawn{particle + d.response.head<3>().cast<double>(), d.response.tail<3>().cast<double>()};
  if (!d.trial)
    drawn.linear.x() =
        keep_out(drawn.linear.x(), particle.x() + double(found.mean[0]), double(found.deviation[0]));
  drawn.linear.x() = std::max(0.0, drawn.linear.x());
  return drawn;
}

}  // namespace lodestone
