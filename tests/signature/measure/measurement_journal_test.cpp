#include "signature/measure/measurement_journal.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "reference/error.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class Journal : public ::testing::Test {
 protected:
  static MeasurementIdentity identity(std::uint64_t seed = 1) {
    MeasurementIdentity identity;
    identity.versions = "test";
    identity.settings.seed = seed;
    identity.shape = make_shape("box", make_box({1, 1, 1}));
    identity.shape.mesh = {};
    return identity;
  }
  std::unique_ptr<MeasurementJournal> open(std::uint64_t seed = 1) const {
    return MeasurementJournal::try_open(file(), identity(seed));
  }
  fs::path file() const { return folder_ / "deeper" / "box.journal"; }
  void note_heights(int count) const {
    const auto journal = open();
    for (int i = 0; i < count; ++i) journal->note(UnitKind::height, i, HeightUnit{float(i), 0.5f});
  }
  // How many of the first ten are there.
  static int count_heights(MeasurementJournal& journal) {
    int count = 0;
    for (int i = 0; i < 10; ++i) {
      HeightUnit unit;
      if (!journal.take(UnitKind::height, i, unit)) continue;
      EXPECT_EQ(unit.mean, float(i));
      EXPECT_EQ(unit.deviation, 0.5f);
      ++count;
    }
    return count;
  }

 private:
  const testing::TemporaryFolder own_;
  const fs::path& folder_ = own_.path();
};

TEST_F(Journal, KeepsUnitsForTheNextSession) {
  note_heights(3);
  const auto journal = open();
  ASSERT_TRUE(journal);
  EXPECT_EQ(count_heights(*journal), 3);
  CellUnit cell;
  EXPECT_FALSE(journal->take(UnitKind::bouncing, 0, cell));  // another kind of the same number
  EXPECT_EQ(journal->trials_found(identity().settings),
            3U * std::uint64_t(identity().settings.height_trials));
}

TEST_F(Journal, UnitsOfThisSessionAreForTheNext) {
  const auto journal = open();
  journal->note(UnitKind::height, 0, HeightUnit{0.0f, 0.5f});
  EXPECT_EQ(count_heights(*journal), 0);
  EXPECT_EQ(journal->trials_found(identity().settings), 0U);
}

TEST_F(Journal, OneHolderAtATime) {
  auto first = open();
  ASSERT_TRUE(first);
  EXPECT_FALSE(open());
  first.reset();
  EXPECT_TRUE(open());
}

TEST_F(Journal, ARecordCutShortIsDropped) {
  note_heights(3);
  fs::resize_file(file(), fs::file_size(file()) - 1);
  EXPECT_EQ(count_heights(*open()), 2);
  {
    const auto journal = open();
    journal->note(UnitKind::height, 2, HeightUnit{2.0f, 0.5f});  // after the sound ones
  }
  EXPECT_EQ(count_heights(*open()), 3);
}

TEST_F(Journal, ADamagedRecordEndsWhatIsKept) {
  note_heights(3);
  const auto size = fs::file_size(file());
  {
    std::fstream damaged(file(), std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekg(std::streamoff(size) - 1);
    const char last = char(damaged.get());
    damaged.seekp(std::streamoff(size) - 1);
    damaged.put(char(last ^ 0x5a));  // another, whatever it was
  }
  EXPECT_EQ(count_heights(*open()), 2);
}

TEST_F(Journal, OneOfAnythingElseIsBegunAnew) {
  note_heights(3);
  EXPECT_EQ(count_heights(*open(2)), 0);
  EXPECT_EQ(count_heights(*open(1)), 0);  // it went with it
}

TEST_F(Journal, GoesOnCountingSeconds) {
  double before = 0.0;
  {
    const auto journal = open();
    before = journal->seconds();
    EXPECT_GE(before, 0.0);
    journal->note(UnitKind::height, 0, HeightUnit{0.0f, 0.5f});
  }
  EXPECT_GE(open()->seconds(), before);
}

TEST_F(Journal, IsGoneOnceRemoved) {
  const auto journal = open();
  EXPECT_TRUE(fs::exists(file()));
  journal->remove();
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(Journal, APlaceThatCannotBeWrittenIsAnInputError) {
  EXPECT_THROW(MeasurementJournal::try_open("/proc/nowhere/box.journal", identity()), InputError);
}

}  // namespace
}  // namespace lodestone
