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

/// Six numbers in the frame (e1, e2, e3): (V_rigid − V_particle)/s, then RΩ⁺/s.
using Response = Eigen::Matrix<float, 6, 1>;

/// Lower triangle, row by row, of the Cholesky factor of a response's covariance.
using ResponseFactor = std::array<float, 21>;

/// How run-time draws follow the trials.
enum class ResponseDraw : std::uint8_t {
  independent,  ///< a Gaussian for each of the six numbers: the paper's
  correlated,   ///< one Gaussian in six dimensions
  empirical,    ///< one of the trials themselves
};

/// The approach of the contact point towards the plane over s: whether a collision is faster than ODE's
/// bounce_vel.
struct Approach {
  float mean = 0.0f, deviation = 0.0f;
};

/// A trial kept for empirical draws, 16 bits a number.
struct ResponseSample {
  std::array<std::int16_t, 6> response;  ///< over the table's sample_range; of 32767
  std::uint16_t approach;                ///< over s, over 2; of 65535
};

/// What the trials of each cell of a table gave. `factor` only for correlated draws, `first_sample` and
/// `sample` only for empirical ones.
struct ResponseCells {
  std::vector<Response> mean, deviation;
  std::vector<std::uint32_t> trials;  ///< behind each cell
  std::vector<Approach> approach;
  std::vector<ResponseFactor> factor;
  std::vector<std::uint32_t> first_sample;  ///< of each cell's run of `sample`; one more than there are cells
  std::vector<ResponseSample> sample;
  float sample_range = 1.0f;
};

/// Responses over (θ, φ, α, ψ). ODE's impact law is the same at every speed above its bounce_vel, and so is
/// it below: ‖V⁻‖ and ‖Ω⁻‖ enter through their ratio alone. Cell centres: θ = (i + ½)π/(2 n_theta), φ = (j +
/// ½)π/n_phi, α = (k + ½)π/(2 n_alpha), ψ = 2π l/n_psi; cell index
/// ((i n_phi + j) n_alpha + k) n_psi + l. With n_psi = 1 a cell holds every ψ, as the paper's do.
struct ResponseTable {
  int n_theta = 0, n_phi = 0, n_alpha = 0, n_psi = 1;
  ResponseCells cells;
  std::int64_t size() const { return std::int64_t(n_theta) * n_phi * n_alpha * n_psi; }
  CollisionConfiguration center(std::int64_t cell) const;  ///< at a speed unit of 1 m/s
  /// Whose centre is nearest along every axis.
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
  /// Whose centre is nearest along every axis.
  std::int64_t find_cell(const CollisionConfiguration& c) const;
};

}  // namespace lodestone
