#include "tools/inspect_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "signature/signature_file.h"
#include "tools/height_plot.h"
#include "tools/signature_report.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

// What the paper compares a signature with: the mesh as vertices of three floats and faces of three 32-bit
// indices, and seven spheres of four floats.
std::size_t mesh_bytes(const Signature& s) { return 12 * (std::size_t(s.mesh_vertices) + s.mesh_faces); }
constexpr std::size_t kSevenSpheresBytes = 7 * 4 * sizeof(float);

std::string text_of(const std::vector<SectionSize>& sections, std::size_t bytes) {
  TextTable table({"bytes of", "part", "bytes", "%"});
  for (const SectionSize& s : sections)
    table.add_row({s.group, s.name, fmt::format("{}", s.bytes),
                   fmt::format("{:.1f}", 100.0 * double(s.bytes) / double(bytes))});
  return table.text();
}

std::string comparison_of(const Signature& signature, std::size_t bytes) {
  TextTable table({"compared", "bytes"});
  table.add_row({"signature", fmt::format("{}", bytes)});
  table.add_row(
      {fmt::format("mesh of {} vertices and {} faces", signature.mesh_vertices, signature.mesh_faces),
       fmt::format("{}", mesh_bytes(signature))});
  table.add_row({"seven spheres", fmt::format("{}", kSevenSpheresBytes)});
  return table.text();
}

ordered_json json_of(const CollisionHeights& heights) {
  ordered_json json{{"spin_over_speed", ordered_json::array()},
                    {"mean", ordered_json::array()},
                    {"deviation", ordered_json::array()}};
  for (std::size_t i = 0; i < heights.mean.size(); ++i) {
    const bool last = i + 1 == heights.mean.size();  // at infinity, which JSON does not know
    const double alpha =
        heights.mean.size() > 1 ? std::numbers::pi / 2 * double(i) / double(heights.mean.size() - 1) : 0.0;
    json["spin_over_speed"].push_back(last ? ordered_json(nullptr) : ordered_json(std::tan(alpha)));
    json["mean"].push_back(heights.mean[i]);
    json["deviation"].push_back(heights.deviation[i]);
  }
  return json;
}

ordered_json json_of(const std::vector<SectionSize>& sections) {
  ordered_json json = ordered_json::array();
  for (const SectionSize& s : sections)
    json.push_back({{"group", s.group}, {"part", s.name}, {"bytes", s.bytes}});
  return json;
}

}  // namespace

std::string page_of(const Signature& signature, std::size_t bytes) {
  std::string page = fmt::format("versions     {}\n", signature.versions);
  page += text_of(signature, bytes) + "\n" + text_plot(signature.collision_heights) + "\n";
  return page + text_of(list_section_sizes(signature), bytes) + "\n" + comparison_of(signature, bytes);
}

ordered_json full_json_of(const Signature& signature, std::size_t bytes) {
  ordered_json json = json_of(signature, bytes);
  json["versions"] = signature.versions;
  json["format_version"] = kSignatureFormatVersion;
  json["seed"] = signature.settings.seed;
  json["collision_heights"] = json_of(signature.collision_heights);
  json["clip_frames"] = signature.clip_frames.size();
  json["sections"] = json_of(list_section_sizes(signature));
  json["mesh"] = {{"vertices", signature.mesh_vertices},
                  {"faces", signature.mesh_faces},
                  {"bytes", mesh_bytes(signature)}};
  json["seven_spheres_bytes"] = kSevenSpheresBytes;
  return json;
}

}  // namespace lodestone
