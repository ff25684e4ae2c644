// Materials, and the contact law of each pair of them.
#pragma once

#include <vector>

namespace lodestone {

/// What a body or a piece of ground is made of; all numbers are finite.
struct Material {
  double restitution = 0.4;  ///< Newton's coefficient of normal restitution, 0 … 1
  double friction = 0.5;     ///< Coulomb's coefficient of friction, ≥ 0
  double density = 1000.0;   ///< kg/m³, > 0
};

/// The law of contacts between two materials; coefficients as in Material.
struct ContactLaw {
  double restitution = 0.4;  ///< 0 … 1
  double friction = 0.5;     ///< ≥ 0
  friend bool operator==(const ContactLaw&, const ContactLaw&) = default;
};

using MaterialId = int;  ///< index into a MaterialTable; 0 is the default material

/// The materials of a scene. A pair of materials has the lower restitution and √(μ₁ μ₂), unless a law was set
/// for it. Functions that change the table throw InputError, and change nothing, for numbers that are out of
/// the ranges above or not finite, and for materials that the table does not have.
class MaterialTable {
 public:
  /// With the default material alone.
  MaterialTable() { add(Material{}); }
  /// With the default material alone, and `law` between two of it.
  explicit MaterialTable(const ContactLaw& law) : MaterialTable() { set_law(0, 0, law); }
  MaterialId add(const Material& material);
  void replace(MaterialId id, const Material& material);            ///< laws that were set for it stay
  void set_law(MaterialId a, MaterialId b, const ContactLaw& law);  ///< in either order; they may be the same
  // Reading. The table must have the materials: that is not checked.
  const Material& operator[](MaterialId id) const { return materials_[id]; }
  ContactLaw law(MaterialId a, MaterialId b) const { return laws_[a * materials_.size() + b]; }
  int size() const { return int(materials_.size()); }
  bool has(MaterialId id) const { return id >= 0 && id < size(); }
  void check_known(MaterialId id) const;  ///< throws InputError unless has(id)

 private:
  struct Listed {
    MaterialId a, b;
    ContactLaw law;
  };
  void rebuild();
  std::vector<Material> materials_;
  std::vector<Listed> listed_;
  std::vector<ContactLaw> laws_;  // dense size × size
};

}  // namespace lodestone
