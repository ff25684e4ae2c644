#include "lod/manager/recorder.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <utility>

namespace lodestone {

namespace {

std::uint64_t hash_of(std::uint64_t length) { return XXH64(&length, sizeof length, 0); }

}  // namespace

ChunkHead ChunkHead::of(std::span<const std::byte> chunk) {
  const auto length = std::uint64_t(chunk.size());
  return {length, hash_of(length), XXH64(chunk.data(), chunk.size(), 0)};
}

bool ChunkHead::has_true_length() const { return length_hash == hash_of(length); }

std::string words_of(ShapeName name) {
  return fmt::format("a body of a shape that is not here (content {:016x}, radius {} m)", name.content_hash,
                     name.radius);
}

std::shared_ptr<const Shape> find_shape(ShapeName name, std::span<const std::shared_ptr<const Shape>> given,
                                        const BodyTable& bodies) {
  for (const std::shared_ptr<const Shape>& shape : given)
    if (shape && name_of(*shape) == name) return shape;
  for (std::uint32_t i = 0; i < bodies.indices(); ++i)
    if (bodies.alive(i) && name_of(*bodies.shape(i)) == name) return bodies.shape(i);
  return nullptr;
}

std::vector<std::uint32_t> body_hashes(const Levels& levels) {
  std::vector<std::uint32_t> hashes;
  for (const std::uint32_t body : levels.bodies.in_order_of_creation()) {
    const std::array<double, 15> numbers = levels.numbers_of(body);
    hashes.push_back(std::uint32_t(XXH64(numbers.data(), sizeof numbers, 0)));
  }
  return hashes;
}

void Recorder::set(RecordFunction write, std::vector<std::byte> snapshot) {
  write_ = nullptr;
  rethrow();
  if (!write) return;
  write(std::as_bytes(std::span(kRecordingMagic)));
  write_ = std::move(write);
  note(Call::begin, snapshot);
  rethrow();
}

void Recorder::rethrow() {
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

// The call that is written down has been made, so what `write` throws waits for one whose caller loses
// nothing.
void Recorder::put(const std::vector<std::byte>& chunk) {
  const ChunkHead head = ChunkHead::of(chunk);
  try {
    write_(std::as_bytes(std::span(&head, 1)));
    write_(chunk);
  } catch (...) {
    thrown_ = std::current_exception();
    write_ = nullptr;
  }
}

}  // namespace lodestone
