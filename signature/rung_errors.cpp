#include "signature/rung_errors.h"

#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "signature/file_bytes.h"

namespace lodestone {
namespace {

constexpr char kErrorsMagic[8] = {'L', 'O', 'D', 'E', 'R', 'R', '\r', '\n'};
constexpr std::uint32_t kErrorsVersion = 1;

struct File {
  char magic[8];
  std::uint32_t version, drops;
  double values[6];        // score and drift of tables, support, full
  std::uint64_t checksum;  // XXH3 of all before it
};
static_assert(sizeof(File) == 72);

std::uint64_t checksum_of(const File& file) { return XXH3_64bits(&file, offsetof(File, checksum)); }

}  // namespace

void save_rung_errors(const RungErrors& errors, const std::filesystem::path& path) {
  File file{.magic = {},
            .version = kErrorsVersion,
            .drops = errors.drops,
            .values = {errors.tables.score, errors.tables.drift, errors.support.score, errors.support.drift,
                       errors.full.score, errors.full.drift},
            .checksum = 0};
  std::memcpy(file.magic, kErrorsMagic, sizeof kErrorsMagic);
  file.checksum = checksum_of(file);
  write_atomically(std::as_bytes(std::span(&file, 1)), path);
}

std::optional<RungErrors> load_rung_errors(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(stream), {});
  File file;
  if (!stream || bytes.size() != sizeof file) return {};
  std::memcpy(&file, bytes.data(), sizeof file);
  if (std::memcmp(file.magic, kErrorsMagic, sizeof kErrorsMagic) != 0 || file.version != kErrorsVersion ||
      file.checksum != checksum_of(file))
    return {};
  for (const double value : file.values)
    if (!(value >= 0.0 && std::isfinite(value))) return {};
  const double* v = file.values;
  return RungErrors{
      .tables = {v[0], v[1]}, .support = {v[2], v[3]}, .full = {v[4], v[5]}, .drops = file.drops};
}

}  // namespace lodestone
