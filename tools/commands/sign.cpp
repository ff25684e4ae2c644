#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <utility>

#include "signature/measure/measurement_part.h"
#include "signature/measure/signature_from_trials.h"
#include "signature/signature_file.h"
#include "signature/signature_source.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/mesh_parts.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"
#include "tools/signature_report.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

struct SignArguments {
  ShapeArguments shape;
  SignatureArguments signature;
  std::filesystem::path out;
  int threads = 0;
  bool no_cache = false;
  ResultArguments results;
  std::optional<Share> share;
  std::filesystem::path from_trials, export_trials;
};

SignatureSettings settings_of(const SignArguments& arguments) {
  SignatureSettings settings = arguments.signature.measuring();
  settings.law = arguments.shape.law();
  return settings;
}

// Measuring that is interrupted stops where it is, with its units in the journal.
SignatureSourceSettings source_settings(const SignArguments& arguments, ProgressLine& line,
                                        std::stop_source& stop) {
  SignatureSourceSettings source;
  source.measuring = arguments.signature.measuring();
  source.use_cache = !arguments.no_cache;
  source.threads = arguments.threads;
  source.progress = [&](const std::string& stage, double fraction) {
    line.show(stage, fraction);
    if (is_interrupted()) stop.request_stop();
  };
  source.warn = warn;
  source.stop = stop.get_token();
  return source;
}

// What `measure` makes, past the cache, with how long it took.
template <class Measure>
SourcedSignature sign_now(Measure measure) {
  const auto start = std::chrono::steady_clock::now();
  Signature signature = measure();
  signature.measuring_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {.signature = std::make_shared<const Signature>(std::move(signature)), .file = {}};
}

SourcedSignature sign_from_trials(const SignArguments& arguments, const Shape& shape) {
  const MeasuredTrials trials = load_trials(arguments.from_trials);
  TrialCoverage coverage;
  ProgressLine line;
  const SourcedSignature sourced = sign_now([&] {
    return make_signature_from_trials(shape, settings_of(arguments), trials,
                                      {.threads = arguments.threads, .progress = line.function()}, &coverage);
  });
  write_stderr(fmt::format("{} collisions fill {} of {} cells; {} left out; {} rests. The rest is ODE's.\n",
                           coverage.collisions, coverage.measured_cells, coverage.cells, coverage.left_out,
                           coverage.rests));
  return sourced;
}

SourcedSignature sign_and_export(const SignArguments& arguments, const Shape& shape) {
  ProgressLine line;
  const SignatureSettings settings = settings_of(arguments);
  Measurement measurement;
  const SourcedSignature sourced = sign_now([&] {
    measurement =
        measure_units(shape, settings, {}, {.threads = arguments.threads, .progress = line.function()});
    return make_signature(shape, settings, measurement);
  });
  save_trials(list_trials(shape, settings, measurement, arguments.threads), arguments.export_trials);
  return sourced;
}

SourcedSignature find_signature(const SignArguments& arguments, const Shape& shape) {
  if (!arguments.from_trials.empty()) return sign_from_trials(arguments, shape);
  if (!arguments.export_trials.empty()) return sign_and_export(arguments, shape);
  ProgressLine line;
  std::stop_source stop;
  return find_or_measure_signature(shape, arguments.shape.law(), source_settings(arguments, line, stop));
}

// Of a mesh: what was mended in it, and what lies in it in an odd way and was left.
struct Repairs {
  MeshReport report;
  MeshParts parts;
  std::vector<std::pair<const char*, int>> counts() const {
    return {{"vertices_welded", report.vertices_welded},
            {"degenerate_faces_dropped", report.degenerate_faces_dropped},
            {"duplicate_faces_dropped", report.duplicate_faces_dropped},
            {"faces_flipped", report.faces_flipped},
            {"unused_vertices_dropped", report.unused_vertices_dropped},
            {"open_edges", report.open_edges},
            {"non_manifold_edges", report.non_manifold_edges},
            {"nested_parts", parts.nested},
            {"overlapping_parts", parts.overlapping}};
  }
};

nlohmann::ordered_json json_of(const Repairs& repairs) {
  nlohmann::ordered_json json = {{"components", repairs.report.components}};
  for (const auto& [name, count] : repairs.counts()) json[name] = count;
  return json;
}

// A line where there is something to say; not of vertices welded, since reading a file gives each face its
// own.
std::string text_of(const Repairs& repairs) {
  std::string text;
  for (const auto& [name, count] : repairs.counts()) {
    if (std::string_view(name) == "vertices_welded") continue;
    std::string words = name;
    std::ranges::replace(words, '_', ' ');
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "mesh         " : ", ", count, words);
  }
  return text.empty() ? "" : text + '\n';
}

// The lengths of a signature are over the radius; who signs a shape wants its own.
nlohmann::ordered_json json_of(const SourcedSignature& sourced, const Shape& shape) {
  nlohmann::ordered_json json = json_of(*sourced.signature, encode_signature(*sourced.signature).size());
  for (std::size_t i = 0; i < sourced.signature->rest_poses.size(); ++i)
    json["rest_poses"][i]["height_m"] = sourced.signature->rest_poses[i].height * shape.radius;
  json["cached"] = sourced.cached;
  json["trials_resumed"] = sourced.trials_resumed;
  json["file"] = sourced.file.string();
  return json;
}

// What a part knows: of the signature itself, nothing yet.
nlohmann::ordered_json json_of(const MeasurementPart& part, const std::filesystem::path& file) {
  const std::uint64_t trials = count_trials(part);
  nlohmann::ordered_json json;
  json["shape"] = part.identity.shape.name;
  json["shape_hash"] = fmt::format("{:016x}", part.identity.shape.content_hash);
  json["shard"] = fmt::format("{}/{}", part.identity.share.index + 1, part.identity.share.count);
  json["trials"] = trials;
  json["seconds"] = part.seconds;
  json["cached"] = false;
  json["trials_per_s"] = part.seconds > 0.0 ? nlohmann::ordered_json(double(trials) / part.seconds)
                                            : nlohmann::ordered_json(nullptr);
  json["bytes"] = encode_part(part).size();
  json["rest_poses"] = nlohmann::ordered_json::array();
  json["held_out_ks"] = nullptr;
  json["trials_resumed"] = part.trials_resumed;
  json["file"] = file.string();
  return json;
}

// Of a measurement that was interrupted; `trials` are in its journal.
void say_incomplete(const SignArguments& arguments, const Shape& shape, std::uint64_t trials) {
  print_results(
      arguments.results, {{"shape", shape.name}, {"trials", trials}, {"cached", false}, {"file", ""}},
      fmt::format("{}: {} trials are kept; the same command goes on from there\n", shape.name, trials));
}

void sign_share(const SignArguments& arguments, const Shape& shape) {
  MeasurementPart part;
  std::stop_source stop;
  {
    ProgressLine line;
    part = measure_part(shape, arguments.shape.law(), *arguments.share,
                        source_settings(arguments, line, stop), arguments.out);
  }
  if (stop.stop_requested()) return say_incomplete(arguments, shape, part.trials_resumed + part.trials_noted);
  print_results(
      arguments.results, json_of(part, arguments.out),
      fmt::format("part {} of {}: {} trials in {:.1f} s, in {}\n", arguments.share->index + 1,
                  arguments.share->count, count_trials(part), part.seconds, arguments.out.string()));
}

void sign(const SignArguments& arguments) {
  catch_interrupts();
  MeshReport report;
  const auto shape = make_shape_from_arguments(arguments.shape, &report);
  const Repairs repairs{report, report.components > 1 ? find_mesh_parts(shape->mesh) : MeshParts{}};
  if (arguments.share) return sign_share(arguments, *shape);
  SourcedSignature sourced = find_signature(arguments, *shape);
  if (!sourced.signature) return say_incomplete(arguments, *shape, sourced.trials_left);
  if (!arguments.out.empty()) {
    save_signature(*sourced.signature, arguments.out);
    sourced.file = arguments.out;
  }
  nlohmann::ordered_json json = json_of(sourced, *shape);
  if (report.components > 0) json["mesh"] = json_of(repairs);
  print_results(arguments.results, json,
                fmt::format("file         {}{}\n{}{}", sourced.file.string(),
                            sourced.cached ? " (cached)" : "", text_of(repairs),
                            text_of(*sourced.signature, encode_signature(*sourced.signature).size())));
}

}  // namespace

void add_sign_command(Command& program) {
  auto [command, arguments] = program.add<SignArguments>(
      "sign", "measure a shape's statistical signature, or find it in the cache", sign);
  add_shape_arguments(command, arguments.shape);
  add_signature_arguments(command, arguments.signature);
  Option out = command.add_option("-o", arguments.out, "write it to this file, too").written();
  Option shard =
      add_share_argument(command, arguments.share,
                         "measure one share of the trials, the I-th of N; -o names its part (see merge)")
          .needs(out);
  Option from = command
                    .add_option("--from-trials", arguments.from_trials,
                                "make its tables of the measured collisions and rests in this CSV file")
                    .excludes(shard);
  command
      .add_option("--export-trials", arguments.export_trials,
                  "measure it anew and write the trials to this CSV file")
      .written()
      .excludes(shard)
      .excludes(from);
  command.add_option("--seed", arguments.signature.settings.seed, "of every random draw of the measuring");
  command.add_flag("--no-cache", arguments.no_cache, "measure it anew and leave the cache alone");
  command.add_option("--threads", arguments.threads, "0: all cores").within(0, 4096);
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
