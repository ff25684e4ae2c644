#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/compare/pile_report.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

struct ComparePileArguments {
  ShapeArguments shape;
  SignatureArguments signature;
  PileComparisonSettings comparison;
  std::vector<std::string> steps = {"1/60"};
  std::filesystem::path out;
  ResultArguments results;
};

void compare_pile(const ComparePileArguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  PileComparisonSettings settings = arguments.comparison;
  settings.measuring = arguments.signature.measuring();
  settings.dt_s = steps_of(arguments.steps);
  const PileComparison comparison =
      with_progress(settings, [&](const auto& with_line) { return compare_piles(job, with_line); });
  print_results(arguments.results, json_of(comparison), text_of(job, comparison));
  if (!arguments.out.empty()) save_piles(comparison, arguments.out);
}

}  // namespace

void add_compare_pile_command(Command& compare) {
  auto [pile, arguments] = compare.add<ComparePileArguments>(
      "pile", "bodies poured into a bin, by each method and by the truth", compare_pile);
  PileComparisonSettings& comparison = arguments.comparison;
  add_shape_arguments(pile, arguments.shape);
  add_signature_arguments(pile, arguments.signature);
  pile.add_option("--bodies", comparison.conditions.bodies, "in a pile").within(1, 10'000);
  pile.add_option("--side", comparison.conditions.side, "of the bin's square floor, m").within(1e-3, 1e3);
  pile.add_option("--seeds", comparison.piles, "piles of each method").within(1, 1000);
  add_steps_argument(pile, arguments.steps);
  add_methods_argument(pile, comparison.methods);
  pile.add_option("--check-truth", comparison.check_truth,
                  "the truth itself done finer, as rows beside the methods")
      .several()
      .one_of(finer_truth_names());
  add_starts_arguments(pile, comparison.seed, comparison.threads);
  pile.add_option("--out", arguments.out, "folder for piles.csv, one line a pile, and pile_energy.csv")
      .written_into();
  add_json_argument(pile, arguments.results);
}

}  // namespace lodestone
