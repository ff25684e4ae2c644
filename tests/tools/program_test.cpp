// The program as scripts see it: exit codes, what goes to stdout and what does not.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "lod/version.h"

namespace lodestone::program_test {
namespace {

struct Ended {
  int exit_code = -1;
  std::string out;
};

// As one word to the shell.
std::string quoted(const std::string& path) {
  std::string word = "'";
  word.append(path).push_back('\'');
  return word;
}

// Runs `lodestone` with `arguments`; stderr is joined where asked for.
Ended run(const std::string& arguments, bool with_errors = false) {
  const std::string command =
      quoted(LODESTONE_CLI) + ' ' + arguments + (with_errors ? " 2>&1" : " 2>/dev/null");
  Ended ended;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    ended.out.append(buffer.data(), count);
  const int status = pclose(pipe);
  ended.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return ended;
}

TEST(Program, HelpIsDone) {
  for (const char* arguments :
       {"--help", "run --help", "sign --help", "merge --help", "inspect --help", "compare drop --help",
        "demo --help", "bench hard_cases --help", "bench budget --help", "bench rungs --help"}) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.exit_code, 0) << arguments;
    EXPECT_FALSE(ended.out.empty()) << arguments;
  }
}

TEST(Program, TellsItsVersion) {
  const Ended ended = run("--version");
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_EQ(ended.out, "lodestone " LODESTONE_VERSION_STRING "\n");
}

TEST(Program, WrongUsageIsTwoAndSilentOnStdout) {
  for (const char* arguments : {"",
                                "nonsense",
                                "run",
                                "compare",
                                "compare drop",
                                "run a.yaml --steps 0",
                                "run a.yaml --level fast",
                                "run a.yaml --model full",
                                "run a.yaml --budget-ms 0",
                                "run a.yaml --budget-ms nan",
                                "run a.yaml --budget-work inf",
                                "run a.yaml --budget-work -4",
                                "run a.yaml --budget-ms 4 --budget-work 2000",
                                "bench budget --budgets 0",
                                "bench rungs --shape cube",
                                "run a.yaml --dt 0",
                                "compare drop box:1,1,1 --trials 1",
                                "compare drop box:1,1,1 --dt 1/0",
                                "compare drop box:1,1,1 --methods nonsense",
                                "compare drop box:1,1,1 --restitution 2",
                                "sign box:1,1,1 --threads -1",
                                "bench",
                                "bench hard_cases --only nonsense"}) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.exit_code, 2) << arguments;
    EXPECT_EQ(ended.out, "") << arguments;
    EXPECT_FALSE(run(arguments, true).out.empty()) << arguments;
  }
}

TEST(Program, ACommandThatIsNoneIsNamed) {
  EXPECT_NE(run("nonsense", true).out.find("found 'nonsense', expected one of run, view, replay, "),
            std::string::npos);
  EXPECT_NE(run("", true).out.find("found no command, expected one of run, "), std::string::npos);
  EXPECT_NE(run("compare --all dropp box", true).out.find("compare: found 'dropp', expected one of drop, "),
            std::string::npos);
}

// Not in the words of the library that reads the command line.
TEST(Program, WhatIsWrongWithItsArgumentsIsFoundAndExpected) {
  const std::pair<const char*, const char*> wrong[] = {
      {"run a.yaml --budget-ms 4 --budget-work 9",
       "--budget-ms: found it beside --budget-work, expected one of them"},
      {"run", "SCENE: found none, expected a YAML file"},
      {"run a.yaml --steps 4 --steps 5", "--steps: found it 2 times, expected once"},
      {"run a.yaml --steps", "--steps: found no value, expected one"},
      {"run a.yaml --step 4", "run: found '--step', expected one of its options (did you mean \"--steps\"?)"},
      {"run a.yaml b.yaml", "run: found 'b.yaml', expected no more arguments"},
      {"view a b c d", "RUN: found 4, expected at most 3"},
      {"sign box:1,1,1 --shard 1/2", "--shard: found it without -o, expected both"},
      {"sign box:1,1,1 --paper-grid --cell-trials 9",
       "--paper-grid: found it beside --cell-trials, expected one of them"},
      {"bench endurance --scene a.yaml --bodies 9",
       "--scene: found it beside --bodies, expected one of them"},
      {"bench endurance --scene a.yaml --seed 9", "--scene: found it beside --seed, expected one of them"},
      {"report --json -o r.html", "--out: found it beside --json, expected one of them"},
      {"run a.yaml --dt 0.01,,2", "--dt: found '0.01,,2', expected seconds from 1e-9 to 0.1"},
      {"compare drop box:1,1,1 --dt 0.01,,0.02", "--dt: found '', expected seconds from 1e-9 to 0.1"},
      {"run " LODESTONE_SOURCE_DIR "/scenes/drop.yaml --steps 10 --fork 100 --level full",
       "--fork: found 100, expected a step from 1 to 9"}};
  for (const auto& [arguments, message] : wrong) {
    const Ended ended = run(arguments, true);
    EXPECT_EQ(ended.exit_code, 2) << arguments;
    EXPECT_TRUE(ended.out.starts_with(std::string("lodestone: ") + message))
        << arguments << ": " << ended.out;
  }
}

TEST(Program, BadInputIsThreeAndSilentOnStdout) {
  for (const char* arguments :
       {"run /nowhere/scene.yaml --json", "sign box:1,2 --json", "sign nowhere.obj",
        "inspect /nowhere/file.sig --json", "compare drop cube:1 --json", "demo /nowhere/scene.yaml"}) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.exit_code, 3) << arguments;
    EXPECT_EQ(ended.out, "") << arguments;
    EXPECT_EQ(run(arguments, true).out.substr(0, 11), "lodestone: ") << arguments;
  }
}

TEST(Program, CompareDropPrintsOneJsonObjectAndNothingElse) {
  const Ended ended =
      run("compare drop box:0.2,0.3,0.4 --trials 4 --methods full_1,hull --dt 1/60,1/120 --json", true);
  EXPECT_EQ(ended.exit_code, 0);
  const auto json = nlohmann::json::parse(ended.out);
  ASSERT_EQ(json["rows"].size(), 4U);
  EXPECT_EQ(json["trials"], 4);
  EXPECT_EQ(json["rows"][0]["method"], "full_1");
  EXPECT_NEAR(json["rows"][1]["dt_s"].get<double>(), 1.0 / 120.0, 1e-12);
  EXPECT_GT(json["rows"][3]["ns_per_body_step"].get<double>(), 0.0);
}

TEST(Program, ListsDoNotSwallowTheShape) {
  const Ended ended = run("compare drop --trials 2 --methods full_1 --dt 1/60,1/120 box:0.2,0.3,0.4 --json");
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(ended.out)["rows"].size(), 2U);
}

TEST(Program, RunPrintsOneJsonObjectAndNothingElse) {
  const Ended ended = run(
      "run " + quoted(LODESTONE_SOURCE_DIR "/scenes/drop.yaml") + " --level full --steps 5 --dt 1/120 --json",
      true);
  EXPECT_EQ(ended.exit_code, 0);
  const auto json = nlohmann::json::parse(ended.out);
  for (const char* key : {"steps", "bodies", "state_hash", "step_ms", "levels", "transitions", "counters"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* key : {"p50", "p95", "p99", "mean", "max"})
    EXPECT_TRUE(json["step_ms"].contains(key)) << key;
  EXPECT_EQ(json["steps"], 5);
  EXPECT_EQ(json["levels"]["full"].get<int>() + json["levels"]["statistical"].get<int>(),
            json["bodies"].get<int>());
  EXPECT_EQ(json["counters"]["signatures_loaded"], 0);
  for (const char* key : {"full", "statistical", "support", "tables", "asleep"})
    EXPECT_TRUE(json["levels"].contains(key)) << key;
  EXPECT_FALSE(json.contains("budget"));
}

TEST(Program, RunTakesABudget) {
  const std::string any_steps =
      "run " + quoted(LODESTONE_SOURCE_DIR "/scenes/drop.yaml") + " --level full --json --steps ";
  const std::string scene = any_steps + "20";
  const auto timed = nlohmann::json::parse(run(scene + " --budget-ms 4").out)["budget"];
  EXPECT_EQ(timed["ms"], 4.0);
  EXPECT_EQ(timed["steps"], 11);
  EXPECT_EQ(timed["mean_full"], 1.0);
  for (const char* key : {"over", "p50", "p99", "max", "mean_support"})
    EXPECT_TRUE(timed[key].is_number()) << key;
  const auto worked = nlohmann::json::parse(run(scene + " --budget-work 2000").out)["budget"];
  EXPECT_EQ(worked["work"], 2000.0);
  for (const char* key : {"over", "mean_measured_ms", "mean_error_ms"})
    EXPECT_TRUE(worked[key].is_null()) << key;
  EXPECT_TRUE(worked["mean_predicted_ms"].is_number());
  const auto brief = nlohmann::json::parse(run(any_steps + "5 --budget-ms 4").out)["budget"];
  EXPECT_EQ(brief["steps"], 0);
  for (const char* key : {"over", "p50", "p99", "max", "mean_full", "mean_work", "mean_predicted_ms"})
    EXPECT_TRUE(brief[key].is_null()) << key;
}

TEST(Program, BenchHardCasesPrintsOneJsonObjectAndNothingElse) {
  const Ended ended = run("bench hard_cases --only F1 --quick --json", true);
  EXPECT_EQ(ended.exit_code, 0);
  const auto json = nlohmann::json::parse(ended.out);
  ASSERT_GE(json["cases"].size(), 1U);
  for (const auto& one : json["cases"]) EXPECT_EQ(one["id"], "F1");
}

}  // namespace
}  // namespace lodestone::program_test
