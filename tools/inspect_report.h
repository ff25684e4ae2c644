// All that a signature's file says, on a page for people and as JSON for programs: the report of
// signature_report.h, with what the file is made of.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "signature/signature.h"

namespace lodestone {

/// `bytes`: of its file.
std::string page_of(const Signature& signature, std::size_t bytes);
nlohmann::ordered_json full_json_of(const Signature& signature, std::size_t bytes);

}  // namespace lodestone
