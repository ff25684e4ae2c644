// The signatures that a manager's statistical bodies need, each asked for once.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lod/manager/background_signatures.h"
#include "lod/signatures.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

class SignatureStore {
 public:
  /// `source` empty: find_or_measure_signature with its defaults, in the background on half of the cores.
  SignatureStore(SignatureFunction source, SignatureTiming timing);

  /// Whether find() would return at once. Where not, a thread begins to make it so. Throws InputError where the signature cannot be had.
  bool ready(const Shape& shape, const ContactLaw& law);
  /// The signature of `shape`, or of a scaled copy of it, under `law`; null where the source has none.
  std::shared_ptr<const Signature> find(const Shape& shape, const ContactLaw& law);
  std::int64_t loaded() const { return loaded_; }

 private:
  struct Entry {
    std::uint64_t shape_hash;
    ContactLaw law;
    std::shared_ptr<const Signature> signature;
    FutureSignature pending;  // valid until it is in `signature`
  };
  Entry* find_entry(const Shape& shape, const ContactLaw& law);
  std::shared_ptr<const Signature> take(Entry& entry);

  SignatureFunction source_;
  bool in_background_;
  std::vector<Entry> entries_;
  std::int64_t loaded_ = 0;
  std::unique_ptr<BackgroundSignatures> background_;  // made when it is first needed
};

}  // namespace lodestone
