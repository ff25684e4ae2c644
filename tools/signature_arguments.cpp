#include "tools/signature_arguments.h"

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace lodestone {

SignatureSettings SignatureArguments::measuring() const {
  SignatureSettings measuring = settings;
  measuring.trial_end =
      trial_end.value_or(settings.paper_grid ? TrialEnd::first_impulse : TrialEnd::leaves_plane);
  return measuring;
}

void add_signature_arguments(CLI::App& command, SignatureArguments& arguments) {
  SignatureSettings& settings = arguments.settings;
  static const std::map<std::string, TrialEnd> kEnds{{"first-impulse", TrialEnd::first_impulse},
                                                     {"leaves-plane", TrialEnd::leaves_plane}};
  static const std::map<std::string, ResponseDraw> kDraws{{"independent", ResponseDraw::independent},
                                                          {"correlated", ResponseDraw::correlated},
                                                          {"empirical", ResponseDraw::empirical}};
  const std::string group = "Signature";
  command
      .add_flag("--paper-grid", settings.paper_grid,
                "responses over the paper's grid: theta 7, phi 10, speed 26, spin 16, 30 trials each")
      ->group(group);
  command
      .add_option("--trial-end", arguments.trial_end,
                  "when a collision is over; leaves-plane, but first-impulse on the paper's grid")
      ->transform(CLI::CheckedTransformer(kEnds))
      ->option_text("first-impulse|leaves-plane")
      ->group(group);
  command
      .add_option("--psi", settings.n_psi,
                  "cells of the azimuth of the spin about the velocity; 1: all in one, as the paper's are")
      ->check(CLI::Range(1, 64))
      ->capture_default_str()
      ->group(group);
  command.add_option("--draw", settings.draw, "how responses are drawn")
      ->transform(CLI::CheckedTransformer(kDraws))
      ->option_text("independent|correlated|empirical [independent]")
      ->group(group);
  command
      .add_option("--table-error", settings.table_error,
                  "more trials where a cell's mean has a greater standard error than this, over the speed; "
                  "0: the same number in each")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(group);
  command.add_option("--cell-trials", settings.trials_per_cell, "collisions in each cell of the tables")
      ->check(CLI::Range(2, 100'000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--height-trials", settings.height_trials,
                  "contacts for each sample of the collision height")
      ->check(CLI::Range(2, 10'000'000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--settling-trials", settings.settling_trials,
                  "drops to rest, for rest poses and settling clips")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str()
      ->group(group);
  command.add_option("--clips", settings.clips, "settling clips to keep")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str()
      ->group(group);
}

}  // namespace lodestone
