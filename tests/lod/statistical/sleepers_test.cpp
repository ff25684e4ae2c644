#include "lod/statistical/sleepers.h"

#include <gtest/gtest.h>

#include <set>

#include "reference/random.h"

namespace lodestone {
namespace {

using Found = std::set<std::pair<StatisticalModel, std::int32_t>>;

Found near(const Sleepers& sleepers, const Vec3& center, double reach) {
  Found found;
  sleepers.find_near(center, reach, [&](StatisticalModel model, std::int32_t slot) {
    EXPECT_TRUE(found.insert({model, slot}).second) << "twice";
  });
  return found;
}

// Each rung's own slots, found together; as bodies fall asleep and wake, against a plain list.
TEST(Sleepers, AreFoundWhereTheyLieOnBothRungs) {
  struct Lying {
    StatisticalModel model;
    std::int32_t slot;
    Vec3 at;
    double radius;
  };
  RandomStream random(55, 0, 0);
  Sleepers sleepers;
  EXPECT_TRUE(sleepers.empty());
  std::vector<Lying> lying;
  std::int32_t next = 0;
  for (int i = 0; i < 400; ++i) {
    if (random.uniform() < 0.7 || lying.empty()) {
      const Lying one{i % 2 ? StatisticalModel::tables : StatisticalModel::support, next++,
                      random.uniform(0, 5) * random.direction(), random.uniform(0.05, 0.8)};
      sleepers.of(one.model).insert(std::uint32_t(one.slot), one.at, one.radius);
      if (std::ranges::any_of(lying,
                              [&](const Lying& l) { return l.model == one.model && l.slot == one.slot; }))
        FAIL() << "the test gives a slot twice";
      lying.push_back(one);
    } else {
      const auto which = std::size_t(random.uniform(0, double(lying.size())));
      sleepers.of(lying[which].model)
          .remove(std::uint32_t(lying[which].slot), lying[which].at, lying[which].radius);
      lying.erase(lying.begin() + std::ptrdiff_t(which));
    }
    if (i % 20) continue;
    const Vec3 center = random.uniform(0, 5) * random.direction();
    const double reach = random.uniform(0.1, 1.0);
    const Found found = near(sleepers, center, reach);
    std::size_t must = 0;
    for (const Lying& one : lying)
      if ((one.at - center).norm() < one.radius + reach) {
        ++must;
        EXPECT_TRUE(found.contains({one.model, one.slot}));
      }
    EXPECT_LE(must, found.size());
    EXPECT_LE(found.size(), lying.size());
  }
  EXPECT_FALSE(sleepers.empty());
  StateArchive writer;
  sleepers.archive(writer);
  StateArchive reader(writer.bytes(), {});
  Sleepers copy;
  copy.archive(reader);
  for (int i = 0; i < 20; ++i) {
    const Vec3 center = random.uniform(0, 5) * random.direction();
    EXPECT_EQ(near(copy, center, 0.5), near(sleepers, center, 0.5));
  }
  for (const Lying& one : lying) copy.of(one.model).remove(std::uint32_t(one.slot), one.at, one.radius);
  EXPECT_TRUE(copy.empty());
}

}  // namespace
}  // namespace lodestone
