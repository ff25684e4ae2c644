// Where ODE itself cannot go on.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace lodestone {

/// ODE gave up in the middle of a step, by an assertion of its own, which no check foretold. Its world stands
/// where it stood then and is stepped no more: it can be read, and destroyed. The message has ODE's words and
/// names the body that they are most likely about.
class SimulationError : public std::runtime_error {
 public:
  explicit SimulationError(const std::string& message, std::uint32_t body = 0)
      : std::runtime_error(message), body_(body) {}
  std::uint32_t body() const { return body_; }  ///< its OdeBodyId's value; 0: none of the world's own

 private:
  std::uint32_t body_;
};

}  // namespace lodestone
