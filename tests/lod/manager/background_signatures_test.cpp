#include "lod/manager/background_signatures.h"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>

#include "reference/error.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

using Pointer = std::shared_ptr<const Signature>;

Shape named(const std::string& name) {
  Shape shape;
  shape.name = name;
  return shape;
}

TEST(BackgroundSignatures, EachRequestGetsItsOwnAnswer) {
  BackgroundSignatures background(2, [](const Shape& shape, const ContactLaw& law, const std::stop_token&) {
    auto signature = std::make_shared<Signature>();
    signature->rung_errors.drops = int(shape.name.size()) * 100 + int(10 * law.friction);
    return Pointer(signature);
  });
  std::vector<FutureSignature> futures;
  for (int i = 0; i < 20; ++i)
    futures.push_back(background.request(named(std::string(std::size_t(i), 'x')), {0.5, 0.1 * (i % 4)}));
  for (int i = 0; i < 20; ++i) {
    const Pointer signature = futures[std::size_t(i)].get();
    EXPECT_EQ(signature->rung_errors.drops, 100 * i + int(10 * (0.1 * (i % 4))));
    EXPECT_EQ(futures[std::size_t(i)].get(), signature);  // as often as it is asked
  }
}

TEST(BackgroundSignatures, NoMoreThreadsThanItMayHave) {
  for (const int most : {1, 3}) {
    std::atomic<int> now = 0, greatest = 0;
    std::vector<FutureSignature> futures;
    BackgroundSignatures background(most, [&](const Shape&, const ContactLaw&, const std::stop_token&) {
      const int here = ++now;
      for (int seen = greatest; seen < here && !greatest.compare_exchange_weak(seen, here);) {
      }
      --now;
      return Pointer();
    });
    for (int i = 0; i < 50; ++i) futures.push_back(background.request(named("a"), {}));
    for (const FutureSignature& future : futures) EXPECT_EQ(future.get(), nullptr);
    EXPECT_LE(greatest, most);
  }
}

// With one thread in the order in which they were asked for.
TEST(BackgroundSignatures, OneThreadAnswersInOrder) {
  std::vector<std::string> order;
  std::latch begin(1);
  {
    std::vector<FutureSignature> futures;
    BackgroundSignatures background(1, [&](const Shape& shape, const ContactLaw&, const std::stop_token&) {
      begin.wait();
      order.push_back(shape.name);
      return Pointer();
    });
    for (const char* name : {"a", "b", "c", "d"}) futures.push_back(background.request(named(name), {}));
    begin.count_down();
    for (const FutureSignature& future : futures) future.wait();
  }
  EXPECT_EQ(order, (std::vector<std::string>{"a", "b", "c", "d"}));
}

TEST(BackgroundSignatures, WhatIsThrownComesOutEachTime) {
  BackgroundSignatures background(
      1, [](const Shape& shape, const ContactLaw&, const std::stop_token&) -> Pointer {
        throw InputError("no " + shape.name);
      });
  const FutureSignature future = background.request(named("crate"), {});
  for (int i = 0; i < 2; ++i) EXPECT_EQ(testing::message_of([&] { future.get(); }), "no crate");
  // And the thread goes on.
  EXPECT_EQ(testing::message_of([&] { background.request(named("ball"), {}).get(); }), "no ball");
}

// It goes away while one is measured and others wait: that one is told to stop, the others never begin.
TEST(BackgroundSignatures, ItsEndStopsTheSource) {
  std::atomic<int> begun = 0;
  std::latch running(1);
  std::atomic<bool> stopped = false;
  std::vector<FutureSignature> futures;
  {
    BackgroundSignatures background(1, [&](const Shape&, const ContactLaw&, std::stop_token stop) {
      if (++begun == 1) running.count_down();
      std::stop_callback note(stop, [&] { stopped = true; });
      while (!stop.stop_requested()) std::this_thread::yield();
      return Pointer();
    });
    for (int i = 0; i < 3; ++i) futures.push_back(background.request(named("a"), {}));
    running.wait();
  }
  EXPECT_EQ(begun, 1);
  EXPECT_TRUE(stopped);
  EXPECT_EQ(futures[0].get(), nullptr);
  EXPECT_THROW(futures[1].get(), std::future_error);  // a promise that nobody keeps
}

}  // namespace
}  // namespace lodestone
