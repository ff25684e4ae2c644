#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "signature/measure/measurement_part.h"
#include "signature/signature_file.h"
#include "tools/commands.h"
#include "tools/signature_report.h"

namespace lodestone {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path out;
  bool json = false;
};

void merge(const Arguments& arguments) {
  const Signature signature = merge_parts(arguments.parts);
  save_signature(signature, arguments.out);
  const std::size_t bytes = std::filesystem::file_size(arguments.out);
  if (arguments.json) {
    nlohmann::ordered_json json = json_of(signature, bytes);
    json["file"] = arguments.out.string();
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("file         {}\n{}", arguments.out.string(), text_of(signature, bytes));
  }
}

}  // namespace

void add_merge_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command =
      program.add_subcommand("merge", "make a signature out of the parts that sign --shard measured");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILES", arguments->parts, "every part, in any order")->required();
  command->add_option("-o", arguments->out, "the signature's file")->required();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    merge(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
