#include "signature/measure/measurement_part.h"

#include <fmt/format.h>

#include <map>

#include "reference/error.h"
#include "signature/file_bytes.h"
#include "signature/measure/measure.h"
#include "signature/measure/unit_archive.h"
#include "signature/settings_archive.h"
#include "signature/signature_source.h"

namespace lodestone {
namespace {

using Records = std::map<std::pair<UnitKind, std::int64_t>, std::span<const std::byte>>;

[[noreturn]] void fail(const std::string& name, const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("{}: found {}, expected {}", name, found, expected));
}

std::string text_of(const Share& share) { return fmt::format("part {} of {}", share.index + 1, share.count); }

void append(std::vector<std::byte>& to, const std::vector<std::byte>& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

// Every unit of the share and nothing else.
Measurement decode_units(const Records& records, const MeasurementIdentity& identity,
                         const std::string& name) {
  Measurement m = make_empty_measurement(identity.settings, identity.share);
  std::size_t units_read = 0;
  visit_units(m, [&](UnitKind kind, auto& units) {
    for (std::size_t i = 0; i < units.size(); ++i) {
      if (!identity.share.holds(std::int64_t(i))) continue;
      const auto record = records.find({kind, std::int64_t(i)});
      if (record == records.end() || !decode_unit(record->second, units[i]))
        fail(name, "a unit that is missing", "every unit of " + text_of(identity.share));
      ++units_read;
    }
  });
  if (units_read != records.size())
    fail(name, fmt::format("{} units", records.size()),
         fmt::format("{}, those of {}", units_read, text_of(identity.share)));
  return m;
}

std::vector<std::byte> bytes_of(const SignatureSettings& settings) {
  ByteWriter writer;
  writer(settings);
  return std::move(writer.bytes);
}

void check_belongs(const MeasurementPart& part, const std::string& name, const MeasurementPart& first,
                   const std::string& first_name) {
  const MeasurementIdentity &a = part.identity, &b = first.identity;
  if (a.versions != b.versions) fail(name, "made by " + a.versions, b.versions + ", as " + first_name);
  if (a.shape.content_hash != b.shape.content_hash)
    fail(name, fmt::format("shape {} ({:016x})", a.shape.name, a.shape.content_hash),
         fmt::format("{} ({:016x}), as {}", b.shape.name, b.shape.content_hash, first_name));
  if (bytes_of(a.settings) != bytes_of(b.settings))
    fail(name, "other settings", "the restitution, friction, seed, grid and trials of " + first_name);
  if (a.share.count != b.share.count)
    fail(name, text_of(a.share), fmt::format("a part of {}, as {}", b.share.count, first_name));
}

// Each part once.
void check_all_there(std::span<const MeasurementPart> parts, std::span<const std::filesystem::path> files) {
  std::vector<std::string> file_of(std::size_t(parts.front().identity.share.count));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::string& file = file_of[std::size_t(parts[i].identity.share.index)];
    if (!file.empty())
      fail(files[i].string(), text_of(parts[i].identity.share) + " again",
           "each part once (" + file + " is it, too)");
    file = files[i].string();
  }
  for (std::size_t i = 0; i < file_of.size(); ++i)
    if (file_of[i].empty())
      fail("merge", fmt::format("no part {}/{} among {} files", i + 1, file_of.size(), files.size()),
           fmt::format("all of 1/{0} to {0}/{0}", file_of.size()));
}

}  // namespace

std::uint64_t count_trials(const MeasurementPart& part) {
  std::uint64_t trials = 0;
  visit_units(part.measurement, [&](UnitKind, const auto& units) {
    for (std::size_t i = 0; i < units.size(); ++i)
      if (part.identity.share.holds(std::int64_t(i))) trials += trials_of(units[i], part.identity.settings);
  });
  return trials;
}

std::vector<std::byte> encode_part(const MeasurementPart& part) {
  std::vector<std::byte> bytes = encode_head(part.identity);
  visit_units(part.measurement, [&](UnitKind kind, const auto& units) {
    for (std::size_t i = 0; i < units.size(); ++i)
      if (part.identity.share.holds(std::int64_t(i)))
        append(bytes, encode_record({kind, std::int64_t(i), 0.0, encode_unit(units[i])}));
  });
  append(bytes, encode_record({UnitKind::end, 0, part.seconds, {}}));
  return bytes;
}

void save_part(const MeasurementPart& part, const std::filesystem::path& file) {
  write_atomically(encode_part(part), file);
}

MeasurementPart load_part(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::vector<std::byte> content = read_file(file, "a part of a signature");
  std::span<const std::byte> bytes = content;
  MeasurementPart part{.identity = decode_head(bytes, name), .measurement = {}};
  const Share& share = part.identity.share;
  if (share.count < 1 || share.index < 0 || share.index >= share.count)
    fail(name, text_of(share), "a part from 1 to as many as there are");
  Records records;
  for (const UnitRecord& record : take_records(bytes)) {
    if (record.kind == UnitKind::end) part.seconds = record.seconds;
    if (!records.emplace(std::pair(record.kind, record.unit), record.bytes).second)
      fail(name, "a unit twice", "each unit once");
  }
  if (records.erase(std::pair(UnitKind::end, std::int64_t(0))) == 0 || !bytes.empty())
    fail(name, "a part that was cut short or damaged", "a whole one: measure it again");
  part.measurement = decode_units(records, part.identity, name);
  return part;
}

Signature merge_parts(std::span<const std::filesystem::path> files) {
  check_that(!files.empty(), "there are parts to merge");
  std::vector<MeasurementPart> parts;
  for (const auto& file : files) parts.push_back(load_part(file));
  const MeasurementIdentity& identity = parts.front().identity;
  if (identity.versions != measurement_versions())
    fail(files.front().string(), "made by " + identity.versions,
         measurement_versions() + ": measure it again");
  for (std::size_t i = 1; i < parts.size(); ++i)
    check_belongs(parts[i], files[i].string(), parts.front(), files.front().string());
  check_all_there(parts, files);
  std::vector<Measurement> shares;
  double seconds = 0.0;
  for (MeasurementPart& part : parts) shares.push_back(std::move(part.measurement)), seconds += part.seconds;
  Signature signature = make_signature(identity.shape, identity.settings, merge_measurements(shares));
  signature.measuring_seconds = seconds;
  return signature;
}

}  // namespace lodestone
