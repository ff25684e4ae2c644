#include "signature/measure/response_grid.h"

#include <cmath>

namespace lodestone {
namespace {

constexpr int kPaperSpeeds = 26, kPaperSpins = 16, kPaperTrials = 30;
constexpr double kSlowest = 0.02, kFastest = 10.0, kFastestSpin = 5.0;  // m/s

void append_logarithmic(std::vector<float>& samples, double last, int count) {
  for (int i = 0; i < count; ++i)
    samples.push_back(float(kSlowest * std::pow(last / kSlowest, double(i) / (count - 1))));
}

}  // namespace

ResponseTable make_response_grid(const SignatureSettings& settings) {
  return {settings.n_theta, settings.n_phi, settings.n_alpha, settings.n_psi, {}};
}

SpeedTable make_speed_grid(const SignatureSettings& settings) {
  SpeedTable table{settings.n_theta, settings.n_phi, {}, {0.0f}, {}};
  append_logarithmic(table.speeds, kFastest, kPaperSpeeds);
  append_logarithmic(table.spins, kFastestSpin, kPaperSpins - 1);
  return table;
}

CellSampling make_cell_sampling(const SignatureSettings& settings) {
  return {.seed = settings.seed,
          .trials = settings.paper_grid ? kPaperTrials : settings.trials_per_cell,
          .error = settings.table_error,
          .most_trials = settings.most_trials_per_cell,
          .every_psi = settings.paper_grid || settings.n_psi == 1,
          .keep_responses = settings.draw == ResponseDraw::empirical};
}

}  // namespace lodestone
