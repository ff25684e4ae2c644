#include "tools/report/report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/pages/page.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct ReportArguments {
  ReportSettings settings;
  std::filesystem::path out = "report.html";
  ResultArguments results;
};

void report(const ReportArguments& arguments) {
  const nlohmann::ordered_json data = with_progress(arguments.settings, gather_report);
  if (arguments.results.json) {
    print_json(data);
    return;
  }
  save_page(arguments.out, make_report(data));
  fmt::print("The report is in {}, for any browser\n", arguments.out.string());
}

}  // namespace

void add_report_command(Command& program) {
  auto [command, arguments] = program.add<ReportArguments>(
      "report", "one page of HTML: speed against error, budgets, the paper's table, hard cases, signatures",
      report);
  const Option out = command.add_option("-o,--out", arguments.out, "file for the page").written();
  command.add_option("--shapes", arguments.settings.shapes,
                     "whose signatures are shown; several with spaces");
  command.add_option("--threads", arguments.settings.threads, "that measure signatures; 0: all cores")
      .within(0, 4096);
  command
      .add_flag("--json", arguments.results.json,
                "what the page shows as one JSON object on stdout, in place of the page")
      .excludes(out);
  command.add_footer(
      "Figures that take long to measure are those of tests/baselines, each with its commit and machine; "
      "tools/baselines makes them anew.");
}

}  // namespace lodestone
