#include "tools/hard_cases/scene_text.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

const std::string kSound =
    "version: 1\nshapes: {crate: {box_m: [1, 1, 1]}}\nground: [{plane: {}}]\n"
    "bodies: [{shape: crate, position_m: [0, 0, 1]}]\n";

TEST(SceneText, ASoundOneHasNoFault) { EXPECT_EQ(scene_error_of(kSound), ""); }

TEST(SceneText, AFaultIsSaidWithItsLineAndKey) {
  const std::string fault = scene_error_of(kSound + "step: {dt_s: -1}\n");
  EXPECT_TRUE(fault.starts_with("5: step.dt_s: found -1, expected ")) << fault;
}

TEST(SceneText, UnclearIsWhatLoadsOrDoesNotNameTheKey) {
  const std::string bad = kSound + "step: {dt_s: -1}\n";
  const std::vector<std::string> texts = {bad, kSound, bad};
  EXPECT_EQ(count_unclear(texts, "dt_s"), 1);     // the sound one
  EXPECT_EQ(count_unclear(texts, "mass_kg"), 3);  // another key
  EXPECT_EQ(count_unclear({}, "dt_s"), 0);
}

}  // namespace
}  // namespace lodestone
