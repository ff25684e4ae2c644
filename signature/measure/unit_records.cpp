#include "signature/measure/unit_records.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "reference/error.h"
#include "signature/measure/unit_archive.h"
#include "signature/settings_archive.h"

namespace lodestone {
namespace {

constexpr std::uint64_t kPartMagic = 0x0a325250'45444f4cull;  // "LODEPR2\n" in a file
constexpr std::size_t kHeadNumbers = 3 * sizeof(std::uint64_t), kRecordNumbers = 4 * sizeof(std::uint64_t);

template <class Archive>
void archive(Archive& a, Archived<MeasurementIdentity> auto& identity) {
  a(identity.versions, identity.settings, identity.share, identity.shape);
}

std::uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace

std::vector<std::byte> encode_head(const MeasurementIdentity& identity) {
  ByteWriter content, head;
  archive(content, identity);
  head(kPartMagic, std::uint64_t(content.bytes.size()), checksum(content.bytes));
  head.bytes.insert(head.bytes.end(), content.bytes.begin(), content.bytes.end());
  return std::move(head.bytes);
}

MeasurementIdentity decode_head(std::span<const std::byte>& bytes, const std::string& name) {
  std::uint64_t magic = 0, length = 0, expected = 0;
  ByteReader(bytes.first(std::min(bytes.size(), kHeadNumbers)))(magic, length, expected);
  if (magic != kPartMagic)
    throw InputError(
        fmt::format("{}: found a file of another kind, expected a part of a signature (sign --shard)", name));
  if (bytes.size() < kHeadNumbers || length > bytes.size() - kHeadNumbers)
    throw InputError(fmt::format("{}: found its end in the middle of a value, expected a whole part", name));
  bytes = bytes.subspan(kHeadNumbers);
  const std::span<const std::byte> content = bytes.first(length);
  MeasurementIdentity identity;
  ByteReader reader(content);
  if (checksum(content) == expected) archive(reader, identity);
  if (!reader.whole())
    throw InputError(fmt::format("{}: found a checksum that does not match, expected undamaged bytes", name));
  bytes = bytes.subspan(length);
  return identity;
}

std::vector<std::byte> encode_record(const UnitRecord& record) {
  ByteWriter writer;
  writer(record.kind, std::uint32_t(record.bytes.size()), record.unit, record.seconds);
  writer.bytes.insert(writer.bytes.end(), record.bytes.begin(), record.bytes.end());
  writer(checksum(writer.bytes));
  return std::move(writer.bytes);
}

std::vector<UnitRecord> take_records(std::span<const std::byte>& bytes) {
  std::vector<UnitRecord> records;
  while (bytes.size() >= kRecordNumbers) {
    UnitRecord record;
    std::uint32_t length = 0;
    ByteReader numbers_reader(bytes);
    numbers_reader(record.kind, length, record.unit, record.seconds);
    if (length > bytes.size() - kRecordNumbers) break;
    const std::size_t numbers = kRecordNumbers - sizeof(std::uint64_t);
    std::uint64_t expected = 0;
    ByteReader(bytes.subspan(numbers + length))(expected);
    if (checksum(bytes.first(numbers + length)) != expected) break;
    record.bytes = bytes.subspan(numbers, length);
    records.push_back(record);
    bytes = bytes.subspan(kRecordNumbers + length);
  }
  return records;
}

}  // namespace lodestone
