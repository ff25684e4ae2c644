#include "signature/signature_view.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "reference/error.h"
#include "signature/signature_file.h"

namespace lodestone {

const std::array<char, 8> kSignatureMagic = {'L', 'O', 'D', 'E', 'S', 'I', 'G', '\n'};

std::array<std::uint32_t, kSections> section_value_bytes() {
  std::array<std::uint32_t, kSections> bytes{1};
  std::size_t section = 1;
  const Signature any;
  visit_sections(any, [&](std::string_view, std::string_view, const auto& list) {
    bytes.at(section++) =
        sizeof(typename Stored<typename std::remove_cvref_t<decltype(list)>::value_type>::Type);
  });
  check_that(section == kSections, "kSections counts the sections:", std::to_string(section));
  return bytes;
}

namespace {

struct Failure {
  const std::string& name;
  template <class Found, class Expected>
  [[noreturn]] void operator()(const Found& found, const Expected& expected) const {
    throw InputError(fmt::format("{}: found {}, expected {}", name, found, expected));
  }
};

template <class T>
T read_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

bool all_finite(const auto& numbers) {
  return std::ranges::all_of(numbers, [](auto x) { return std::isfinite(x); });
}

template <class T>
bool every(const SectionValues<T>& values, auto holds) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!holds(values[i])) return false;
  return true;
}

template <class T>
bool rises(const SectionValues<T>& values, bool strictly) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(strictly ? values[i] > values[i - 1] : values[i] >= values[i - 1])) return false;
  return true;
}

bool is_fraction(double x) { return x >= 0.0 && x <= 1.0; }

// The lists of a table, from section `first` on.
struct TableView {
  TableView(const SignatureView& view, std::size_t first)
      : mean(view.list(first)),
        deviation(view.list(first + 1)),
        trials(view.list(first + 2)),
        approach(view.list(first + 3)),
        factor(view.list(first + 4)),
        first_sample(view.list(first + 5)),
        sample(view.list(first + 6)) {}
  SectionValues<std::array<float, 6>> mean, deviation;
  SectionValues<std::uint32_t> trials;
  SectionValues<Approach> approach;
  SectionValues<ResponseFactor> factor;
  SectionValues<std::uint32_t> first_sample;
  SectionValues<ResponseSample> sample;
};

void check_settings(const SignatureSettings& s, const Failure& fail) {
  if (!is_fraction(s.law.restitution) || !(s.law.friction >= 0.0 && std::isfinite(s.law.friction)))
    fail("an impossible contact law", "e in 0 … 1, μ ≥ 0");
  if (s.trial_end > TrialEnd::leaves_plane || s.draw > ResponseDraw::empirical)
    fail("a setting of no known kind", "one of this version");
}

void check_heights(const SectionValues<float>& mean, const SectionValues<float>& deviation,
                   const Failure& fail) {
  if (mean.empty() || mean.size() != deviation.size())
    fail("collision heights whose lists differ in length", "one deviation per mean");
  if (!every(mean, [](float height) { return height > 0.0f && height <= 1.001f; }))
    fail("an impossible collision height", "0 … 1 over R");
  if (!every(deviation, [](float d) { return d >= 0.0f && std::isfinite(d); }))
    fail("an impossible deviation of the collision height", "finite, ≥ 0");
}

// An empty table has no cells and no axes; any other has one value per cell.
void check_table(const TableView& t, std::array<std::int64_t, 4> axes, float sample_range,
                 const Failure& fail) {
  double product = 1.0;
  for (const std::int64_t n : axes) {
    if (n < 0 || n > 1'000'000) fail(fmt::format("an axis of {} samples", n), "0 … 1,000,000");
    product *= double(n);
  }
  const std::size_t cells = t.mean.size();
  if (double(cells) != product || t.deviation.size() != cells || t.trials.size() != cells ||
      t.approach.size() != cells || !(t.factor.empty() || t.factor.size() == cells) ||
      !(t.first_sample.empty() || t.first_sample.size() == cells + 1))
    fail("a response table whose lists do not fit its axes", "one value per cell");
  const auto finite = [](const auto& numbers) { return all_finite(numbers); };
  const auto is_deviation = [&](const auto& numbers) {
    return all_finite(numbers) && std::ranges::all_of(numbers, [](float x) { return x >= 0.0f; });
  };
  if (!every(t.mean, finite) || !every(t.factor, finite))
    fail("a response that is not finite", "finite means and covariances");
  if (!every(t.deviation, is_deviation)) fail("a deviation that is negative or not finite", "σ ≥ 0");
  if (!every(t.approach, [](const Approach& a) {
        return std::isfinite(a.mean) && std::isfinite(a.deviation) && a.deviation >= 0.0f;
      }))
    fail("an impossible approach", "a finite mean, σ ≥ 0");
  if (t.first_sample.empty() != t.sample.empty() ||
      (!t.sample.empty() && (t.first_sample[0] != 0 || t.first_sample.back() != t.sample.size())) ||
      !rises(t.first_sample, false) || !(sample_range > 0.0f && std::isfinite(sample_range)))
    fail("samples outside of their cells", "a run of samples for each cell");
}

void check_axis(const SectionValues<float>& axis, const Failure& fail) {
  if (!rises(axis, true) || !every(axis, [](float x) { return std::isfinite(x); }))
    fail("an axis that does not rise", "rising, finite speeds");
}

void check_certificate(const TableCertificate& c, const Failure& fail) {
  const std::array numbers{c.impulses,     c.into_plane_first,    c.into_plane,     c.energy_ratio_first,
                           c.energy_ratio, c.mean_over_deviation, c.standard_error, c.greatest_standard_error,
                           c.held_out_ks,  c.held_out_error,      c.uniform_trials};
  if (!all_finite(numbers) || std::ranges::any_of(numbers, [](double x) { return x < 0.0; }))
    fail("an impossible certificate", "finite numbers ≥ 0");
}

void check_rest_poses(const SectionValues<std::array<double, 6>>& poses, const Failure& fail) {
  const auto possible = [](const std::array<double, 6>& stored) {
    const RestPose pose = Stored<RestPose>::unpack(stored);
    return std::abs(pose.normal.norm() - 1.0) < 1e-6 && pose.height > 0.0 && std::isfinite(pose.height) &&
           is_fraction(pose.frequency) && pose.basin >= 0.0 && pose.basin <= 1.0 + 1e-9;
  };
  if (!every(poses, possible))
    fail("an impossible rest pose", "a unit normal, a positive height, fractions in 0 … 1");
}

void check_clips(const SectionValues<SettlingClip>& clips, std::size_t frames,
                 const SectionValues<ClipEntry>& entries, float interval, const Failure& fail) {
  const auto recorded = [&](const SettlingClip& c) {
    return c.frames >= 2 && std::uint64_t(c.first_frame) + c.frames <= frames && c.extent > 0.0f &&
           std::isfinite(c.extent);
  };
  if (!every(clips, recorded))
    fail("a settling clip outside the recorded frames", "2 frames or more, all recorded");
  const auto there = [&](const ClipEntry& e) {
    return e.clip < clips.size() && e.frame < clips[e.clip].frames;
  };
  if (!every(entries, there)) fail("an entry into a clip that is not there", "a recorded frame");
  if (!clips.empty() && !(interval > 0.0f && std::isfinite(interval)))
    fail("a clip frame interval that is not positive", "a positive one");
}

// Later code follows every index and draws from every number without looking.
void check_content(const SignatureView& view, const Failure& fail) {
  const Signature& s = view.numbers();
  check_settings(s.settings, fail);
  check_heights(SectionValues<float>(view.list(1)), SectionValues<float>(view.list(2)), fail);
  const ResponseTable &b = s.bouncing, &n = s.non_bouncing;
  check_table({view, 3}, {b.n_theta, b.n_phi, b.n_alpha, b.n_psi}, b.cells.sample_range, fail);
  check_table({view, 10}, {n.n_theta, n.n_phi, n.n_alpha, n.n_psi}, n.cells.sample_range, fail);
  const SectionValues<float> speeds(view.list(24)), spins(view.list(25));
  check_axis(speeds, fail);
  check_axis(spins, fail);
  check_table({view, 17},
              {s.by_speed.n_theta, s.by_speed.n_phi, std::int64_t(speeds.size()), std::int64_t(spins.size())},
              s.by_speed.cells.sample_range, fail);
  const bool scale_free = !view.list(3).empty() && view.list(3).size() == view.list(10).size();
  if (view.list(7).empty() != view.list(14).empty() || view.list(8).empty() != view.list(15).empty())
    fail("covariances or samples of one scale-free table alone", "those of both or of neither");
  if (scale_free == !view.list(17).empty())
    fail("response tables of neither kind or both", "two scale-free tables or one by speed");
  for (const TableCertificate* c :
       {&s.bouncing_certificate, &s.non_bouncing_certificate, &s.by_speed_certificate})
    check_certificate(*c, fail);
  check_rest_poses(SectionValues<std::array<double, 6>>(view.list(26)), fail);
  check_clips(SectionValues<SettlingClip>(view.list(27)), SectionValues<ClipFrame>(view.list(28)).size(),
              SectionValues<ClipEntry>(view.list(29)), s.clip_frame_interval, fail);
}

}  // namespace

SignatureView::SignatureView(std::span<const std::byte> bytes, const std::string& name) {
  const Failure fail{name};
  if (bytes.size() < sizeof(SignatureHeader))
    fail(fmt::format("{} bytes", bytes.size()), "a whole signature");
  const auto header = read_at<SignatureHeader>(bytes, 0);
  if (std::memcmp(header.magic, kSignatureMagic.data(), sizeof(header.magic)) != 0)
    fail("a file of another kind", "a signature (it begins with LODESIG)");
  if (header.version != kSignatureFormatVersion)
    fail(fmt::format("format version {}", header.version),
         fmt::format("version {}: measure it again", kSignatureFormatVersion));
  if (header.file_bytes != bytes.size())
    fail(fmt::format("{} bytes", bytes.size()), fmt::format("{}", header.file_bytes));
  if (header.sections != kSections ||
      std::ranges::any_of(header.reserved, [](std::uint64_t x) { return x != 0; }))
    fail("a header of another kind", "one of this version");
  const auto rest = bytes.subspan(sizeof(SignatureHeader));
  if (XXH3_64bits(rest.data(), rest.size()) != header.checksum)
    fail("a checksum that does not match", "undamaged bytes");
  find_sections(bytes, name);
  ByteReader reader(sections_[0]);
  archive_numbers(reader, numbers_);
  if (!reader.whole()) fail("a list of numbers of another length", "those of this version");
  check_content(*this, fail);
}

void SignatureView::find_sections(std::span<const std::byte> bytes, const std::string& name) {
  const Failure fail{name};
  const auto value_bytes = section_value_bytes();
  std::uint64_t end = sizeof(SignatureHeader) + kSections * sizeof(SectionEntry);
  if (end > bytes.size()) fail("its end in the list of sections", "a whole signature");
  for (std::uint32_t i = 0; i < kSections; ++i) {
    const auto entry = read_at<SectionEntry>(bytes, sizeof(SignatureHeader) + i * sizeof(SectionEntry));
    if (entry.id != i || entry.value_bytes != value_bytes[i] || entry.offset != aligned(end) ||
        entry.offset > bytes.size() || entry.count > (bytes.size() - entry.offset) / entry.value_bytes)
      fail(fmt::format("section {} of {} values at {}", entry.id, entry.count, entry.offset),
           "sections one after the other, within the file");
    if (std::ranges::any_of(bytes.subspan(end, entry.offset - end),
                            [](std::byte b) { return b != std::byte(0); }))
      fail(fmt::format("bytes between the sections before {}", entry.offset), "zeros");
    sections_[i] = bytes.subspan(entry.offset, entry.count * entry.value_bytes);
    end = entry.offset + sections_[i].size();
  }
  if (end != bytes.size()) fail(fmt::format("{} bytes after the last section", bytes.size() - end), "none");
}

}  // namespace lodestone
