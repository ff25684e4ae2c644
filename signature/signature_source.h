// Where a signature comes from: the user's cache folder, or measured now and kept there.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Called while measuring with what is being done and the fraction done, 0 … 1; from one thread at a time.
using Progress = std::function<void(const std::string& stage, double fraction)>;

/// How long another process that measures the same may take before who it is is said, s.
inline constexpr double kWaitSaid = 1.0;

struct SignatureSourceSettings {
  SignatureSettings measuring;  ///< `law` is replaced by the one asked for
  bool use_cache = true;
  std::filesystem::path cache_folder;  ///< empty: $XDG_CACHE_HOME/lodestone, else ~/.cache/lodestone
  int threads = 0;                     ///< 0: all cores
  Progress progress;
  /// Told of a cache that cannot be used, and of a process that is waited for longer than kWaitSaid; from one
  /// thread.
  std::function<void(const std::string&)> warn = {};
  /// Once stopped, measuring ends soon, and goes on from there the next time (with the cache).
  std::stop_token stop = {};
};

struct MeasurementPart;
struct Share;

/// A signature and how it was had.
struct SourcedSignature {
  std::shared_ptr<const Signature> signature;  ///< null only where measuring was stopped
  bool cached = false;
  std::filesystem::path file;        ///< in the cache; empty where the cache was not or cannot be used
  std::uint64_t trials_resumed = 0;  ///< that an interrupted measurement had left
  std::uint64_t trials_left = 0;     ///< of a measurement that was stopped: for the next to go on from
};

/// The signature of `shape` under `law`: from the cache, or measured and cached. Of several processes (or
/// threads) that want the same one, one measures it and the others wait for it; one that is interrupted
/// leaves its finished units to the next. A file in the cache that is damaged or of another version is
/// measured anew. Where the cache cannot be written it is measured all the same, with a warning, and nothing
/// is left behind.
SourcedSignature find_or_measure_signature(const Shape& shape, const ContactLaw& law,
                                           const SignatureSourceSettings& settings = {});

/// One share of it, measured, and saved in `file` where one is given, unless it is stopped: check the stop
/// token. A share that is interrupted, or that found no room in `file` (InputError), goes on from where it
/// was the next time, unless the cache is not used.
MeasurementPart measure_part(const Shape& shape, const ContactLaw& law, const Share& share,
                             const SignatureSourceSettings& settings = {},
                             const std::filesystem::path& file = {});

/// Where the errors of a signature's rungs are kept, beside its file in the cache.
std::filesystem::path rung_errors_file(const Shape& shape, const ContactLaw& law,
                                       const SignatureSourceSettings& settings = {});

/// The versions of the format, of the measuring code and of ODE, on all of which a signature depends.
std::string measurement_versions();

}  // namespace lodestone
