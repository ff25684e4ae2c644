// What drops fall on other than a plane: boxes and meshes whose sizes are those of the body, about the
// origin.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "reference/geometry.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

enum class DropGround : std::uint8_t {
  plane,
  tiles,   ///< boxes of one height, side by side
  ledges,  ///< the same at five heights
  stairs,  ///< down along x from the origin on
  hills,   ///< a mesh, each way several times as long as the body
  waves,   ///< a mesh, each of about its length
};

struct NamedGround {
  DropGround ground;
  std::string_view name;
};
inline constexpr std::array<NamedGround, 5> kUnevenGrounds = {{{DropGround::tiles, "tiles"},
                                                              {DropGround::ledges, "ledges"},
                                                              {DropGround::stairs, "stairs"},
                                                              {DropGround::hills, "hills"},
                                                              {DropGround::waves, "waves"}}};

struct StaticBox {
  Vec3 sides, center;  ///< m
};

/// What a world stands on beside its planes.
struct GroundSolidsOfWorld {
  std::vector<StaticBox> boxes;
  std::vector<Mesh> meshes;
  bool empty() const { return boxes.empty() && meshes.empty(); }
};

/// For a body of `size` m, the longest side of its bounding box. None for a plane.
GroundSolidsOfWorld make_drop_ground(DropGround ground, double size);

}  // namespace lodestone
