#include "tools/signature_report.h"

#include <fmt/format.h>

#include <string_view>
#include <vector>

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
  for (const auto& [name, cells, c] : tables)
    table.add_row({std::string(name), fmt::format("{}", cells), fmt::format("{}", c.trials),
                   c.fewest_trials == c.most_trials ? fmt::format("{}", c.most_trials)
                                                    : fmt::format("{}-{}", c.fewest_trials, c.most_trials),
                   fmt::format("{:.4f}", c.standard_error), fmt::format("{:.4f}", c.greatest_standard_error),
                   fmt::format("{:.4f}", c.held_out_ks), fmt::format("{:.4f}", c.held_out_error),
                   fmt::format("{:.4f}", c.into_plane), fmt::format("{:.4f}", c.into_plane_first),
                   fmt::format("{:.3f}", c.energy_ratio), fmt::format("{:.3f}", c.energy_ratio_first),
                   fmt::format("{:.3f}", c.mean_over_deviation)});
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
          {"into_plane_after_first_impulse", c.into_plane_first},
          {"into_plane", c.into_plane},
          {"energy_ratio_after_first_impulse", c.energy_ratio_first},
          {"energy_ratio", c.energy_ratio},
          {"impulses", c.impulses},
          {"mean_over_deviation_v", c.mean_over_deviation}};
}

ordered_json json_of(const RestPose& pose) {
  return {{"normal", {pose.normal.x(), pose.normal.y(), pose.normal.z()}},
          {"height_over_radius", pose.height},
          {"frequency", pose.frequency},
          {"basin", pose.basin}};
}

}  // namespace

std::string text_of(const Signature& signature, std::size_t bytes) {
  const SignatureSettings& settings = signature.settings;
  std::string text;
  text += fmt::format("shape        {} ({:016x})\n", signature.shape_name, signature.shape_hash);
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
  text += fmt::format("rest poses   {} kept, {} above 5 %\n\n", signature.rest_poses.size(),
                      signature.rest_poses_above_5_percent);
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
  return json;
}

}  // namespace lodestone
