#include "tools/bench/table1_job.h"

#include <array>
#include <cmath>
#include <string_view>

#include "reference/random.h"

namespace lodestone {
namespace {

constexpr int kLayers = 6;
constexpr double kCell = 0.34, kLowest = 1.2, kLayerHeight = 0.7, kJitter = 0.15;  // m

struct PaperCell {
  std::string_view method;
  int bodies;
  PaperTimes times;
};

// Its table 1: impulse, low, 7-sphere, statistical.
constexpr std::array<PaperCell, 14> kPaper = {{
    {"full_plain", 10, {0.17861, 0.17535, 0.00018}},
    {"low", 10, {0.04699, 0.04363, 0.00035}},
    {"spheres7", 10, {0.01974, 0.01561, 0.00032}},
    {"statistical", 10, {0.00453, 0.00061, 0.00021}},
    {"full_plain", 100, {4.72734, 4.66885, 0.03072}},
    {"low", 100, {0.98305, 0.93947, 0.02231}},
    {"spheres7", 100, {0.15952, 0.12011, 0.01914}},
    {"statistical", 100, {0.05729, 0.02694, 0.00566}},
    {"full_plain", 1'000, {925.83944, 923.04164, 2.55375}},
    {"low", 1'000, {81.42146, 80.50417, 0.67762}},
    {"spheres7", 1'000, {9.24859, 7.12144, 1.87502}},
    {"statistical", 1'000, {6.91050, 5.87160, 0.77710}},
    {"spheres7", 10'000, {332.61309, 285.89991, 43.45081}},
    {"statistical", 10'000, {213.12389, 202.17268, 8.00835}},
}};

}  // namespace

DropJob make_table1_job() {
  return {.shape = std::make_shared<const Shape>(make_bunny_shape(0.2)),
          .conditions = {},
          .material = {.restitution = 0.3, .friction = 0.5}};
}

RigidState table1_start(int index, int bodies, std::uint64_t seed) {
  RandomStream random(seed, std::uint64_t(index), 0x7ab1e1);
  const int side = int(std::ceil(std::sqrt(double(bodies) / kLayers)));
  const int layer = index / (side * side), column = index % side, row = index / side % side;
  const double shift = (layer % 2 ? 0.5 : 0.0) - 0.5 * side;
  RigidState state;
  state.position = {kCell * (column + shift), kCell * (row + shift),
                    kLowest + kLayerHeight * layer + random.uniform(-kJitter, kJitter)};
  state.orientation = random.orientation();
  return state;
}

PaperTimes paper_times(const std::string& method, int bodies) {
  for (const PaperCell& cell : kPaper)
    if (cell.method == method && cell.bodies == bodies) return cell.times;
  return {};
}

}  // namespace lodestone
