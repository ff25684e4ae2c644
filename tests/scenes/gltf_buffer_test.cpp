#include "scenes/gltf_buffer.h"

#include <gtest/gtest.h>

#include <cstring>

namespace lodestone {
namespace {

TEST(GltfBuffer, ViewsBeginAtMultiplesOfFour) {
  tinygltf::Model model;
  GltfBuffer buffer(model);
  const std::byte bytes[] = {std::byte(1), std::byte(2), std::byte(3), std::byte(4), std::byte(5)};
  EXPECT_EQ(buffer.add_view(std::span(bytes).first(5)), 0);
  EXPECT_EQ(buffer.add_view(std::span(bytes).first(1), TINYGLTF_TARGET_ARRAY_BUFFER), 1);
  EXPECT_EQ(buffer.add_view(std::span(bytes).first(4)), 2);
  ASSERT_EQ(model.buffers.size(), 1U);
  EXPECT_EQ(model.bufferViews[1].byteOffset, 8U);
  EXPECT_EQ(model.bufferViews[1].byteLength, 1U);
  EXPECT_EQ(model.bufferViews[1].target, TINYGLTF_TARGET_ARRAY_BUFFER);
  EXPECT_EQ(model.bufferViews[2].byteOffset, 12U);
  EXPECT_EQ(model.buffers[0].data.size(), 16U);
  EXPECT_EQ(model.buffers[0].data[4], 5);
  EXPECT_EQ(model.buffers[0].data[8], 1);
}

// Viewers refuse key times and positions whose least and greatest are not told.
TEST(GltfBuffer, BoundsAreThoseOfTheValues) {
  tinygltf::Model model;
  GltfBuffer buffer(model);
  const float times[] = {0.5f, 0.25f, 2.0f};
  const std::array<float, 3> places[] = {{1, -2, 3}, {-4, 5, 3}};
  const tinygltf::Accessor& scalars = model.accessors[std::size_t(buffer.add_scalars(times))];
  EXPECT_EQ(scalars.count, 3U);
  EXPECT_EQ(scalars.minValues, (std::vector<double>{0.25}));
  EXPECT_EQ(scalars.maxValues, (std::vector<double>{2.0}));
  const tinygltf::Accessor vectors =
      model.accessors[std::size_t(buffer.add_vectors(places, TINYGLTF_TARGET_ARRAY_BUFFER))];
  EXPECT_EQ(vectors.count, 2U);
  EXPECT_EQ(vectors.type, TINYGLTF_TYPE_VEC3);
  EXPECT_EQ(vectors.minValues, (std::vector<double>{-4, -2, 3}));
  EXPECT_EQ(vectors.maxValues, (std::vector<double>{1, 5, 3}));
  float read[6];
  std::memcpy(read,
              model.buffers[0].data.data() + model.bufferViews[std::size_t(vectors.bufferView)].byteOffset,
              sizeof read);
  EXPECT_EQ(read[4], 5.0f);
}

TEST(GltfBuffer, IndicesAreForTheGraphicsCard) {
  tinygltf::Model model;
  GltfBuffer buffer(model);
  const std::uint32_t indices[] = {2, 1, 0, 70'000};
  const tinygltf::Accessor& accessor = model.accessors[std::size_t(buffer.add_indices(indices))];
  EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  EXPECT_EQ(accessor.count, 4U);
  EXPECT_EQ(model.bufferViews[std::size_t(accessor.bufferView)].target, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

}  // namespace
}  // namespace lodestone
