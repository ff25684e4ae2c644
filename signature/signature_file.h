// A signature as bytes: little-endian, versioned, checksummed. Layout: an 8-byte magic, the format version, the payload's length and its
// XXH3 hash, then the payload. Any damage gives an InputError before anything is allocated for the damaged part.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "signature/signature.h"

namespace lodestone {

inline constexpr std::uint32_t kSignatureFormatVersion = 2;

std::vector<std::byte> encode_signature(const Signature& signature);

/// Throws InputError, with `name` at its head, for anything that encode_signature did not make.
Signature decode_signature(std::span<const std::byte> bytes, const std::string& name);

/// Throws InputError where the file is missing, unreadable or damaged.
Signature load_signature(const std::filesystem::path& file);

/// Written to a temporary file beside `file` and renamed: readers see the old file or the new one, whole. Throws InputError where it cannot be written.
void save_signature(const Signature& signature, const std::filesystem::path& file);

}  // namespace lodestone
