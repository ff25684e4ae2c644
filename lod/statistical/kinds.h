// The kinds of body in a world: what all bodies of one shape, mass and material share, on either statistical rung.
#pragma once

#include <unordered_map>
#include <vector>

#include "lod/body.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

class Kinds {
 public:
  /// The number of a kind that is known or new, ready for bodies of `model`. `tables` needs a signature.
  std::uint16_t find(StatisticalModel model, std::shared_ptr<const Shape> shape, double mass, MaterialId material, std::shared_ptr<const Signature> signature);

  std::size_t size() const { return kinds_.size(); }
  const BodyKind& operator[](std::size_t kind) const { return kinds_[kind]; }
  auto begin() const { return kinds_.begin(); }
  auto end() const { return kinds_.end(); }

 private:
  struct Key {
    const Shape* shape;
    const Signature* signature;
    double mass;
    MaterialId material;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  void prepare(StatisticalModel model, BodyKind& kind);

  std::vector<BodyKind> kinds_;
  std::unordered_map<Key, std::uint16_t, Hash> known_;
};

}  // namespace lodestone
