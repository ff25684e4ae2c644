#include "tools/signature_report.h"

#include <fmt/format.h>

#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string text_of(const std::vector<RestPose>& poses) {
  TextTable table({"rest pose", "height over R", "frequency", "up in body"});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vec3& up = poses[i].normal;
    table.add_row({fmt::format("{}", i + 1), fmt::format("{:.4f}", poses[i].height), fmt::format("{:.4f}", poses[i].frequency),
                   fmt::format("{:.4f} {:.4f} {:.4f}", up.x(), up.y(), up.z())});
  }
  return table.text();
}

ordered_json json_of(const RestPose& pose) {
  return {{"normal", {pose.normal.x(), pose.normal.y(), pose.normal.z()}}, {"height_over_radius", pose.height}, {"frequency", pose.frequency}};
}

}  // namespace

std::string text_of(const Signature& signature, std::size_t bytes) {
  const SignatureSettings& settings = signature.settings;
  const ResponseTable& table = signature.bouncing;
  std::string text;
  text += fmt::format("shape        {} ({:016x})\n", signature.shape_name, signature.shape_hash);
  text += fmt::format("contact      restitution {}, friction {}\n", settings.law.restitution, settings.law.friction);
  text += fmt::format("trials       {} in {:.1f} s; seed {}; until the {}\n", signature.trials, signature.measuring_seconds, settings.seed,
                      settings.trial_end == TrialEnd::first_impulse ? "first impulse" : "body leaves the plane");
  text += fmt::format("responses    {} x {} x {} cells (theta, phi, alpha), bouncing and not\n", table.n_theta, table.n_phi, table.n_alpha);
  text += fmt::format("clips        {} of {} frames\n", signature.clips.size(), signature.clip_frames.size());
  text += fmt::format("size         {} bytes\n", bytes);
  text += fmt::format("rest poses   {} kept, {} above 5 %\n\n", signature.rest_poses.size(), signature.rest_poses_above_5_percent);
  return text + text_of(signature.rest_poses);
}

ordered_json json_of(const Signature& signature, std::size_t bytes) {
  const SignatureSettings& settings = signature.settings;
  ordered_json json;
  json["shape"] = signature.shape_name;
  json["shape_hash"] = fmt::format("{:016x}", signature.shape_hash);
  json["restitution"] = settings.law.restitution;
  json["friction"] = settings.law.friction;
  json["trials"] = signature.trials;
  json["seconds"] = signature.measuring_seconds;
  json["trials_per_s"] = signature.measuring_seconds > 0 ? ordered_json(double(signature.trials) / signature.measuring_seconds) : ordered_json(nullptr);
  json["bytes"] = bytes;
  json["held_out_ks"] = nullptr;  // not measured yet
  json["clips"] = signature.clips.size();
  json["rest_poses"] = ordered_json::array();
  for (const RestPose& pose : signature.rest_poses) json["rest_poses"].push_back(json_of(pose));
  return json;
}

}  // namespace lodestone
