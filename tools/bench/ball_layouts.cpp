#include "tools/bench/ball_layouts.h"

#include <array>
#include <cmath>

#include "reference/random.h"

namespace lodestone {
namespace {

constexpr double kRadius = 0.1, kBallReach = 1.05 * kRadius;  // m, but for mixed sizes

RandomStream stream(std::uint64_t seed, int ball) { return {seed, std::uint64_t(ball), 0xba115}; }

// On places of a lattice, off them by a fifth of the spacing at most.
Balls lattice(int balls, std::uint64_t seed, double spacing, std::array<int, 3> places) {
  Balls all;
  for (int i = 0; i < balls; ++i) {
    RandomStream random = stream(seed, i);
    const Vec3 place(i % places[0], i / places[0] % places[1], i / places[0] / places[1]);
    const double z = places[2] == 1 ? 0.0 : random.uniform(-0.2, 0.2), y = random.uniform(-0.2, 0.2),
                 x = random.uniform(-0.2, 0.2);
    all.add(spacing * (place + Vec3(x, y, z)), kBallReach);
  }
  return all;
}

int root_of(int balls, double power) {
  return std::max(1, int(std::ceil(std::pow(double(balls), power) - 1e-9)));
}

Balls layer(int balls, std::uint64_t seed) {
  const int side = root_of(balls, 0.5);
  return lattice(balls, seed, 2.0 * kRadius, {side, side, 1});
}

Balls pile(int balls, std::uint64_t seed) {
  const int side = root_of(balls, 1.0 / 3);
  return lattice(balls, seed, 2.0 * kRadius, {side, side, side});
}

// A ball in 8 m³.
Balls sparse(int balls, std::uint64_t seed) {
  const double side = 2.0 * std::cbrt(double(balls));
  Balls all;
  for (int i = 0; i < balls; ++i) {
    RandomStream random = stream(seed, i);
    const double x = random.uniform(0.0, side), y = random.uniform(0.0, side);
    all.add({x, y, random.uniform(0.0, side)}, kBallReach);
  }
  return all;
}

// On the ground, a hundred in a square metre: pebbles of 1 cm; every 100th a stone of 10 cm, every 1,000th
// one of 1 m, every 30,000th, at least one, a boulder of 10 m.
Balls mixed(int balls, std::uint64_t seed) {
  const double side = 0.1 * std::sqrt(double(balls));
  Balls all;
  for (int i = 0; i < balls; ++i) {
    RandomStream random = stream(seed, i);
    const double size = i % 30'000 == 0 ? 10.0 : i % 1'000 == 1 ? 1.0 : i % 100 == 2 ? 0.1 : 0.01;
    const double radius = 0.5 * size * random.uniform(0.8, 1.0), x = random.uniform(0.0, side),
                 y = random.uniform(0.0, side);
    all.add({x, y, radius}, 1.05 * radius);
  }
  return all;
}

Balls line(int balls, std::uint64_t seed) { return lattice(balls, seed, 2.0 * kRadius, {1, balls, 1}); }

// A layer, and one ball in a thousand, five at most, that has flown off by 100 km and more.
Balls outliers(int balls, std::uint64_t seed) {
  Balls all = layer(balls, seed);
  const int far = std::min(5, 1 + balls / 1'000);
  for (int i = 0; i < far && i < balls; ++i) {
    const Vec3 away = 1e5 * (i + 1) * stream(seed, balls + i).direction();
    all.x[std::size_t(i)] += away.x(), all.y[std::size_t(i)] += away.y(), all.z[std::size_t(i)] += away.z();
  }
  return all;
}

constexpr std::array<BallLayout, 6> kLayouts = {
    {{"layer", "one layer of touching balls", layer},
     {"pile", "a cube of touching balls", pile},
     {"sparse", "a ball in 8 m3 of air", sparse},
     {"mixed", "pebbles of 1 cm, stones of 10 cm and 1 m, boulders of 10 m on the ground", mixed},
     {"line", "all in one row", line},
     {"outliers", "a layer, and a few balls 100 km away and more", outliers}}};

}  // namespace

void Balls::add(const Vec3& center, double radius) {
  x.push_back(center.x()), y.push_back(center.y()), z.push_back(center.z()), reach.push_back(float(radius));
}

bool Balls::meet(std::size_t a, std::size_t b) const {
  const double limit = double(reach[a]) + double(reach[b]);
  return Vec3(x[a] - x[b], y[a] - y[b], z[a] - z[b]).squaredNorm() < limit * limit;
}

std::span<const BallLayout> ball_layouts() { return kLayouts; }

Balls move(const Balls& first, double speed, int steps, std::uint64_t seed) {
  constexpr int kTurn = 4;
  const int out = steps % (2 * kTurn) <= kTurn ? steps % (2 * kTurn) : 2 * kTurn - steps % (2 * kTurn);
  Balls balls = first;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Vec3 way = speed / 60.0 * out * RandomStream(seed, i, 0x3a4e).direction();
    balls.x[i] += way.x(), balls.y[i] += way.y(), balls.z[i] += way.z();
  }
  return balls;
}

}  // namespace lodestone
