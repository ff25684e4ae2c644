#include "scenes/gltf_buffer.h"

#include <algorithm>

namespace lodestone {

int GltfBuffer::add_view(std::span<const std::byte> bytes, int target) {
  std::vector<unsigned char>& data = model_.buffers[0].data;
  data.resize((data.size() + 3) / 4 * 4);  // accessors must start at multiples of their component's size
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = bytes.size();
  view.target = target;
  const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
  data.insert(data.end(), first, first + bytes.size());
  model_.bufferViews.push_back(std::move(view));
  return int(model_.bufferViews.size()) - 1;
}

int GltfBuffer::add_accessor(int view, std::size_t byte_offset, std::size_t count, int type, int component,
                             bool normalized) {
  tinygltf::Accessor accessor;
  accessor.bufferView = view;
  accessor.byteOffset = byte_offset;
  accessor.count = count;
  accessor.type = type;
  accessor.componentType = component;
  accessor.normalized = normalized;
  model_.accessors.push_back(std::move(accessor));
  return int(model_.accessors.size()) - 1;
}

template <class Value>
int GltfBuffer::add_bounded(std::span<const Value> values, int components, int type, int target) {
  const int view = add_view(std::as_bytes(values), target);
  const int accessor = add_accessor(view, 0, values.size(), type, TINYGLTF_COMPONENT_TYPE_FLOAT);
  const float* numbers = reinterpret_cast<const float*>(values.data());
  for (int c = 0; c < components; ++c) {
    float low = numbers[c], high = numbers[c];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float x = numbers[i * std::size_t(components) + std::size_t(c)];
      low = std::min(low, x);
      high = std::max(high, x);
    }
    model_.accessors.back().minValues.push_back(low);
    model_.accessors.back().maxValues.push_back(high);
  }
  return accessor;
}

int GltfBuffer::add_scalars(std::span<const float> values) {
  return add_bounded(values, 1, TINYGLTF_TYPE_SCALAR, 0);
}

int GltfBuffer::add_vectors(std::span<const std::array<float, 3>> values, int target) {
  return add_bounded(values, 3, TINYGLTF_TYPE_VEC3, target);
}

int GltfBuffer::add_indices(std::span<const std::uint32_t> values) {
  const int view = add_view(std::as_bytes(values), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  return add_accessor(view, 0, values.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
}

}  // namespace lodestone
