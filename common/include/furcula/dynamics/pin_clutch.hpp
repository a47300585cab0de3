// A joint with a pin (dog) clutch behind its gear (document 000, section II): a pin in the link joins it to
// the motor's rotator, to a spring's rotator, or to neither.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// Everything as seen at the joint: the rotor's inertia times the gear ratio's square, its torque times the
/// ratio.
template <class T>
struct PinClutchParameters {
  // The link, a pendulum that hangs down at angle 0.
  T link_inertia_kgm2{},     ///< of the link about the joint
      link_gravity_nm{},     ///< gravity's torque on the horizontal link
      link_damping_nmspr{};  ///< viscous friction of the joint
  // The active rotator: rotor and gear. A passive link does not have their friction.
  T rotor_inertia_kgm2{},    ///< of rotor and gear
      gear_friction_nm{},    ///< dry friction of the gear
      gear_damping_nmspr{},  ///< viscous friction of the gear
      torque_limit_nm{};     ///< largest magnitude of the motor's torque
  // The spring rotator.
  T spring_inertia_kgm2{},        ///< of the rotator
      spring_stiffness_nmprad{},  ///< of the spring, in both directions
      spring_damping_nmspr{},     ///< viscous friction of the rotator
      spring_rest_rad{};          ///< angle at which the spring is relaxed
  // The pin.
  T play_rad{};         ///< clearance of an inserted pin to each side
  T chamfer_rad{};      ///< by which the pin may be further off where it enters
  T contact_nmprad{},   ///< stiffness of the contact of pin and hole
      contact_nmspr{};  ///< damping of the contact of pin and hole
  T pin_stroke_s{};     ///< time that the servo needs from the middle to either end
  T wedge_nm{};         ///< largest torque with which the servo, pushing over a chamfer, turns the rotators
  T pull_nm{};          ///< largest load under which the servo can pull the pin out
};

/// Classic Runge-Kutta steps of at most kLongestStep. Dry friction is smooth below kCreep.
template <class T>
class PinClutchJoint {
 public:
  /// Plain numbers: float or double.
  using V = ValueOf<T>;
  static constexpr V kLongestStep = V(2e-5);  ///< s
  static constexpr V kCreep = V(5e-3);        ///< rad/s, below which dry friction is smooth
  static constexpr V kEnters = V(0.2);        ///< share of the stroke at which the pin meets the hole
  static constexpr V kChamferEnds = V(0.4);   ///< share of the stroke at which the chamfer is passed

  /// A joint at reset(0, 0).
  explicit PinClutchJoint(const PinClutchParameters<T>& p) : p_(p) { reset(T(V(0)), T(V(0))); }

  /// The pin in the middle, the active rotator beside the link and at rest, the spring's at its rest.
  void reset(const T& link_rad, const T& link_radps) {
    s_ = {link_rad, link_radps, link_rad, T(V(0)), p_.spring_rest_rad, T(V(0))};
    pin_ = V(0);
  }

  /// Sets the link's angle and rate where another model moves it (give it a very large inertia here), rad and rad/s.
  void set_link(const T& rad, const T& radps) { s_[0] = rad, s_[1] = radps; }
  /// Sets the active rotator's angle and rate, rad and rad/s.
  void set_rotor(const T& rad, const T& radps) { s_[2] = rad, s_[3] = radps; }

  /// By `dt_s` >= 0 with the motor's torque and the servo's target held: 1 the active rotator, 0 the middle,
  /// -1 the spring's.
  void advance(const T& torque_nm, V pin_target, V dt_s) {
    const V most = value_of(p_.torque_limit_nm);
    torque_ = value_of(torque_nm) > most ? T(most) : value_of(torque_nm) < -most ? T(-most) : torque_nm;
    const int steps = static_cast<int>(dt_s / kLongestStep + V(0.999));
    mean_contact_ = T(V(0));
    for (int n = 0; n < steps; ++n) {
      const V h = dt_s / static_cast<V>(steps);
      move_pin(pin_target, h);
      const State a = rates(s_), at_b = along(s_, a, V(0.5) * h);
      const State b = rates(at_b), at_c = along(s_, b, V(0.5) * h);
      const State c = rates(at_c), at_d = along(s_, c, h);
      const State d = rates(at_d);
      mean_contact_ += (contact(s_) + V(2) * (contact(at_b) + contact(at_c)) + contact(at_d)) / V(6 * steps);
      for (std::size_t i = 0; i < s_.size(); ++i) s_[i] += h / V(6) * (a[i] + V(2) * (b[i] + c[i]) + d[i]);
    }
  }

  /// Angle of the link, rad.
  const T& link_rad() const { return s_[0]; }
  /// Rate of the link, rad/s.
  const T& link_radps() const { return s_[1]; }
  /// Angle of the active rotator, rad.
  const T& rotor_rad() const { return s_[2]; }
  /// Rate of the active rotator, rad/s.
  const T& rotor_radps() const { return s_[3]; }
  /// Angle of the spring rotator, rad.
  const T& spring_rad() const { return s_[4]; }
  /// Position of the pin: 1 in the active rotator, 0 in the middle, -1 in the spring rotator.
  V pin() const { return pin_; }
  /// Whether the pin is in the hole of the active rotator.
  bool in_rotor() const { return pin_ > kEnters; }
  /// Whether the pin is in the hole of the spring rotator.
  bool in_spring() const { return pin_ < -kEnters; }
  /// Torque of the pin on the link, N m.
  T contact_nm() const { return contact(s_); }
  /// Mean of that torque over the last advance(), N m.
  const T& mean_contact_nm() const { return mean_contact_; }
  /// The parameters.
  const PinClutchParameters<T>& parameters() const { return p_; }

  /// Kinetic, of gravity (0 hanging down) and of the springs, J.
  T energy() const {
    using std::cos;
    const T stretch = s_[4] - p_.spring_rest_rad;
    const T pressed = pressing(s_);
    return V(0.5) * (p_.link_inertia_kgm2 * s_[1] * s_[1] + p_.rotor_inertia_kgm2 * s_[3] * s_[3] +
                     p_.spring_inertia_kgm2 * s_[5] * s_[5] + p_.spring_stiffness_nmprad * stretch * stretch +
                     p_.contact_nmprad * pressed * pressed) +
           p_.link_gravity_nm * (V(1) - cos(s_[0]));
  }

 private:
  using State = std::array<T, 6>;  ///< angle and rate of link, active rotator, spring rotator

  static State along(const State& s, const State& rate, V h) {
    State out = s;
    for (std::size_t i = 0; i < s.size(); ++i) out[i] += h * rate[i];
    return out;
  }

  /// Way of a pin at `pin` either way in its hole, rad.
  T way(V pin) const {
    const V depth = pin < V(0) ? -pin : pin;
    if (depth >= kChamferEnds) return p_.play_rad;
    return p_.play_rad + p_.chamfer_rad * ((kChamferEnds - depth) / (kChamferEnds - kEnters));
  }
  T off(const State& s) const { return s[0] - (pin_ > V(0) ? s[2] : s[4]); }
  /// By which the pin presses into its hole's wall, rad; 0 where it does not.
  T pressing(const State& s) const {
    if (!in_rotor() && !in_spring()) return T(V(0));
    const T r = off(s);
    const T over = (value_of(r) < V(0) ? T(-r) : r) - way(pin_);
    return value_of(over) > V(0) ? over : T(V(0));
  }
  T contact(const State& s) const {
    const T pressed = pressing(s);
    if (!(value_of(pressed) > V(0))) return T(V(0));
    const bool ahead = value_of(off(s)) > V(0);
    const T closing = (ahead ? V(1) : V(-1)) * (s[1] - (pin_ > V(0) ? s[3] : s[5]));
    const T push = p_.contact_nmprad * pressed + p_.contact_nmspr * closing;  // a wall does not pull
    return value_of(push) > V(0) ? (ahead ? T(-push) : push) : T(V(0));
  }

  State rates(const State& s) const {
    using std::sin;
    using std::tanh;
    const T push = contact(s);
    const T on_rotor = in_rotor() ? T(-push) : T(V(0)), on_spring = in_spring() ? T(-push) : T(V(0));
    const T dry = p_.gear_friction_nm * tanh(T(s[3] / kCreep));
    return {s[1],
            (push - p_.link_gravity_nm * sin(s[0]) - p_.link_damping_nmspr * s[1]) / p_.link_inertia_kgm2,
            s[3],
            (torque_ + on_rotor - dry - p_.gear_damping_nmspr * s[3]) / p_.rotor_inertia_kgm2,
            s[5],
            (on_spring - p_.spring_stiffness_nmprad * (s[4] - p_.spring_rest_rad) -
             p_.spring_damping_nmspr * s[5]) /
                p_.spring_inertia_kgm2};
  }

  /// The servo moves at its speed, unless the pin stands on a rotator's face, has a wall beside it that it
  /// would have to push away too hard, or is held by what it carries.
  void move_pin(V target, V h) {
    const V step = h / value_of(p_.pin_stroke_s);
    const V wanted = target > pin_ + step ? pin_ + step : target < pin_ - step ? pin_ - step : target;
    if (wanted == pin_) return;
    const V now = pin_ < V(0) ? -pin_ : pin_, next = wanted < V(0) ? -wanted : wanted;
    if (next > kEnters && next > now) {
      const V r = value_of(s_[0] - (wanted > V(0) ? s_[2] : s_[4]));
      const V over = (r < V(0) ? -r : r) - value_of(way(wanted));
      const bool face = now <= kEnters && over > V(0);
      if (face || over * value_of(p_.contact_nmprad) > value_of(p_.wedge_nm)) return;
    }
    if (now > kEnters && next < now) {
      const V load = value_of(contact(s_));
      if ((load < V(0) ? -load : load) > value_of(p_.pull_nm)) return;
    }
    pin_ = wanted;
  }

  PinClutchParameters<T> p_;
  State s_{};
  V pin_{};
  T torque_{}, mean_contact_{};
};

/// A hip of the robot of 000 (gear 160, 220 N m [given]; a motor of 5e-5 kg m^2, the rest chosen).
template <class T>
constexpr PinClutchParameters<T> biped_hip() {
  PinClutchParameters<T> p;
  p.link_inertia_kgm2 = T(0.8);
  p.link_gravity_nm = T(20.0);
  p.link_damping_nmspr = T(0.05);
  p.rotor_inertia_kgm2 = T(5e-5 * 160.0 * 160.0);
  p.gear_friction_nm = T(8.0);
  p.gear_damping_nmspr = T(2.0);
  p.torque_limit_nm = T(220.0);
  p.spring_inertia_kgm2 = T(0.02);
  p.spring_stiffness_nmprad = T(60.0);
  p.spring_damping_nmspr = T(0.3);
  p.spring_rest_rad = T(0.1);
  p.play_rad = T(0.006);
  p.chamfer_rad = T(0.03);
  p.contact_nmprad = T(2e4);
  p.contact_nmspr = T(40.0);
  p.pin_stroke_s = T(0.06);
  p.wedge_nm = T(15.0);
  p.pull_nm = T(30.0);
  return p;
}

}  // namespace furcula::dynamics
