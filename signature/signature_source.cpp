#include "signature/signature_source.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "reference/error.h"
#include "signature/file_bytes.h"
#include "signature/measure/measure.h"
#include "signature/measure/measurement_journal.h"
#include "signature/measure/measurement_part.h"
#include "signature/measure/measurement_shape.h"
#include "signature/measure/settling_trial.h"
#include "signature/settings_archive.h"
#include "signature/signature_file.h"

namespace lodestone {
namespace {

// Raised when measuring changes its results: older files are then measured anew.
constexpr std::uint32_t kMeasuringVersion = 12;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::filesystem::path default_cache_folder() {
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
    return std::filesystem::path(folder) / "lodestone";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "lodestone";
  return std::filesystem::temp_directory_path() / "lodestone-cache";
}

MeasurementIdentity identity_of(const Shape& shape, const SignatureSettings& settings, const Share& share) {
  return {measurement_versions(), settings, share, *make_measurement_shape(shape)};
}

// Names the content: shape, law, settings and versions.
std::string content_key(const Shape& shape, const SignatureSettings& settings) {
  ByteWriter content;
  content(shape.content_hash, settings, measurement_versions());
  if (settings.law.friction < kSlipperyFriction)
    content(std::uint32_t(1));  // measured otherwise since they came to rest by sliding steadily
  const XXH128_hash_t hash = XXH3_128bits(content.bytes.data(), content.bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::filesystem::path beside(std::filesystem::path file, const std::string& ending) { return file += ending; }

std::filesystem::path cache_file(const Shape& shape, const SignatureSettings& measuring,
                                 const SignatureSourceSettings& settings) {
  return (settings.cache_folder.empty() ? default_cache_folder() : settings.cache_folder) /
         (content_key(shape, measuring) + ".sig");
}

std::shared_ptr<const Signature> find_cached(const std::filesystem::path& file, const Shape& shape) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return nullptr;
  try {
    auto signature = std::make_shared<Signature>(load_signature(file));
    std::ifstream(beside(file, ".seconds")) >> signature->measuring_seconds;
    if (const auto errors = load_rung_errors(beside(file, ".errors"))) signature->rung_errors = *errors;
    check_measured_for(*signature, shape, file.string());
    return signature;
  } catch (const InputError&) {
    return nullptr;  // damaged, or another's: it is measured and written anew
  }
}

// The time first: whoever finds the signature finds its time, too.
void keep(const Signature& signature, const std::filesystem::path& file) {
  const std::string seconds = fmt::format("{}\n", signature.measuring_seconds);
  write_atomically(std::as_bytes(std::span(seconds)), beside(file, ".seconds"));
  save_signature(signature, file);
}

void warn(const SignatureSourceSettings& settings, const std::string& message) {
  if (settings.warn) settings.warn(message);
}

// Whoever is stopped (by a debugger or a shell) keeps others waiting until someone lets it go on.
std::string text_of_holder(const std::filesystem::path& file) {
  const auto holder = find_holder(file);
  if (!holder) return "another process";
  return fmt::format("process {} on {}{}", holder->pid, holder->host,
                     holder->is_stopped ? " (which is stopped: kill -CONT lets it go on)" : "");
}

// Null once `done` says that another process has made it, or measuring is stopped.
template <class Done>
std::unique_ptr<MeasurementJournal> wait_for_journal(const std::filesystem::path& file,
                                                     const MeasurementIdentity& identity,
                                                     const SignatureSourceSettings& settings, Done done) {
  const Stopwatch watch;
  bool is_said = false;
  while (!settings.stop.stop_requested() && !done()) {
    if (auto journal = MeasurementJournal::try_open(file, identity)) return journal;
    if (settings.progress) settings.progress(text_of_holder(file) + " measures it", 0.0);
    if (!is_said && watch.seconds() > kWaitSaid) {
      warn(settings, fmt::format("the signature of {} is being measured by {}, which is waited for",
                                 identity.shape.name, text_of_holder(file)));
      is_said = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return nullptr;
}

MeasureOptions options_of(const SignatureSourceSettings& settings, MeasurementJournal* journal) {
  return {
      .threads = settings.threads, .progress = settings.progress, .stop = settings.stop, .journal = journal};
}

// The time and the signature; its journal, which may have taken the room, goes before a second attempt.
bool try_to_keep(const Signature& signature, const std::filesystem::path& file, MeasurementJournal& journal,
                 const SignatureSourceSettings& settings) {
  for (const bool is_second : {false, true}) {
    try {
      keep(signature, file);
      return true;
    } catch (const InputError& error) {
      if (is_second)
        warn(settings, fmt::format("{}; the signature is used, but not kept", error.what()));
      else
        journal.remove();
    }
  }
  return false;
}

SourcedSignature measure_uncached(const Shape& shape, const SignatureSettings& measuring,
                                  const SignatureSourceSettings& settings) {
  const Stopwatch watch;
  const Measurement units = measure_units(shape, measuring, {}, options_of(settings, nullptr));
  if (settings.stop.stop_requested()) return {};
  Signature signature = make_signature(shape, measuring, units);
  signature.measuring_seconds = watch.seconds();
  return {.signature = std::make_shared<const Signature>(std::move(signature)), .file = {}};
}

SourcedSignature find_or_measure_in(const std::filesystem::path& file, const Shape& shape,
                                    const SignatureSettings& measuring,
                                    const SignatureSourceSettings& settings) {
  SourcedSignature sourced{.signature = find_cached(file, shape), .file = file};
  const MeasurementIdentity identity = identity_of(shape, measuring, {});
  std::unique_ptr<MeasurementJournal> journal;
  try {
    if (!sourced.signature)
      journal = wait_for_journal(beside(file, ".measuring"), identity, settings,
                                 [&] { return (sourced.signature = find_cached(file, shape)) != nullptr; });
  } catch (const InputError& error) {
    warn(settings,
         fmt::format("{}; the signature of {} is measured without the cache", error.what(), shape.name));
    return measure_uncached(shape, measuring, settings);
  }
  // Another process may have finished between the look and the lock.
  if (journal && (sourced.signature = find_cached(file, shape))) journal->remove();
  sourced.cached = sourced.signature != nullptr;
  if (sourced.cached || !journal) return sourced;
  const Measurement units = measure_units(shape, measuring, {}, options_of(settings, journal.get()));
  sourced.trials_resumed = journal->trials_found(measuring);
  if (settings.stop.stop_requested()) {
    sourced.trials_left = sourced.trials_resumed + journal->trials_noted();
    return sourced;
  }
  Signature signature = make_signature(shape, measuring, units);
  signature.measuring_seconds = journal->seconds();
  if (!try_to_keep(signature, file, *journal, settings)) sourced.file.clear();
  journal->remove();
  sourced.signature = std::make_shared<const Signature>(std::move(signature));
  return sourced;
}

}  // namespace

std::filesystem::path rung_errors_file(const Shape& shape, const ContactLaw& law,
                                       const SignatureSourceSettings& settings) {
  SignatureSettings measuring = settings.measuring;
  measuring.law = law;
  return beside(cache_file(shape, measuring, settings), ".errors");
}

std::string measurement_versions() {
  return fmt::format("format {} measuring {} ode {}", kSignatureFormatVersion, kMeasuringVersion,
                     LODESTONE_ODE_VERSION);
}

SourcedSignature find_or_measure_signature(const Shape& shape, const ContactLaw& law,
                                           const SignatureSourceSettings& settings) {
  SignatureSettings measuring = settings.measuring;
  measuring.law = law;
  check_settings(measuring);  // before anything is written
  if (settings.use_cache)
    return find_or_measure_in(cache_file(shape, measuring, settings), shape, measuring, settings);
  return measure_uncached(shape, measuring, settings);
}

MeasurementPart measure_part(const Shape& shape, const ContactLaw& law, const Share& share,
                             const SignatureSourceSettings& settings, const std::filesystem::path& file) {
  SignatureSettings measuring = settings.measuring;
  measuring.law = law;
  check_settings(measuring);
  MeasurementPart part{.identity = identity_of(shape, measuring, share), .measurement = {}};
  std::unique_ptr<MeasurementJournal> journal;
  if (settings.use_cache) {
    const std::string ending = fmt::format(".{}-of-{}.measuring", share.index + 1, share.count);
    try {
      journal = wait_for_journal(beside(cache_file(shape, measuring, settings), ending), part.identity,
                                 settings, [] { return false; });
    } catch (const InputError& error) {
      warn(settings,
           fmt::format("{}; the share is measured without the cache: if it is interrupted it begins anew",
                       error.what()));
    }
  }
  const Stopwatch watch;
  part.measurement = measure_units(shape, measuring, share, options_of(settings, journal.get()));
  part.seconds = journal ? journal->seconds() : watch.seconds();
  part.trials_resumed = journal ? journal->trials_found(measuring) : 0;
  part.trials_noted = journal ? journal->trials_noted() : 0;
  if (settings.stop.stop_requested()) return part;
  if (!file.empty()) save_part(part, file);
  if (journal) journal->remove();
  return part;
}

}  // namespace lodestone
