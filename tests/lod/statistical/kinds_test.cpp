// Kinds of body: what takes long to make is shared, and a kind goes with its last body.
#include "lod/statistical/kinds.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

std::shared_ptr<const Shape> make_crate(double scale = 1.0) {
  return std::make_shared<const Shape>(scale_shape(make_shape("crate", make_box({0.2, 0.3, 0.4})), scale));
}

TEST(Kinds, ShareWhatDoesNotDependOnMaterialOrSize) {
  const auto signature = std::make_shared<const Signature>();
  const auto crate = make_crate(), larger = make_crate(3.0);
  Kinds kinds;
  const std::uint32_t first = kinds.take(StatisticalModel::tables, crate, 0, signature);
  const std::uint32_t of_other_material = kinds.take(StatisticalModel::tables, crate, 1, signature);
  const std::uint32_t of_other_size = kinds.take(StatisticalModel::tables, larger, 0, signature);
  EXPECT_NE(first, of_other_material);
  EXPECT_NE(first, of_other_size);
  ASSERT_NE(kinds[first].faces, nullptr);
  EXPECT_EQ(kinds[first].faces, kinds[of_other_material].faces);
  EXPECT_EQ(kinds[first].faces, kinds[of_other_size].faces);
  EXPECT_EQ(kinds[first].clips, nullptr);  // which only `support` asks for
  kinds.take(StatisticalModel::support, crate, 0, signature);
  kinds.take(StatisticalModel::support, larger, 0, signature);
  ASSERT_NE(kinds[first].clips, nullptr);
  EXPECT_EQ(kinds[first].clips, kinds[of_other_size].clips);
}

TEST(Kinds, GoWithTheirLastBody) {
  Kinds kinds;
  const auto crate = make_crate();
  const std::uint32_t number = kinds.take(StatisticalModel::support, crate, 0, nullptr);
  const std::uint64_t birth = kinds.birth(number);
  EXPECT_EQ(kinds.take(StatisticalModel::support, crate, 0, nullptr), number);
  kinds.give_back(number);
  EXPECT_EQ(crate.use_count(), 2);  // the second body's kind
  kinds.give_back(number);
  EXPECT_EQ(crate.use_count(), 1);
  EXPECT_EQ(kinds.take(StatisticalModel::support, make_crate(2.0), 0, nullptr), number);
  EXPECT_NE(kinds.birth(number), birth);
}

TEST(Kinds, DoNotGrowWhileOthersComeAndGo) {
  Kinds kinds;
  for (int i = 0; i < 1000; ++i)
    kinds.give_back(kinds.take(StatisticalModel::support, make_crate(1.0 + 1e-3 * i), 0, nullptr));
  EXPECT_EQ(kinds.size(), 1u);
}

}  // namespace
}  // namespace lodestone
