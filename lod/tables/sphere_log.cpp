#include "lod/tables/sphere_log.h"

#include <algorithm>

namespace lodestone {
namespace {

void write_contact(const SphereScene& scene, const NearGround& ground, const SphereContact& c,
                   ContactLog& log) {
  if (c.impulse <= 0.0f) return;
  const Vec3 normal(double(c.nx), double(c.ny), double(c.nz));
  if (c.second >= kGroundPlace) {
    const HalfSpace& under = ground.plane(std::int32_t(c.second - kGroundPlace));
    return log.add(
        {.first = scene.spheres.owner[c.first],
         .ground = under.id,
         .ground_material = under.material,
         .point = scene.spheres.position(c.first) - double(scene.ground_height(c.first, -normal)) * normal,
         .normal = normal,
         .impulse = double(c.impulse),
         .approach = std::max(0.0, -double(c.closing))});
  }
  log.add({.first = scene.spheres.owner[c.first],
           .second = scene.spheres.owner[c.second],
           .point = scene.meeting_point(c.first, c.second),
           .normal = normal,
           .impulse = double(c.impulse),
           .approach = std::max(0.0, -double(c.closing))});
}

}  // namespace

void write_contacts(const SphereScene& scene, const NearGround& ground, std::span<const SphereContact> passed,
                    ContactLog& log) {
  scene.contacts.each([&](const SphereContact& c) { write_contact(scene, ground, c, log); });
  for (const SphereContact& c : passed) write_contact(scene, ground, c, log);
}

void write_lying(const SphereScene& scene, const NearGround& ground, ContactLog& log) {
  for (std::int64_t i = 0; i < scene.spheres.awake; ++i) {
    const std::uint8_t state = scene.step.on_ground[std::size_t(i)];
    if (state != std::uint8_t(GroundState::lies) && state != std::uint8_t(GroundState::settles)) continue;
    const HalfSpace& under = ground.plane(scene.step.plane[std::size_t(i)]);
    const double pressing =
        std::max(0.0, -scene.settings.gravity.dot(under.normal)) * scene.constants.wide_time;  // m/s
    log.add({.first = scene.spheres.owner[std::size_t(i)],
             .ground = under.id,
             .ground_material = under.material,
             .point = scene.spheres.position(i) - double(scene.spheres.radius[std::size_t(i)]) * under.normal,
             .normal = under.normal,
             .impulse = std::max(pressing, double(scene.step.a[std::size_t(i)].w)) /
                        scene.spheres.inverse_mass[std::size_t(i)]});
  }
}

}  // namespace lodestone
