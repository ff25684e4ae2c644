// Where a signature comes from: the user's cache folder, or measured now and kept there.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Called while measuring with what is being done and the fraction done, 0 … 1; from one thread at a time.
using Progress = std::function<void(const std::string& stage, double fraction)>;

struct SignatureSourceSettings {
  SignatureSettings measuring;      ///< `law` is replaced by the one asked for
  bool use_cache = true;
  std::filesystem::path cache_folder;  ///< empty: $XDG_CACHE_HOME/lodestone, else ~/.cache/lodestone
  int threads = 0;                  ///< 0: all cores
  Progress progress;
};

/// A signature and how it was had.
struct SourcedSignature {
  std::shared_ptr<const Signature> signature;
  bool cached = false;
  std::filesystem::path file;       ///< in the cache; empty where the cache was not used
};

/// The signature of `shape` under `law`: from the cache, or measured (and cached, atomically, several processes at once being safe).
/// A file in the cache that is damaged or of another version is measured anew. Throws InputError where the cache folder cannot be written.
SourcedSignature find_or_measure_signature(const Shape& shape, const ContactLaw& law, const SignatureSourceSettings& settings = {});

}  // namespace lodestone
