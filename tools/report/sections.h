// The sections of the report's data, one each.
#pragma once

#include "tools/report/report.h"

namespace lodestone {

/// Speed against error: of each shape its noise floor, and every method at every step.
nlohmann::ordered_json curve_section(const std::optional<FreshResults>& fresh);

/// What a budget did step by step, fresh runs in place of baselines.
nlohmann::ordered_json budget_section(const std::optional<FreshResults>& fresh);

/// The paper's table 1, its figures beside ours.
nlohmann::ordered_json table1_section();

nlohmann::ordered_json hard_cases_section();

/// Collision heights, responses and rest poses of `settings.shapes`, and the collision heights of a square.
nlohmann::ordered_json signature_section(const ReportSettings& settings);

/// This machine and this program, and how each table of `data` was made.
nlohmann::ordered_json machine_section();

/// What the figures come to: `data` holds the other sections.
nlohmann::ordered_json headline_section(const nlohmann::ordered_json& data);

}  // namespace lodestone
