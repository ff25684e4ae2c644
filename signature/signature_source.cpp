#include "signature/signature_source.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstdlib>

#include "reference/error.h"
#include "signature/measure/measure.h"
#include "signature/signature_file.h"

namespace lodestone {
namespace {

// Raised when measuring changes its results: older files are then measured anew.
constexpr std::uint32_t kMeasuringVersion = 4;

std::filesystem::path default_cache_folder() {
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder) return std::filesystem::path(folder) / "lodestone";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "lodestone";
  return std::filesystem::temp_directory_path() / "lodestone-cache";
}

// Names the content: shape, law, settings and the versions of the format, of the measuring code and of ODE.
std::string content_key(const Shape& shape, const SignatureSettings& settings) {
  const SignatureSettings& s = settings;
  std::string content = fmt::format("{:016x} {} {} {} {} {} {} {} {} {}", shape.content_hash, s.law.restitution, s.law.friction, int(s.trial_end), s.paper_grid,
                                    s.n_theta, s.n_phi, s.n_alpha, s.n_psi, int(s.draw));
  content += fmt::format(" {} {} {} {} {} {} {} {} {} {}", s.trials_per_cell, s.table_error, s.most_trials_per_cell, s.held_out_conditions, s.height_samples,
                         s.height_trials, s.settling_trials, s.clips, s.rest_pose_frequency_min, s.seed);
  content += fmt::format(" format {} measuring {} ode {}", kSignatureFormatVersion, kMeasuringVersion, LODESTONE_ODE_VERSION);
  const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::shared_ptr<const Signature> find_cached(const std::filesystem::path& file, const Shape& shape) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return nullptr;
  try {
    auto signature = std::make_shared<const Signature>(load_signature(file));
    return signature->shape_hash == shape.content_hash ? signature : nullptr;
  } catch (const InputError&) {
    return nullptr;  // damaged: it is measured and written anew
  }
}

}  // namespace

SourcedSignature find_or_measure_signature(const Shape& shape, const ContactLaw& law, const SignatureSourceSettings& settings) {
  SignatureSettings measuring = settings.measuring;
  measuring.law = law;
  SourcedSignature sourced;
  if (settings.use_cache) {
    const std::filesystem::path folder = settings.cache_folder.empty() ? default_cache_folder() : settings.cache_folder;
    sourced.file = folder / (content_key(shape, measuring) + ".sig");
    sourced.signature = find_cached(sourced.file, shape);
    sourced.cached = sourced.signature != nullptr;
  }
  if (!sourced.signature) {
    sourced.signature = std::make_shared<const Signature>(measure_signature(shape, measuring, settings.threads, settings.progress));
    if (settings.use_cache) save_signature(*sourced.signature, sourced.file);
  }
  return sourced;
}

}  // namespace lodestone
