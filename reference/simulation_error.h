// Where ODE itself cannot go on.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace lodestone {

/// ODE gave up in the middle of a step, by an assertion of its own, which no check foretold. Its world stands
/// where it stood then and is stepped no more: it can be read, and destroyed; each further step throws the
/// same. The message has ODE's words and names the body that they are most likely about.
class SimulationError : public std::runtime_error {
 public:
  explicit SimulationError(const std::string& message, std::optional<std::uint32_t> body = {})
      : std::runtime_error(message), body_(body) {}
  /// That body, by its BodyId::index where a manager's step throws, by its OdeBodyId's value where an
  /// OdeWorld does; none: one of the caller's own.
  std::optional<std::uint32_t> body() const { return body_; }

 private:
  std::optional<std::uint32_t> body_;
};

}  // namespace lodestone
