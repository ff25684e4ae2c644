// A signature as bytes: little-endian, versioned, checksummed, laid out to be mapped. First a header, then a
// list of sections, then the sections; each has values of one kind without padding, and begins at a multiple
// of 64 bytes (signature_view.h, signature_sections.h). Any damage is an InputError before anything is
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

inline constexpr std::uint32_t kSignatureFormatVersion = 4;  ///< files of other versions are refused

/// The signature as bytes. The same signature gives the same bytes; how long it took to measure and the
/// errors of the rungs (Signature::rung_errors) are not among them.
std::vector<std::byte> encode_signature(const Signature& signature);

/// The signature that the bytes are of. Throws InputError, which begins with `name`, for bytes that
/// encode_signature did not make.
Signature load_signature(std::span<const std::byte> bytes, const std::string& name = "a signature in memory");

/// The signature in a file. Throws InputError if the file is missing, unreadable or damaged.
Signature load_signature(const std::filesystem::path& file);

/// Throws InputError, which begins with `name` and names both shapes, unless `signature` was measured for
/// `shape` or a scaled copy of it.
void check_measured_for(const Signature& signature, const Shape& shape, const std::string& name);

/// Writes a temporary file beside `file` and renames it, so that readers see either the old file or the whole
/// new one. Throws InputError if it cannot be written.
void save_signature(const Signature& signature, const std::filesystem::path& file);

/// How many bytes one list takes in the file.
struct SectionSize {
  std::string group, name;
  std::size_t bytes = 0;
};

/// The sizes of all lists that are not empty. The last entry is the header, with the single numbers and what
/// aligns the rest.
std::vector<SectionSize> list_section_sizes(const Signature& signature);

}  // namespace lodestone
