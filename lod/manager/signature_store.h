// The signatures that a manager's statistical bodies need, each asked for once.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "lod/hooks.h"
#include "lod/manager/background_signatures.h"
#include "lod/signatures.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

class SignatureStore {
 public:
  /// `source` empty: find_or_measure_signature with its defaults, in the background on up to half of the
  /// cores.
  SignatureStore(SignatureFunction source, SignatureTiming timing);

  /// Whether find() would return at once. Where not, a thread begins to make it so. Throws InputError where
  /// the signature cannot be had.
  bool ready(const Shape& shape, const ContactLaw& law);
  /// The signature of `shape`, or of a scaled copy of it, under `law`; null where the source has none.
  std::shared_ptr<const Signature> find(const Shape& shape, const ContactLaw& law);
  /// Under which find() found it.
  const ContactLaw& law_of(const Signature& signature) const;
  /// Of what was found; else the averages. Asks for nothing.
  const RungErrors& errors(const Shape& shape, const ContactLaw& law) const;
  std::int64_t loaded() const { return loaded_; }
  /// Told, by ready() and find(), of each signature that is there, or cannot be had, and of what is in the
  /// way of keeping it in the cache.
  void set_log(LogFunction log) { log_ = std::move(log); }

 private:
  struct Entry {
    std::uint64_t shape_hash;
    ContactLaw law;
    std::shared_ptr<const Signature> signature;
    FutureSignature pending;  // valid until it is in `signature`
  };
  /// What is to be told once a call comes from the caller's thread.
  class Warnings {
   public:
    void add(const std::string& text);
    std::vector<std::string> take();

   private:
    std::mutex mutex_;
    std::vector<std::string> texts_;
  };
  static std::unique_ptr<BackgroundSignatures> make_background(const SignatureFunction& source,
                                                               const std::shared_ptr<Warnings>& warnings);
  void tell_warnings() const;
  Entry* find_entry(const Shape& shape, const ContactLaw& law);
  std::shared_ptr<const Signature> take(const Shape& shape, Entry& entry);
  template <class Get>
  std::shared_ptr<const Signature> logged(const Shape& shape, const Get& get) const;
  const Entry* find_entry(const Shape& shape, const ContactLaw& law) const {
    return const_cast<SignatureStore*>(this)->find_entry(shape, law);
  }

  SignatureFunction source_;
  bool in_background_;
  LogFunction log_;
  std::vector<Entry> entries_;
  std::int64_t loaded_ = 0;
  std::shared_ptr<Warnings> warnings_ = std::make_shared<Warnings>();  // the threads add to them
  std::unique_ptr<BackgroundSignatures> background_;                   // made when it is first needed
};

}  // namespace lodestone
