#include "tools/methods/drop_ground.h"

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

// All over the body's size.
constexpr double kTile = 1.25, kLedge = 0.15, kRise = 0.4, kRun = 0.75, kReach = 10.0, kCell = 0.3;
constexpr int kSteps = 8;

// Of a grid of boxes whose tops are at `height_of(i, k)`.
template <class HeightOf>
std::vector<StaticBox> make_grid(double size, const HeightOf& height_of) {
  constexpr int kBoxes = int(kReach / kTile);  // to each side
  const double side = kTile * size;
  std::vector<StaticBox> boxes;
  for (int i = -kBoxes; i < kBoxes; ++i)
    for (int k = -kBoxes; k < kBoxes; ++k)
      boxes.push_back(
          {Vec3::Constant(side), {(i + 0.5) * side, (k + 0.5) * side, height_of(i, k) - 0.5 * side}});
  return boxes;
}

// Each stands on the floor at the foot of all.
std::vector<StaticBox> make_stairs(double size) {
  const double rise = kRise * size, run = kRun * size, reach = 2.0 * kReach * size;
  std::vector<StaticBox> boxes;
  for (int i = 0; i <= kSteps; ++i) {
    const double end = i < kSteps ? i * run : reach, height = (kSteps - i + 1) * rise;
    boxes.push_back({{end + reach, 2.0 * reach, height},
                     {0.5 * (end - reach), 0.0, -(kSteps + 1) * rise + 0.5 * height}});
  }
  return boxes;
}

Mesh make_waves(double height, double length, double size) {
  constexpr int kCells = int(2.0 * kReach / kCell);
  const double cell = kCell * size, turn = 2.0 * std::numbers::pi / (length * size);
  Mesh mesh;
  for (int i = 0; i <= kCells; ++i)
    for (int k = 0; k <= kCells; ++k) {
      const double x = (i - 0.5 * kCells) * cell, y = (k - 0.5 * kCells) * cell;
      mesh.vertices.push_back({x, y, height * size * std::sin(turn * x) * std::cos(turn * y / 1.3)});
    }
  for (int i = 0; i < kCells; ++i)
    for (int k = 0; k < kCells; ++k) {
      const int a = i * (kCells + 1) + k, b = a + kCells + 1;
      mesh.faces.push_back({a, b, b + 1}), mesh.faces.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

}  // namespace

GroundSolidsOfWorld make_drop_ground(DropGround ground, double size) {
  switch (ground) {
    case DropGround::tiles:
      return {make_grid(size, [](int, int) { return 0.0; }), {}};
    case DropGround::ledges:
      return {make_grid(size, [size](int i, int k) { return kLedge * size * ((7 * i + 13 * k + 100) % 5); }),
              {}};
    case DropGround::stairs:
      return {make_stairs(size), {}};
    case DropGround::hills:
      return {{}, {make_waves(0.3, 5.0, size)}};
    case DropGround::waves:
      return {{}, {make_waves(0.05, 1.1, size)}};
    case DropGround::plane:
      break;
  }
  return {};
}

}  // namespace lodestone
