// A measurement divided among processes or machines: each measures its share of the units into a file, a
// part; all parts together give the signature.
#pragma once

#include <filesystem>
#include <span>

#include "signature/measure/unit_records.h"

namespace lodestone {

/// One share, measured.
struct MeasurementPart {
  MeasurementIdentity identity;
  Measurement measurement;
  double seconds = 0.0;              ///< of measuring
  std::uint64_t trials_resumed = 0;  ///< that an interrupted measurement had left; not in the file
  std::uint64_t trials_noted = 0;    ///< that the journal got now; not in the file
};

/// In the part, without those of other shares.
std::uint64_t count_trials(const MeasurementPart& part);

std::vector<std::byte> encode_part(const MeasurementPart& part);

/// Written whole or not at all. Throws InputError where it cannot be written.
void save_part(const MeasurementPart& part, const std::filesystem::path& file);

/// Throws InputError for anything but a whole, undamaged part.
MeasurementPart load_part(const std::filesystem::path& file);

/// The signature that the parts give, in any order: the same as if one process had measured it. Its
/// `measuring_seconds` are those of all. Throws InputError where they are not the parts of one measurement,
/// each given once, or were made by another version of this program.
Signature merge_parts(std::span<const std::filesystem::path> files);

}  // namespace lodestone
