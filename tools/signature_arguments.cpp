#include "tools/signature_arguments.h"

#include <charconv>
#include <string>
#include <string_view>

namespace lodestone {
namespace {

std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty() ? std::optional(number)
                                                                                   : std::nullopt;
}

std::optional<Share> share_from_text(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return {};
  const auto index = whole_number(text.substr(0, slash)), count = whole_number(text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count) return {};
  return Share{*index - 1, *count};
}

std::string find_share_fault(const std::string& text) {
  return share_from_text(text) ? "" : "found " + text + ", expected I/N with I from 1 to N";
}

}  // namespace

SignatureSettings SignatureArguments::measuring() const {
  SignatureSettings measuring = settings;
  measuring.trial_end =
      trial_end.value_or(settings.paper_grid ? TrialEnd::first_impulse : TrialEnd::leaves_plane);
  return measuring;
}

void add_signature_arguments(Command& command, SignatureArguments& arguments) {
  SignatureSettings& settings = arguments.settings;
  const std::string group = "Signature";
  const Option paper_grid =
      command
          .add_flag("--paper-grid", settings.paper_grid,
                    "responses over the paper's grid: theta 7, phi 10, speed 26, spin 16, 30 trials each")
          .in_group(group);
  command
      .add_choice<TrialEnd>(
          "--trial-end", arguments.trial_end,
          {{"first-impulse", TrialEnd::first_impulse}, {"leaves-plane", TrialEnd::leaves_plane}},
          "when a collision is over; leaves-plane, but first-impulse on the paper's grid")
      .shown_as("first-impulse|leaves-plane")
      .in_group(group);
  command
      .add_option("--psi", settings.n_psi,
                  "cells of the azimuth of the spin about the velocity; 1: all in one, as the paper's are")
      .within(1, 64)
      .excludes(paper_grid)
      .in_group(group);
  command
      .add_choice<ResponseDraw>("--draw", settings.draw,
                                {{"independent", ResponseDraw::independent},
                                 {"correlated", ResponseDraw::correlated},
                                 {"empirical", ResponseDraw::empirical}},
                                "how responses are drawn")
      .shown_as("independent|correlated|empirical [independent]")
      .in_group(group);
  command
      .add_option("--table-error", settings.table_error,
                  "more trials where a cell's mean has a greater standard error than this, over the speed; "
                  "0: the same number in each")
      .within(0.0, 1.0)
      .in_group(group);
  command.add_option("--cell-trials", settings.trials_per_cell, "collisions in each cell of the tables")
      .within(2, 100'000)
      .excludes(paper_grid)
      .in_group(group);
  command
      .add_option("--height-trials", settings.height_trials,
                  "contacts for each sample of the collision height")
      .within(2, 10'000'000)
      .in_group(group);
  command
      .add_option("--settling-trials", settings.settling_trials,
                  "drops to rest, for rest poses and settling clips")
      .within(1, 1'000'000)
      .in_group(group);
  command.add_option("--clips", settings.clips, "settling clips to keep").within(0, 100'000).in_group(group);
}

Option add_share_argument(Command& command, std::optional<Share>& share, const std::string& what) {
  return command
      .add_text(
          "--shard", [&share](const std::string& text) { share = share_from_text(text); }, what)
      .checked(find_share_fault)
      .typed("I/N");
}

}  // namespace lodestone
