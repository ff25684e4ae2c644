#include "signature/measure/measured_trials.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

constexpr const char* kHead =
    "kind,vx_before_m_per_s,vy_before_m_per_s,vz_before_m_per_s,wx_before_rad_per_s,wy_before_rad_per_s,wz_"
    "before_rad_per_s,nx,ny,nz,vx_after_m_per_s,vy_after_m_per_s,vz_after_m_per_s,wx_after_rad_per_s,wy_"
    "after_rad_per_s,wz_after_rad_per_s\n";
constexpr const char* kCollision = "collision,0,0,-1,0,0,0,0,0,1,0,0,0.5,0,0,0\n";
constexpr const char* kRest = "rest,,,,,,,0,0,1,,,,,,\n";

class TrialsFile : public ::testing::Test {
 protected:
  MeasuredTrials load(const std::string& text) const { return load_trials(folder_.write("t.csv", text)); }
  std::string fault(const std::string& rows) const {
    return testing::after_head(testing::message_of([&] { load(kHead + rows); }),
                               folder_.at("t.csv").string() + ":");
  }
  const testing::TemporaryFolder folder_;
};

TEST_F(TrialsFile, NumbersComeBackToTheBit) {
  RandomStream random(3, 0, 0);
  MeasuredTrials trials;
  for (int i = 0; i < 50; ++i) {
    const auto vector = [&] { return Vec3(std::pow(10.0, random.uniform(-12, 12)) * random.direction()); };
    trials.collisions.push_back({vector(), vector(), random.direction(), vector(), vector()});
    trials.rest_normals.push_back(random.direction());
  }
  save_trials(trials, folder_.at("t.csv"));
  const MeasuredTrials read = load_trials(folder_.at("t.csv"));
  ASSERT_EQ(read.collisions.size(), 50U);
  ASSERT_EQ(read.rest_normals.size(), 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(read.collisions[i].velocity_before, trials.collisions[i].velocity_before);
    EXPECT_EQ(read.collisions[i].angular_velocity_before, trials.collisions[i].angular_velocity_before);
    EXPECT_EQ(read.collisions[i].velocity_after, trials.collisions[i].velocity_after);
    EXPECT_EQ(read.collisions[i].angular_velocity_after, trials.collisions[i].angular_velocity_after);
    EXPECT_LT((read.collisions[i].normal - trials.collisions[i].normal).norm(), 1e-15);
    EXPECT_LT((read.rest_normals[i] - trials.rest_normals[i]).norm(), 1e-15);
  }
}

TEST_F(TrialsFile, LinesMayEndAsOnOtherSystemsAndBeEmpty) {
  std::string text = std::string(kHead) + kCollision + "\n" + kRest;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  const MeasuredTrials read = load(text);
  EXPECT_EQ(read.collisions.size(), 1U);
  EXPECT_EQ(read.rest_normals.size(), 1U);
  EXPECT_EQ(load(std::string(kHead) + "collision,0,0,-1,0,0,0,0,0,1,0,0,0.5,0,0,0").collisions.size(), 1U);
}

TEST_F(TrialsFile, NormalsAreMadeOfUnitLength) {
  const MeasuredTrials read = load(std::string(kHead) + "rest,,,,,,,0,0,1.0009,,,,,,\n");
  EXPECT_EQ(read.rest_normals[0], Vec3(0, 0, 1));
}

TEST_F(TrialsFile, WhatIsWrongIsSaidWithLineAndColumn) {
  const std::string good = kCollision;
  EXPECT_EQ(fault(good + "collision,0,x,-1,0,0,0,0,0,1,0,0,0.5,0,0,0\n"),
            "3: found 'x' in column 3, expected a finite number");
  EXPECT_EQ(fault("collision,0,nan,-1,0,0,0,0,0,1,0,0,0.5,0,0,0\n"),
            "2: found 'nan' in column 3, expected a finite number");
  EXPECT_EQ(fault("collision,0,1e999,-1,0,0,0,0,0,1,0,0,0.5,0,0,0\n"),
            "2: found '1e999' in column 3, expected a finite number");
  EXPECT_EQ(fault("collision,0, 1,-1,0,0,0,0,0,1,0,0,0.5,0,0,0\n"),
            "2: found ' 1' in column 3, expected a finite number");
  EXPECT_EQ(fault("collision,0,0,-1,0,0,0,0,0,1,0,0,0.5,0,0,\n"),
            "2: found '' in column 16, expected a finite number");
  EXPECT_EQ(fault("collision,0,0,-1\n"), "2: found a row of another length, expected 16 columns");
  EXPECT_EQ(fault("collision,0,0,-1,0,0,0,0,0,1,0,0,0.5,0,0,0,7\n"),
            "2: found a row of another length, expected 16 columns");
  EXPECT_EQ(fault("collision,0,0,-1,0,0,0,0,0,2,0,0,0.5,0,0,0\n"),
            "2: found a normal of length 2, expected unit length");
  EXPECT_EQ(fault("hit,0,0,-1,0,0,0,0,0,1,0,0,0.5,0,0,0\n"),
            "2: found 'hit' in column 1, expected collision or rest");
  EXPECT_EQ(fault("rest,1,,,,,,0,0,1,,,,,,\n"),
            "2: found '1' in column 2 of a rest, expected nothing but a normal");
  EXPECT_EQ(fault(""), "2: found no row, expected at least one");
}

TEST_F(TrialsFile, AnotherHeadingIsRefused) {
  const std::string message = testing::message_of([&] { load("a,b,c\n1,2,3\n"); });
  EXPECT_NE(message.find("t.csv:1: found 'a,b,c', expected the heading 'kind,"), std::string::npos)
      << message;
}

}  // namespace
}  // namespace lodestone
