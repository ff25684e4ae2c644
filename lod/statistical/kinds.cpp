#include "lod/statistical/kinds.h"

#include <functional>
#include <utility>

#include "reference/error.h"

namespace lodestone {

std::size_t Kinds::Hash::operator()(const Key& key) const {
  std::size_t hash = std::hash<const void*>()(key.shape);
  const auto mix = [&](std::size_t part) { hash = (hash ^ part) * 0x9e3779b97f4a7c15u; };
  mix(std::hash<const void*>()(key.signature)), mix(std::hash<double>()(key.mass)), mix(std::size_t(key.material));
  return hash ^ (hash >> 32);
}

std::uint16_t Kinds::find(StatisticalModel model, std::shared_ptr<const Shape> shape, double mass, MaterialId material, std::shared_ptr<const Signature> signature) {
  const auto [known, fresh] = known_.try_emplace({shape.get(), signature.get(), mass, material}, std::uint16_t(kinds_.size()));
  if (fresh) {
    check_that(kinds_.size() < 65535, "at most 65,535 kinds of body");
    kinds_.push_back(make_body_kind(std::move(shape), std::move(signature), mass, material));
  }
  prepare(model, kinds_[known->second]);
  return known->second;
}

// What only one model asks for is made when its first body comes.
void Kinds::prepare(StatisticalModel model, BodyKind& kind) {
  if (model == StatisticalModel::tables) {
    check_that(kind.signature != nullptr, "the tables model needs a signature");
    if (!kind.faces && !kind.shape->sphere_radius) kind.faces = std::make_shared<const RestingFaces>(kind.shape->hull);
  } else if (kind.signature && kind.clips.empty()) {
    kind.clips = ClipIndex(*kind.signature, kind.shape->inertia_per_mass / (kind.shape->radius * kind.shape->radius), kGreatestClipDistance);
  }
}

}  // namespace lodestone
