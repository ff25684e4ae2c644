#include "lod/manager/recorder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>

#include "lod/manager.h"
#include "tests/lod/callers/callers_scene.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

using Bytes = std::vector<std::byte>;

struct Tape {
  Bytes bytes;
  RecordFunction write = [this](std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  /// After the magic: each chunk.
  std::vector<Bytes> chunks() const {
    std::vector<Bytes> chunks;
    for (std::size_t at = kRecordingMagic.size(); at < bytes.size();) {
      ChunkHead head;
      std::memcpy(&head, bytes.data() + at, sizeof head);
      at += sizeof head;
      EXPECT_LE(at + head.length, bytes.size());
      chunks.emplace_back(bytes.begin() + std::ptrdiff_t(at),
                          bytes.begin() + std::ptrdiff_t(at + head.length));
      EXPECT_TRUE(head.has_true_length() && head.fits(chunks.back()));
      at += head.length;
    }
    return chunks;
  }
};

TEST(Recorder, AChunkIsItsHeadAndTheCall) {
  Tape tape;
  Recorder recorder;
  EXPECT_FALSE(recorder.on());
  recorder.note(Call::wake, BodyId{1, 2});  // nobody listens
  recorder.set(tape.write, {std::byte(7), std::byte(8)});
  EXPECT_TRUE(recorder.on());
  recorder.note(Call::sleep, BodyId{5, 6});
  recorder.set({}, {});
  EXPECT_FALSE(recorder.on());
  recorder.note(Call::wake, BodyId{1, 2});

  ASSERT_GE(tape.bytes.size(), kRecordingMagic.size());
  EXPECT_EQ(std::memcmp(tape.bytes.data(), kRecordingMagic.data(), kRecordingMagic.size()), 0);
  const std::vector<Bytes> chunks = tape.chunks();
  ASSERT_EQ(chunks.size(), 2U);
  StateArchive begin(chunks[0], {}), sleep(chunks[1], {});
  Call call{};
  Bytes snapshot;
  begin(call, snapshot);
  EXPECT_EQ(call, Call::begin);
  EXPECT_EQ(snapshot, (Bytes{std::byte(7), std::byte(8)}));
  BodyId body;
  sleep(call, body);
  EXPECT_EQ(call, Call::sleep);
  EXPECT_EQ(body, (BodyId{5, 6}));
  EXPECT_TRUE(sleep.at_end());
}

TEST(FindShape, LooksAmongThoseGivenByContentAndSize) {
  const auto box = testing::box_shape({0.2, 0.3, 0.4});
  const auto large = std::make_shared<const Shape>(scale_shape(*box, 2.0));
  const std::shared_ptr<const Shape> given[] = {nullptr, large, box};
  const BodyTable none;
  EXPECT_EQ(find_shape(name_of(*box), given, none), box);
  EXPECT_EQ(find_shape(name_of(*large), given, none), large);
  EXPECT_EQ(find_shape(name_of(*testing::sphere_shape(0.1)), given, none), nullptr);
}

// Whatever is done, doing it again gives the same; changed anywhere in the calls, it does not pass unnoticed.
TEST(Recording, CallsOfEveryKindComeOutTheSame) {
  using namespace testing;
  const auto box = box_shape({0.2, 0.3, 0.4});
  Tape tape;
  Manager manager = on_floor();
  manager.set_record(tape.write);
  const BodyId a = add(manager, box, at({0, 0, 0.5})), b = add(manager, box, at({1, 0, 0.5}, {1, 0, 0})),
               c = add(manager, box, at({-1, 0, 0.3}), LevelChoice::full);
  const GroundId ramp = manager.add_static_box({1, 1, 0.2}, {3, 0, 0.1}, Quat::Identity());
  view_from(manager, {0, 0, 1});
  for (int i = 0; i < 20; ++i) {
    manager.step(kFrame);
    if (i == 3) manager.add_impulse(b, {0, 1, 2}, {1, 0, 0.5});
    if (i == 5) manager.set_level(a, LevelChoice::full);
    if (i == 7) manager.set_properties(c, {.linear_damping = 0.5});
    if (i == 9) manager.add_force(a, {0, 0, 30}, {1, 0, 0});
    if (i == 11) manager.sleep(b);
    if (i == 12) manager.wake(b);
    if (i == 13) manager.set_gravity({0, 1, -5});
    if (i == 14) manager.move_ground(ramp, at({3, 0, 0.2}));
    if (i == 15) manager.set_state(c, at({-1, 1, 1}, {0, 0, 1}, {1, 2, 3}));
    if (i == 16) manager.set_importance(b, 3.0);
    if (i == 17) manager.set_rung_range(b, Rung::support, Rung::support);
    if (i == 18) manager.remove_body(a);
  }
  const std::uint64_t hash = manager.state_hash();
  manager.set_record({});
  manager.step(kFrame);  // on no tape

  const std::shared_ptr<const Shape> shapes[] = {box};
  Manager again = on_floor();
  const ReplayResult result = again.replay(tape.bytes, shapes);
  EXPECT_TRUE(result.same) << result.text;
  EXPECT_EQ(result.steps, 20);
  EXPECT_EQ(again.state_hash(), hash);

  // Without its shape, and with one call changed.
  Manager without = on_floor();
  EXPECT_NE(message_of([&] { without.replay(tape.bytes); }), kNothingThrown);
  int noticed = 0, calls = 0;
  std::size_t at = kRecordingMagic.size();
  for (const Bytes& chunk : tape.chunks()) {
    if (Call(chunk[0]) == Call::add_impulse || Call(chunk[0]) == Call::set_gravity) {
      ++calls;
      Bytes changed = tape.bytes;
      changed[at + 8 + chunk.size() - 2] ^= std::byte(0x10);  // in the exponent of its last number
      Manager other = on_floor();
      std::string fault = message_of([&] {
        if (!other.replay(changed, shapes).same) throw InputError("otherwise");
      });
      noticed += fault != kNothingThrown;
    }
    at += 8 + chunk.size();
  }
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(noticed, calls);
}

// Of a loop of his own, too, in which the world is stepped once.
TEST(Recording, ACallersOwnLoopComesOutTheSame) {
  using namespace testing;
  const auto box = box_shape({0.2, 0.3, 0.4});
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support}) {
    CallersScene scene, other;
    dWorldSetGravity(scene.world, 0, 0, -9.81), dWorldSetGravity(other.world, 0, 0, -9.81);
    dCreatePlane(scene.space, 0, 0, 1, 0), dCreatePlane(other.space, 0, 0, 1, 0);
    Tape tape;
    Manager manager(scene.world, scene.space, unmeasured());
    manager.set_record(tape.write);
    for (int i = 0; i < 4; ++i) add(manager, box, at({0.05 * i, 0, 0.5 + 0.4 * i}), level);
    for (int i = 0; i < 60; ++i) {
      manager.before_world_step(kFrame);
      dWorldStep(scene.world, kFrame);
      manager.after_world_step();
    }
    manager.set_record({});
    const std::shared_ptr<const Shape> shapes[] = {box};
    Manager again(other.world, other.space, unmeasured());
    const ReplayResult result = again.replay(tape.bytes, shapes);
    EXPECT_TRUE(result.same) << result.text;
    EXPECT_EQ(result.steps, 60);
    EXPECT_EQ(again.state_hash(), manager.state_hash());
  }
}

TEST(Recording, WhatIsRestoredMeanwhileIsRestoredAgain) {
  using namespace testing;
  const auto box = box_shape({0.2, 0.2, 0.2});
  Tape tape;
  Manager manager = on_floor();
  const BodyId body = add(manager, box, at({0, 0, 1}));
  manager.set_record(tape.write);
  run(manager, 0.1);
  const Bytes before = manager.snapshot();
  run(manager, 0.1);
  manager.restore(before);
  run(manager, 0.1);
  manager.set_record({});
  Manager other = on_floor();
  const std::vector shapes{std::shared_ptr<const Shape>(box)};
  const ReplayResult result = other.replay(tape.bytes, shapes);
  EXPECT_TRUE(result.same) << result.text;
  EXPECT_EQ(result.steps, 18);
  EXPECT_EQ(other.state(body).position, manager.state(body).position);
}

TEST(Recording, EveryTruncationIsRefusedOrEndsAtAStep) {
  using namespace testing;
  const auto box = box_shape({0.2, 0.2, 0.2});
  Tape tape;
  Manager manager = on_floor();
  add(manager, box, at({0, 0, 1}));
  manager.step(kFrame);
  manager.set_record(tape.write);
  for (int i = 0; i < 3; ++i) manager.step(kFrame);
  const std::shared_ptr<const Shape> shapes[] = {box};
  int refused = 0;
  for (std::size_t length = 0; length < tape.bytes.size(); length += 37) {
    Manager other = on_floor();
    const std::string fault = message_of([&] {
      EXPECT_LT(other.replay({tape.bytes.data(), length}, shapes).steps, 3);
    });
    refused += fault != kNothingThrown;
  }
  EXPECT_GT(refused, 10);
}

// A full disk costs the recording, and neither the body that was being added nor the step.
TEST(Recording, EndsWhereItsWriterThrows) {
  using namespace testing;
  const auto box = box_shape({0.2, 0.2, 0.2});
  Tape tape;
  bool full = false;
  const auto write = [&](std::span<const std::byte> bytes) {
    if (full) throw std::runtime_error("no room");
    tape.write(bytes);
  };
  Manager manager = on_floor(), plain = on_floor();
  manager.set_record(write);
  add(manager, box, at({0, 0, 1})), add(plain, box, at({0, 0, 1}));
  manager.step(kFrame), plain.step(kFrame);
  full = true;
  const BodyId late = add(manager, box, at({0, 0, 2}));
  EXPECT_EQ(late, add(plain, box, at({0, 0, 2})));
  EXPECT_EQ(message_of<std::runtime_error>([&] { manager.step(kFrame); }), "no room");
  plain.step(kFrame);
  EXPECT_EQ(manager.state_hash(), plain.state_hash());
  EXPECT_EQ(message_of([&] { manager.step(kFrame); }), kNothingThrown);
  const std::shared_ptr<const Shape> shapes[] = {box};
  EXPECT_EQ(on_floor().replay(tape.bytes, shapes).steps, 1);

  EXPECT_EQ(message_of<std::runtime_error>([&] { manager.set_record(write); }), "no room");
  EXPECT_EQ(message_of([&] { manager.step(kFrame); }), kNothingThrown);
  full = false;
  manager.set_record(write);
  full = true;
  manager.remove_body(late);
  EXPECT_EQ(message_of<std::runtime_error>([&] { manager.set_record({}); }), "no room");
  EXPECT_EQ(message_of([&] { manager.step(kFrame); }), kNothingThrown);
}

// A bit is enough, in the call and its values, in what came of it, or in a chunk's head.
TEST(Recording, DamageIsFoundWhereverItIs) {
  using namespace testing;
  const auto box = box_shape({0.2, 0.2, 0.2});
  Tape tape;
  Manager manager = on_floor();
  const BodyId body = add(manager, box, at({0, 0, 1}));
  manager.set_record(tape.write);
  for (int i = 0; i < 3; ++i) manager.add_impulse(body, Vec3(0, 0, 1), Vec3(0, 0, 1)), manager.step(kFrame);
  const std::shared_ptr<const Shape> shapes[] = {box};
  EXPECT_TRUE(on_floor().replay(tape.bytes, shapes).same);
  for (std::size_t place = 0; place < tape.bytes.size(); place += 3) {
    Bytes damaged = tape.bytes;
    damaged[place] ^= std::byte(1 << place % 8);
    const std::string fault = message_of([&] { on_floor().replay(damaged, shapes); });
    EXPECT_TRUE(fault.starts_with(place < kRecordingMagic.size() ? "recording: found no LODEREC3"
                                                                 : "recording: found damage in chunk"))
        << place << " of " << tape.bytes.size() << ": " << fault;
  }
}

}  // namespace
}  // namespace lodestone
