// A signature's bytes, looked at where they lie (mapped or in memory, aligned or not) and checked without any
// allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>

#include "signature/signature_sections.h"

namespace lodestone {

inline constexpr std::size_t kSections = 32;  ///< lists of visit_sections, and the numbers before them
inline constexpr std::size_t kSectionAlignment = 64;  ///< of each section's start in the file

/// The file's first bytes. `checksum`: XXH3 of all that follows them.
struct SignatureHeader {
  char magic[8];
  std::uint32_t version, sections;
  std::uint64_t file_bytes, checksum;
  std::uint64_t reserved[4];
};
static_assert(sizeof(SignatureHeader) == 64);

/// Follows the header once for each section. The sections lie in this order without a gap but what aligns
/// them.
struct SectionEntry {
  std::uint32_t id, value_bytes;
  std::uint64_t offset, count;
};

/// A section's values, read one by one.
template <class T>
class SectionValues {
 public:
  explicit SectionValues(std::span<const std::byte> bytes = {}) : bytes_(bytes) {}
  std::size_t size() const { return bytes_.size() / sizeof(T); }
  bool empty() const { return bytes_.empty(); }
  T operator[](std::size_t i) const {
    T value;
    std::memcpy(&value, bytes_.data() + i * sizeof(T), sizeof(T));
    return value;
  }
  T back() const { return (*this)[size() - 1]; }

 private:
  std::span<const std::byte> bytes_;
};

/// What a file says, its lists still bytes. Made only of bytes in which every number, index and list is
/// sound.
class SignatureView {
 public:
  /// Throws InputError, with `name` at its head, for anything that encode_signature did not make.
  SignatureView(std::span<const std::byte> bytes, const std::string& name);

  /// The numbers; its lists are empty.
  const Signature& numbers() const { return numbers_; }
  /// Section `index` of the lists of visit_sections, from 0.
  std::span<const std::byte> list(std::size_t index) const { return sections_[index + 1]; }

 private:
  void find_sections(std::span<const std::byte> bytes, const std::string& name);
  Signature numbers_;
  std::array<std::span<const std::byte>, kSections> sections_;
};

/// Where a section that would begin at `offset` begins.
constexpr std::uint64_t aligned(std::uint64_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

extern const std::array<char, 8> kSignatureMagic;
/// Bytes of a value in each section.
std::array<std::uint32_t, kSections> section_value_bytes();

}  // namespace lodestone
