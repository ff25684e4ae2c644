// Materials and what a pair of them does at a contact.
#pragma once

#include <vector>

namespace lodestone {

struct Material {
  double restitution = 0.4;  ///< Newton's coefficient of normal restitution, 0 … 1
  double friction = 0.5;     ///< Coulomb's coefficient, ≥ 0
  double density = 1000.0;   ///< kg/m³, > 0
};

/// What two touching materials do together.
struct ContactLaw {
  double restitution = 0.4;  ///< 0 … 1
  double friction = 0.5;     ///< ≥ 0
  friend bool operator==(const ContactLaw&, const ContactLaw&) = default;
};

using MaterialId = int;  ///< index into a MaterialTable; 0 is the default material

/// The materials of a scene. A pair takes the lower restitution and √(μ₁ μ₂) unless it is listed. What adds
/// to it throws InputError, and changes nothing, for numbers out of the ranges above or not finite, and for
/// materials that it does not have.
class MaterialTable {
 public:
  MaterialTable() { add(Material{}); }
  /// The default material, which does this with itself.
  explicit MaterialTable(const ContactLaw& law) : MaterialTable() { set_law(0, 0, law); }
  MaterialId add(const Material& material);
  void replace(MaterialId id, const Material& material);
  void set_law(MaterialId a, MaterialId b, const ContactLaw& law);
  const Material& operator[](MaterialId id) const { return materials_[id]; }
  ContactLaw law(MaterialId a, MaterialId b) const { return laws_[a * materials_.size() + b]; }
  int size() const { return int(materials_.size()); }
  bool has(MaterialId id) const { return id >= 0 && id < size(); }
  void check_known(MaterialId id) const;  ///< throws InputError where it has none of that id

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
