// What an expected exception says.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "reference/error.h"

namespace lodestone::testing {

inline constexpr const char* kNothingThrown = "no error";

/// The message of the `Fault` that `act` throws, or kNothingThrown.
template <typename Fault = InputError>
std::string message_of(const auto& act) {
  try {
    act();
  } catch (const Fault& fault) {
    return fault.what();
  }
  return kNothingThrown;
}

/// `message` without `head`, at which it must begin; kNothingThrown as it is.
inline std::string after_head(const std::string& message, const std::string& head) {
  if (message == kNothingThrown) return message;
  EXPECT_TRUE(message.starts_with(head)) << message;
  return message.substr(std::min(head.size(), message.size()));
}

}  // namespace lodestone::testing
