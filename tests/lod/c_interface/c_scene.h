// The same scene by the C interface and by the classes behind it.
#pragma once

#include "lod/lodestone_c.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::testing {

struct CScene {
  explicit CScene(double full_within = 4.0) {
    lodestone_settings settings = lodestone_default_settings();
    settings.signatures = [](void*, const char*, double, double) -> const lodestone_signature* {
      return nullptr;
    };
    settings.policy.full_within = full_within;
    EXPECT_EQ(lodestone_create(&settings, &c), LODESTONE_OK);
    EXPECT_EQ(lodestone_add_plane(c, {0, 0, 1}, 0.0, 0, nullptr), LODESTONE_OK);
    EXPECT_EQ(lodestone_make_box("box", {0.2, 0.3, 0.4}, &box), LODESTONE_OK);
  }
  ~CScene() {
    lodestone_destroy(c);
    lodestone_release_shape(box);
  }
  CScene(const CScene&) = delete;
  CScene& operator=(const CScene&) = delete;

  /// To both.
  void add(const Vec3& place, LevelChoice level = LevelChoice::automatic) {
    lodestone_body_definition definition = lodestone_default_body(box);
    definition.state.position = {place.x(), place.y(), place.z()};
    definition.level = lodestone_level_choice(level);
    EXPECT_EQ(lodestone_add_body(c, &definition, &c_bodies.emplace_back()), LODESTONE_OK);
    bodies.push_back(testing::add(manager, shape, at(place), level));
  }
  void step(int steps = 1) {
    for (int i = 0; i < steps; ++i) {
      EXPECT_EQ(lodestone_step(c, kFrame, nullptr), LODESTONE_OK);
      manager.step(kFrame);
    }
  }
  std::uint64_t c_hash() const {
    std::uint64_t hash = 0;
    EXPECT_EQ(lodestone_state_hash(c, &hash), LODESTONE_OK);
    return hash;
  }
  void expect_same() const { EXPECT_EQ(c_hash(), manager.state_hash()); }

  lodestone_manager* c = nullptr;
  lodestone_shape* box = nullptr;
  std::vector<lodestone_body> c_bodies;
  Manager manager = on_floor();
  std::shared_ptr<const Shape> shape = box_shape({0.2, 0.3, 0.4});
  std::vector<BodyId> bodies;
};

}  // namespace lodestone::testing
