// The properties of those few bodies that have others than all the rest, by owner.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "lod/ground/half_space.h"
#include "reference/body_properties.h"
#include "reference/state_archive.h"

namespace lodestone {

class OwnProperties {
 public:
  bool empty() const { return own_.empty(); }
  bool has(std::uint32_t owner) const { return !own_.empty() && own_.contains(owner); }
  const BodyProperties& of(std::uint32_t owner) const {
    static const BodyProperties usual;
    if (own_.empty()) return usual;
    const auto own = own_.find(owner);
    return own == own_.end() ? usual : own->second;
  }
  void set(std::uint32_t owner, const BodyProperties& properties) {
    if (properties == BodyProperties{})
      own_.erase(owner);
    else
      own_[owner] = properties;
  }
  void forget(std::uint32_t owner) { own_.erase(owner); }
  void archive(StateArchive& a) { a(own_); }

 private:
  std::unordered_map<std::uint32_t, BodyProperties> own_;
};

inline bool may_meet(const BodyProperties& a, const BodyProperties& b) {
  return may_meet(a.category, a.collide, b.category, b.collide);
}
inline bool meets_ground(const BodyProperties& a, const GroundBits& bits = {}) {
  return may_meet(a.category, a.collide, bits.category, bits.collide);
}
/// Whether a settling clip, recorded under gravity and nothing else, is how it comes to rest.
inline bool moves_by_itself(const BodyProperties& p) {
  BodyProperties bits_only;
  bits_only.category = p.category, bits_only.collide = p.collide;
  return p == bits_only && meets_ground(p);
}

}  // namespace lodestone
