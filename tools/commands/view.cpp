#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "reference/error.h"
#include "tools/commands.h"
#include "tools/pages/page.h"
#include "tools/results.h"
#include "tools/view/view_page.h"

namespace lodestone {
namespace {

struct ViewArguments {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path page = "view.html";
  bool blind = false;
  ResultArguments results;
};

void view(const ViewArguments& arguments) {
  for (const std::filesystem::path& run : arguments.runs) {
    for (const std::filesystem::path& file : {playback_of(run), fork_of(run)}) {
      std::error_code error;  // one of them is not there
      if (std::filesystem::equivalent(file, arguments.page, error))
        throw_input_error(arguments.page.string(), "the run that it is to play", "another file for the page");
    }
  }
  const std::string page = make_view_page(arguments.runs, arguments.blind);
  save_page(arguments.page, page);
  print_results(arguments.results,
                {{"page", arguments.page.string()}, {"runs", arguments.runs.size()}, {"bytes", page.size()}},
                fmt::format("written      {}, for any browser\n", arguments.page.string()));
}

}  // namespace

void add_view_command(Command& program) {
  auto [command, arguments] =
      program.add<ViewArguments>("view", "a page that plays recorded runs, side by side", view);
  command
      .add_option("RUN", arguments.runs, "folders that `lodestone run SCENE --out DIR` wrote: one to three")
      .required()
      .words(1, 3);
  command.add_option("-o", arguments.page, "the page").written();
  command.add_flag("--blind", arguments.blind,
                   "a test: two runs without names, left and right at random; which is which?");
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
