// The stage of sensing: from the true position to the measured one, whose encoder may slip and have a clock
// of its own, and from a touch-down to the switch's report.
#pragma once

#include <cmath>
#include <optional>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The position's encoder: scale about a reference height (the touch-down height), eccentricity, offset,
/// slip, clock. And the contact switch.
template <class T>
class Sensing {
 public:
  /// Plain numbers: float or double.
  using V = ValueOf<T>;

  /// With the sensing effects of `effects`; a scale error turns about `reference`, m or rad.
  Sensing(const Effects<T>& effects, const T& reference)
      : e_(effects),
        reference_(reference),
        ideal_(!e_.has(Effect::encoder_offset) && !e_.has(Effect::height_scale_error) &&
               !e_.has(Effect::height_eccentricity)) {}

  /// True if each position is measured as it is, at whatever instant.
  bool ideal() const { return ideal_; }

  /// What the encoder shows at a true position, without a slip; m or rad.
  T measured(const T& position) const { return ideal_ ? position : distorted(position); }

  /// Measured velocity over true velocity at a position.
  T gain(const T& position) const {
    T slope = T(V(1));
    if (ideal_) return slope;
    if (e_.has(Effect::height_scale_error)) slope = e_.value(Effect::height_scale_error);
    if (e_.has(Effect::height_eccentricity))
      slope += e_.value(Effect::height_eccentricity, 0) *
               (V(kTwoPi) / e_.value(Effect::height_eccentricity, 1)) * swing(position, true);
    return slope;
  }

  /// The position that is measured as this: by Newton steps, each of which carries the derivatives of T.
  /// Where an eccentricity turns the measured position back there are several or none; the result is near
  /// then.
  T position(const T& measured_position) const {
    if (ideal_) return measured_position;
    // Less than half of the gain between the swings would not converge from one to the next.
    const V least = V(0.6) * value_of(e_.value_or(Effect::height_scale_error, T(V(1))));
    T z = measured_position;
    for (int round = 0; round < 6; ++round) {
      T slope = gain(z);
      if (value_of(slope) < least) slope = T(least);
      z -= (measured(z) - measured_position) / slope;
    }
    return z;
  }

  /// measured(t) = true(t - skew): by how much the encoder's clock is behind that of the commands and of all
  /// else; nothing where it is the same clock.
  std::optional<T> skew_s() const {
    if (!e_.has(Effect::time_skew)) return std::nullopt;
    return e_.value(Effect::time_skew);
  }

  /// A slip is an event of each recording and not of the machine: where it is on, the instant and the step
  /// are those of one recording, and a fit takes the recording's own.
  bool slips() const { return e_.has(Effect::encoder_slip); }
  /// By how much the measured position is off at an instant.
  T slip(V time_s) const {
    return slips() && time_s >= value_of(e_.value(Effect::encoder_slip, 1))
               ? e_.value(Effect::encoder_slip, 0)
               : T(V(0));
  }

  /// By how much the contact switch reports late, s.
  T contact_delay_s() const { return e_.value_or(Effect::contact_delay, T(V(0))); }
  /// How much later the switch reports a touch-down than the measured position, which is off by `slipped`,
  /// falls through the reference with this measured velocity.
  T report_lag_s(V velocity, V slipped) const {
    T lag = contact_delay_s();
    if (e_.has(Effect::time_skew)) lag -= e_.value(Effect::time_skew);
    if (velocity < V(0)) {
      if (!ideal_) lag += (measured(reference_) - reference_) / velocity;
      lag += slipped / velocity;
    }
    return lag;
  }

 private:
  static constexpr double kTwoPi = 6.283185307179586;

  T distorted(const T& position) const {
    T z = position;
    if (e_.has(Effect::height_scale_error))
      z = reference_ + e_.value(Effect::height_scale_error) * (z - reference_);
    if (e_.has(Effect::height_eccentricity))
      z += e_.value(Effect::height_eccentricity, 0) * swing(position, false);
    if (e_.has(Effect::encoder_offset)) z += e_.value(Effect::encoder_offset);
    return z;
  }

  T swing(const T& z, bool slope) const {
    using std::cos;
    using std::sin;
    const T angle =
        V(kTwoPi) * z / e_.value(Effect::height_eccentricity, 1) + e_.value(Effect::height_eccentricity, 2);
    return slope ? T(cos(angle)) : T(sin(angle));
  }

  EffectsOf<T, Stage::sensing> e_;
  T reference_;
  bool ideal_;
};

}  // namespace furcula::dynamics
