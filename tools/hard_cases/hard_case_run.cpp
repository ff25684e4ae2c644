#include "tools/hard_cases/hard_case_run.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>

#include "reference/allowed_threads.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

std::vector<HardCase> choose_cases(std::span<const std::string> only) {
  std::vector<HardCase> chosen;
  for (const HardCase& one : hard_cases())
    if (only.empty() || std::ranges::find(only, one.id) != only.end()) chosen.push_back(one);
  return chosen;
}

}  // namespace

std::vector<HardCaseResult> run_hard_cases(const HardCaseRunSettings& settings) {
  const std::vector<HardCase> chosen = choose_cases(settings.only);
  std::vector<HardCaseResult> results(chosen.size());
  std::atomic<int> done = 0;
  const auto measure = [&](std::size_t i) {
    results[i] = {std::string(chosen[i].id), chosen[i].measure(settings.cases)};
    if (settings.progress)
      settings.progress(results[i].id + " measured", double(++done) / double(chosen.size()));
  };

  tbb::task_arena arena(allowed_threads(settings.threads));
  until_interrupted([&] {
    arena.execute([&] {
      tbb::parallel_for(
          std::size_t(0), chosen.size(),
          [&](std::size_t i) {
            if (!chosen[i].alone) measure(i);
          },
          tbb::simple_partitioner());
    });
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i].alone) measure(i);
  });
  std::erase_if(results,
                [](const HardCaseResult& result) { return result.id.empty(); });  // those not come to
  return results;
}

}  // namespace lodestone
