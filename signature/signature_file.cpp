#include "signature/signature_file.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

#include "reference/error.h"

static_assert(std::endian::native == std::endian::little, "the format is little-endian: add byte swapping for other machines");

namespace lodestone {
namespace {

constexpr char kMagic[8] = {'L', 'O', 'D', 'E', 'S', 'I', 'G', '\n'};

struct Header {
  char magic[8];
  std::uint32_t version, reserved;
  std::uint64_t payload_bytes, payload_hash;
};

class Writer {
 public:
  template <class T>
    requires std::is_trivially_copyable_v<T>
  void put(const T& value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  void put(const Vec3& v) { for (double x : v) put(x); }
  void put(const Response& r) { for (float x : r) put(x); }
  void put(const std::string& text) { put_each(std::span(text.data(), text.size())); }
  void put(const RestPose& p) { put(p.normal), put(p.height), put(p.frequency), put(p.basin); }
  template <class Range>
  void put_each(const Range& values) {
    put(std::uint64_t(values.size()));
    for (const auto& value : values) put(value);
  }
  void put(const ResponseCells& c) {
    put_each(c.mean), put_each(c.deviation), put_each(c.trials), put_each(c.approach), put_each(c.factor), put_each(c.first_sample), put_each(c.sample);
    put(c.sample_range);
  }
  void put(const ResponseTable& t) { put(t.n_theta), put(t.n_phi), put(t.n_alpha), put(t.n_psi), put(t.cells); }
  void put(const SpeedTable& t) { put(t.n_theta), put(t.n_phi), put_each(t.speeds), put_each(t.spins), put(t.cells); }
  void put(const TableCertificate& c) {
    put(c.trials), put(c.missed), put(c.fewest_trials), put(c.most_trials), put(c.impulses), put(c.into_plane_first), put(c.into_plane);
    put(c.energy_ratio_first), put(c.energy_ratio), put(c.mean_over_deviation), put(c.standard_error), put(c.greatest_standard_error);
    put(c.held_out), put(c.held_out_ks), put(c.held_out_error), put(c.uniform_trials);
  }
  void put(const SignatureSettings& s) {
    put(s.law.restitution), put(s.law.friction), put(s.trial_end), put(s.paper_grid), put(s.n_theta), put(s.n_phi), put(s.n_alpha), put(s.n_psi);
    put(s.draw), put(s.trials_per_cell), put(s.table_error), put(s.most_trials_per_cell), put(s.held_out_conditions);
    put(s.height_samples), put(s.height_trials), put(s.settling_trials), put(s.clips), put(s.rest_pose_frequency_min), put(s.seed);
  }

  std::vector<std::byte> bytes;
};

class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError(fmt::format("{}: found {}, expected {}", name_, found, expected));
  }
  template <class T>
    requires std::is_trivially_copyable_v<T>
  void get(T& value) {
    if (bytes_.size() < sizeof(T)) fail("its end in the middle of a value", "a whole signature");
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
  }
  void get(Vec3& v) { for (double& x : v) get(x); }
  void get(Response& r) { for (float& x : r) get(x); }
  void get(RestPose& p) { get(p.normal), get(p.height), get(p.frequency), get(p.basin); }
  template <class Container>
  void get_each(Container& values) {
    std::uint64_t count = 0;
    get(count);
    if (count > bytes_.size()) fail(fmt::format("a list of {} values", count), "no more than the file can hold");  // before allocating
    values.resize(count);
    for (auto& value : values) get(value);
  }
  void get(ResponseCells& c) {
    get_each(c.mean), get_each(c.deviation), get_each(c.trials), get_each(c.approach), get_each(c.factor), get_each(c.first_sample), get_each(c.sample);
    get(c.sample_range);
  }
  void get(ResponseTable& t) {
    get(t.n_theta), get(t.n_phi), get(t.n_alpha), get(t.n_psi), get(t.cells);
    check_cells(t.cells, {t.n_theta, t.n_phi, t.n_alpha, t.n_psi});
  }
  void get(SpeedTable& t) {
    get(t.n_theta), get(t.n_phi), get_each(t.speeds), get_each(t.spins), get(t.cells);
    check_cells(t.cells, {t.n_theta, t.n_phi, int(t.speeds.size()), int(t.spins.size())});
    for (const auto& axis : {t.speeds, t.spins})
      for (std::size_t i = 0; i < axis.size(); ++i)
        if (!std::isfinite(axis[i]) || (i > 0 && !(axis[i] > axis[i - 1]))) fail("an axis that does not rise", "rising, finite speeds");
  }
  void get(TableCertificate& c) {
    get(c.trials), get(c.missed), get(c.fewest_trials), get(c.most_trials), get(c.impulses), get(c.into_plane_first), get(c.into_plane);
    get(c.energy_ratio_first), get(c.energy_ratio), get(c.mean_over_deviation), get(c.standard_error), get(c.greatest_standard_error);
    get(c.held_out), get(c.held_out_ks), get(c.held_out_error), get(c.uniform_trials);
  }
  void get(SignatureSettings& s) {
    get(s.law.restitution), get(s.law.friction), get(s.trial_end), get(s.paper_grid), get(s.n_theta), get(s.n_phi), get(s.n_alpha), get(s.n_psi);
    get(s.draw), get(s.trials_per_cell), get(s.table_error), get(s.most_trials_per_cell), get(s.held_out_conditions);
    get(s.height_samples), get(s.height_trials), get(s.settling_trials), get(s.clips), get(s.rest_pose_frequency_min), get(s.seed);
  }
  void end() const {
    if (!bytes_.empty()) fail(fmt::format("{} bytes after the last value", bytes_.size()), "none");
  }

 private:
  // An empty table has no cells and no axes; any other has one value per cell, finite.
  void check_cells(const ResponseCells& c, const std::array<int, 4>& axes) const {
    const std::size_t cells = c.mean.size();
    double product = 1.0;
    for (const int n : axes) product *= std::max(0, n);
    if (double(cells) != product || c.deviation.size() != cells || c.trials.size() != cells || c.approach.size() != cells ||
        !(c.factor.empty() || c.factor.size() == cells) || !(c.first_sample.empty() || c.first_sample.size() == cells + 1))
      fail("a response table whose lists do not fit its axes", "one value per cell");
    for (std::size_t i = 0; i < cells; ++i)
      if (!c.mean[i].allFinite() || !c.deviation[i].allFinite() || (c.deviation[i].array() < 0.0f).any())
        fail("a response that is not finite or of negative deviation", "finite means, deviations ≥ 0");
    if (c.first_sample.empty() != c.sample.empty() || (!c.sample.empty() && c.first_sample.back() != c.sample.size()) ||
        !std::ranges::is_sorted(c.first_sample))
      fail("samples outside of their cells", "a run of samples for each cell");
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
};

void write_payload(Writer& w, const Signature& s) {
  w.put(s.shape_hash), w.put(s.settings), w.put(s.shape_name);
  w.put_each(s.collision_heights.mean), w.put_each(s.collision_heights.deviation);
  w.put(s.bouncing), w.put(s.non_bouncing), w.put(s.by_speed);
  w.put(s.bouncing_certificate), w.put(s.non_bouncing_certificate), w.put(s.by_speed_certificate);
  w.put_each(s.rest_poses), w.put(s.rest_poses_above_5_percent);
  w.put_each(s.clips), w.put_each(s.clip_frames), w.put_each(s.clip_entries), w.put(s.clip_frame_interval);
  w.put(s.trials), w.put(s.measuring_seconds);
}

Signature read_payload(Reader& r) {
  Signature s;
  r.get(s.shape_hash), r.get(s.settings), r.get_each(s.shape_name);
  r.get_each(s.collision_heights.mean), r.get_each(s.collision_heights.deviation);
  r.get(s.bouncing), r.get(s.non_bouncing), r.get(s.by_speed);
  r.get(s.bouncing_certificate), r.get(s.non_bouncing_certificate), r.get(s.by_speed_certificate);
  r.get_each(s.rest_poses), r.get(s.rest_poses_above_5_percent);
  r.get_each(s.clips), r.get_each(s.clip_frames), r.get_each(s.clip_entries), r.get(s.clip_frame_interval);
  r.get(s.trials), r.get(s.measuring_seconds);
  r.end();
  return s;
}

// Indices that later code follows without looking.
void check_references(const Signature& s, const Reader& r) {
  if (s.collision_heights.mean.empty() || s.collision_heights.mean.size() != s.collision_heights.deviation.size())
    r.fail("collision heights whose lists differ in length", "one deviation per mean");
  for (const float height : s.collision_heights.mean)
    if (!(height > 0.0f && height <= 1.001f)) r.fail(fmt::format("a collision height of {}", height), "0 … 1 over R");
  const bool scale_free = s.bouncing.size() > 0 && s.non_bouncing.size() == s.bouncing.size();
  if (scale_free == (s.by_speed.size() > 0)) r.fail("response tables of neither kind or both", "two scale-free tables or one by speed");
  for (const SettlingClip& clip : s.clips)
    if (clip.frames < 2 || std::uint64_t(clip.first_frame) + clip.frames > s.clip_frames.size() || !(clip.extent > 0.0f))
      r.fail("a settling clip outside the recorded frames", "2 frames or more, all recorded");
  for (const ClipEntry& entry : s.clip_entries)
    if (entry.clip >= s.clips.size() || entry.frame >= s.clips[entry.clip].frames) r.fail("an entry into a clip that is not there", "a recorded frame");
  if (!s.clips.empty() && !(s.clip_frame_interval > 0.0f)) r.fail("a clip frame interval that is not positive", "a positive one");
  for (const RestPose& pose : s.rest_poses)
    if (!(std::abs(pose.normal.norm() - 1.0) < 1e-6) || !(pose.height > 0.0) || !(pose.frequency >= 0.0 && pose.frequency <= 1.0))
      r.fail("an impossible rest pose", "a unit normal, a positive height, a frequency in 0 … 1");
}

}  // namespace

std::vector<std::byte> encode_signature(const Signature& signature) {
  Writer payload;
  write_payload(payload, signature);
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.version = kSignatureFormatVersion;
  header.payload_bytes = payload.bytes.size();
  header.payload_hash = XXH3_64bits(payload.bytes.data(), payload.bytes.size());
  Writer whole;
  whole.put(header);
  whole.bytes.insert(whole.bytes.end(), payload.bytes.begin(), payload.bytes.end());
  return std::move(whole.bytes);
}

Signature decode_signature(std::span<const std::byte> bytes, const std::string& name) {
  Reader reader(bytes, name);
  Header header{};
  reader.get(header);
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0) reader.fail("a file of another kind", "a signature (it begins with LODESIG)");
  if (header.version != kSignatureFormatVersion)
    reader.fail(fmt::format("format version {}", header.version), fmt::format("version {}: measure it again", kSignatureFormatVersion));
  if (header.reserved != 0) reader.fail("a header of another kind", "zeros after the version");
  const std::span<const std::byte> payload = bytes.subspan(sizeof(Header));
  if (payload.size() != header.payload_bytes) reader.fail(fmt::format("{} bytes of payload", payload.size()), fmt::format("{}", header.payload_bytes));
  if (XXH3_64bits(payload.data(), payload.size()) != header.payload_hash) reader.fail("a checksum that does not match", "undamaged bytes");
  Reader content(payload, name);
  Signature signature = read_payload(content);
  check_references(signature, content);
  return signature;
}

Signature load_signature(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(fmt::format("{}: found no such file, expected a signature", file.string()));
  std::vector<std::byte> bytes(std::filesystem::file_size(file, error));
  std::ifstream in(file, std::ios::binary);
  if (error || !in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
    throw InputError(fmt::format("{}: found a file that cannot be read, expected a signature", file.string()));
  return decode_signature(bytes, file.string());
}

void save_signature(const Signature& signature, const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = encode_signature(signature);
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  std::filesystem::path temporary = file;
  temporary += fmt::format(".{}.partial", ::getpid());
  std::ofstream out(temporary, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  out.close();
  if (out) std::filesystem::rename(temporary, file, error);
  if (!out || error) {
    std::filesystem::remove(temporary, error);
    throw InputError(fmt::format("{}: found a place that cannot be written, expected a writable folder", file.string()));
  }
}

}  // namespace lodestone
