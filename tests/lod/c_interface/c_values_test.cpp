#include "lod/c_interface/c_values.h"

#include <gtest/gtest.h>

#include <new>
#include <thread>

#include "tests/temporary_folder.h"

namespace lodestone::c {
namespace {

TEST(CResults, WhatIsThrownBecomesAResultAndItsWords) {
  EXPECT_EQ(guarded([] {}), LODESTONE_OK);
  EXPECT_EQ(guarded([] { throw InputError("a wrong number"); }), LODESTONE_BAD_INPUT);
  EXPECT_STREQ(lodestone_error(), "a wrong number");
  EXPECT_EQ(guarded([] { throw std::bad_alloc(); }), LODESTONE_OUT_OF_MEMORY);
  EXPECT_STREQ(lodestone_error(), "out of memory");
  EXPECT_EQ(guarded([] { throw std::runtime_error("a bug"); }), LODESTONE_FAILED);
  EXPECT_STREQ(lodestone_error(), "a bug");
  EXPECT_EQ(guarded([] { throw 7; }), LODESTONE_FAILED);
  EXPECT_STREQ(lodestone_error(), "an exception that is none of the library's");
}

TEST(CResults, EachThreadHasItsOwnWords) {
  set_error("here");
  std::thread([] {
    EXPECT_STREQ(lodestone_error(), "");
    set_error("there");
  }).join();
  EXPECT_STREQ(lodestone_error(), "here");
}

TEST(CValues, GoThereAndBack) {
  const BodyProperties own{.category = 3,
                           .collide = 5,
                           .gravity = false,
                           .linear_damping = 0.1,
                           .angular_damping = 0.2,
                           .max_angular_speed = 7,
                           .kinematic = true,
                           .allow_sleep = false};
  EXPECT_TRUE(properties(properties(own)) == own);
  EXPECT_TRUE(properties(lodestone_default_properties()) == BodyProperties{});
  // One at a time: each is true once.
  constexpr bool TablesOptions::*kOptions[] = {
      &TablesOptions::interpolate,       &TablesOptions::draw_height,     &TablesOptions::rest_poses,
      &TablesOptions::nearest_rest_pose, &TablesOptions::paper_pair_rule, &TablesOptions::published};
  for (const auto option : kOptions) {
    TablesOptions options{.interpolate = false, .radius_update_interval = 3, .rest_poses = false};
    options.*option = true;
    const TablesOptions back = tables(tables(options));
    for (const auto other : kOptions) EXPECT_EQ(back.*other, other == option);
    EXPECT_EQ(back.radius_update_interval, 3);
  }
  EXPECT_EQ(vec3(vec3(Vec3(1, 2, 3))), Vec3(1, 2, 3));
  const Quat turn = Quat(1, 2, 3, 4).normalized();
  EXPECT_EQ(quat(quat(turn)).coeffs(), turn.coeffs());
  EXPECT_EQ(body(body(BodyId{4, 5})), (BodyId{4, 5}));
  EXPECT_EQ(ground(ground(GroundId{6, 7})), (GroundId{6, 7}));
}

TEST(CValues, EnumeratorsHaveARange) {
  EXPECT_EQ(enumerator(LODESTONE_FULL, Rung::full, "rung"), Rung::full);
  EXPECT_EQ(guarded([] { enumerator(lodestone_rung(3), Rung::full, "rung"); }), LODESTONE_BAD_INPUT);
  EXPECT_STREQ(lodestone_error(), "rung: found 3, expected 0 to 2");
  EXPECT_EQ(guarded([] { enumerator(-1, Rung::full, "rung"); }), LODESTONE_BAD_INPUT);
}

TEST(CShapes, AreThoseOfTheClasses) {
  lodestone_shape *box = nullptr, *ball = nullptr, *mesh = nullptr;
  ASSERT_EQ(lodestone_make_box("crate", {1, 2, 3}, &box), LODESTONE_OK);
  ASSERT_EQ(lodestone_make_sphere(0.5, &ball), LODESTONE_OK);
  EXPECT_EQ(box->shape->content_hash, make_shape("crate", make_box({1, 2, 3})).content_hash);
  EXPECT_EQ(box->shape->name, "crate");
  EXPECT_EQ(ball->shape->sphere_radius, 0.5);
  const Mesh l = make_l(0.5, 0.4, 0.1, 0.2);
  std::vector<lodestone_vec3> vertices;
  std::vector<std::int32_t> faces;
  for (const Vec3& v : l.vertices) vertices.push_back(vec3(v));
  for (const auto& f : l.faces) faces.insert(faces.end(), f.begin(), f.end());
  ASSERT_EQ(lodestone_make_mesh("l", vertices.data(), vertices.size(), faces.data(), l.faces.size(), &mesh),
            LODESTONE_OK);
  EXPECT_EQ(mesh->shape->content_hash, make_shape("l", l).content_hash);
  for (lodestone_shape* shape : {box, ball, mesh}) lodestone_release_shape(shape);
  lodestone_release_shape(nullptr);
}

TEST(CShapes, WhatCannotBeIsSaidAndGivesNone) {
  auto* const before = reinterpret_cast<lodestone_shape*>(0x10);
  lodestone_shape* shape = before;
  EXPECT_EQ(lodestone_make_box("flat", {1, 0, 1}, &shape), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_make_box(nullptr, {1, 1, 1}, &shape), LODESTONE_BAD_INPUT);
  EXPECT_STREQ(lodestone_error(), "name: found null, expected an address");
  EXPECT_EQ(lodestone_make_sphere(-1, &shape), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_make_mesh("m", nullptr, 3, nullptr, 1, &shape), LODESTONE_BAD_INPUT);
  EXPECT_STREQ(lodestone_error(), "vertices: found null, expected an address");
  EXPECT_EQ(lodestone_load_mesh("/none.obj", 0, &shape), LODESTONE_BAD_INPUT);
  EXPECT_EQ(shape, before);
  EXPECT_EQ(lodestone_make_sphere(1, nullptr), LODESTONE_BAD_INPUT);
  EXPECT_STREQ(lodestone_error(), "where the handle shall go: found null, expected an address");
}

TEST(CShapes, AFileIsLoadedAtItsSize) {
  const testing::TemporaryFolder folder;
  const auto file =
      folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  for (const double size : {0.0, 0.25}) {
    lodestone_shape* shape = nullptr;
    ASSERT_EQ(lodestone_load_mesh(file.c_str(), size, &shape), LODESTONE_OK) << lodestone_error();
    EXPECT_NEAR(shape->shape->size, size == 0.0 ? 1.0 : size, 1e-12);
    lodestone_release_shape(shape);
  }
}

TEST(CSignatures, BytesThatAreNoneAreRefused) {
  lodestone_signature* signature = nullptr;
  EXPECT_EQ(lodestone_read_signature("nonsense", 8, &signature), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_read_signature(nullptr, 8, &signature), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_read_signature(nullptr, 0, &signature), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_load_signature("/none.sig", &signature), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_find_or_measure_signature(nullptr, 0.4, 0.5, 1, &signature), LODESTONE_BAD_INPUT);
  EXPECT_EQ(signature, nullptr);
  lodestone_release_signature(nullptr);
}

}  // namespace
}  // namespace lodestone::c
