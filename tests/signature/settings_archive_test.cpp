#include "signature/settings_archive.h"

#include <gtest/gtest.h>

#include <functional>

#include "signature/byte_archive.h"

namespace lodestone {
namespace {

std::vector<std::byte> bytes_of(const SignatureSettings& settings) {
  ByteWriter writer;
  writer(settings);
  return writer.bytes;
}

using Change = std::function<void(SignatureSettings&)>;

const std::vector<Change>& changes_of_each_field() {
  using S = SignatureSettings;
  static const std::vector<Change> changes = {[](S& s) { s.law.restitution = 0.7; },
                                              [](S& s) { s.law.friction = 0.9; },
                                              [](S& s) { s.trial_end = TrialEnd::first_impulse; },
                                              [](S& s) { s.paper_grid = true; },
                                              [](S& s) { s.n_theta = 5; },
                                              [](S& s) { s.n_phi = 5; },
                                              [](S& s) { s.n_alpha = 5; },
                                              [](S& s) { s.n_psi = 8; },
                                              [](S& s) { s.draw = ResponseDraw::empirical; },
                                              [](S& s) { s.trials_per_cell = 5; },
                                              [](S& s) { s.table_error = 0.01; },
                                              [](S& s) { s.most_trials_per_cell = 5; },
                                              [](S& s) { s.held_out_conditions = 5; },
                                              [](S& s) { s.height_samples = 5; },
                                              [](S& s) { s.height_trials = 5; },
                                              [](S& s) { s.settling_trials = 5; },
                                              [](S& s) { s.clips = 5; },
                                              [](S& s) { s.rest_pose_frequency_min = 0.05; },
                                              [](S& s) { s.seed = 5; }};
  return changes;
}

// Whatever a signature depends on names another file in the cache.
TEST(SettingsArchive, EachFieldChangesTheBytes) {
  const auto plain = bytes_of({});
  for (std::size_t i = 0; i < changes_of_each_field().size(); ++i) {
    SignatureSettings changed;
    changes_of_each_field()[i](changed);
    EXPECT_FALSE(changed == SignatureSettings{});
    EXPECT_NE(bytes_of(changed), plain) << i;
    for (std::size_t k = 0; k < i; ++k) {
      SignatureSettings other;
      changes_of_each_field()[k](other);
      EXPECT_NE(bytes_of(changed), bytes_of(other)) << i << ' ' << k;
    }
  }
}

TEST(SettingsArchive, AllFieldsComeBack) {
  SignatureSettings settings;
  for (const Change& change : changes_of_each_field()) change(settings);
  const auto bytes = bytes_of(settings);
  SignatureSettings read;
  ByteReader reader(bytes);
  reader(read);
  EXPECT_TRUE(reader.whole());
  EXPECT_TRUE(read == settings);
}

}  // namespace
}  // namespace lodestone
