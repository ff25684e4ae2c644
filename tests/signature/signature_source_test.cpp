#include "signature/signature_source.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "signature/signature_file.h"
#include "tests/message_of.h"
#include "tests/signature/few_units.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::few_trials;
using testing::measured_box;

class SignatureCache : public ::testing::Test {
 protected:
  SignatureSourceSettings settings() {
    SignatureSourceSettings settings;
    settings.measuring = few_trials();
    settings.cache_folder = folder_.path() / "cache", settings.threads = 1;
    settings.warn = [this](const std::string& text) { warnings_.push_back(text); };
    return settings;
  }
  SourcedSignature find(const ContactLaw& law = {}) {
    return find_or_measure_signature(box_, law, settings());
  }
  int files(const std::string& ending) const {
    int count = 0;
    if (fs::exists(folder_.path() / "cache"))
      for (const auto& entry : fs::directory_iterator(folder_.path() / "cache"))
        count += entry.path().string().ends_with(ending);
    return count;
  }
  const testing::TemporaryFolder folder_;
  const Shape box_ = measured_box();
  std::vector<std::string> warnings_;
};

TEST_F(SignatureCache, TheSecondTimeItIsThere) {
  const SourcedSignature first = find(), second = find();
  EXPECT_FALSE(first.cached);
  EXPECT_TRUE(second.cached);
  EXPECT_EQ(first.file, second.file);
  EXPECT_EQ(encode_signature(*first.signature), encode_signature(*second.signature));
  EXPECT_EQ(files(".sig"), 1);
  EXPECT_EQ(files(".measuring"), 0);
  EXPECT_TRUE(warnings_.empty());
  EXPECT_NEAR(second.signature->measuring_seconds, first.signature->measuring_seconds, 1e-3);
}

// A scaled copy has the same, another law, another seed or another shape has its own.
TEST_F(SignatureCache, IsByContentNotByName) {
  const SourcedSignature first = find();
  Shape large = scale_shape(box_, 3.0);
  large.name = "large";
  EXPECT_TRUE(find_or_measure_signature(large, {}, settings()).cached);
  EXPECT_FALSE(find({0.5, 0.5}).cached);
  SignatureSourceSettings other = settings();
  other.measuring.seed = 9;
  EXPECT_FALSE(find_or_measure_signature(box_, {}, other).cached);
  const Shape cube = make_shape("cube", make_box({0.3, 0.3, 0.3}));
  EXPECT_FALSE(find_or_measure_signature(cube, {}, settings()).cached);
  EXPECT_EQ(files(".sig"), 4);
}

TEST_F(SignatureCache, WhatIsDamagedIsMeasuredAnew) {
  const SourcedSignature first = find();
  const std::string sound = testing::bytes_of(first.file);
  for (const std::string& damaged : {std::string(), sound.substr(0, sound.size() / 2), sound + "x"}) {
    std::ofstream(first.file, std::ios::binary | std::ios::trunc) << damaged;
    const SourcedSignature again = find();
    EXPECT_FALSE(again.cached);
    EXPECT_EQ(testing::bytes_of(first.file), sound);
  }
}

TEST_F(SignatureCache, WithoutItNothingIsWritten) {
  SignatureSourceSettings without = settings();
  without.use_cache = false;
  const SourcedSignature measured = find_or_measure_signature(box_, {}, without);
  EXPECT_NE(measured.signature, nullptr);
  EXPECT_TRUE(measured.file.empty());
  EXPECT_EQ(files(""), 0);
  EXPECT_EQ(encode_signature(*measured.signature), encode_signature(*find().signature));
}

TEST_F(SignatureCache, OneThatCannotBeWrittenIsSaidAndDoneWithout) {
  SignatureSourceSettings nowhere = settings();
  nowhere.cache_folder = "/dev/null/cache";
  const SourcedSignature measured = find_or_measure_signature(box_, {}, nowhere);
  EXPECT_NE(measured.signature, nullptr);
  EXPECT_FALSE(measured.cached);
  ASSERT_EQ(warnings_.size(), 1U);
  EXPECT_TRUE(warnings_[0].ends_with("; the signature of box is measured without the cache")) << warnings_[0];
}

TEST_F(SignatureCache, ALawOutOfRangeIsRefusedBeforeAnythingIsWritten) {
  EXPECT_NE(testing::message_of([&] { find({1.5, 0.5}); }), testing::kNothingThrown);
  EXPECT_NE(testing::message_of([&] { find({0.5, -1}); }), testing::kNothingThrown);
  EXPECT_EQ(files(""), 0);
}

TEST_F(SignatureCache, WhatNothingCanBeMeasuredByIsRefusedBeforeAnythingIsWritten) {
  const auto refused = [&](auto change) {
    SignatureSourceSettings wrong = settings();
    change(wrong.measuring);
    return testing::message_of([&] { find_or_measure_signature(box_, {}, wrong); });
  };
  const auto names = [](const std::string& message, const std::string& what) {
    return message.starts_with(what + " of a signature: found ") &&
           message.find(", expected ") != message.npos;
  };
  EXPECT_TRUE(names(refused([](auto& s) { s.n_theta = 0; }), "an axis"));
  EXPECT_TRUE(names(refused([](auto& s) { s.n_psi = -1; }), "an axis"));
  EXPECT_TRUE(names(refused([](auto& s) { s.trials_per_cell = 0; }), "trials_per_cell"));
  EXPECT_TRUE(names(refused([](auto& s) { s.height_samples = 1; }), "height_samples"));
  EXPECT_TRUE(names(refused([](auto& s) { s.settling_trials = 0; }), "settling_trials"));
  EXPECT_TRUE(names(refused([](auto& s) { s.clips = -1; }), "clips"));
  EXPECT_TRUE(names(refused([](auto& s) { s.table_error = std::nan(""); }), "table_error"));
  EXPECT_EQ(files(""), 0);
}

// Stopped before it began there is none; the next goes on and comes to the same bytes.
TEST_F(SignatureCache, StoppedThereIsNoneAndTheNextGoesOn) {
  SignatureSourceSettings stopping = settings();
  std::stop_source stop;
  stopping.stop = stop.get_token();
  int stages = 0;
  stopping.progress = [&](const std::string&, double fraction) {
    if (++stages > 3 && fraction > 0.2) stop.request_stop();
  };
  const SourcedSignature stopped = find_or_measure_signature(box_, {}, stopping);
  EXPECT_EQ(stopped.signature, nullptr);
  EXPECT_GT(stopped.trials_left, 0U);
  EXPECT_EQ(files(".sig"), 0);
  EXPECT_EQ(files(".measuring"), 1);
  const SourcedSignature resumed = find();
  EXPECT_EQ(resumed.trials_resumed, stopped.trials_left);
  SignatureSourceSettings without = settings();
  without.use_cache = false;
  EXPECT_EQ(encode_signature(*resumed.signature),
            encode_signature(*find_or_measure_signature(box_, {}, without).signature));
  EXPECT_EQ(files(".measuring"), 0);
}

// Of two that want it at once one measures; the other has it from the cache.
TEST_F(SignatureCache, OfTwoAtOnceOneMeasures) {
  SourcedSignature found[2];
  const SignatureSourceSettings shared = [&] {
    SignatureSourceSettings quiet = settings();
    quiet.warn = {};
    return quiet;
  }();
  {
    std::jthread other([&] { found[1] = find_or_measure_signature(box_, {}, shared); });
    found[0] = find_or_measure_signature(box_, {}, shared);
  }
  EXPECT_EQ(found[0].cached + found[1].cached, 1);
  EXPECT_EQ(encode_signature(*found[0].signature), encode_signature(*found[1].signature));
}

TEST_F(SignatureCache, ErrorsOfRungsLieBesideIt) {
  const SourcedSignature first = find();
  const fs::path file = rung_errors_file(box_, {}, settings());
  EXPECT_EQ(file.string(), first.file.string() + ".errors");
  save_rung_errors({.tables = {0.5, 0.6}, .drops = 7}, file);
  const SourcedSignature second = find();
  EXPECT_EQ(second.signature->rung_errors.drops, 7U);
  EXPECT_EQ(second.signature->rung_errors.tables.drift, 0.6);
  EXPECT_EQ(first.signature->rung_errors, RungErrors{});
}

}  // namespace
}  // namespace lodestone
