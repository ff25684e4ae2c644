// Snapshots and recordings.
#include <cstring>

#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

lodestone_result lodestone_snapshot(const lodestone_manager* manager, void* buffer, size_t capacity,
                                    size_t* size) {
  return guarded([&] {
    const std::vector<std::byte> bytes = of(manager).snapshot();
    if (buffer && capacity < bytes.size())
      throw InputError("capacity: found " + std::to_string(capacity) + ", expected at least " +
                       std::to_string(bytes.size()));
    if (buffer) std::memcpy(buffer, bytes.data(), bytes.size());
    give(size, bytes.size());
  });
}

lodestone_result lodestone_restore(lodestone_manager* manager, const void* snapshot, size_t size,
                                   const lodestone_shape* const* given, size_t shape_count) {
  return guarded([&] {
    of(manager).restore(list(static_cast<const std::byte*>(snapshot), size, "snapshot"),
                        shapes(given, shape_count));
  });
}

lodestone_result lodestone_set_record(lodestone_manager* manager,
                                      void (*write)(void* context, const void* bytes, size_t size),
                                      void* context) {
  return guarded([&] {
    if (write)
      of(manager).set_record(
          [write, context](std::span<const std::byte> bytes) { write(context, bytes.data(), bytes.size()); });
    else
      of(manager).set_record({});
  });
}

lodestone_result lodestone_replay(lodestone_manager* manager, const void* recording, size_t size,
                                  const lodestone_shape* const* given, size_t shape_count,
                                  lodestone_replay_result* result) {
  return guarded([&] {
    const ReplayResult replayed = of(manager).replay(
        list(static_cast<const std::byte*>(recording), size, "recording"), shapes(given, shape_count));
    manager->replayed = replayed.text;
    give(result, lodestone_replay_result{replayed.steps, replayed.same, body(replayed.body),
                                         manager->replayed.c_str()});
  });
}
