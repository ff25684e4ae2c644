#include "signature/measure/measurement_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>

#include "reference/error.h"

namespace lodestone {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Whether `file` still names what is open: its holder before may have removed it meanwhile.
bool is_same_file(int descriptor, const std::filesystem::path& file) {
  struct stat opened {
  }, named{};
  return ::fstat(descriptor, &opened) == 0 && ::stat(file.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

std::vector<std::byte> read_all(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return {};
  std::vector<std::byte> bytes(std::size_t(status.st_size));
  std::size_t length = 0;
  while (length < bytes.size()) {
    const ssize_t count = ::pread(descriptor, bytes.data() + length, bytes.size() - length, off_t(length));
    if (count <= 0) break;
    length += std::size_t(count);
  }
  bytes.resize(length);
  return bytes;
}

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(std::size_t(count));
  }
  return true;
}

std::filesystem::path holder_file(std::filesystem::path file) { return file += ".holder"; }

std::string host_name() {
  utsname system{};
  return ::uname(&system) == 0 ? system.nodename : "unknown";
}

// For those who wait; where it cannot be written they wait for an unnamed one.
void write_holder(const std::filesystem::path& file) {
  std::ofstream out(holder_file(file));
  out << ::getpid() << ' ' << host_name() << '\n';
}

// The third field of its stat, after the name in parentheses (proc(5)).
bool is_stopped(long pid) {
  std::ifstream in(fmt::format("/proc/{}/stat", pid));
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t name_end = text.rfind(')');
  return name_end != text.npos && name_end + 2 < text.size() &&
         (text[name_end + 2] == 'T' || text[name_end + 2] == 't');
}

}  // namespace

std::optional<JournalHolder> find_holder(const std::filesystem::path& file) {
  JournalHolder holder;
  std::ifstream in(holder_file(file));
  if (!(in >> holder.pid >> holder.host)) return std::nullopt;
  holder.is_stopped = holder.host == host_name() && is_stopped(holder.pid);
  return holder;
}

std::unique_ptr<MeasurementJournal> MeasurementJournal::try_open(const std::filesystem::path& file,
                                                                 const MeasurementIdentity& identity) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  for (;;) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (descriptor < 0)
      throw InputError(
          fmt::format("{}: found a place that cannot be written ({}), expected a writable folder",
                      file.string(), std::strerror(errno)));
    std::unique_ptr<MeasurementJournal> journal(new MeasurementJournal(file, descriptor, identity.settings));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) return nullptr;
      throw InputError(
          fmt::format("{}: found a file that cannot be locked ({}), expected a folder that allows it",
                      file.string(), std::strerror(errno)));
    }
    if (!is_same_file(descriptor, file)) continue;
    write_holder(file);  // before the journal has a byte: who finds one finds a name
    journal->read(identity);
    return journal;
  }
}

MeasurementJournal::~MeasurementJournal() { ::close(descriptor_); }  // and with it the lock

void MeasurementJournal::read(const MeasurementIdentity& identity) {
  opened_ = now();
  content_ = read_all(descriptor_);
  const std::vector<std::byte> head = encode_head(identity);
  std::size_t sound = 0;
  if (content_.size() >= head.size() && std::memcmp(content_.data(), head.data(), head.size()) == 0) {
    std::span<const std::byte> rest = std::span(content_).subspan(head.size());
    for (const UnitRecord& record : take_records(rest)) {
      found_[{record.kind, record.unit}] = record.bytes;
      seconds_before_ = std::max(seconds_before_, record.seconds);
    }
    sound = content_.size() - rest.size();
  }
  // What follows the last sound record was being written when the process ended.
  writable_ = ::ftruncate(descriptor_, off_t(sound)) == 0 && (sound > 0 || write_all(descriptor_, head));
}

bool MeasurementJournal::append(UnitKind kind, std::int64_t unit, std::span<const std::byte> bytes) {
  const std::vector<std::byte> record = encode_record({kind, unit, seconds(), bytes});
  const std::lock_guard lock(mutex_);
  return writable_ = writable_ && write_all(descriptor_, record);
}

double MeasurementJournal::seconds() const { return seconds_before_ + now() - opened_; }

std::uint64_t MeasurementJournal::trials_found(const SignatureSettings& settings) const {
  std::uint64_t trials = 0;
  Measurement any;
  visit_units(any, [&](UnitKind kind, auto& units) {
    auto& unit = units.emplace_back();
    for (const auto& [key, bytes] : found_)
      if (key.first == kind && decode_unit(bytes, unit)) trials += trials_of(unit, settings);
  });
  return trials;
}

void MeasurementJournal::remove() {
  std::error_code error;
  std::filesystem::remove(holder_file(file_), error);
  std::filesystem::remove(file_, error);
}

}  // namespace lodestone
