#include "lod/signature_store.h"

#include "signature/signature_source.h"

namespace lodestone {

std::shared_ptr<const Signature> SignatureStore::find(const Shape& shape, const ContactLaw& law) {
  for (const Entry& entry : entries_)
    if (entry.shape_hash == shape.content_hash && entry.law == law) return entry.signature;
  entries_.push_back(
      {shape.content_hash, law, source_ ? source_(shape, law) : find_or_measure_signature(shape, law).signature});
  if (entries_.back().signature) ++loaded_;
  return entries_.back().signature;
}

const Signature* SignatureStore::find_known(const Shape& shape, const ContactLaw& law) const {
  for (const Entry& entry : entries_)
    if (entry.shape_hash == shape.content_hash && entry.law == law) return entry.signature.get();
  return nullptr;
}

}  // namespace lodestone
