// Reading a mesh of a stranger in a child process with limits: whatever a file does to the reader, it is the
// child that dies.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "reference/mesh/mesh.h"

namespace lodestone {

struct ChildLimits {
  std::uintmax_t memory_bytes = std::uintmax_t(2) << 30;  ///< beyond what this process has
  unsigned processor_s = 20;
  unsigned wall_s = 60;
};

/// What `read` returns, called in a child process with `limits`; an InputError that it throws is thrown here.
/// The child's death and a limit that it meets are InputErrors, too, with `name` at their head. `max_faces`
/// bounds what is taken from it. Under a sanitizer, which takes address space by the terabyte, memory is not
/// limited.
Mesh read_mesh_in_child(const std::string& name, const std::function<Mesh()>& read, int max_faces,
                        const ChildLimits& limits = {});

}  // namespace lodestone
