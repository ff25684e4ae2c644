// The error of a step in which ODE itself cannot go on.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace lodestone {

/// One of ODE's own assertions failed in the middle of a step; no check had foreseen it. ODE's world is left
/// as it was at that point: it can be read and destroyed, but each further step throws the same. The message
/// has ODE's words, and names the body that they are most likely about.
class SimulationError : public std::runtime_error {
 public:
  explicit SimulationError(const std::string& message, std::optional<std::uint32_t> body = {})
      : std::runtime_error(message), body_(body) {}
  /// That body: its BodyId::index if a manager's step throws, its OdeBodyId's value if an OdeWorld does.
  /// None: it is one of the caller's own.
  std::optional<std::uint32_t> body() const { return body_; }

 private:
  std::optional<std::uint32_t> body_;
};

}  // namespace lodestone
