// The one binary buffer of a glTF file, filled array by array.
#pragma once

#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lodestone {

/// Appends arrays to `model`'s buffer 0 and describes them with buffer views and accessors.
class GltfBuffer {
 public:
  explicit GltfBuffer(tinygltf::Model& model) : model_(model) { model_.buffers.resize(1); }

  /// A view on bytes that are appended now; `target`: what a graphics card does with it, 0 for animation
  /// data.
  int add_view(std::span<const std::byte> bytes, int target = 0);
  /// `count` values of `type` (TINYGLTF_TYPE_…) made of `component` (TINYGLTF_COMPONENT_TYPE_…) from
  /// `byte_offset` of a view on.
  int add_accessor(int view, std::size_t byte_offset, std::size_t count, int type, int component,
                   bool normalized = false);

  int add_scalars(std::span<const float> values);  ///< with the bounds that key times need
  /// With the bounds that positions need.
  int add_vectors(std::span<const std::array<float, 3>> values, int target);
  int add_indices(std::span<const std::uint32_t> values);

 private:
  template <class Value>
  int add_bounded(std::span<const Value> values, int components, int type, int target);
  tinygltf::Model& model_;
};

}  // namespace lodestone
