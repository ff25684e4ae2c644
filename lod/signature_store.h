// The signatures that a manager's statistical bodies need, each asked for once.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lod/background_signatures.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Supplies the signature of a shape under a contact law, when a first statistical body needs it.
using SignatureFunction = std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&)>;

/// When a signature is had that a body needs for the first time.
enum class SignatureTiming : std::uint8_t {
  automatic,      ///< in_step from a source that was given, in_background where it is measured or found in the cache
  in_step,        ///< the step waits for it: the same levels in every run
  in_background,  ///< by a thread; the body is full until it is there
};

class SignatureStore {
 public:
  /// `source` empty: find_or_measure_signature with its defaults, in the background on half of the cores.
  SignatureStore(SignatureFunction source, SignatureTiming timing);

  /// Whether find() would return at once. Where not, a thread begins to make it so. Throws InputError where the signature cannot be had.
  bool ready(const Shape& shape, const ContactLaw& law);
  /// The signature of `shape`, or of a scaled copy of it, under `law`; null where the source has none.
  std::shared_ptr<const Signature> find(const Shape& shape, const ContactLaw& law);
  /// Null, too, where it was not asked for before.
  const Signature* find_known(const Shape& shape, const ContactLaw& law) const;
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
