#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/c_interface/c_scene.h"

namespace lodestone {
namespace {

using namespace testing;

class CQueries : public ::testing::Test {
 protected:
  CQueries() {
    RandomStream random(3, 0, 0);
    for (int i = 0; i < 12; ++i)
      s_.add({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.3, 2)});
  }
  static lodestone_vec3 c(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
  CScene s_;
};

TEST_F(CQueries, RaysAndSpheresMeetWhatTheClassesSay) {
  RandomStream random(4, 0, 0);
  std::vector<lodestone_ray> rays;
  for (int i = 0; i < 60; ++i)
    rays.push_back({c(3.0 * random.direction() + Vec3(0, 0, 3)), c(random.direction() - Vec3(0, 0, 1)),
                    i % 3 ? 1e9 : 2.0, i % 2 ? 0.0 : 0.2});
  const auto met = std::make_unique<bool[]>(rays.size());
  std::vector<lodestone_hit> hits(rays.size());
  ASSERT_EQ(lodestone_cast_rays(s_.c, rays.data(), rays.size(), nullptr, met.get(), hits.data()),
            LODESTONE_OK);
  int found = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray{{rays[i].from.x, rays[i].from.y, rays[i].from.z},
                  {rays[i].direction.x, rays[i].direction.y, rays[i].direction.z},
                  rays[i].length};
    const auto expected =
        rays[i].radius > 0 ? s_.manager.sweep_sphere({ray, rays[i].radius}) : s_.manager.cast_ray(ray);
    ASSERT_EQ(met[i], expected.has_value()) << i;
    if (!expected) continue;
    ++found;
    EXPECT_EQ(hits[i].distance, expected->distance);
    EXPECT_EQ(int(hits[i].who.kind), int(expected->who.kind));
    EXPECT_EQ(hits[i].who.body.index, expected->who.body.index);
    EXPECT_EQ(hits[i].normal.z, expected->normal.z());
  }
  EXPECT_GT(found, 30);
}

struct Collected {
  std::vector<std::pair<std::size_t, lodestone_hit>> hits;
  static void take(void* context, std::size_t which, const lodestone_hit* hit) {
    static_cast<Collected*>(context)->hits.emplace_back(which, *hit);
  }
};

TEST_F(CQueries, AllAlongARayComeByDistance) {
  const lodestone_ray rays[] = {{{0, 0, 9}, {0, 0, -1}, 1e9, 0.0}, {{0.3, 0, 9}, {0, 0, -1}, 1e9, 0.3}};
  Collected collected;
  ASSERT_EQ(lodestone_cast_rays_through(s_.c, rays, 2, nullptr, Collected::take, &collected), LODESTONE_OK);
  const Ray ray{{0, 0, 9}, {0, 0, -1}};
  std::vector<QueryHit> expected;
  s_.manager.cast_rays_through({&ray, 1}, {&expected, 1});
  std::size_t of_first = 0;
  for (std::size_t i = 0; i < collected.hits.size(); ++i) {
    of_first += collected.hits[i].first == 0;
    if (i > 0 && collected.hits[i].first == collected.hits[i - 1].first) {
      EXPECT_GE(collected.hits[i].second.distance, collected.hits[i - 1].second.distance);
    }
  }
  EXPECT_EQ(of_first, expected.size());
  EXPECT_GE(of_first, 1U);
}

TEST_F(CQueries, VolumesAreSpheresOrBoxes) {
  const lodestone_volume volumes[] = {{{0, 0, 0}, 0.8, {0, 0, 1}, {1, 0, 0, 0}},
                                      {{1.5, 1.5, 1.5}, 0.0, {0, 0, 1}, {1, 0, 0, 0}}};
  Collected collected;
  ASSERT_EQ(lodestone_overlap(s_.c, volumes, 2, nullptr, Collected::take, &collected), LODESTONE_OK);
  const SphereVolume sphere{{0, 0, 1}, 0.8};
  const BoxVolume box{{1.5, 1.5, 1.5}, {0, 0, 1}};
  std::vector<QueryHit> in_sphere, in_box;
  s_.manager.overlap_spheres({&sphere, 1}, {&in_sphere, 1});
  s_.manager.overlap_boxes({&box, 1}, {&in_box, 1});
  std::size_t counts[2] = {0, 0};
  for (const auto& [which, hit] : collected.hits) ++counts[which];
  EXPECT_EQ(counts[0], in_sphere.size());
  EXPECT_EQ(counts[1], in_box.size());
  EXPECT_GT(counts[1], 2U);
}

TEST_F(CQueries, FiltersAndBadQuestions) {
  lodestone_query_filter none = lodestone_default_filter();
  EXPECT_TRUE(none.bodies && none.ground && none.callers);
  none.bodies = none.ground = false;
  const lodestone_ray down{{0, 0, 9}, {0, 0, -1}, 1e9, 0.0};
  bool met = true;
  lodestone_hit hit;
  ASSERT_EQ(lodestone_cast_rays(s_.c, &down, 1, &none, &met, &hit), LODESTONE_OK);
  EXPECT_FALSE(met);
  const lodestone_ray nowhere{{0, 0, 9}, {0, 0, 0}, 1e9, 0.0}, backward{{0, 0, 9}, {0, 0, 1}, -1.0, 0.0},
      odd{{NAN, 0, 9}, {0, 0, -1}, 1e9, 0.0}, thin{{0, 0, 9}, {0, 0, -1}, 1e9, -0.1};
  for (const lodestone_ray& ray : {nowhere, backward, odd, thin})
    EXPECT_EQ(lodestone_cast_rays(s_.c, &ray, 1, nullptr, &met, &hit), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_cast_rays(s_.c, nullptr, 1, nullptr, &met, &hit), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_cast_rays(s_.c, nullptr, 0, nullptr, nullptr, nullptr), LODESTONE_OK);
}

}  // namespace
}  // namespace lodestone
