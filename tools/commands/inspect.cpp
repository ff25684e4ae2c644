#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "signature/file_bytes.h"
#include "signature/signature_file.h"
#include "tools/commands.h"
#include "tools/height_plot.h"
#include "tools/results.h"
#include "tools/signature_report.h"

namespace lodestone {
namespace {

struct InspectArguments {
  std::filesystem::path file, svg;
  ResultArguments results;
};

void inspect(const InspectArguments& arguments) {
  const Signature signature = load_signature(arguments.file);
  const std::size_t bytes = std::filesystem::file_size(arguments.file);
  if (!arguments.svg.empty()) {
    const std::string svg = svg_plot(signature.collision_heights, signature.shape_name);
    write_atomically(std::as_bytes(std::span(svg)), arguments.svg);
  }
  print_results(arguments.results, full_json_of(signature, bytes), page_of(signature, bytes));
}

}  // namespace

void add_inspect_command(Command& program) {
  auto [command, arguments] =
      program.add<InspectArguments>("inspect", "say what a signature file holds", inspect);
  command.add_option("FILE", arguments.file, "a .sig file").required();
  command.add_option("--svg", arguments.svg, "draw the collision height over spin to this SVG file")
      .written();
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
