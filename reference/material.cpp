#include "reference/material.h"

#include <algorithm>
#include <cmath>

#include "reference/error.h"

namespace lodestone {

MaterialId MaterialTable::add(const Material& material) {
  materials_.push_back(material);
  rebuild();
  return int(materials_.size()) - 1;
}

void MaterialTable::replace(MaterialId id, const Material& material) {
  check_that(id >= 0 && id < size(), "material id out of range");
  materials_[id] = material;
  rebuild();
}

void MaterialTable::set_law(MaterialId a, MaterialId b, const ContactLaw& law) {
  check_that(a >= 0 && a < size() && b >= 0 && b < size(), "material id out of range");
  listed_.push_back({a, b, law});
  rebuild();
}

void MaterialTable::rebuild() {
  const std::size_t n = materials_.size();
  laws_.resize(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      laws_[i * n + j] = {std::min(materials_[i].restitution, materials_[j].restitution),
                          std::sqrt(materials_[i].friction * materials_[j].friction)};
  for (const auto& [a, b, law] : listed_) laws_[a * n + b] = laws_[b * n + a] = law;
}

}  // namespace lodestone
