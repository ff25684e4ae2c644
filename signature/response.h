// What a collision with a plane does to a body (section 3.2.2): the configuration before it, the response,
// and tables of responses.
//
// Symbols: n collision plane normal, V⁻ Ω⁻ velocities before the collision, e1 = n, e3 = n × V⁻ normalised
// (the working plane's normal), e2 = e3 × e1; θ = ∠(V⁻, −n), φ = ∠(V⁻, Ω⁻), ψ the azimuth of Ω⁻ about V⁻ (0
// on the side of e3 × V⁻, in the sampling plane), s = √(V² + R²Ω²), α = atan(R‖Ω⁻‖ / ‖V⁻‖); V_particle = V⁻ −
// (1 + e)(V⁻·n) n.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

/// How a body meets a plane: angles in rad, speeds in m/s.
struct CollisionConfiguration {
  double theta = 0.0, phi = 0.0, psi = 0.0;
  double speed = 1.0;  ///< ‖V⁻‖
  double spin = 0.0;   ///< R‖Ω⁻‖
  double alpha() const { return std::atan2(spin, speed); }
  double speed_unit() const { return std::hypot(speed, spin); }
};

/// A response: six numbers in the frame (e1, e2, e3), (V_rigid − V_particle)/s and then RΩ⁺/s.
using Response = Eigen::Matrix<float, 6, 1>;

/// The Cholesky factor of a response's covariance: its lower triangle, row by row.
using ResponseFactor = std::array<float, 21>;

/// How run-time draws follow the trials.
enum class ResponseDraw : std::uint8_t {
  independent,  ///< a Gaussian for each of the six numbers: the paper's
  correlated,   ///< one Gaussian in six dimensions
  empirical,    ///< one of the trials themselves
};

/// How fast the contact point approaches the plane, over s: it tells whether a collision is faster than ODE's
/// bounce_vel.
struct Approach {
  float mean = 0.0f, deviation = 0.0f;
};

/// A trial kept for empirical draws, with 16 bits for each number.
struct ResponseSample {
  std::array<std::int16_t, 6> response;  ///< over the table's sample_range; of 32767
  std::uint16_t approach;                ///< over s, over 2; of 65535
};

/// What the trials of each cell of a table gave, by cell. `factor` is empty unless draws are correlated,
/// `first_sample` and `sample` unless they are empirical.
struct ResponseCells {
  std::vector<Response> mean, deviation;
  std::vector<std::uint32_t> trials;  ///< number of trials of each cell
  std::vector<Approach> approach;
  std::vector<ResponseFactor> factor;
  std::vector<std::uint32_t> first_sample;  ///< cells + 1: where each one's run of `sample` begins
  std::vector<ResponseSample> sample;
  float sample_range = 1.0f;
};

/// Responses over (θ, φ, α, ψ). ODE's impact law is the same at every speed above its bounce_vel, and the
/// same at every speed below: so only the ratio of ‖V⁻‖ and ‖Ω⁻‖ matters. Cell centres:
/// θ = (i + ½)π/(2 n_theta), φ = (j + ½)π/n_phi, α = (k + ½)π/(2 n_alpha), ψ = 2π l/n_psi; cell index
/// ((i n_phi + j) n_alpha + k) n_psi + l. With n_psi = 1 a cell holds every ψ, as the paper's do.
struct ResponseTable {
  int n_theta = 0, n_phi = 0, n_alpha = 0, n_psi = 1;
  ResponseCells cells;
  std::int64_t size() const { return std::int64_t(n_theta) * n_phi * n_alpha * n_psi; }
  CollisionConfiguration center(std::int64_t cell) const;  ///< at a speed unit of 1 m/s
  /// The cell whose centre is nearest along every axis.
  std::int64_t find_cell(const CollisionConfiguration& c) const;
};

/// The paper's own table: responses over (θ, φ, ‖V⁻‖, ‖Ω⁻‖), on both sides of bounce_vel. Cell index ((i
/// n_phi + j) speeds + k) spins + l.
struct SpeedTable {
  int n_theta = 0, n_phi = 0;
  std::vector<float> speeds;  ///< ‖V⁻‖, m/s, rising
  std::vector<float> spins;   ///< R‖Ω⁻‖, m/s, rising from 0
  ResponseCells cells;
  std::int64_t size() const {
    return std::int64_t(n_theta) * n_phi * std::int64_t(speeds.size() * spins.size());
  }
  CollisionConfiguration center(std::int64_t cell) const;
  /// The cell whose centre is nearest along every axis.
  std::int64_t find_cell(const CollisionConfiguration& c) const;
};

}  // namespace lodestone
