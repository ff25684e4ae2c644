#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "signature/file_bytes.h"
#include "signature/signature_file.h"
#include "tools/commands.h"
#include "tools/height_plot.h"
#include "tools/inspect_report.h"

namespace lodestone {
namespace {

struct Arguments {
  std::filesystem::path file, svg;
  bool json = false;
};

void inspect(const Arguments& arguments) {
  const Signature signature = load_signature(arguments.file);
  const std::size_t bytes = std::filesystem::file_size(arguments.file);
  if (!arguments.svg.empty()) {
    const std::string svg = svg_plot(signature.collision_heights, signature.shape_name);
    write_atomically(std::as_bytes(std::span(svg)), arguments.svg);
  }
  if (arguments.json)
    fmt::print("{}\n", full_json_of(signature, bytes).dump(2));
  else
    fmt::print("{}", page_of(signature, bytes));
}

}  // namespace

void add_inspect_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand("inspect", "say what a signature file holds");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "a .sig file")->required();
  command->add_option("--svg", arguments->svg, "draw the collision height over spin to this SVG file");
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    inspect(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
