#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>

#include "signature/signature_file.h"
#include "signature/signature_source.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"
#include "tools/signature_report.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  SignatureArguments signature;
  std::filesystem::path out;
  int threads = 0;
  bool no_cache = false, json = false;
};

SourcedSignature find_signature(const Arguments& arguments, const Shape& shape) {
  ProgressLine line;
  SignatureSourceSettings source;
  source.measuring = arguments.signature.measuring();
  source.use_cache = !arguments.no_cache;
  source.threads = arguments.threads;
  source.progress = line.function();
  return find_or_measure_signature(shape, arguments.shape.law(), source);
}

// The lengths of a signature are over the radius; who signs a shape wants its own.
nlohmann::ordered_json json_of(const SourcedSignature& sourced, const Shape& shape) {
  nlohmann::ordered_json json = json_of(*sourced.signature, encode_signature(*sourced.signature).size());
  for (std::size_t i = 0; i < sourced.signature->rest_poses.size(); ++i)
    json["rest_poses"][i]["height_m"] = sourced.signature->rest_poses[i].height * shape.radius;
  json["cached"] = sourced.cached;
  json["file"] = sourced.file.string();
  return json;
}

void sign(const Arguments& arguments) {
  const auto shape = make_shape_from_arguments(arguments.shape);
  SourcedSignature sourced = find_signature(arguments, *shape);
  if (!arguments.out.empty()) {
    save_signature(*sourced.signature, arguments.out);
    sourced.file = arguments.out;
  }
  if (arguments.json) fmt::print("{}\n", json_of(sourced, *shape).dump(2));
  else fmt::print("file         {}{}\n{}", sourced.file.string(), sourced.cached ? " (cached)" : "",
                  text_of(*sourced.signature, encode_signature(*sourced.signature).size()));
}

}  // namespace

void add_sign_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand("sign", "measure a shape's statistical signature, or find it in the cache");
  const auto arguments = std::make_shared<Arguments>();
  add_shape_arguments(*command, arguments->shape);
  add_signature_arguments(*command, arguments->signature);
  command->add_option("-o", arguments->out, "write it to this file, too");
  command->add_flag("--no-cache", arguments->no_cache, "measure it anew and leave the cache alone");
  command->add_option("--threads", arguments->threads, "0: all cores")->check(CLI::Range(0, 4096))->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    sign(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
