// What cannot be written is said, and what is complete is kept.
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

using testing::Ended;
using testing::quoted;

const std::string kScene = quoted(LODESTONE_SOURCE_DIR "/scenes/drop.yaml");
const std::string kRun = "run " + kScene + " --level full --steps 5 ";
const std::string kSign =
    "sign box:0.2,0.3,0.4 --cell-trials 2 --height-trials 20 --settling-trials 7 --clips 3 --threads 1 ";

class Losses : public testing::CliTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  }
  // A file of that name that has no room.
  std::string full(const std::string& file) const {
    std::filesystem::create_directories(at(file).parent_path());
    std::filesystem::create_symlink("/dev/full", at(file));
    return name(file);
  }
  void expect_no_room(const std::string& arguments, const std::string& where) const {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.exit_code, 3) << arguments << '\n' << ended.out;
    EXPECT_NE(ended.out.find("lodestone: "), ended.out.npos) << ended.out;
    EXPECT_NE(ended.out.find(where + ": found no space left on device, expected "), ended.out.npos)
        << arguments << '\n'
        << ended.out;
  }
};

TEST_F(Losses, StandardOutputIsChecked) {
  for (const std::string& arguments :
       {kRun, kRun + "--json ", kSign + "--json ", std::string("--help "), std::string("bench --help "),
        "inspect " + name("a.sig") + " --json "}) {
    if (arguments.starts_with("inspect")) {
      ASSERT_EQ(run(kSign + "-o " + name("a.sig")).exit_code, 0);
    }
    const Ended ended = testing::run_shell(command(arguments + "2>&1 >/dev/full"));
    EXPECT_EQ(ended.exit_code, 3) << arguments;
    EXPECT_TRUE(ended.out.ends_with(
        "lodestone: standard output: found no space left on device, expected room for the results\n"))
        << arguments << ended.out;
  }
}

TEST_F(Losses, EveryFileOfARunIsChecked) {
  for (const char* file : {"steps.csv", "run.play"}) {
    const std::string folder = std::string("out-") + file;
    full(folder + "/" + file);
    expect_no_room(kRun + "--out " + name(folder), file);
  }
  expect_no_room(kRun + "--record " + full("a.rec"), "a.rec");
}

TEST_F(Losses, EveryFileOfASignatureIsChecked) {
  expect_no_room(kSign + "-o " + full("a.sig"), "a.sig");
  expect_no_room(kSign + "--export-trials " + full("a.csv"), "a.csv");
  expect_no_room(kSign + "--shard 1/2 -o " + full("a.part"), "a.part");
  ASSERT_EQ(run(kSign + "-o " + name("b.sig")).exit_code, 0);
  expect_no_room("inspect " + name("b.sig") + " --svg " + full("a.svg"), "a.svg");
}

// Past the cache, too.
TEST_F(Losses, ASignatureSaysHowLongItTook) {
  const std::string csv = name("a.csv");
  for (const std::string& arguments : {"--export-trials " + csv, "--from-trials " + csv}) {
    const Ended ended = testing::run_shell(command(kSign + "--json " + arguments + " 2>/dev/null"));
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    const auto json = nlohmann::json::parse(ended.out);
    EXPECT_TRUE(json["seconds"].is_number() && json["trials_per_s"].is_number()) << arguments << ended.out;
  }
}

TEST_F(Losses, EveryFileOfAComparisonIsChecked) {
  const std::string compare = "compare drop box:0.2,0.3,0.4 --trials 2 --methods full_1 ";
  expect_no_room(compare + "--csv " + full("a.csv"), "a.csv");
  full("out/drops.csv");
  expect_no_room(compare + "--out " + name("out"), "drops.csv");
}

// Before anything is measured.
TEST_F(Losses, WhatCannotBeWrittenIsSaidAtOnce) {
  for (const char* file : {"/dev/null/a.csv", "/"}) {
    const Ended ended = run(std::string("compare drop box:0.2,0.3,0.4 --trials 1000000 --csv ") + file);
    EXPECT_EQ(ended.exit_code, 3);
    EXPECT_NE(ended.out.find(std::string(file) + ": found "), std::string::npos) << ended.out;
  }
  const std::string drops = "compare drop box:0.2,0.3,0.4 --trials 1000000 --out /dev/null/a";
  for (const std::string& line :
       {drops, std::string("compare scores --only materials --write /dev/null/a")}) {
    const Ended ended = run(line);
    EXPECT_EQ(ended.exit_code, 3) << line;
    EXPECT_NE(ended.out.find("/dev/null/a: found not a directory, expected a f"), std::string::npos)
        << ended.out;
  }
}

// One of them would be lost.
TEST_F(Losses, TwoResultsInOneFileAreRefused) {
  const std::string small =
      "sign sphere:0.1 --cell-trials 2 --height-trials 4 --settling-trials 2 --clips 0 ";
  const Ended ended = run(small + "-o " + name("a") + " --export-trials " + name("./a"));
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.out.find("a: found the file that --export-trials writes, expected another one for -o"),
            std::string::npos)
      << ended.out;
  EXPECT_FALSE(std::filesystem::exists(at("a")));
  EXPECT_EQ(run(small + "-o /dev/null --export-trials /dev/null").exit_code, 0);
}

TEST_F(Losses, AMeshInAFolderOfMeshesIsNotWrittenOver) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  std::filesystem::create_directories(at("meshes"));
  std::ofstream(at("meshes/a.obj")) << mesh;
  const Ended ended = run("sign a.obj --mesh-path /dev:" + name("meshes") + " -o " + name("meshes/a.obj"));
  EXPECT_EQ(ended.exit_code, 3) << ended.out;
  EXPECT_NE(ended.out.find("a.obj: found the file that SHAPE reads, expected another one for -o"),
            std::string::npos)
      << ended.out;
  EXPECT_EQ(testing::bytes_of(at("meshes/a.obj")), mesh);
}

TEST_F(Losses, APageIsNotPutInPlaceOfAFutureThatItPlays) {
  for (const char* file : {"run.play", "fork.play"}) {
    std::filesystem::create_directories(at("run"));
    std::ofstream(at("run") / file) << "kept";
    const Ended ended = run("view " + name("run") + " -o " + name(std::string("run/") + file));
    EXPECT_EQ(ended.exit_code, 3);
    EXPECT_NE(ended.out.find("found the run that it is to play"), std::string::npos) << ended.out;
  }
}

TEST_F(Losses, ScoresOfAPageAreNotMeasured) {
  std::ofstream(at("page.md")) << "a page\n";
  for (const char* other : {" --write /dev/null", " --only quick"}) {
    const Ended ended = run("compare scores --page " + name("page.md") + other);
    EXPECT_EQ(ended.exit_code, 2) << ended.out;
    EXPECT_NE(ended.out.find("found it beside"), std::string::npos) << ended.out;
  }
}

// Files may grow to a few kB, of a report of 200 steps.
TEST_F(Losses, ARunKeepsWhatIsCompleteAndSaysWhatItHas) {
  const Ended ended = testing::run_shell("trap '' XFSZ; ulimit -f 16; " +
                                         command("run " + kScene + " --level full --steps 400 --json --out " +
                                                 name("out") + " 2>" + name("errors")));
  EXPECT_EQ(ended.exit_code, 3);
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["incomplete"], true);
  EXPECT_TRUE(json["steps"].get<int>() >= 1);
  const std::string csv = testing::bytes_of(at("out/steps.csv"));
  ASSERT_FALSE(csv.empty());
  EXPECT_EQ(csv.back(), '\n');
  const auto cells = [](const std::string& line) { return std::ranges::count(line, ','); };
  EXPECT_EQ(cells(csv.substr(csv.rfind('\n', csv.size() - 2))), cells(csv.substr(0, csv.find('\n'))));
  EXPECT_NE(testing::bytes_of(at("errors")).find("steps.csv: found file too large, expected room"),
            std::string::npos)
      << testing::bytes_of(at("errors"));
}

TEST_F(Losses, ARunWhoseRecordingHasNoRoomKeepsItsResults) {
  const Ended ended = testing::run_shell(
      "trap '' XFSZ; ulimit -f 8; " + command("run " + kScene + " --level full --steps 400 --json --record " +
                                              name("a.rec") + " 2>" + name("errors")));
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_EQ(nlohmann::json::parse(ended.out)["incomplete"], true);
  EXPECT_NE(testing::bytes_of(at("errors")).find("a.rec: found file too large"), std::string::npos)
      << testing::bytes_of(at("errors"));
}

// Of nothing there is nothing to drop: said before the scene has run.
TEST_F(Losses, ADemoOfNoBodiesIsRefused) {
  testing::run_shell("echo 'version: 1\nbodies: []' >" + name("empty.yaml"));
  const Ended ended = run("demo " + name("empty.yaml") + " --out " + name("report"));
  EXPECT_EQ(ended.exit_code, 3) << ended.out;
  EXPECT_NE(ended.out.find("empty.yaml: bodies: found none, expected one or more to drop"), std::string::npos)
      << ended.out;
}

TEST_F(Losses, ADemosFilesAreNotThoseOfItsRun) {
  const std::string demo = "demo " + kScene + " --level full --steps 5 --trials 2 --out " + name("out");
  for (const char* option : {" --steps-csv ", " --report "}) {
    const Ended ended = run(demo + option + name("out/steps.csv"));
    EXPECT_EQ(ended.exit_code, 3) << ended.out;
    EXPECT_NE(ended.out.find("steps.csv: found a file that the mixed run writes"), std::string::npos)
        << ended.out;
  }
  EXPECT_FALSE(std::filesystem::exists(at("out")));
}

// Names are bytes; JSON is UTF-8.
TEST_F(Losses, AFolderWhoseNameIsNoTextLosesNothing) {
  const Ended ended = run(kRun + "--json --out " + quoted(at("out\xff").string()));
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_NE(ended.out.find("state_hash"), std::string::npos) << ended.out;
  EXPECT_TRUE(std::filesystem::exists(at("out\xff/run.play")));
}

TEST_F(Losses, AnOutputThatIsNoFileIsWrittenThrough) {
  ASSERT_EQ(run(kSign + "--no-cache -o " + name("plain.sig")).exit_code, 0);
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  const Ended ended = testing::run_shell("timeout 60 cat " + name("pipe") + " >" + name("copy") + " & " +
                                         "(" + command(kSign + "--no-cache -o " + name("pipe")) +
                                         ") >/dev/null; code=$?; wait; exit $code");
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_fifo(at("pipe")));
  EXPECT_TRUE(testing::bytes_of(at("copy")) == testing::bytes_of(at("plain.sig")));
}

// The size that it tells is that of what was written: a pipe has none.
TEST_F(Losses, APartOrAPageThroughAPipeIsASuccess) {
  ASSERT_EQ(run(kRun + "--out " + name("out")).exit_code, 0);
  for (const std::string& arguments :
       {kSign + "--shard 1/2 --json -o ", "view " + name("out") + " --json -o "}) {
    const std::string pipe = name("pipe");
    ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
    const Ended ended = testing::run_shell("timeout 60 cat " + pipe + " >" + name("copy") + " & (" +
                                           command(arguments + pipe) + ") 2>&1; code=$?; wait; exit $code");
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    EXPECT_EQ(nlohmann::json::parse(ended.out)["bytes"], std::filesystem::file_size(at("copy")));
    std::filesystem::remove(at("pipe"));
  }
}

class Messages : public testing::CliTest {};

TEST_F(Messages, AMeshNameBeyondWhatTheSystemTakes) {
  for (const std::string& name :
       {std::string(5000, 'a') + ".obj", std::string(300, 'a') + ".obj", "l:" + std::string(5000, 'a')}) {
    const Ended ended = run("sign " + name);
    EXPECT_EQ(ended.exit_code, 3) << ended.out;
    EXPECT_TRUE(ended.out.starts_with("lodestone: ")) << ended.out;
    EXPECT_LT(ended.out.size(), 1200U);
    EXPECT_NE(ended.out.find("expected"), ended.out.npos) << ended.out;
  }
}

TEST_F(Messages, ControlCharactersAreNotObeyed) {
  const Ended ended = run("run \"$(printf 'a\\033[31m\\nb.yaml')\"");
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.out.find("a\\x1b[31m\\nb.yaml"), ended.out.npos) << ended.out;
  EXPECT_EQ(ended.out.find('\x1b'), ended.out.npos);
  const Ended usage = run("run a.yaml --steps \"$(printf '\\033[31m')\"");
  EXPECT_EQ(usage.exit_code, 2);
  EXPECT_EQ(usage.out.find('\x1b'), usage.out.npos) << usage.out;
}

TEST_F(Messages, ControlCharactersOfASignatureAreNotObeyed) {
  std::ofstream(at("a\x1b[31m.obj"))
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const Ended ended = run("sign " + name("a\x1b[31m.obj") +
                          " --cell-trials 2 --height-trials 4 --settling-trials 2 --clips 0 --no-cache");
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_NE(ended.out.find("shape        a\\x1b[31m.obj ("), std::string::npos) << ended.out;
}

TEST_F(Messages, WhyAFileCannotBeRead) {
  std::filesystem::create_symlink("loop.yaml", at("loop.yaml"));
  const Ended loop = run("run " + name("loop.yaml"));
  EXPECT_EQ(loop.exit_code, 3);
  EXPECT_NE(loop.out.find("too many levels of symbolic links"), loop.out.npos) << loop.out;
  std::filesystem::create_symlink("loop.sig", at("loop.sig"));
  const Ended signature = run("inspect " + name("loop.sig"));
  EXPECT_EQ(signature.exit_code, 3);
  EXPECT_NE(signature.out.find("too many levels of symbolic links"), signature.out.npos) << signature.out;
}

// Root may read everything, and is nobody here.
TEST_F(Messages, AFileThatMayNotBeReadIsDenied) {
  const std::string program =
      (::geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "") +
      quoted(LODESTONE_CLI) + ' ';
  if (testing::run_shell(program + "--version 2>&1").exit_code != 0)
    GTEST_SKIP() << "nobody may not run the program";
  std::filesystem::permissions(at(""), std::filesystem::perms::others_exec,
                               std::filesystem::perm_options::add);
  for (const char* file : {"s.yaml", "s.sig"}) {
    std::ofstream(at(file)) << "version: 1\n";
    std::filesystem::permissions(at(file), std::filesystem::perms::none);
  }
  for (const std::string& arguments : {"run " + name("s.yaml"), "inspect " + name("s.sig")}) {
    const Ended denied = testing::run_shell(program + arguments + " 2>&1");
    EXPECT_EQ(denied.exit_code, 3);
    EXPECT_NE(denied.out.find("found permission denied, expected"), denied.out.npos) << denied.out;
  }
}

TEST_F(Messages, SettingsOutOfRangeAreUsageAndFilesAreInput) {
  EXPECT_EQ(run(kRun + "--fork 5").exit_code, 2);
  EXPECT_EQ(run("compare pile box:0.2,0.3,0.4 --side 0.1").exit_code, 2);
  EXPECT_EQ(run("view a --blind").exit_code, 2);    // of one run there is nothing to tell apart
  EXPECT_EQ(run("view a b --blind").exit_code, 3);  // there is no a
  std::ofstream(at("bad.yaml")) << "version: 2\n";
  EXPECT_EQ(run("run " + name("bad.yaml")).exit_code, 3);
}

TEST_F(Messages, NoneOfTheLibrariesOnThreads) {
  const Ended ended =
      run("sign box:0.2,0.3,0.4 --cell-trials 2 --height-trials 20 --settling-trials 7 --clips 3 --threads "
          "500 --no-cache --json");  // stderr is joined
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_TRUE(nlohmann::json::accept(ended.out)) << ended.out;
  const Ended stepped = run("run " + kScene + " --level full --steps 2 --threads 500 --json");
  EXPECT_TRUE(nlohmann::json::accept(stepped.out)) << stepped.out;
}

}  // namespace
}  // namespace lodestone
