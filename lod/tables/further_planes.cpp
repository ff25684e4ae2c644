#include "lod/tables/further_planes.h"

#include <algorithm>

namespace lodestone {

// Who has contacts with others.
void FurtherPlanes::note_paired() {
  paired_.assign(std::size_t(scene_.spheres.awake), 0);
  scene_.contacts.each([&](const SphereContact& c) {
    paired_[c.first] = 1;
    if (c.second < paired_.size()) paired_[c.second] = 1;
  });
}

void FurtherPlanes::find() {
  const auto everywhere = std::int32_t(scene_.ground.planes().size());
  touches_.clear();
  if (everywhere + ground_.faces() < 2) return;
  const bool hulls = scene_.constants.hulls;
  if (hulls) note_paired();
  scene_.step.each(GroundState::near, 0, scene_.spheres.awake, [&](std::int64_t i) {
    if (hulls && !paired_[std::size_t(i)] && scene_.is_alone(i)) return;  // its hull, on all of them
    for (std::int32_t number = 0; number < everywhere; ++number) look(i, number);
    ground_.each_face_of(i, [&](std::int32_t number) { look(i, number); });
  });
  if (touches_.empty()) return;
  scene_.contacts.add_ground(scene_.spheres, touches_, scene_.bounce_velocity(), scene_.constants);
}

void FurtherPlanes::look(std::int64_t i, std::int32_t number) {
  if (number == scene_.step.plane[std::size_t(i)]) return;
  const HalfSpace& other = ground_.plane(number);
  const Vec3 ground = ground_.planes().velocity(std::size_t(number)), velocity = scene_.spheres.velocity(i);
  const float gap =
                  float(other.height_of(scene_.spheres.position(i))) - scene_.ground_height(i, -other.normal),
              closing = float((velocity - ground).dot(other.normal));
  const BodyKind& kind = scene_.kind_of(i);
  if (gap + closing * scene_.constants.time > scene_.contacts.settings().touching * float(kind.shape->radius))
    return;
  const Vec3& n = other.normal;
  touches_.push_back({.place = std::uint32_t(i),
                      .plane = std::uint32_t(number),
                      .normal = {float(n.x()), float(n.y()), float(n.z())},
                      .velocity = {float(ground.x()), float(ground.y()), float(ground.z())},
                      .gap = gap,
                      .closing = closing,
                      .flush = scene_.constants.hulls && scene_.lies_flush(i, -other.normal),
                      .law = scene_.materials.law(kind.material, other.material)});
}

bool FurtherPlanes::touches(std::int64_t place) const {
  return std::ranges::binary_search(touches_, std::uint32_t(place), {}, &PlaneTouch::place);
}

}  // namespace lodestone
