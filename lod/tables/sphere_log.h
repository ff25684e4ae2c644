// Writes down what touched what in a step of `tables`, for whoever asked.
#pragma once

#include <span>

#include "lod/statistical/contact_log.h"
#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

/// The contacts that the step has, and `passed`, through which a blow went on.
void write_contacts(const SphereScene& scene, const NearGround& ground, std::span<const SphereContact> passed,
                    ContactLog& log);

/// Of those that lie on the ground; impacts are written where they are answered.
void write_lying(const SphereScene& scene, const NearGround& ground, ContactLog& log);

}  // namespace lodestone
