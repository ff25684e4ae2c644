// Which rungs are open to a body.
#pragma once

#include <initializer_list>

#include "lod/body.h"

namespace lodestone {

/// Never none of them.
class RungSet {
 public:
  constexpr RungSet(std::initializer_list<Rung> rungs) {
    for (const Rung rung : rungs) bits_ = std::uint8_t(bits_ | bit(rung));
  }
  constexpr bool has(Rung rung) const { return bits_ & bit(rung); }
  constexpr bool one() const { return (bits_ & (bits_ - 1)) == 0; }
  constexpr Rung lowest() const {
    return has(Rung::tables) ? Rung::tables : has(Rung::support) ? Rung::support : Rung::full;
  }
  constexpr Rung highest() const {
    return has(Rung::full) ? Rung::full : has(Rung::support) ? Rung::support : Rung::tables;
  }
  /// The highest that is no higher than `rung`; the lowest of all where there is none.
  constexpr Rung at_most(Rung rung) const {
    for (int i = int(rung); i >= 0; --i)
      if (has(Rung(i))) return Rung(i);
    return lowest();
  }
  /// Those that are in both; `other` alone where none are.
  constexpr RungSet within(RungSet other) const {
    const auto both = std::uint8_t(bits_ & other.bits_);
    if (both) other.bits_ = both;
    return other;
  }
  /// Of bodies that change rung together: those that are in both; where none are, the one that asks for more.
  constexpr RungSet together_with(RungSet other) const {
    if (bits_ & other.bits_) return within(other);
    return lowest() > other.lowest() ? *this : other;
  }
  /// For a body that `tables` cannot hold.
  constexpr RungSet with_support_for_tables() const {
    RungSet set = *this;
    if (has(Rung::tables)) set.bits_ = std::uint8_t((bits_ & ~bit(Rung::tables)) | bit(Rung::support));
    return set;
  }
  static constexpr RungSet between(Rung least, Rung greatest) {
    RungSet set{least};
    for (int i = int(least); i <= int(greatest); ++i) set.bits_ = std::uint8_t(set.bits_ | bit(Rung(i)));
    return set;
  }
  friend constexpr bool operator==(RungSet, RungSet) = default;

 private:
  static constexpr std::uint8_t bit(Rung rung) { return std::uint8_t(1u << unsigned(rung)); }
  std::uint8_t bits_ = 0;
};
inline constexpr RungSet kEveryRung{Rung::tables, Rung::support, Rung::full};

}  // namespace lodestone
