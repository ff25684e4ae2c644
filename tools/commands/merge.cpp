#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "signature/measure/measurement_part.h"
#include "signature/signature_file.h"
#include "tools/commands.h"
#include "tools/results.h"
#include "tools/signature_report.h"

namespace lodestone {
namespace {

struct MergeArguments {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path out;
  ResultArguments results;
};

void merge(const MergeArguments& arguments) {
  const Signature signature = merge_parts(arguments.parts);
  save_signature(signature, arguments.out);
  const std::size_t bytes = std::filesystem::file_size(arguments.out);
  nlohmann::ordered_json json = json_of(signature, bytes);
  json["file"] = arguments.out.string();
  print_results(arguments.results, json,
                fmt::format("file         {}\n{}", arguments.out.string(), text_of(signature, bytes)));
}

}  // namespace

void add_merge_command(Command& program) {
  auto [command, arguments] = program.add<MergeArguments>(
      "merge", "make a signature out of the parts that sign --shard measured", merge);
  command.add_option("FILES", arguments.parts, "every part, in any order").required();
  command.add_option("-o", arguments.out, "the signature's file").required();
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
