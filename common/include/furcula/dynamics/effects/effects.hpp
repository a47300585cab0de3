// The effects that are switched on in a plant, with their parameters, and the effects of each stage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "furcula/dynamics/effects/catalogue.hpp"

namespace furcula::dynamics {

template <class T, Stage kStage>
class EffectsOf;

/// The effects that are on, and their parameters in the order of the catalogue's parameter tables. Filled by the code that
/// sets up a plant; read only by the stages, each its own effects (EffectsOf).
template <class T>
class Effects {
 public:
  /// Parameters of an effect in catalogue order, SI units; entries beyond its number of parameters are not used.
  using Values = std::array<T, kMaxEffectParameters>;

  /// Switches an effect on with these parameters.
  constexpr void set(Effect e, const Values& values) {
    active_ |= mask(e);
    values_[static_cast<std::size_t>(e)] = values;
  }
  /// Switches an effect on and sets one parameter by its index in the catalogue; the others keep their values (zero at first).
  constexpr void set(Effect e, std::size_t parameter, const T& value) {
    active_ |= mask(e);
    values_[static_cast<std::size_t>(e)][parameter] = value;
  }
  /// Switches an effect off.
  constexpr void clear(Effect e) { active_ &= ~mask(e); }

 private:
  template <class, Stage>
  friend class EffectsOf;

  static_assert(kEffectCount <= 64, "one bit an effect");
  static constexpr std::uint64_t mask(Effect e) { return std::uint64_t{1} << static_cast<unsigned>(e); }
  std::uint64_t active_ = 0;
  std::array<Values, kEffectCount> values_{};
};

/// The name of an effect in the code of its stage. An effect of another stage does not compile, so that catalogue and code
/// agree on the stage of each effect.
template <Stage kStage>
class EffectIn {
 public:
  /// From an effect of this stage, known at compile time.
  consteval EffectIn(Effect e) : slot_(0) {
    if (info(e).stage != kStage) the_catalogue_has_this_effect_in_another_stage();
    for (const EffectInfo& other : kCatalogue)
      if (other.effect < e && other.stage == kStage) ++slot_;
  }
  /// Its index among the stage's effects, in catalogue order.
  constexpr std::size_t slot() const { return slot_; }

 private:
  static void the_catalogue_has_this_effect_in_another_stage();  // not constant: ends the compilation

  std::size_t slot_;
};

/// The effects of one stage that are switched on.
template <class T, Stage kStage>
class EffectsOf {
 public:
  using Name = EffectIn<kStage>;  ///< an effect of this stage

  /// The stage's effects among `all`.
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

  /// Whether the effect is on.
  constexpr bool has(Name e) const { return (active_ >> e.slot() & 1u) != 0; }
  /// Whether any effect of the stage is on.
  constexpr bool any() const { return active_ != 0; }
  /// One parameter of an effect by its index in the catalogue; of no meaning where the effect is off.
  constexpr const T& value(Name e, std::size_t parameter = 0) const { return values_[e.slot()][parameter]; }
  /// All parameters of an effect; of no meaning where the effect is off.
  constexpr const typename Effects<T>::Values& values(Name e) const { return values_[e.slot()]; }
  /// The first parameter of the effect if it is on, else `otherwise`, the model's value.
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
