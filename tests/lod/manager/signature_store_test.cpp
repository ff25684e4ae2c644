#include "lod/manager/signature_store.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <latch>
#include <thread>

#include "reference/error.h"
#include "reference/mesh/mesh.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

Shape shape_of(std::uint64_t hash, const std::string& name = "crate") {
  Shape shape;
  shape.content_hash = hash, shape.name = name;
  return shape;
}

std::shared_ptr<const Signature> signature_of(const Shape& shape, double drift = 0.5) {
  auto signature = std::make_shared<Signature>();
  signature->shape_hash = shape.content_hash, signature->shape_name = shape.name;
  signature->rung_errors.tables.drift = drift;
  return signature;
}

struct Counted {
  std::atomic<int> asked = 0;
  SignatureFunction source = [this](const Shape& shape, const ContactLaw& law) {
    ++asked;
    return signature_of(shape, law.friction);
  };
};

TEST(SignatureStore, EachShapeAndLawIsAskedForOnce) {
  Counted counted;
  SignatureStore store(counted.source, SignatureTiming::in_step);
  const ContactLaw first{0.4, 0.5}, second{0.4, 0.6};
  for (int i = 0; i < 3; ++i)
    for (const std::uint64_t hash : {1, 2}) {
      EXPECT_TRUE(store.ready(shape_of(hash), first));
      const auto a = store.find(shape_of(hash), first), b = store.find(shape_of(hash, "scaled copy"), second);
      EXPECT_EQ(a->shape_hash, hash);
      EXPECT_NE(a, b);
      EXPECT_EQ(store.find(shape_of(hash), first), a);
    }
  EXPECT_EQ(counted.asked, 4);
  EXPECT_EQ(store.loaded(), 4);
}

TEST(SignatureStore, NoSignatureIsAnAnswerToo) {
  int asked = 0;
  SignatureStore store(
      [&](const Shape&, const ContactLaw&) {
        ++asked;
        return std::shared_ptr<const Signature>();
      },
      SignatureTiming::in_step);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(store.find(shape_of(1), {}), nullptr);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(store.loaded(), 0);
}

TEST(SignatureStore, ErrorsAreOfWhatWasFoundElseAverages) {
  Counted counted;
  SignatureStore store(counted.source, SignatureTiming::in_step);
  const ContactLaw law{0.4, 0.25};
  EXPECT_EQ(store.errors(shape_of(1), law), RungErrors{});
  EXPECT_EQ(counted.asked, 0);
  store.find(shape_of(1), law);
  EXPECT_EQ(store.errors(shape_of(1), law).tables.drift, 0.25);
  EXPECT_EQ(store.errors(shape_of(2), law), RungErrors{});
}

TEST(SignatureStore, AnothersSignatureIsRefused) {
  SignatureStore store([](const Shape&, const ContactLaw&) { return signature_of(shape_of(0xab, "ball")); },
                       SignatureTiming::in_step);
  EXPECT_EQ(
      testing::message_of([&] { store.find(shape_of(0xcd), {}); }),
      "signature of shape crate: found the signature of ball (00000000000000ab), expected that of crate "
      "(00000000000000cd)");
  EXPECT_EQ(store.loaded(), 0);
}

TEST(SignatureStore, WhatFailsIsAskedForAgainAndLogged) {
  int asked = 0;
  SignatureStore store(
      [&](const Shape& shape, const ContactLaw&) -> std::shared_ptr<const Signature> {
        if (++asked == 1) throw InputError("the disk is full");
        return signature_of(shape);
      },
      SignatureTiming::in_step);
  std::vector<std::pair<LogLevel, std::string>> log;
  store.set_log([&](LogLevel level, std::string_view text) { log.emplace_back(level, text); });
  EXPECT_EQ(testing::message_of([&] { store.find(shape_of(1), {}); }), "the disk is full");
  EXPECT_NE(store.find(shape_of(1), {}), nullptr);
  EXPECT_EQ(asked, 2);
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[0].first, LogLevel::error);
  EXPECT_EQ(log[0].second, "the signature of crate cannot be had: the disk is full");
  EXPECT_EQ(log[1].first, LogLevel::info);
}

// Measured at each start of a game, a cache that cannot be written would go unnoticed.
TEST(SignatureStore, ACacheThatCannotBeUsedIsWarnedOf) {
  const testing::TemporaryFolder folder;
  const char* const before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before ? before : "";
  ::setenv("XDG_CACHE_HOME", folder.write("a file", "no folder").c_str(), 1);
  std::vector<std::string> warnings;
  {
    SignatureStore store({}, SignatureTiming::in_background);
    store.set_log([&](LogLevel level, std::string_view text) {
      if (level == LogLevel::warning) warnings.emplace_back(text);
    });
    const Shape crate = make_shape("crate", make_box({0.2, 0.3, 0.4}));
    for (int i = 0; i < 3000 && warnings.empty(); ++i) {
      store.ready(crate, {});
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  before ? ::setenv("XDG_CACHE_HOME", kept.c_str(), 1) : ::unsetenv("XDG_CACHE_HOME");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("the signature of crate is measured without the cache"), std::string::npos)
      << warnings[0];
}

// In the background nobody waits until it is asked for outright.
TEST(SignatureStore, InTheBackgroundItIsReadyOnceItIsThere) {
  std::latch go(1);
  std::atomic<int> asked = 0;
  SignatureStore store(
      [&](const Shape& shape, const ContactLaw&) {
        ++asked;
        go.wait();
        return signature_of(shape);
      },
      SignatureTiming::in_background);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(store.ready(shape_of(1), {}));
  EXPECT_EQ(store.errors(shape_of(1), {}), RungErrors{});
  EXPECT_EQ(store.loaded(), 0);
  go.count_down();
  const auto signature = store.find(shape_of(1), {});  // waits
  EXPECT_NE(signature, nullptr);
  EXPECT_TRUE(store.ready(shape_of(1), {}));
  EXPECT_EQ(store.find(shape_of(1), {}), signature);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(store.loaded(), 1);
}

TEST(SignatureStore, WhatAThreadCannotHaveIsThrownEachTime) {
  SignatureStore store(
      [](const Shape&, const ContactLaw&) -> std::shared_ptr<const Signature> { throw InputError("none"); },
      SignatureTiming::in_background);
  const std::string early = testing::message_of([&] { store.ready(shape_of(1), {}); });
  EXPECT_TRUE(early == "none" || early == testing::kNothingThrown) << early;
  for (int i = 0; i < 2; ++i) EXPECT_EQ(testing::message_of([&] { store.find(shape_of(1), {}); }), "none");
  EXPECT_EQ(testing::message_of([&] { store.ready(shape_of(1), {}); }), "none");
}

// A source of the caller's is asked within the step unless he wants it otherwise.
TEST(SignatureStore, TimingOfAGivenSourceIsInTheStep) {
  Counted counted;
  SignatureStore store(counted.source, SignatureTiming::automatic);
  EXPECT_TRUE(store.ready(shape_of(1), {}));
  EXPECT_EQ(counted.asked, 0);
}

}  // namespace
}  // namespace lodestone
