// One measurement divided among processes.
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tests/tools/cli_fixture.h"

namespace lodestone::shard_test {
namespace {

using testing::Ended;

// Cheap: a few trials of everything.
const std::string kBox =
    "sign box:0.2,0.3,0.4 --cell-trials 2 --height-trials 20 --settling-trials 7 --clips 3 ";

class Shard : public testing::CliTest {
 protected:
  void sign_parts(int count, const std::string& more = "") {
    for (int i = 1; i <= count; ++i) {
      const std::string part = std::to_string(i) + "/" + std::to_string(count);
      const Ended ended = run(kBox + more + " --threads " + std::to_string(1 + i % 2) + " --shard " + part +
                              " -o " + name("part" + std::to_string(i)));
      ASSERT_EQ(ended.exit_code, 0) << ended.out;
    }
  }
  std::string parts(int count) const {
    std::string all;
    for (int i = count; i >= 1; --i) all += name("part" + std::to_string(i)) + " ";  // in any order
    return all;
  }
};

TEST_F(Shard, MergedPartsAreTheBytesOfOneRun) {
  ASSERT_EQ(run(kBox + "--no-cache --threads 2 -o " + name("whole.sig")).exit_code, 0);
  const std::string whole = testing::bytes_of(at("whole.sig"));
  ASSERT_GT(whole.size(), 10'000U);
  for (const int count : {1, 2, 5}) {
    sign_parts(count);
    const Ended merged = run("merge " + parts(count) + "--json -o " + name("merged.sig"));
    ASSERT_EQ(merged.exit_code, 0) << merged.out;
    EXPECT_TRUE(testing::bytes_of(at("merged.sig")) == whole) << count << " parts";
    EXPECT_FALSE(nlohmann::json::parse(merged.out)["rest_poses"].empty());
  }
}

TEST_F(Shard, APartIsNotWrittenOver) {
  sign_parts(1);
  const std::string before = testing::bytes_of(at("part1"));
  const Ended ended = run("merge " + name("part1") + " -o " + name("part1"));
  EXPECT_EQ(ended.exit_code, 3) << ended.out;
  EXPECT_EQ(testing::bytes_of(at("part1")), before);
}

// A share may have taken hours.
TEST_F(Shard, APartThatFoundNoRoomIsNotMeasuredAgain) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const std::string share = kBox + "--json --shard 1/2 -o ";
  const Ended full = run(share + "/dev/full");
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_NE(full.out.find("/dev/full: found no space left on device"), std::string::npos) << full.out;
  const auto json = nlohmann::json::parse(run(share + name("part")).out);
  EXPECT_GT(json["trials"], 0);
  EXPECT_EQ(json["trials_resumed"], json["trials"]);
  const auto again = nlohmann::json::parse(run(share + name("part")).out);
  EXPECT_EQ(again["trials_resumed"], 0) << "what is saved leaves nothing behind";
}

TEST_F(Shard, APartSaysWhatItMeasured) {
  std::uint64_t trials = 0;
  for (const std::string part : {"1/2", "2/2"}) {
    const Ended ended = run(kBox + "--json --shard " + part + " -o " + name("part"));
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    const auto json = nlohmann::json::parse(ended.out);
    EXPECT_EQ(json["rest_poses"], nlohmann::json::array());
    EXPECT_EQ(json["shard"], part);
    EXPECT_EQ(json["cached"], false);
    trials += json["trials"].get<std::uint64_t>();
  }
  EXPECT_EQ(nlohmann::json::parse(run(kBox + "--no-cache --json").out)["trials"], trials);
}

// Scores by two signatures are no series.
TEST_F(Shard, PartsOfAComparisonByOtherSignaturesAreRefused) {
  const std::string compare =
      "compare conditions box:0.2,0.3,0.4 --trials 2 --methods full_1 --only slope_deg=20 --json --threads "
      "1 ";
  for (const auto& [part, options] :
       {std::pair("1", "--shard 1/2"), {"2", "--shard 2/2"}, {"other", "--shard 2/2 --clips 7"}}) {
    const Ended ended =
        testing::run_shell(command(compare + options + " >" + name(std::string(part) + ".json")));
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
  }
  EXPECT_EQ(run("merge " + name("1.json") + " " + name("2.json") + " -o " + name("all.json")).exit_code, 0);
  const Ended ended = run("merge " + name("1.json") + " " + name("other.json") + " -o " + name("all.json"));
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.out.find("other.json: found part 2/2 of "), std::string::npos) << ended.out;
}

TEST_F(Shard, PartsThatDoNotBelongTogetherAreNamed) {
  sign_parts(2);
  const auto expect_error = [&](const std::string& files, const std::string& culprit,
                                const std::string& reason) {
    const Ended ended = run("merge " + files + " -o " + name("merged.sig"));
    EXPECT_EQ(ended.exit_code, 3) << reason;
    EXPECT_NE(ended.out.find(culprit), std::string::npos) << ended.out;
    EXPECT_NE(ended.out.find(reason), std::string::npos) << ended.out;
    EXPECT_FALSE(std::filesystem::exists(at("merged.sig")));
  };
  expect_error(name("part1"), "merge", "found no part 2/2 among 1 files");
  expect_error(name("part1") + " " + name("part1"), "part1", "part 1 of 2 again");
  ASSERT_EQ(run(kBox + "--seed 9 --shard 2/2 -o " + name("seed")).exit_code, 0);
  expect_error(name("part1") + " " + name("seed"), "seed", "other settings");
  ASSERT_EQ(run(kBox + "--shard 2/3 -o " + name("thirds")).exit_code, 0);
  expect_error(name("part1") + " " + name("thirds"), "thirds", "found part 2 of 3, expected a part of 2");
  ASSERT_EQ(run("sign box:0.2,0.3,0.5 --cell-trials 2 --height-trials 20 --settling-trials 7 --clips 3 "
                "--shard 2/2 -o " +
                name("longer"))
                .exit_code,
            0);
  expect_error(name("part1") + " " + name("longer"), "longer", "found shape box:0.2,0.3,0.5");
  expect_error(name("part1") + " " + name("nowhere"), "nowhere", "found no such file");
  ASSERT_EQ(run(kBox + "--no-cache -o " + name("whole.sig")).exit_code, 0);
  expect_error(name("whole.sig"), "whole.sig", "found a file of another kind");
  std::ofstream(at("half"), std::ios::binary) << testing::bytes_of(at("part2")).substr(0, 60'000);
  expect_error(name("part1") + " " + name("half"), "half", "cut short or damaged");
}

TEST_F(Shard, SharesThatAreNoneAreWrongUsage) {
  for (const char* share : {"0/2", "3/2", "1/0", "1", "a/b", "-1/2", "1/2/3"})
    EXPECT_EQ(run(kBox + "-o x --shard " + share).exit_code, 2) << share;
  EXPECT_EQ(run(kBox + "--shard 1/2").exit_code, 2);  // nowhere to put it
}

}  // namespace
}  // namespace lodestone::shard_test
