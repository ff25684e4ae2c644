// The units that an interrupted measurement had finished, in a file beside the one that is being made. The file is also the lock: one process measures,
// others wait for what it makes.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "signature/measure/unit_archive.h"
#include "signature/measure/unit_records.h"

namespace lodestone {

class MeasuringJournal {
 public:
  /// Opens `file`, or makes it, for this process alone; null while another one holds it. Units that belong to `identity` are kept, a record cut
  /// short is dropped, a journal of anything else is begun anew. Throws InputError where the file cannot be written.
  static std::unique_ptr<MeasuringJournal> try_open(const std::filesystem::path& file, const MeasurementIdentity& identity);
  ~MeasuringJournal();
  MeasuringJournal(const MeasuringJournal&) = delete;
  MeasuringJournal& operator=(const MeasuringJournal&) = delete;

  /// Sets `into` to the unit, if it is here. From any thread.
  template <class Unit>
  bool take(UnitKind kind, std::int64_t unit, Unit& into) {
    return take_bytes(kind, unit, [&](std::span<const std::byte> bytes) { return decode_unit(bytes, into); });
  }
  /// Appends a finished unit. From any thread. A full disk ends the journal, not the measurement.
  template <class Unit>
  void note(UnitKind kind, std::int64_t unit, const Unit& finished) { append(kind, unit, encode_unit(finished)); }

  /// Trials behind the units that were here from the start.
  std::uint64_t trials_found(const SignatureSettings& settings) const;
  double seconds() const;                          ///< of measuring, all sessions together
  void remove();                                   ///< of no more use: what was to be made is there

 private:
  MeasuringJournal(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
  void read(const MeasurementIdentity& identity);
  void append(UnitKind kind, std::int64_t unit, std::span<const std::byte> bytes);
  template <class Read>
  bool take_bytes(UnitKind kind, std::int64_t unit, Read read) const {
    const auto found = found_.find({kind, unit});
    return found != found_.end() && read(found->second);
  }

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::vector<std::byte> content_;  // which `found_` points into
  std::map<std::pair<UnitKind, std::int64_t>, std::span<const std::byte>> found_;
  double seconds_before_ = 0.0, opened_ = 0.0;
  std::mutex mutex_;
  bool writable_ = true;
};

}  // namespace lodestone
