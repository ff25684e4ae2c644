#include "tools/compare/unseen_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "reference/error.h"
#include "tools/compare/solid_meshes.h"

namespace lodestone {
namespace {

constexpr double kSize = 0.3;  // m

// Lengths in any unit: each is scaled to kSize.

Mesh letter(std::vector<std::string> rows, std::vector<double> columns, std::vector<double> heights) {
  return make_cell_mesh(
      {.x = std::move(columns), .y = std::move(heights), .z = {1.0}, .layers = {std::move(rows)}});
}

Mesh chair() {
  const std::vector<std::string> legs = {"#.#", "...", "#.#"}, seat = {"###", "###", "###"},
                                 back = {"###", "...", "..."};
  return make_cell_mesh({.x = {1, 8, 1}, .y = {1, 8, 1}, .z = {9, 1, 9}, .layers = {legs, seat, back}});
}

Mesh table() {
  const std::vector<std::string> legs = {".....", ".#.#.", ".....", ".#.#.", "....."}, top(5, "#####");
  return make_cell_mesh({.x = {2, 1, 14, 1, 2}, .y = {1, 1, 8, 1, 1}, .z = {10, 1}, .layers = {legs, top}});
}

Mesh gear() {
  std::vector<double> radii;
  for (int tooth = 0; tooth < 12; ++tooth) radii.insert(radii.end(), {1.0, 1.0, 0.8, 0.8});
  return make_star_prism(radii, 0.4);
}

Mesh star() {
  std::vector<double> radii;
  for (int point = 0; point < 5; ++point) radii.insert(radii.end(), {1.0, 0.42});
  return make_star_prism(radii, 0.35);
}

Mesh wedge() {
  const std::array<Vec3, 6> corners = {{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {3, 2, 0}, {0, 0, 1}, {0, 2, 1}}};
  return make_hull_mesh(corners);
}

constexpr std::array kShapes = {
    UnseenShape{"random_hull_10",
                [] {
                  return make_random_hull(10, {1.0, 1.0, 1.0}, 1);
                }},
    UnseenShape{"random_hull_40",
                [] {
                  return make_random_hull(40, {1.0, 0.8, 0.6}, 2);
                }},
    UnseenShape{"random_hull_flat",
                [] {
                  return make_random_hull(30, {1.0, 0.7, 0.25}, 3);
                }},
    UnseenShape{"torus", [] { return make_torus(1.0, 0.4, 32, 16); }},
    UnseenShape{"ring", [] { return make_torus(1.0, 0.12, 40, 10); }},
    UnseenShape{"chair", chair},
    UnseenShape{"table", table},
    UnseenShape{"letter_t",
                [] {
                  return letter({"###", ".#."}, {1, 1, 1}, {3, 1});
                }},
    UnseenShape{"letter_u",
                [] {
                  return letter({"#.#", "###"}, {1, 2, 1}, {1, 3});
                }},
    UnseenShape{"letter_e",
                [] {
                  return letter({"##", "#.", "##", "#.", "##"}, {1, 2}, {1, 1, 1, 1, 1});
                }},
    UnseenShape{"thin_plate",
                [] {
                  return make_box({1.0, 0.7, 0.03});
                }},
    UnseenShape{"needle", [] { return make_needle(1.0, 0.03); }},
    UnseenShape{"gear", gear},
    UnseenShape{"star", star},
    UnseenShape{"wedge", wedge},
    UnseenShape{"frustum", [] { return make_frustum(16, 1.0, 0.5, 1.2); }},
};

}  // namespace

std::span<const UnseenShape> unseen_shapes() { return kShapes; }

std::shared_ptr<const Shape> make_unseen_shape(std::string_view name) {
  const auto found = std::ranges::find(kShapes, name, &UnseenShape::name);
  check_that(found != kShapes.end(), "an unseen shape of this name", std::string(name));
  return std::make_shared<const Shape>(make_shape(std::string(name), scale_to_size(found->mesh(), kSize)));
}

}  // namespace lodestone
