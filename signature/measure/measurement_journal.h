// The units that an interrupted measurement had finished, in a file beside the one that is being made. The
// file is also the lock: one process measures, others wait for what it makes.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "signature/measure/unit_archive.h"
#include "signature/measure/unit_records.h"

namespace lodestone {

/// Who holds a journal.
struct JournalHolder {
  long pid = 0;
  std::string host;
  bool is_stopped = false;  ///< known of this machine's processes only
};

/// Of the journal `file`, which another process holds; none where it has not said so (yet).
std::optional<JournalHolder> find_holder(const std::filesystem::path& file);

class MeasurementJournal {
 public:
  /// Opens `file`, or makes it, for this process alone; null while another one holds it. Units that belong to
  /// `identity` are kept, a record cut short is dropped, a journal of anything else is begun anew. Throws
  /// InputError where the file cannot be written.
  static std::unique_ptr<MeasurementJournal> try_open(const std::filesystem::path& file,
                                                      const MeasurementIdentity& identity);
  ~MeasurementJournal();
  MeasurementJournal(const MeasurementJournal&) = delete;
  MeasurementJournal& operator=(const MeasurementJournal&) = delete;

  /// Sets `into` to the unit, if it is here. From any thread.
  template <class Unit>
  bool take(UnitKind kind, std::int64_t unit, Unit& into) {
    return take_bytes(kind, unit, [&](std::span<const std::byte> bytes) { return decode_unit(bytes, into); });
  }
  /// Appends a finished unit. From any thread. A full disk ends the journal, not the measurement.
  template <class Unit>
  void note(UnitKind kind, std::int64_t unit, const Unit& finished) {
    if (append(kind, unit, encode_unit(finished))) trials_noted_ += trials_of(finished, settings_);
  }

  /// Trials behind the units that were here from the start.
  std::uint64_t trials_found(const SignatureSettings& settings) const;
  /// And behind those that were appended since, and are in the file.
  std::uint64_t trials_noted() const { return trials_noted_; }
  double seconds() const;  ///< of measuring, all sessions together
  void remove();           ///< of no more use: what was to be made is there

 private:
  MeasurementJournal(std::filesystem::path file, int descriptor, const SignatureSettings& settings)
      : file_(std::move(file)), descriptor_(descriptor), settings_(settings) {}
  void read(const MeasurementIdentity& identity);
  bool append(UnitKind kind, std::int64_t unit, std::span<const std::byte> bytes);
  template <class Read>
  bool take_bytes(UnitKind kind, std::int64_t unit, Read read) const {
    const auto found = found_.find({kind, unit});
    return found != found_.end() && read(found->second);
  }

  std::filesystem::path file_;
  int descriptor_ = -1;
  SignatureSettings settings_;
  std::vector<std::byte> content_;  // which `found_` points into
  std::map<std::pair<UnitKind, std::int64_t>, std::span<const std::byte>> found_;
  double seconds_before_ = 0.0, opened_ = 0.0;
  std::mutex mutex_;
  bool writable_ = true;
  std::atomic<std::uint64_t> trials_noted_ = 0;
};

}  // namespace lodestone
