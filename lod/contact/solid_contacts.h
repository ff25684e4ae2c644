// Where a body meets static boxes and meshes.
#pragma once

#include <optional>
#include <vector>

#include "lod/ground/static_ground.h"
#include "lod/contact/pair_contacts.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

struct SolidContact {
  std::int32_t slot = 0;  ///< of the body
  int solid = 0;          ///< index in StaticGround::solids
  PairContact contact;    ///< the normal points into the body
};

/// The face of `solid` that a ball about `center` lies over wholly, with the solid's other faces farther than `reach` beyond: there it is a plane like any
/// other. None near an edge.
std::optional<HalfSpace> find_face_below(const StaticSolid& solid, const Vec3& center, double reach);

/// Contacts of the body in `slot` that may close within `time` seconds, appended to `found`. Where the body lies over faces only, away from their edges,
/// there are none but these faces' planes, appended to `planes`.
void find_solid_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot, const StaticSolids& solids, double time,
                         std::vector<SolidContact>& found, std::vector<HalfSpace>& planes);

/// The faces of static solids that bodies lie over: planes, as far as these bodies are concerned.
struct FacesBelow {
  std::vector<HalfSpace> faces;
  std::vector<std::pair<std::int32_t, std::int32_t>> run;  ///< of each slot, in `faces`; empty where there are no solids
  std::span<const HalfSpace> of(std::int32_t slot) const {
    if (run.empty()) return {};
    const auto& [begin, end] = run[std::size_t(slot)];
    return std::span(faces).subspan(std::size_t(begin), std::size_t(end - begin));
  }
};

}  // namespace lodestone
