// The signatures that a manager's statistical bodies need, each asked for once.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Supplies the signature of a shape under a contact law, when a first statistical body needs it.
using SignatureFunction = std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&)>;

class SignatureStore {
 public:
  /// `source` empty: find_or_measure_signature with its defaults.
  explicit SignatureStore(SignatureFunction source) : source_(std::move(source)) {}

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
  };
  SignatureFunction source_;
  std::vector<Entry> entries_;
  std::int64_t loaded_ = 0;
};

}  // namespace lodestone
