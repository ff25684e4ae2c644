#include "lod/contact/triangle_sieve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "lod/contact/solid_contacts.h"
#include "lod/contact/solid_meeting.h"

namespace lodestone {
namespace {

// Hills of .4 m in cells of .1 m.
Mesh make_fine_hills() {
  constexpr int kCells = 40;
  Mesh mesh;
  for (int y = 0; y <= kCells; ++y)
    for (int x = 0; x <= kCells; ++x) {
      const double u = 0.1 * x - 2.0, v = 0.1 * y - 2.0;
      mesh.vertices.push_back({u, v, 0.4 * std::sin(2.0 * u) * std::cos(1.7 * v)});
    }
  for (int y = 0; y < kCells; ++y)
    for (int x = 0; x < kCells; ++x) {
      const int a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.faces.push_back({a, b, d}), mesh.faces.push_back({a, d, c});
    }
  return mesh;
}

double height_of_fine_hills(const Vec3& at) { return 0.4 * std::sin(2.0 * at.x()) * std::cos(1.7 * at.y()); }

class TriangleSieveTest : public ::testing::Test {
 protected:
  TriangleSieveTest() { id_ = ground_.add_mesh(make_fine_hills(), 0); }
  Vec3 draw(double size) { return size * Vec3(unit_(random_), unit_(random_), unit_(random_)); }
  // Near the ground, and moving.
  StatisticalBody draw_body() {
    StatisticalBody body;
    body.position = draw(1.5);
    body.position.z() = height_of_fine_hills(body.position) + 0.2 + 0.1 * unit_(random_);
    body.orientation = Quat(Eigen::AngleAxisd(3.0 * unit_(random_), draw(1.0).normalized()));
    body.velocity = draw(2.0);
    return body;
  }

  Ground ground_;
  GroundId id_;
  std::shared_ptr<const Shape> box_ =
      std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

// Of those that are beyond, the body is nearer to none than what counts as touching once it has gone on, and
// of those in reach that it does not meet then these are most.
TEST_F(TriangleSieveTest, OnlyWhatMeetsNothingIsBeyond) {
  constexpr double kTime = 1.0 / 180, kNear = 0.003;  // s, m
  HullContactSearch search;
  std::size_t beyond = 0, all = 0, met = 0, wrong = 0;
  for (int i = 0; i < 200; ++i) {
    const StatisticalBody body = draw_body();
    const PairBody self{box_.get(), body.position, body.orientation},
        later{box_.get(), body.position + kTime * body.velocity, body.orientation};
    const double reach = kNear + body.velocity.norm() * kTime;  // m
    TriangleSieve sieve(self, {.velocity = body.velocity,
                               .touching = kNear,
                               .time = kTime,
                               .margin = reach,
                               .deepest = kDeepestBelow * box_->inner_radius});
    std::vector<PlacedSolid> near;
    find_solids(ground_.part(id_), body.position, box_->radius + reach, 0.0, near);
    for (const PlacedSolid& triangle : near) {
      const bool is_beyond = sieve.is_beyond(triangle);
      meet_solid(later, triangle, 0.999 * kNear, search);
      ++all, beyond += is_beyond, met += !search.contacts.empty();
      wrong += is_beyond && !search.contacts.empty();
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(met, 500u);
  EXPECT_GT(double(beyond), 0.7 * double(all - met));
}

// To know whether a body meets a part one contact is enough.
TEST_F(TriangleSieveTest, OneContactOfAPartIsFoundWhereThereIsAny) {
  const BodyKind kind = make_body_kind(box_);
  std::size_t several = 0;
  for (int i = 0; i < 100; ++i) {
    const StatisticalBody body = draw_body();
    std::vector<SolidContact> every, one;
    std::vector<HalfSpace> planes;
    find_solid_contacts(body, kind, 5, ground_, 0.0, 1.0 / 60, every, planes);
    find_solid_contacts(body, kind, 5, ground_, 0.0, 1.0 / 60, one, planes, SolidSearch::one_of_a_part);
    EXPECT_LE(one.size(), 1u);
    EXPECT_GE(one.size(), std::min<std::size_t>(1, every.size()));
    several += every.size() > 1;
  }
  EXPECT_GT(several, 20u);
}

}  // namespace
}  // namespace lodestone
