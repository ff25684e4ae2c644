#include "lod/statistical/kinds.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "reference/error.h"

namespace lodestone {
namespace {

template <class... Part>
std::size_t hash_of(const Part&... part) {
  std::size_t hash = 0;
  ((hash = (hash ^ std::hash<Part>()(part)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32), ...);
  return hash;
}

// With its shape, whose hull it refers to.
std::shared_ptr<const RestingFaces> make_faces(const std::shared_ptr<const Shape>& shape) {
  struct Held {
    std::shared_ptr<const Shape> shape;
    RestingFaces faces;
  };
  const auto held = std::make_shared<const Held>(Held{shape, RestingFaces(shape->hull)});
  return {held, &held->faces};
}

}  // namespace

std::size_t Kinds::Hash::operator()(const Key& key) const {
  return hash_of(key.shape, key.signature, key.material);
}
std::size_t Kinds::Hash::operator()(const PartsKey& key) const {
  return hash_of(key.shape_hash, key.signature);
}

std::uint32_t Kinds::take(StatisticalModel model, std::shared_ptr<const Shape> shape, MaterialId material,
                          std::shared_ptr<const Signature> signature) {
  const auto known = known_.find({shape.get(), signature.get(), material});
  const std::uint32_t number = known != known_.end()
                                   ? known->second
                                   : add(make_body_kind(std::move(shape), std::move(signature), material));
  prepare(model, kinds_[number]);
  ++uses_[number].bodies;
  return number;
}

std::uint32_t Kinds::add(BodyKind kind) {
  if (free_.empty()) {
    free_.push_back(std::uint32_t(kinds_.size()));
    kinds_.emplace_back();
    uses_.emplace_back();
  }
  const std::uint32_t number = free_.back();
  known_.emplace(key_of(kind), number);
  free_.pop_back();
  kinds_[number] = std::move(kind);
  uses_[number].birth = ++births_;
  return number;
}

void Kinds::give_back(std::uint32_t number) {
  check_that(uses_[number].bodies > 0, "a kind that is given back was taken");
  if (--uses_[number].bodies > 0) return;
  const PartsKey key = parts_key_of(kinds_[number]);
  known_.erase(key_of(kinds_[number]));
  kinds_[number] = {};
  free_.push_back(number);
  if (const auto parts = parts_.find(key);
      parts != parts_.end() && parts->second.clips.expired() && parts->second.faces.expired())
    parts_.erase(parts);
}

std::vector<KindSignature> Kinds::signatures() const {
  std::vector<KindSignature> found;
  for (const BodyKind& kind : kinds_) {
    if (!kind.signature) continue;
    auto known = std::ranges::find(found, kind.signature, &KindSignature::signature);
    if (known == found.end()) known = found.insert(found.end(), {kind.signature, kind.shape});
    known->tables |= kind.faces != nullptr;
  }
  return found;
}

void Kinds::archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures) {
  struct Known {
    std::shared_ptr<const Shape> shape;  // null: a number that no kind has
    MaterialId material = 0;
    std::uint32_t signature = 0;  // 0: none; else its place, from 1 on
    bool tables = false, support = false;
    void archive(StateArchive& b) { b(shape, material, signature, tables, support); }
  };
  std::vector<Known> known;
  for (const BodyKind& kind : kinds_) {
    const auto place = std::ranges::find(signatures, kind.signature) - signatures.begin();
    known.push_back({kind.shape, kind.material, kind.signature ? std::uint32_t(place) + 1 : 0,
                     kind.faces != nullptr, kind.clips != nullptr});
  }
  a(known, uses_, free_, births_);
  if (!a.reading()) return;
  kinds_.assign(known.size(), {});
  known_.clear();
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Known& kind = known[i];
    if (!kind.shape) continue;
    check_that(kind.signature <= signatures.size(), "a snapshot has the signatures that it names");
    kinds_[i] = make_body_kind(kind.shape, kind.signature > 0 ? signatures[kind.signature - 1] : nullptr,
                               kind.material);
    known_.emplace(key_of(kinds_[i]), std::uint32_t(i));
    if (kind.tables) prepare(StatisticalModel::tables, kinds_[i]);
    if (kind.support) prepare(StatisticalModel::support, kinds_[i]);
  }
}

// What only one model asks for is made when its first body comes.
void Kinds::prepare(StatisticalModel model, BodyKind& kind) {
  const bool tables = model == StatisticalModel::tables;
  if (tables) check_that(kind.signature != nullptr, "the tables model needs a signature");
  if (tables && !kind.faces && !kind.shape->sphere_radius) {
    std::weak_ptr<const RestingFaces>& known = parts_[parts_key_of(kind)].faces;
    kind.faces = known.lock();
    if (!kind.faces) known = kind.faces = make_faces(kind.shape);
  }
  if ((!tables || clips_at_tables_) && kind.signature && !kind.clips) {
    std::weak_ptr<const ClipIndex>& known = parts_[parts_key_of(kind)].clips;
    kind.clips = known.lock();
    const double radius = kind.shape->radius;
    if (!kind.clips)
      known = kind.clips = std::make_shared<const ClipIndex>(
          *kind.signature, kind.shape->inertia_per_mass / (radius * radius));
  }
}

}  // namespace lodestone
