#include "tools/shape_arguments.h"

#include <gtest/gtest.h>

#include "tests/message_of.h"
#include "tests/temporary_folder.h"
#include "tests/tools/parsed_command.h"

namespace lodestone {
namespace {

ShapeArguments shape_asked(const std::string& line) {
  return testing::parse<ShapeArguments>(line, add_shape_arguments);
}

TEST(ShapeArguments, OptionsReachTheShapeAndItsLaw) {
  const ShapeArguments arguments = shape_asked(
      "box:0.2,0.3,0.4 --restitution 0.25 --friction 0.75 --density 7800 --mesh-path /a:/b --untrusted");
  EXPECT_EQ(arguments.law(), (ContactLaw{0.25, 0.75}));
  EXPECT_EQ(arguments.material.density, 7800.0);
  EXPECT_EQ(arguments.options.search, (std::vector<std::filesystem::path>{"/a", "/b"}));
  EXPECT_TRUE(arguments.options.untrusted);
  const auto shape = make_shape_from_arguments(arguments);
  EXPECT_NEAR(shape->volume, 0.024, 1e-12);
}

TEST(ShapeArguments, SizeAndFacesAreThoseOfTheMesh) {
  const testing::TemporaryFolder folder;
  folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const ShapeArguments arguments = shape_asked("t.obj --size 0.5 --mesh-path " + folder.path().string());
  MeshReport report;
  const auto shape = make_shape_from_arguments(arguments, &report);
  EXPECT_NEAR(shape->size, 0.5, 1e-12);
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.components, 1);
}

// They would do nothing.
TEST(ShapeArguments, ASolidHasNoSizeOrFacesToBeGiven) {
  EXPECT_EQ(testing::message_of([&] { make_shape_from_arguments(shape_asked("box:1,2,3 --size 2")); }),
            "size: found it beside box:1,2,3, expected a mesh there");
  EXPECT_EQ(testing::message_of([&] { make_shape_from_arguments(shape_asked("sphere:1 --faces 20")); }),
            "faces: found it beside sphere:1, expected a mesh there");
}

TEST(ShapeArguments, WhatIsOutOfRangeIsRefused) {
  for (const char* line :
       {"", "box:1,1,1 --restitution 1.1", "box:1,1,1 --restitution -0.1", "box:1,1,1 --friction -1",
        "box:1,1,1 --density 0", "a.obj --size 0", "a.obj --faces 3", "a.obj --size inf"})
    EXPECT_NE(testing::refusal<ShapeArguments>(line, add_shape_arguments), "no error") << line;
}

TEST(ShapeArguments, AShapeThatIsNoneIsBadInput) {
  for (const char* shape : {"box:1,2", "box:1,2,x", "ball:1", "none.obj", "sphere:-1"})
    EXPECT_NE(testing::message_of([&] { make_shape_from_arguments(shape_asked(shape)); }),
              testing::kNothingThrown)
        << shape;
}

}  // namespace
}  // namespace lodestone
