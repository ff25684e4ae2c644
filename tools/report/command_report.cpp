#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/commands.h"
#include "tools/pages/page.h"
#include "tools/progress.h"
#include "tools/report/report.h"

namespace lodestone {
namespace {

struct Arguments {
  ReportSettings settings;
  std::filesystem::path out = "report.html";
  bool json = false;
};

void report(Arguments arguments) {
  nlohmann::ordered_json data;
  {
    ProgressLine line;
    arguments.settings.progress = line.function();
    data = gather_report(arguments.settings);
  }
  if (arguments.json) {
    fmt::print("{}\n", data.dump(2));
    return;
  }
  save_page(arguments.out, make_report(data));
  fmt::print("The report is in {}, for any browser\n", arguments.out.string());
}

}  // namespace

void add_report_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand(
      "report", "one page of HTML: speed against error, budgets, the paper's table, hard cases, signatures");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("-o,--out", arguments->out, "file for the page")->capture_default_str();
  command
      ->add_option("--shapes", arguments->settings.shapes, "whose signatures are shown; several with spaces")
      ->capture_default_str();
  command->add_option("--threads", arguments->settings.threads, "that measure signatures; 0: all cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_flag("--json", arguments->json,
                    "what the page shows as one JSON object on stdout, in place of the page");
  command->footer(
      "Figures that take long to measure are those of tests/baselines, each with its commit and machine; "
      "tools/baselines makes them anew.");
  command->callback([arguments, &exit_code] {
    report(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
