#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>

#include "signature/signature_file.h"
#include "tools/commands.h"
#include "tools/signature_report.h"

namespace lodestone {
namespace {

struct Arguments {
  std::filesystem::path file;
  bool json = false;
};

void inspect(const Arguments& arguments) {
  const Signature signature = load_signature(arguments.file);
  const std::size_t bytes = std::filesystem::file_size(arguments.file);
  if (arguments.json) fmt::print("{}\n", json_of(signature, bytes).dump(2));
  else fmt::print("{}", text_of(signature, bytes));
}

}  // namespace

void add_inspect_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand("inspect", "say what a signature file holds");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "a .sig file")->required();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    inspect(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
