#include "tools/report/report.h"

#include "tools/pages/page.h"
#include "tools/report/sections.h"

namespace lodestone {

nlohmann::ordered_json gather_report(const ReportSettings& settings) {
  nlohmann::ordered_json data;
  data["machine"] = machine_section();
  data["curve"] = curve_section(settings.fresh);
  data["budget"] = budget_section(settings.fresh);
  data["table1"] = table1_section();
  data["hard_cases"] = hard_cases_section();
  data["signature"] = signature_section(settings);
  data["headline"] = headline_section(data);
  return data;
}

std::string make_report(const nlohmann::ordered_json& data) {
  return make_page("report.html", "Lodestone: speed against error", data);
}

}  // namespace lodestone
