// Where a signature comes from: the user's cache folder; or it is measured now, and kept there.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// Called while measuring, from one thread at a time, with what is being done and the fraction done, 0 … 1.
using Progress = std::function<void(const std::string& stage, double fraction)>;

/// s: after waiting so long for another process that measures the same signature, a warning says which it is.
inline constexpr double kWaitSaid = 1.0;

/// How a signature is found or measured.
struct SignatureSourceSettings {
  SignatureSettings measuring;  ///< its `law` is replaced by the one asked for
  bool use_cache = true;        ///< false: it is measured, and not kept
  /// Empty: $XDG_CACHE_HOME/lodestone, else ~/.cache/lodestone, else lodestone-cache among temporary files.
  std::filesystem::path cache_folder;
  int threads = 0;  ///< that measure; 0: all cores
  Progress progress;
  /// Called, from one thread, with a warning that the cache cannot be used, or that another process has been
  /// waited for longer than kWaitSaid; empty: nobody is warned.
  std::function<void(const std::string&)> warn = {};
  /// Once it is stopped, measuring ends soon; with the cache it goes on from there the next time.
  std::stop_token stop = {};
};

struct MeasurementPart;
struct Share;

/// A signature, and where it came from.
struct SourcedSignature {
  std::shared_ptr<const Signature> signature;  ///< null only if measuring was stopped
  bool cached = false;         ///< whether it was in the cache, or another process put it there
  std::filesystem::path file;  ///< its file in the cache; empty if the cache was not, or cannot be, used
  std::uint64_t trials_resumed = 0;  ///< trials that an interrupted measurement had left, and that were used
  std::uint64_t trials_left = 0;     ///< trials that a stopped measurement leaves to the next
};

/// The signature of `shape` under `law`: from the cache, or measured, for seconds, and cached. If several
/// processes or threads want the same one, one measures it and the others wait; an interrupted measurement
/// leaves what it has finished to the next. A file in the cache that is damaged or of another version is
/// measured anew. If the cache cannot be written, the signature is measured all the same, with a warning, and
/// nothing is left behind. Throws InputError if `law` or `settings.measuring` is out of its ranges.
SourcedSignature find_or_measure_signature(const Shape& shape, const ContactLaw& law,
                                           const SignatureSourceSettings& settings = {});

/// Measures one share of a signature, and saves it in `file` unless that is empty or measuring was stopped
/// (look at the stop token). With the cache, a share that was interrupted, or for which `file` had no room
/// (InputError), goes on from where it was the next time. Throws as find_or_measure_signature does.
MeasurementPart measure_part(const Shape& shape, const ContactLaw& law, const Share& share,
                             const SignatureSourceSettings& settings = {},
                             const std::filesystem::path& file = {});

/// The file in which the errors of a signature's rungs (RungErrors) are kept, beside its own in the cache.
std::filesystem::path rung_errors_file(const Shape& shape, const ContactLaw& law,
                                       const SignatureSourceSettings& settings = {});

/// The versions of the file format, of the measuring code and of ODE: a signature depends on all three.
std::string measurement_versions();

}  // namespace lodestone
