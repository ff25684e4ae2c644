#include "tools/signature_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "signature/signature_file.h"
#include "tools/height_plot.h"
#include "tools/results.h"
#include "tools/terminal.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct NamedTable {
  std::string_view name;
  std::int64_t cells;
  const TableCertificate& certificate;
};

std::vector<NamedTable> tables_of(const Signature& s) {
  if (s.by_speed.size() > 0) return {{"by_speed", s.by_speed.size(), s.by_speed_certificate}};
  return {{"bouncing", s.bouncing.size(), s.bouncing_certificate},
          {"non_bouncing", s.non_bouncing.size(), s.non_bouncing_certificate}};
}

std::string_view name_of(ResponseDraw draw) {
  switch (draw) {
    case ResponseDraw::independent:
      return "independent";
    case ResponseDraw::correlated:
      return "correlated";
    case ResponseDraw::empirical:
      return "empirical";
  }
  return "";
}

std::string text_of_axes(const Signature& s) {
  if (s.by_speed.size() > 0)
    return fmt::format("{} x {} x {} x {} cells (theta, phi, speed, spin)", s.by_speed.n_theta,
                       s.by_speed.n_phi, s.by_speed.speeds.size(), s.by_speed.spins.size());
  const ResponseTable& t = s.bouncing;
  return fmt::format("{} x {} x {} x {} cells (theta, phi, alpha, psi), bouncing and not", t.n_theta, t.n_phi,
                     t.n_alpha, t.n_psi);
}

std::string text_of_validity(const Signature& s) {
  if (s.by_speed.size() == 0) return "any speed and spin; theta up to 90 degrees";
  return fmt::format("speed {:.3g} to {:.3g} m/s, radius x spin up to {:.3g} m/s; theta up to 90 degrees",
                     s.by_speed.speeds.front(), s.by_speed.speeds.back(), s.by_speed.spins.back());
}

std::string text_of(const std::vector<NamedTable>& tables) {
  TextTable table({"table", "cells", "trials", "a cell", "std. error", "greatest", "held-out KS",
                   "held-out error", "into plane", "at first", "energy", "at first", "mean/dev. V"});
  for (const NamedTable& named : tables) {
    const TableCertificate& c = named.certificate;
    const auto known = [&](double figure, int digits) {
      return c.knows_first_impulse() ? fmt::format("{:.{}f}", figure, digits) : "-";
    };
    table.add_row({std::string(named.name), fmt::format("{}", named.cells), fmt::format("{}", c.trials),
                   c.fewest_trials == c.most_trials ? fmt::format("{}", c.most_trials)
                                                    : fmt::format("{}-{}", c.fewest_trials, c.most_trials),
                   fmt::format("{:.4f}", c.standard_error), fmt::format("{:.4f}", c.greatest_standard_error),
                   fmt::format("{:.4f}", c.held_out_ks), fmt::format("{:.4f}", c.held_out_error),
                   fmt::format("{:.4f}", c.into_plane), known(c.into_plane_first, 4),
                   known(c.energy_ratio, 3), known(c.energy_ratio_first, 3),
                   fmt::format("{:.3f}", c.mean_over_deviation)});
  }
  return table.text();
}

std::string text_of(const std::vector<RestPose>& poses) {
  TextTable table({"rest pose", "height over R", "frequency", "basin", "up in body"});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vec3& up = poses[i].normal;
    table.add_row({fmt::format("{}", i + 1), fmt::format("{:.4f}", poses[i].height),
                   fmt::format("{:.4f}", poses[i].frequency), fmt::format("{:.4f}", poses[i].basin),
                   fmt::format("{:.4f} {:.4f} {:.4f}", up.x(), up.y(), up.z())});
  }
  return table.text();
}

ordered_json json_of(const NamedTable& table) {
  const TableCertificate& c = table.certificate;
  const auto known = [&](double figure) {
    return c.knows_first_impulse() ? ordered_json(figure) : ordered_json(nullptr);
  };
  return {{"table", table.name},
          {"cells", table.cells},
          {"trials", c.trials},
          {"trials_missed", c.missed},
          {"fewest_trials", c.fewest_trials},
          {"most_trials", c.most_trials},
          {"uniform_trials", c.uniform_trials},
          {"standard_error", c.standard_error},
          {"greatest_standard_error", c.greatest_standard_error},
          {"held_out", c.held_out},
          {"held_out_ks", c.held_out_ks},
          {"held_out_error", c.held_out_error},
          {"into_plane_after_first_impulse", known(c.into_plane_first)},
          {"into_plane", c.into_plane},
          {"energy_ratio_after_first_impulse", known(c.energy_ratio_first)},
          {"energy_ratio", known(c.energy_ratio)},
          {"impulses", c.impulses},
          {"mean_over_deviation_v", c.mean_over_deviation}};
}

ordered_json json_of(const RestPose& pose) {
  return {{"normal", {pose.normal.x(), pose.normal.y(), pose.normal.z()}},
          {"height_over_radius", pose.height},
          {"frequency", pose.frequency},
          {"basin", pose.basin}};
}

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

// Of the settling trials, those that ended in a kept rest pose; none where there is none, as of a sphere.
std::optional<double> settled_fraction(const Signature& signature) {
  if (signature.rest_poses.empty()) return {};
  double settled = 0.0;
  for (const RestPose& pose : signature.rest_poses) settled += pose.frequency;
  return settled;
}

}  // namespace

std::string text_of(const Signature& signature, std::size_t bytes) {
  const SignatureSettings& settings = signature.settings;
  std::string text;
  text += fmt::format("shape        {} ({:016x})\n", printable(signature.shape_name), signature.shape_hash);
  text += fmt::format("contact      restitution {}, friction {}\n", settings.law.restitution,
                      settings.law.friction);
  text += fmt::format(
      "trials       {}{}; seed {}; until the {}\n", signature.trials,
      signature.measuring_seconds > 0.0 ? fmt::format(" in {:.1f} s", signature.measuring_seconds) : "",
      settings.seed,
      settings.trial_end == TrialEnd::first_impulse ? "first impulse" : "body leaves the plane");
  text += fmt::format("responses    {}; {} draws\n", text_of_axes(signature), name_of(settings.draw));
  text += fmt::format("valid for    {}\n", text_of_validity(signature));
  text += fmt::format(
      "support map  exact with the climb; without it {:.2g} R too low in the mean, {:.2g} R at worst\n",
      signature.support_map_error.mean, signature.support_map_error.greatest);
  text += fmt::format("clips        {} of {} frames\n", signature.clips.size(), signature.clip_frames.size());
  text += fmt::format("size         {} bytes\n", bytes);
  text += fmt::format("rest poses   {} kept, {} above 5 %", signature.rest_poses.size(),
                      signature.rest_poses_above_5_percent);
  if (const auto settled = settled_fraction(signature))
    text += fmt::format("; {:.1f} % of the drops came to rest in one of them", 100.0 * *settled);
  text += "\n\n";
  return text + text_of(tables_of(signature)) + "\n" + text_of(signature.rest_poses);
}

ordered_json json_of(const Signature& signature, std::size_t bytes) {
  const SignatureSettings& settings = signature.settings;
  ordered_json json;
  json["shape"] = signature.shape_name;
  json["shape_hash"] = fmt::format("{:016x}", signature.shape_hash);
  json["restitution"] = settings.law.restitution;
  json["friction"] = settings.law.friction;
  json["trials"] = signature.trials;
  json["seconds"] =
      signature.measuring_seconds > 0 ? ordered_json(signature.measuring_seconds) : ordered_json(nullptr);
  json["trials_per_s"] = signature.measuring_seconds > 0
                             ? ordered_json(double(signature.trials) / signature.measuring_seconds)
                             : ordered_json(nullptr);
  json["bytes"] = bytes;
  json["draw"] = name_of(settings.draw);
  double worst = 0.0;
  json["tables"] = ordered_json::array();
  for (const NamedTable& table : tables_of(signature)) {
    json["tables"].push_back(json_of(table));
    worst = std::max(worst, table.certificate.held_out_ks);
  }
  json["held_out_ks"] = worst;
  json["support_map_error"] = {{"mean_over_radius", signature.support_map_error.mean},
                               {"greatest_over_radius", signature.support_map_error.greatest}};
  json["clips"] = signature.clips.size();
  json["rest_poses"] = ordered_json::array();
  for (const RestPose& pose : signature.rest_poses) json["rest_poses"].push_back(json_of(pose));
  json["rest_poses_above_5_percent"] = signature.rest_poses_above_5_percent;
  json["settled_fraction"] = or_null(settled_fraction(signature));
  return json;
}

std::string page_of(const Signature& signature, std::size_t bytes) {
  std::string page = fmt::format("versions     {}\n", printable(signature.versions));
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
