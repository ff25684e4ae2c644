#include "tools/signature_arguments.h"

#include <gtest/gtest.h>

#include "tests/tools/parsed_command.h"

namespace lodestone {
namespace {

SignatureSettings measuring(const std::string& line) {
  return testing::parse<SignatureArguments>(line, add_signature_arguments).measuring();
}
std::string signature_refused(const std::string& line) {
  return testing::refusal<SignatureArguments>(line, add_signature_arguments);
}

TEST(SignatureArguments, WithoutAnyTheSettingsAreTheirDefaults) {
  EXPECT_TRUE(measuring("") == SignatureSettings{});
}

TEST(SignatureArguments, EachReachesItsSetting) {
  const SignatureSettings s = measuring(
      "--psi 8 --draw empirical --table-error 0.02 --cell-trials 7 --height-trials 9 "
      "--settling-trials 11 --clips 13");
  EXPECT_EQ(s.n_psi, 8);
  EXPECT_EQ(s.draw, ResponseDraw::empirical);
  EXPECT_EQ(s.table_error, 0.02);
  EXPECT_EQ(s.trials_per_cell, 7);
  EXPECT_EQ(s.height_trials, 9);
  EXPECT_EQ(s.settling_trials, 11);
  EXPECT_EQ(s.clips, 13);
}

// The paper's trials end with the first impulse, unless it is said otherwise.
TEST(SignatureArguments, TheEndOfATrialFollowsTheGrid) {
  EXPECT_EQ(measuring("").trial_end, TrialEnd::leaves_plane);
  EXPECT_EQ(measuring("--paper-grid").trial_end, TrialEnd::first_impulse);
  EXPECT_EQ(measuring("--paper-grid --trial-end leaves-plane").trial_end, TrialEnd::leaves_plane);
  EXPECT_EQ(measuring("--trial-end first-impulse").trial_end, TrialEnd::first_impulse);
  EXPECT_TRUE(measuring("--paper-grid").paper_grid);
}

TEST(SignatureArguments, WhatIsOutOfRangeIsRefusedByName) {
  EXPECT_TRUE(signature_refused("--psi 65").starts_with("--psi: found '65', expected"))
      << signature_refused("--psi 65");
  for (const char* line :
       {"--psi 0", "--cell-trials 1", "--height-trials 1", "--settling-trials 0", "--clips -1",
        "--table-error 1.5", "--table-error nan", "--draw often", "--trial-end never", "--psi 2.5"})
    EXPECT_NE(signature_refused(line), "no error") << line;
}

// Which has one psi, and a number of trials of its own.
TEST(SignatureArguments, WhatThePapersGridHasNoUseForIsRefusedBesideIt) {
  for (const char* option : {"--psi 8", "--cell-trials 7"}) {
    const std::string line = std::string("--paper-grid ") + option;
    EXPECT_NE(signature_refused(line).find("--paper-grid"), std::string::npos) << signature_refused(line);
  }
  EXPECT_TRUE(measuring("--paper-grid --height-trials 9 --draw correlated").paper_grid);
}

struct Shared {
  std::optional<Share> share;
};
void add_shard(Command& command, Shared& shared) { add_share_argument(command, shared.share, "which"); }

TEST(ShareArgument, CountsFromOne) {
  EXPECT_FALSE(testing::parse<Shared>("", add_shard).share);
  for (int count = 1; count < 5; ++count)
    for (int index = 1; index <= count; ++index) {
      const auto share =
          testing::parse<Shared>("--shard " + std::to_string(index) + "/" + std::to_string(count), add_shard)
              .share;
      ASSERT_TRUE(share);
      EXPECT_EQ(share->index, index - 1);
      EXPECT_EQ(share->count, count);
    }
}

TEST(ShareArgument, WhatIsNoneIsRefused) {
  for (const char* text : {"0/3", "4/3", "-1/3", "1/0", "1", "/", "1/", "/3", "1/3/5", "1.0/3", "+1/3", "a/b",
                           "1/99999999999", "1 /3"})
    EXPECT_NE(testing::refusal<Shared>("--shard '" + std::string(text) + "'", add_shard)
                  .find("expected I/N with I from 1 to N"),
              std::string::npos)
        << text;
}

}  // namespace
}  // namespace lodestone
