// The kinds of body in a world: what all bodies of one shape and material share, on either statistical rung.
// A kind is kept for as long as a body has it.
#pragma once

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "lod/body.h"
#include "lod/statistical/statistical_body.h"
#include "reference/state_archive.h"

namespace lodestone {

/// A signature that bodies move by.
struct KindSignature {
  std::shared_ptr<const Signature> signature;
  std::shared_ptr<const Shape> shape;  ///< of one of its kinds
  bool tables = false;                 ///< some are at `tables`
};

class Kinds {
 public:
  /// `clips_at_tables`: bodies of `tables` play settling clips, too.
  explicit Kinds(bool clips_at_tables = false) : clips_at_tables_(clips_at_tables) {}

  /// The number of a kind that is known or new, for one more body of `model`. `tables` needs a signature.
  std::uint32_t take(StatisticalModel model, std::shared_ptr<const Shape> shape, MaterialId material,
                     std::shared_ptr<const Signature> signature);
  /// A body less has it. A number that no body has is given to another kind in time.
  void give_back(std::uint32_t kind);

  /// The signatures that kinds have, each once. They must be known when kinds are read.
  std::vector<KindSignature> signatures() const;
  /// `signatures`: those of signatures(), where it reads as they were when that was written.
  void archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures);

  /// Numbers below it are, or were, those of kinds.
  std::size_t size() const { return kinds_.size(); }
  const BodyKind& operator[](std::size_t kind) const { return kinds_[kind]; }
  /// Differs between all the kinds that ever have this number; never 0.
  std::uint64_t birth(std::size_t kind) const { return uses_[kind].birth; }

 private:
  struct Key {
    const Shape* shape;
    const Signature* signature;
    MaterialId material;
    friend bool operator==(const Key&, const Key&) = default;
  };
  // Of scaled copies alike: their inertia over R² and where their hulls can stand do not depend on the size.
  struct PartsKey {
    std::uint64_t shape_hash;
    const Signature* signature;
    friend bool operator==(const PartsKey&, const PartsKey&) = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
    std::size_t operator()(const PartsKey& key) const;
  };
  // What takes long to make, shared by the kinds that have the same.
  struct Parts {
    std::weak_ptr<const ClipIndex> clips;
    std::weak_ptr<const RestingFaces> faces;
  };
  struct Use {
    std::uint64_t bodies = 0, birth = 0;
  };
  static Key key_of(const BodyKind& kind) { return {kind.shape.get(), kind.signature.get(), kind.material}; }
  static PartsKey parts_key_of(const BodyKind& kind) {
    return {kind.shape->content_hash, kind.signature.get()};
  }
  std::uint32_t add(BodyKind kind);
  void prepare(StatisticalModel model, BodyKind& kind);

  std::vector<BodyKind> kinds_;  // those without bodies are empty
  std::vector<Use> uses_;        // of each
  std::vector<std::uint32_t> free_;
  std::unordered_map<Key, std::uint32_t, Hash> known_;
  std::unordered_map<PartsKey, Parts, Hash> parts_;
  std::uint64_t births_ = 0;
  bool clips_at_tables_ = false;
};

}  // namespace lodestone
