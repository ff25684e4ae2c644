#include "signature/signature_file.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "reference/error.h"
#include "signature/file_bytes.h"
#include "signature/signature_view.h"

namespace lodestone {
namespace {

template <class List>
void append(std::vector<std::byte>& bytes, const List& list) {
  for (const auto& value : list) {
    const auto stored = Stored<typename List::value_type>::pack(value);
    const auto* first = reinterpret_cast<const std::byte*>(&stored);
    bytes.insert(bytes.end(), first, first + sizeof(stored));
  }
}

// Of the file as a whole, once its header and sections are known.
class FileWriter {
 public:
  FileWriter() : bytes_(sizeof(SignatureHeader) + kSections * sizeof(SectionEntry)) {}

  template <class List>
  void add(const List& list) {
    bytes_.resize(aligned(bytes_.size()));
    const SectionEntry entry{section_, value_bytes_[section_], bytes_.size(), list.size()};
    std::memcpy(bytes_.data() + sizeof(SignatureHeader) + section_ * sizeof(SectionEntry), &entry,
                sizeof(entry));
    append(bytes_, list);
    ++section_;
  }

  std::vector<std::byte> finish() {
    SignatureHeader header{};
    std::ranges::copy(kSignatureMagic, header.magic);
    header.version = kSignatureFormatVersion, header.sections = kSections, header.file_bytes = bytes_.size();
    header.checksum = XXH3_64bits(bytes_.data() + sizeof(header), bytes_.size() - sizeof(header));
    std::memcpy(bytes_.data(), &header, sizeof(header));
    return std::move(bytes_);
  }

 private:
  std::array<std::uint32_t, kSections> value_bytes_ = section_value_bytes();
  std::uint32_t section_ = 0;
  std::vector<std::byte> bytes_;
};

}  // namespace

std::vector<std::byte> encode_signature(const Signature& signature) {
  FileWriter file;
  ByteWriter numbers;
  archive_numbers(numbers, signature);
  file.add(numbers.bytes);
  visit_sections(signature, [&](std::string_view, std::string_view, const auto& list) { file.add(list); });
  return file.finish();
}

Signature load_signature(std::span<const std::byte> bytes, const std::string& name) {
  const SignatureView view(bytes, name);
  Signature signature = view.numbers();
  std::size_t section = 0;
  visit_sections(signature, [&](std::string_view, std::string_view, auto& list) {
    using Value = typename std::remove_cvref_t<decltype(list)>::value_type;
    const SectionValues<typename Stored<Value>::Type> values(view.list(section++));
    list.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) list[i] = Stored<Value>::unpack(values[i]);
  });
  return signature;
}

Signature load_signature(const std::filesystem::path& file) {
  const MappedFile mapped(file, "a signature");
  return load_signature(mapped.bytes(), file.string());
}

void check_measured_for(const Signature& signature, const Shape& shape, const std::string& name) {
  if (signature.shape_hash == shape.content_hash) return;
  throw InputError(fmt::format("{}: found the signature of {} ({:016x}), expected that of {} ({:016x})", name,
                               signature.shape_name, signature.shape_hash, shape.name, shape.content_hash));
}

void save_signature(const Signature& signature, const std::filesystem::path& file) {
  write_atomically(encode_signature(signature), file);
}

std::vector<SectionSize> list_section_sizes(const Signature& signature) {
  std::vector<SectionSize> sizes;
  std::size_t lists = 0;
  visit_sections(signature, [&](std::string_view group, std::string_view name, const auto& list) {
    using Value = typename std::remove_cvref_t<decltype(list)>::value_type;
    const std::size_t bytes = list.size() * sizeof(typename Stored<Value>::Type);
    if (bytes > 0) sizes.push_back({std::string(group), std::string(name), bytes});
    lists += bytes;
  });
  sizes.push_back({"header", "numbers, alignment", encode_signature(signature).size() - lists});
  return sizes;
}

}  // namespace lodestone
