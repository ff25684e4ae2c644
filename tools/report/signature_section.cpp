#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "reference/material.h"
#include "scenes/shape_source.h"
#include "signature/measure/cell_trials.h"
#include "signature/measure/certify.h"
#include "signature/measure/measurement_shape.h"
#include "signature/measure/response_grid.h"
#include "tools/report/sections.h"
#include "tools/report/square_heights.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

constexpr int kConditions = 300;  // random ones, of kHeldOutTrials each
constexpr int kBins = 40;
constexpr int kSquareTrials = 4000;

double rounded(double value) { return std::round(1e5 * value) / 1e5; }

// Heights over R, at angles α = atan(R‖ω‖/‖v‖) from 0 to a quarter of a turn.
ordered_json json_of(const CollisionHeights& heights) {
  ordered_json json = {{"alpha_deg", ordered_json::array()},
                       {"mean", ordered_json::array()},
                       {"deviation", ordered_json::array()}};
  for (std::size_t i = 0; i < heights.mean.size(); ++i) {
    json["alpha_deg"].push_back(rounded(90.0 * double(i) / double(heights.mean.size() - 1)));
    json["mean"].push_back(rounded(heights.mean[i]));
    json["deviation"].push_back(rounded(heights.deviation[i]));
  }
  return json;
}

ordered_json square_json() {
  constexpr double kR = std::numbers::sqrt2 / 2;  // half the diagonal
  ordered_json json = {
      {"analytic", ordered_json::array()}, {"measured", ordered_json::array()}, {"trials", kSquareTrials}};
  const auto ratio_at = [](double degrees) {
    return std::tan(degrees * std::numbers::pi / 180.0) / kR;
  };  // ω/v in radians a side
  for (double degrees = 0.0; degrees < 89.6; degrees += 0.5)
    json["analytic"].push_back({rounded(degrees), rounded(mean_square_height(ratio_at(degrees)) / kR)});
  json["analytic"].push_back({90.0, 1.0});
  for (double degrees = 0.0; degrees < 89.0; degrees += 6.0)
    json["measured"].push_back(
        {rounded(degrees), rounded(measure_square_height(ratio_at(degrees), kSquareTrials) / kR)});
  return json;
}

// Shares of the values in kBins bins from `low` to `high`, times how many bins a unit has: a density.
ordered_json histogram_of(const std::vector<double>& values, double low, double high) {
  std::vector<double> bins(kBins);
  const double width = (high - low) / kBins;
  for (const double value : values)
    if (const int bin = int((value - low) / width); bin >= 0 && bin < kBins)
      bins[std::size_t(bin)] += 1.0 / (double(values.size()) * width);
  ordered_json json = ordered_json::array();
  for (const double bin : bins) json.push_back(rounded(bin));
  return json;
}

// Trials that are not in the tables, at random conditions, beside draws from the tables.
ordered_json responses_json(const Shape& shape, const Signature& signature) {
  const std::uint64_t seed =
      signature.settings.seed + 1;  // the certificate's own held-out trials are of the seed itself
  CollisionTrial trial(make_measurement_shape(shape), signature.settings.law, signature.settings.trial_end,
                       kAlwaysBounces);
  std::vector<HeldOutUnit> units;
  for (int i = 0; i < kConditions; ++i)
    units.push_back(
        measure_held_out(trial, held_out_condition(i, seed), i, seed, signature.bouncing.n_psi == 1));
  const HeldOutComparison compared = compare_held_out(units, TableKind::bouncing, signature);
  ordered_json json = {{"trials", compared.held_out[0].size()},
                       {"conditions", kConditions},
                       {"bins", kBins},
                       {"measures", ordered_json::array()}};
  for (std::size_t k = 0; k < 3; ++k) {
    static constexpr std::array kNames = {"speed away from the plane", "speed", "spin times R"};
    double high = 0.0;
    for (const auto* values : {&compared.drawn[k], &compared.held_out[k]}) {
      std::vector<double> sorted = *values;
      std::ranges::sort(sorted);
      high = std::max(high, sorted[std::size_t(0.995 * double(sorted.size()))]);
    }
    high = std::ceil(10.0 * high) / 10.0;
    json["measures"].push_back(
        {{"name", kNames[k]},
         {"high", high},
         {"trials", histogram_of(compared.held_out[k], 0.0, high)},
         {"draws", histogram_of(compared.drawn[k], 0.0, high)},
         {"ks", rounded(kolmogorov_smirnov(compared.drawn[k], compared.held_out[k]))}});
  }
  return json;
}

ordered_json mesh_json(const Shape& shape) {
  ordered_json json = {{"vertices", ordered_json::array()}, {"faces", ordered_json::array()}};
  for (const Vec3& vertex : shape.mesh.vertices)
    for (const double x : {vertex.x(), vertex.y(), vertex.z()})
      json["vertices"].push_back(std::round(1e4 * x / shape.radius) / 1e4);
  for (const auto& face : shape.mesh.faces)
    for (const int index : face) json["faces"].push_back(index);
  return json;
}

ordered_json poses_json(const Signature& signature) {
  ordered_json json = ordered_json::array();
  for (const RestPose& pose : signature.rest_poses)
    json.push_back(
        {{"normal", {rounded(pose.normal.x()), rounded(pose.normal.y()), rounded(pose.normal.z())}},
         {"height_over_radius", rounded(pose.height)},
         {"frequency", rounded(pose.frequency)}});
  return json;
}

ordered_json shape_json(const std::string& text, const ReportSettings& settings) {
  const Shape shape = make_shape_from_text(text);
  const Material material;
  SignatureSourceSettings source;
  source.threads = settings.threads;
  source.progress = settings.progress;
  source.warn = warn;
  const auto signature =
      find_or_measure_signature(shape, {material.restitution, material.friction}, source).signature;
  return {{"name", text},
          {"radius_m", rounded(shape.radius)},
          {"restitution", material.restitution},
          {"friction", material.friction},
          {"settling_trials", signature->settings.settling_trials},
          {"heights", json_of(signature->collision_heights)},
          {"responses", responses_json(shape, *signature)},
          {"rest_poses", poses_json(*signature)},
          {"mesh", mesh_json(shape)}};
}

}  // namespace

ordered_json signature_section(const ReportSettings& settings) {
  ordered_json section = {{"square", square_json()}, {"shapes", ordered_json::array()}};
  for (const std::string& shape : settings.shapes) section["shapes"].push_back(shape_json(shape, settings));
  return section;
}

}  // namespace lodestone
