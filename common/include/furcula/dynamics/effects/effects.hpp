// The effects that are switched on in a plant, with their parameters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "furcula/dynamics/effects/catalogue.hpp"

namespace furcula::dynamics {

/// Which effects are on and with what parameters, in the order of the catalogue's parameter tables.
template <class T>
class Effects {
 public:
  using Values = std::array<T, kMaxEffectParameters>;

  constexpr void set(Effect e, const Values& values) {
    active_ |= mask(e);
    values_[static_cast<std::size_t>(e)] = values;
  }
  constexpr void set(Effect e, std::size_t parameter, const T& value) {
    active_ |= mask(e);
    values_[static_cast<std::size_t>(e)][parameter] = value;
  }
  constexpr void clear(Effect e) { active_ &= ~mask(e); }
  constexpr bool has(Effect e) const { return (active_ & mask(e)) != 0; }
  constexpr bool any() const { return active_ != 0; }
  constexpr const T& value(Effect e, std::size_t parameter = 0) const {
    return values_[static_cast<std::size_t>(e)][parameter];
  }
  /// The effect's value if it is on, else the model's.
  constexpr T value_or(Effect e, const T& otherwise) const { return has(e) ? value(e) : otherwise; }

 private:
  static_assert(kEffectCount <= 64, "one bit an effect");
  static constexpr std::uint64_t mask(Effect e) { return std::uint64_t{1} << static_cast<unsigned>(e); }
  std::uint64_t active_ = 0;
  std::array<Values, kEffectCount> values_{};
};

}  // namespace furcula::dynamics
