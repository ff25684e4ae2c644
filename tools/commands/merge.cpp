#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "reference/error.h"
#include "reference/output_file.h"
#include "signature/measure/measurement_part.h"
#include "signature/signature_file.h"
#include "tools/commands.h"
#include "tools/compare/series_parts.h"
#include "tools/results.h"
#include "tools/signature_report.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct MergeArguments {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path out;
  ResultArguments results;
};

bool is_json(const std::filesystem::path& file) { return file.extension() == ".json"; }

ordered_json read_json(const std::filesystem::path& file) {
  if (const std::string fault = find_reading_fault(file); !fault.empty())
    throw_input_error(file.string(), fault, "a part of a comparison");
  std::ifstream in(file);
  ordered_json json = ordered_json::parse(in, nullptr, false);
  if (json.is_discarded()) throw_input_error(file.string(), "no JSON", "a part of a comparison");
  return json;
}

// Of a series of comparisons.
void merge_comparison(const MergeArguments& arguments) {
  std::vector<ordered_json> parts;
  std::vector<std::string> names;
  for (const auto& file : arguments.parts) parts.push_back(read_json(file)), names.push_back(file.string());
  const ordered_json merged = merge_series(parts, names);
  std::string text = fmt::format("{} rows in {}\n", merged["rows"].size(), arguments.out.string());
  if (!merged["rows"].empty() && merged["rows"][0].contains("materials"))
    text += '\n' + material_tables_of(merged);
  OutputFile out(arguments.out, "the comparison");
  out.write(merged.dump(2) + '\n');
  out.close();
  print_results(arguments.results, merged, text);
}

void merge(const MergeArguments& arguments) {
  if (std::ranges::any_of(arguments.parts, is_json)) return merge_comparison(arguments);
  const Signature signature = merge_parts(arguments.parts);
  save_signature(signature, arguments.out);
  const std::size_t bytes = encode_signature(signature).size();
  ordered_json json = json_of(signature, bytes);
  json["file"] = arguments.out.string();
  print_results(arguments.results, json,
                fmt::format("file         {}\n{}", arguments.out.string(), text_of(signature, bytes)));
}

}  // namespace

void add_merge_command(Command& program) {
  auto [command, arguments] = program.add<MergeArguments>(
      "merge", "join what --shard measured in parts: a signature, or the JSON of a comparison", merge);
  command.add_option("FILES", arguments.parts, "every part, in any order").required();
  command.add_option("-o", arguments.out, "the file of the signature, or of the comparison")
      .required()
      .written();
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
