// A signature as bytes: little-endian, versioned, checksummed, laid out to be mapped. A header, a list of
// sections, then the sections, each of one kind of value without padding, each beginning at a multiple of 64
// bytes (signature_view.h, signature_sections.h). Any damage gives an InputError before anything is
// allocated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

inline constexpr std::uint32_t kSignatureFormatVersion = 4;

/// The same signature gives the same bytes; how long it took to measure is not among them.
std::vector<std::byte> encode_signature(const Signature& signature);

/// Throws InputError, with `name` at its head, for anything that encode_signature did not make.
Signature load_signature(std::span<const std::byte> bytes, const std::string& name = "a signature in memory");

/// Maps the file. Throws InputError where it is missing, unreadable or damaged.
Signature load_signature(const std::filesystem::path& file);

/// Throws InputError, naming both, unless `signature` was measured for `shape` or a scaled copy of it.
void check_measured_for(const Signature& signature, const Shape& shape, const std::string& name);

/// Written to a temporary file beside `file` and renamed: readers see the old file or the new one, whole.
/// Throws InputError where it cannot be written.
void save_signature(const Signature& signature, const std::filesystem::path& file);

/// Bytes of one list in the file.
struct SectionSize {
  std::string group, name;
  std::size_t bytes = 0;
};

/// Every list that is not empty; the last entry is the header, with the numbers and what aligns the rest.
std::vector<SectionSize> list_section_sizes(const Signature& signature);

}  // namespace lodestone
