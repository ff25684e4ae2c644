#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/pages/page.h"
#include "tools/view/view_page.h"

namespace lodestone {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path page = "view.html";
  bool blind = false, json = false;
};

void view(const Arguments& arguments) {
  save_page(arguments.page, make_view_page(arguments.runs, arguments.blind));
  if (arguments.json)
    fmt::print("{}\n", nlohmann::ordered_json{{"page", arguments.page.string()},
                                              {"runs", arguments.runs.size()},
                                              {"bytes", std::filesystem::file_size(arguments.page)}}
                           .dump(2));
  else
    fmt::print("written      {}, for any browser\n", arguments.page.string());
}

}  // namespace

void add_view_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand("view", "a page that plays recorded runs, side by side");
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("RUN", arguments->runs, "folders that `lodestone run SCENE --out DIR` wrote: one to three")
      ->required()
      ->expected(1, 3);
  command->add_option("-o", arguments->page, "the page")->capture_default_str();
  command->add_flag("--blind", arguments->blind,
                    "a test: two runs without names, left and right at random; which is which?");
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    view(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
