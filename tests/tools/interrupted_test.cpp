// Measurements that are interrupted, and several processes that want the same one.
#include <fcntl.h>
#include <signal.h>
#include <sys/utsname.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

using testing::Ended;

const std::string kBox =
    "sign box:0.2,0.3,0.4 --cell-trials 12 --height-trials 20 --settling-trials 20 --clips 3 --threads 1 ";

class InterruptedProgram : public testing::CliTest {
 protected:
  // Its stdout goes to the file "out", its stderr to "errors".
  pid_t start(const std::string& arguments, const std::string& cache) const {
    const std::string line = command(arguments + " >" + name("out") + " 2>" + name("errors"), cache);
    const pid_t child = ::fork();
    if (child == 0) {
      for (const int one : {SIGINT, SIGTERM})
        ::signal(one, SIG_DFL);  // in the background of a script they are ignored
      ::execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    return child;
  }

  // The one file in the cache with this ending; empty where there is none.
  std::filesystem::path cached(const std::string& cache, const std::string& ending) const {
    if (std::filesystem::exists(at(cache) / "lodestone"))
      for (const auto& entry : std::filesystem::directory_iterator(at(cache) / "lodestone"))
        if (entry.path().string().ends_with(ending)) return entry.path();
    return {};
  }

  std::uintmax_t journal_bytes(const std::string& cache) const {
    std::error_code error;
    const auto file = cached(cache, ".measuring");
    const std::uintmax_t bytes = file.empty() ? 0 : std::filesystem::file_size(file, error);
    return error ? 0 : bytes;
  }

  // Ends a run of `arguments` by a signal once its journal holds some units; whether it was ended so.
  bool interrupt(const std::string& arguments, const std::string& cache, int signal) const {
    const pid_t child = start(arguments, cache);
    int status = 0;
    while (journal_bytes(cache) < 60'000)
      if (::waitpid(child, &status, WNOHANG) == child)
        return false;  // it was faster
      else
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, signal);
    ::waitpid(child, &status, 0);
    return signal == SIGKILL ? WIFSIGNALED(status) : WIFEXITED(status) && WEXITSTATUS(status) == 128 + signal;
  }
};

TEST_F(InterruptedProgram, GoesOnFromWhereItWasToTheSameBytes) {
  ASSERT_EQ(run(kBox, "straight").exit_code, 0);
  const std::string whole = testing::bytes_of(cached("straight", ".sig"));
  for (const int signal : {SIGKILL, SIGINT, SIGTERM}) {
    const std::string cache = "cache" + std::to_string(signal);
    ASSERT_TRUE(interrupt(kBox, cache, signal));
    EXPECT_TRUE(cached(cache, ".sig").empty());  // no half file
    std::ofstream(cached(cache, ".measuring"), std::ios::binary | std::ios::app)
        << "half a record";  // as a crash would leave
    const Ended again = run(kBox + "--json", cache);
    ASSERT_EQ(again.exit_code, 0) << again.out;
    const auto json = nlohmann::json::parse(again.out);
    EXPECT_GT(json["trials_resumed"].get<int>(), 500);
    EXPECT_LT(json["trials_resumed"].get<int>(), json["trials"].get<int>());
    EXPECT_GT(json["seconds"].get<double>(), 0.0);
    EXPECT_TRUE(testing::bytes_of(cached(cache, ".sig")) == whole);
    EXPECT_TRUE(cached(cache, ".measuring").empty());
    const auto found = nlohmann::json::parse(run(kBox + "--json", cache).out);
    EXPECT_EQ(found["cached"], true);
    EXPECT_EQ(found["seconds"], json["seconds"]);  // always the measuring time
    EXPECT_EQ(found["trials_resumed"], 0);
  }
}

TEST_F(InterruptedProgram, AShareGoesOn) {
  const std::string share = kBox + "--shard 1/2 -o ";
  ASSERT_EQ(run(share + name("straight.part"), "straight").exit_code, 0);
  ASSERT_TRUE(interrupt(share + name("part"), "cache", SIGKILL));
  EXPECT_FALSE(std::filesystem::exists(at("part")));
  const Ended again = run(share + name("part") + " --json");
  ASSERT_EQ(again.exit_code, 0) << again.out;
  EXPECT_GT(nlohmann::json::parse(again.out)["trials_resumed"].get<int>(), 200);
  ASSERT_EQ(run(kBox + "--shard 2/2 -o " + name("other")).exit_code, 0);
  ASSERT_EQ(run("merge " + name("part") + " " + name("other") + " -o " + name("a.sig")).exit_code, 0);
  ASSERT_EQ(run("merge " + name("straight.part") + " " + name("other") + " -o " + name("b.sig")).exit_code,
            0);
  EXPECT_TRUE(testing::bytes_of(at("a.sig")) == testing::bytes_of(at("b.sig")));
}

TEST_F(InterruptedProgram, ADamagedJournalCostsOnlyItsDamagedEnd) {
  ASSERT_EQ(run(kBox, "straight").exit_code, 0);
  ASSERT_TRUE(interrupt(kBox, "cache", SIGKILL));
  const auto file = cached("cache", ".measuring");
  std::string bytes = testing::bytes_of(file);
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  const Ended again = run(kBox + "--json");
  ASSERT_EQ(again.exit_code, 0) << again.out;
  EXPECT_GT(nlohmann::json::parse(again.out)["trials_resumed"].get<int>(), 0);
  EXPECT_TRUE(testing::bytes_of(cached("cache", ".sig")) == testing::bytes_of(cached("straight", ".sig")));
}

TEST_F(InterruptedProgram, OfSeveralProcessesOneMeasures) {
  std::vector<Ended> ended(3);
  {
    std::vector<std::jthread> threads;
    for (Ended& one : ended)
      threads.emplace_back([&] { one = testing::run_shell(command(kBox + "--json 2>/dev/null")); });
  }
  int measured = 0;
  for (const Ended& one : ended) {
    ASSERT_EQ(one.exit_code, 0) << one.out;
    measured += !nlohmann::json::parse(one.out)["cached"].get<bool>();
  }
  EXPECT_EQ(measured, 1);
  EXPECT_TRUE(cached("cache", ".measuring").empty());
  EXPECT_TRUE(cached("cache", ".partial").empty());
  EXPECT_FALSE(cached("cache", ".sig").empty());
}

TEST_F(InterruptedProgram, ASignatureSaysWhatIsLeft) {
  ASSERT_TRUE(interrupt(kBox + "--json", "cache", SIGTERM));
  const auto json = nlohmann::json::parse(testing::bytes_of(at("out")));
  EXPECT_EQ(json["incomplete"], true);
  EXPECT_GT(json["trials"].get<int>(), 500);
  const auto again = nlohmann::json::parse(run(kBox + "--json").out);
  EXPECT_EQ(again["trials_resumed"], json["trials"]);
  EXPECT_FALSE(again.contains("incomplete"));
}

// A run that goes on for hours once the report of its steps is begun.
class InterruptedRun : public InterruptedProgram {
 protected:
  InterruptedRun() {
    std::ofstream(at("s.yaml"))
        << "version: 1\nshapes: {ball: {sphere_m: 0.1}}\nbodies: [{shape: ball, position_m: [0, 0, 1]}]\n"
           "output: {trajectory: run.glb, every_n_steps: 1000000}\n";
  }
  pid_t start_endless() {
    const pid_t child = start(
        "run " + name("s.yaml") + " --level full --steps 100000000 --json --out " + name("results"), "cache");
    std::error_code error;
    while (std::filesystem::file_size(at("results") / "steps.csv", error) == 0 || error) {
      if (::waitpid(child, nullptr, WNOHANG) == child) return -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return child;
  }
  static int exit_code_of(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

TEST_F(InterruptedRun, EndsAfterTheStepWithWhatThereIs) {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::filesystem::remove_all(at("results"));
    const pid_t child = start_endless();
    ASSERT_GT(child, 0) << testing::bytes_of(at("errors"));
    ::kill(child, signal);
    EXPECT_EQ(exit_code_of(child), 128 + signal);
    const auto json = nlohmann::json::parse(testing::bytes_of(at("out")));
    EXPECT_EQ(json["incomplete"], true);
    const std::string csv = testing::bytes_of(at("results/steps.csv"));
    EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + json["steps"].get<int>());
    EXPECT_EQ(csv.back(), '\n');
    EXPECT_TRUE(std::filesystem::exists(at("results/run.play")));
    EXPECT_TRUE(std::filesystem::exists(at("results/run.glb")));
    EXPECT_NE(
        testing::bytes_of(at("errors")).find(signal == SIGINT ? "interrupted by SIGINT" : "ended by SIGTERM"),
        std::string::npos);
  }
}

// Both are there when the process goes on.
TEST_F(InterruptedRun, ASecondSignalEndsAtOnce) {
  const pid_t child = start_endless();
  ASSERT_GT(child, 0) << testing::bytes_of(at("errors"));
  for (const int signal : {SIGSTOP, SIGINT, SIGTERM, SIGCONT}) ::kill(child, signal);
  const int code = exit_code_of(child);
  EXPECT_TRUE(code == 130 || code == 143) << code;
  EXPECT_EQ(testing::bytes_of(at("out")), "");
}

TEST_F(InterruptedProgram, AComparisonEnds) {
  const pid_t child = start(
      "compare drop box:0.2,0.3,0.4 --methods statistical --trials 1000000 --threads 1 --cell-trials 2 "
      "--height-trials 20 --settling-trials 7 --clips 3 --json",
      "cache");
  while (cached("cache", ".sig").empty()) {  // the signature comes first
    ASSERT_NE(::waitpid(child, nullptr, WNOHANG), child) << testing::bytes_of(at("errors"));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 130);
  EXPECT_EQ(nlohmann::json::parse(testing::bytes_of(at("out")))["incomplete"], true);
}

// It measures what another process, which is stopped, has begun.
TEST_F(InterruptedProgram, AWaiterSaysForWhom) {
  const pid_t child = start(kBox, "cache");
  while (journal_bytes("cache") == 0) {
    ASSERT_NE(::waitpid(child, nullptr, WNOHANG), child) << "it was faster";
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, SIGSTOP);
  Ended waiter;
  {
    std::jthread thread([&] { waiter = testing::run_shell(command(kBox + "--json 2>" + name("waiter"))); });
    while (testing::bytes_of(at("waiter")).empty())
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ::kill(child, SIGCONT);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(nlohmann::json::parse(waiter.out)["cached"], true);
  utsname system{};
  ::uname(&system);
  const std::string said = testing::bytes_of(at("waiter"));
  EXPECT_NE(said.find("is being measured by process " + std::to_string(child) + " on " + system.nodename),
            said.npos)
      << said;
}

TEST_F(InterruptedProgram, ACacheThatCannotBeUsedCostsAWarning) {
  std::ofstream(at("file")) << "in the way";  // of a folder
  const Ended ended = testing::run_shell(command(kBox + "--json 2>" + name("warning"), "file"));
  ASSERT_EQ(ended.exit_code, 0) << testing::bytes_of(at("warning"));
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["file"], "");
  EXPECT_FALSE(json["rest_poses"].empty());
  const std::string said = testing::bytes_of(at("warning"));
  EXPECT_NE(said.find("lodestone: warning: "), said.npos) << said;
  EXPECT_NE(said.find("is measured without the cache"), said.npos) << said;
}

// The limit leaves room for a part of the journal, and none for the signature.
TEST_F(InterruptedProgram, AFullCacheCostsAWarningAndTheJournalGoes) {
  const Ended ended =
      testing::run_shell("trap '' XFSZ; ulimit -f 8; " + command(kBox + "--json 2>" + name("warning")));
  ASSERT_EQ(ended.exit_code, 0) << testing::bytes_of(at("warning"));
  EXPECT_FALSE(nlohmann::json::parse(ended.out)["rest_poses"].empty());
  for (const char* ending : {".sig", ".measuring", ".partial", ".holder"})
    EXPECT_TRUE(cached("cache", ending).empty()) << ending;
  const std::string said = testing::bytes_of(at("warning"));
  EXPECT_NE(said.find("the signature is used, but not kept"), said.npos) << said;
}

}  // namespace
}  // namespace lodestone
