// `lodestone report`: speed against error, budgets, the paper's table, hard cases and signatures on one page.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "signature/signature_source.h"
#include "tools/report/report_table.h"

namespace lodestone {

/// What was measured just now on one scene, in place of baselines or beside them.
struct FreshResults {
  std::string material;  ///< of the bodies that were dropped, as "restitution 0.4, friction 0.5"
  ReportTable scores;    ///< score_rows_of drops of the scene's first shape
  ReportTable steps;     ///< step_rows_of the demo
  ReportTable levels;    ///< level_rows_of the demo
};

struct ReportSettings {
  std::vector<std::string> shapes = {"box:0.2,0.3,0.4", "l:0.3,0.2,0.08,0.1",
                                     "bunny"};  ///< whose signatures are shown
  int threads = 0;                              ///< that measure them, and trials beside them; 0: all cores
  Progress progress = {};
  std::optional<FreshResults> fresh = {};
};

/// All that the page shows. Signatures come from the cache or are measured; throws InputError where they
/// cannot be.
nlohmann::ordered_json gather_report(const ReportSettings& settings);

/// The page that shows it.
std::string make_report(const nlohmann::ordered_json& data);

}  // namespace lodestone
