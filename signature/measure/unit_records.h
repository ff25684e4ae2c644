// Units of a measurement as records of bytes: the content of a part (measurement_part.h) and of a journal
// (measurement_journal.h).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "reference/shape.h"
#include "signature/byte_archive.h"
#include "signature/measure/measurement.h"

namespace lodestone {

/// What units belong to: parts of one measurement differ in `share.index` alone.
struct MeasurementIdentity {
  std::string versions;  ///< measurement_versions()
  SignatureSettings settings;
  Share share;
  Shape shape;  ///< as it is measured (make_measurement_shape); of a file without its hull
};

/// One unit: numbers, its own bytes, and a checksum of all of them.
struct UnitRecord {
  UnitKind kind = UnitKind::end;
  std::int64_t unit = 0;
  double seconds = 0.0;  ///< measured so far when it was written
  std::span<const std::byte> bytes;
};

/// The head of a file of records: a magic, its length, the identity and a checksum.
std::vector<std::byte> encode_head(const MeasurementIdentity& identity);

/// Reads the head and takes it off `bytes`. Throws InputError, with `name` at its head, for anything that
/// encode_head did not make.
MeasurementIdentity decode_head(std::span<const std::byte>& bytes, const std::string& name);

std::vector<std::byte> encode_record(const UnitRecord& record);

/// The whole, undamaged records at the front of `bytes`, which is left with what follows them.
std::vector<UnitRecord> take_records(std::span<const std::byte>& bytes);

}  // namespace lodestone
