// The effects that are switched on in a plant, with their parameters, and each stage's share of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "furcula/dynamics/effects/catalogue.hpp"

namespace furcula::dynamics {

template <class T, Stage kStage>
class EffectsOf;

/// Which effects are on and with what parameters, in the order of the catalogue's parameter tables. Whoever
/// sets up a plant fills it; the stages alone read it, each its own effects (EffectsOf).
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

 private:
  template <class, Stage>
  friend class EffectsOf;

  static_assert(kEffectCount <= 64, "one bit an effect");
  static constexpr std::uint64_t mask(Effect e) { return std::uint64_t{1} << static_cast<unsigned>(e); }
  std::uint64_t active_ = 0;
  std::array<Values, kEffectCount> values_{};
};

/// The name of an effect in the code of its stage. That of another stage does not compile, so that the
/// catalogue and the code cannot differ on where an effect sits.
template <Stage kStage>
class EffectIn {
 public:
  consteval EffectIn(Effect e) : slot_(0) {
    if (info(e).stage != kStage) the_catalogue_has_this_effect_in_another_stage();
    for (const EffectInfo& other : kCatalogue)
      if (other.effect < e && other.stage == kStage) ++slot_;
  }
  /// Its place among the stage's effects.
  constexpr std::size_t slot() const { return slot_; }

 private:
  static void the_catalogue_has_this_effect_in_another_stage();  // not constant: ends the compilation

  std::size_t slot_;
};

/// The effects of one stage that are switched on.
template <class T, Stage kStage>
class EffectsOf {
 public:
  using Name = EffectIn<kStage>;

  explicit constexpr EffectsOf(const Effects<T>& all) {
    std::size_t slot = 0;
    for (const EffectInfo& e : kCatalogue) {
      if (e.stage != kStage) continue;
      if ((all.active_ & Effects<T>::mask(e.effect)) != 0) {
        active_ |= std::uint64_t{1} << slot;
        values_[slot] = all.values_[static_cast<std::size_t>(e.effect)];
      }
      ++slot;
    }
  }

  constexpr bool has(Name e) const { return (active_ >> e.slot() & 1u) != 0; }
  constexpr bool any() const { return active_ != 0; }
  constexpr const T& value(Name e, std::size_t parameter = 0) const { return values_[e.slot()][parameter]; }
  constexpr const typename Effects<T>::Values& values(Name e) const { return values_[e.slot()]; }
  /// The effect's value if it is on, else the model's.
  constexpr T value_or(Name e, const T& otherwise) const { return has(e) ? value(e) : otherwise; }

 private:
  static constexpr std::size_t kCount = [] {
    std::size_t count = 0;
    for (const EffectInfo& e : kCatalogue) count += e.stage == kStage ? 1 : 0;
    return count;
  }();

  std::uint64_t active_ = 0;
  std::array<typename Effects<T>::Values, kCount> values_{};
};

}  // namespace furcula::dynamics
