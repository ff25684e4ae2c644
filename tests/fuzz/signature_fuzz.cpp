// A signature file: refused, or read so that the same bytes come out again. The checksum is put right first:
// it would keep all else from being reached.
#include <xxhash.h>

#include <algorithm>
#include <vector>

#include "reference/error.h"
#include "signature/signature_file.h"
#include "signature/signature_view.h"
#include "tests/fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  std::vector<std::byte> bytes(size);
  std::transform(data, data + size, bytes.begin(), [](std::uint8_t one) { return std::byte(one); });
  if (size >= sizeof(SignatureHeader)) {
    const std::uint64_t checksum =
        XXH3_64bits(data + sizeof(SignatureHeader), size - sizeof(SignatureHeader));
    std::memcpy(bytes.data() + offsetof(SignatureHeader, checksum), &checksum, sizeof checksum);
  }
  try {
    fuzz::require(encode_signature(load_signature(bytes, "fuzz")) == bytes,
                  "a signature that was read is written otherwise");
  } catch (const InputError&) {
  }
  return 0;
}
