// A signature as text for people and as JSON for programs.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "signature/signature.h"

namespace lodestone {

/// `bytes`: of its file.
std::string text_of(const Signature& signature, std::size_t bytes);
nlohmann::ordered_json json_of(const Signature& signature, std::size_t bytes);

/// `bytes`: of its file.
std::string page_of(const Signature& signature, std::size_t bytes);
nlohmann::ordered_json full_json_of(const Signature& signature, std::size_t bytes);

}  // namespace lodestone
