// Measurements that are interrupted, and several processes that want the same one.
#include <fcntl.h>
#include <signal.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

using testing::Ended;

const std::string kBox = "sign box:0.2,0.3,0.4 --cell-trials 12 --height-trials 20 --settling-trials 20 --clips 3 --threads 1 ";

class Interrupted : public testing::CliTest {
 protected:
  pid_t start(const std::string& arguments, const std::string& cache) const {
    const std::string line = command(arguments + " >/dev/null 2>&1", cache);
    const pid_t child = ::fork();
    if (child == 0) ::execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
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

  // Kills a run of `arguments` once its journal holds some units.
  bool interrupt(const std::string& arguments, const std::string& cache, int signal) const {
    const pid_t child = start(arguments, cache);
    int status = 0;
    while (journal_bytes(cache) < 60'000)
      if (::waitpid(child, &status, WNOHANG) == child) return false;  // it was faster
      else std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, signal);
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }
};

TEST_F(Interrupted, GoesOnFromWhereItWasToTheSameBytes) {
  ASSERT_EQ(run(kBox, "straight").exit_code, 0);
  const std::string whole = testing::bytes_of(cached("straight", ".sig"));
  for (const int signal : {SIGKILL, SIGINT}) {
    const std::string cache = "cache" + std::to_string(signal);
    ASSERT_TRUE(interrupt(kBox, cache, signal));
    EXPECT_TRUE(cached(cache, ".sig").empty());  // no half file
    std::ofstream(cached(cache, ".measuring"), std::ios::binary | std::ios::app) << "half a record";  // as a crash would leave
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

TEST_F(Interrupted, AShareGoesOn) {
  const std::string share = kBox + "--shard 1/2 -o ";
  ASSERT_EQ(run(share + name("straight.part"), "straight").exit_code, 0);
  ASSERT_TRUE(interrupt(share + name("part"), "cache", SIGKILL));
  EXPECT_FALSE(std::filesystem::exists(at("part")));
  const Ended again = run(share + name("part") + " --json");
  ASSERT_EQ(again.exit_code, 0) << again.out;
  EXPECT_GT(nlohmann::json::parse(again.out)["trials_resumed"].get<int>(), 200);
  ASSERT_EQ(run(kBox + "--shard 2/2 -o " + name("other")).exit_code, 0);
  ASSERT_EQ(run("merge " + name("part") + " " + name("other") + " -o " + name("a.sig")).exit_code, 0);
  ASSERT_EQ(run("merge " + name("straight.part") + " " + name("other") + " -o " + name("b.sig")).exit_code, 0);
  EXPECT_TRUE(testing::bytes_of(at("a.sig")) == testing::bytes_of(at("b.sig")));
}

TEST_F(Interrupted, ADamagedJournalCostsOnlyItsDamagedEnd) {
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

TEST_F(Interrupted, OfSeveralProcessesOneMeasures) {
  std::vector<Ended> ended(3);
  {
    std::vector<std::jthread> threads;
    for (Ended& one : ended) threads.emplace_back([&] { one = run(kBox + "--json"); });
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

}  // namespace
}  // namespace lodestone
