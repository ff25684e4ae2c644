#include "reference/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/error.h"

namespace lodestone {
namespace {

void check_contact(double restitution, double friction) {
  if (!(restitution >= 0.0 && restitution <= 1.0))
    throw_input_error("restitution", fmt::to_string(restitution), "0 … 1");
  if (!(friction >= 0.0 && std::isfinite(friction)))
    throw_input_error("friction", fmt::to_string(friction), "a finite number of 0 or more");
}

void check(const Material& material) {
  check_contact(material.restitution, material.friction);
  if (!(material.density > 0.0 && std::isfinite(material.density)))
    throw_input_error("density", fmt::format("{} kg/m³", material.density), "a positive, finite number");
}

// √(ab), where ab is more than a double holds, too.
double geometric_mean(double a, double b) {
  const double product = a * b;
  return std::isfinite(product) ? std::sqrt(product) : std::sqrt(a) * std::sqrt(b);
}

}  // namespace

MaterialId MaterialTable::add(const Material& material) {
  check(material);
  materials_.push_back(material);
  rebuild();
  return int(materials_.size()) - 1;
}

void MaterialTable::replace(MaterialId id, const Material& material) {
  check_known(id);
  check(material);
  materials_[id] = material;
  rebuild();
}

void MaterialTable::set_law(MaterialId a, MaterialId b, const ContactLaw& law) {
  check_known(a), check_known(b);
  check_contact(law.restitution, law.friction);
  std::erase_if(listed_,
                [&](const Listed& known) { return std::minmax(known.a, known.b) == std::minmax(a, b); });
  listed_.push_back({a, b, law});
  rebuild();
}

void MaterialTable::check_known(MaterialId id) const {
  if (!has(id))
    throw_input_error("material", fmt::to_string(id),
                      fmt::format("0 … {}, as many as were added", size() - 1));
}

void MaterialTable::rebuild() {
  const std::size_t n = materials_.size();
  laws_.resize(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      laws_[i * n + j] = {std::min(materials_[i].restitution, materials_[j].restitution),
                          geometric_mean(materials_[i].friction, materials_[j].friction)};
  for (const auto& [a, b, law] : listed_) laws_[a * n + b] = laws_[b * n + a] = law;
}

}  // namespace lodestone
