// Who takes part in a contact.
#pragma once

#include <compare>
#include <cstdint>

namespace lodestone {

/// A statistical body or a full one of the scene at hand, by its index there, or the ground. Whether it
/// sleeps, and so stands still, is a matter of its state.
class Participant {
 public:
  enum class Kind : std::uint8_t { statistical, full, ground };

  static Participant statistical(std::size_t index) { return {Kind::statistical, index}; }
  static Participant full(std::size_t index) { return {Kind::full, index}; }
  static Participant ground() { return {Kind::ground, 0}; }

  bool is_statistical() const { return kind() == Kind::statistical; }
  bool is_full() const { return kind() == Kind::full; }
  bool is_ground() const { return kind() == Kind::ground; }
  Kind kind() const { return Kind(code_ >> kIndexBits); }
  std::size_t index() const { return code_ & ((1u << kIndexBits) - 1); }
  friend auto operator<=>(Participant, Participant) = default;

 private:
  static constexpr int kIndexBits = 30;
  Participant(Kind kind, std::size_t index)
      : code_(std::uint32_t(kind) << kIndexBits | std::uint32_t(index)) {}
  std::uint32_t code_;
};

}  // namespace lodestone
