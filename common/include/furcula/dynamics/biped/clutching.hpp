// A clutch that closes: the plastic impact between motor and link, and the insertion of the pin into its hole.
#pragma once

#include "furcula/dynamics/biped/step.hpp"
#include "furcula/dynamics/pin_clutch.hpp"

namespace furcula::dynamics::biped {

/// The change of all velocities by a unit impulse (1 N m s) at joint `j` of leg `side`: M^-1 e_j, M with the armatures of `laws`.
template <class Topology = DesignTopology, class P, class T>
Accelerations<T> unit_response(const P& p, const JointLaws<T>& laws, const State<T>& s, std::size_t side,
                               std::size_t j) {
  using V = ValueOf<T>;
  using L = LegScalar<T>;
  State<T> rest = s;
  const T zero = T(V(0));
  const Vec3<T> none{zero, zero, zero};
  const L still = L(V(0));
  rest.w_radps = rest.v_mps = none;
  Actions<T> act;
  act.gravity_mps2 = none;
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
    rest.qd_radps[pass].fill(still);
    act.torque_nm[pass].fill(still);
    act.foot[pass] = {{still, still, still}, {still, still, still}};
    for (std::size_t i = 0; i < kLegJoints; ++i) act.armature_kgm2[pass][i] = laws[pass][i].armature_kgm2;
  }
  Legs<T>::write(act.torque_nm[Legs<T>::pass(side)][j], side, T(V(1)));
  return accelerations<Topology>(p, rest, act);
}

/// Joins the motor behind the open clutch `c` to its link, in the robots `robots` of the SIMD batch: the impulse
///   L = (qd_r - qd_j) / (1/A + (M^-1)_jj)
/// on the link, its opposite on the motor, gives both the same speed. The mode is then active; the motor's angle is set to the link's.
/// Returns the energy lost in the impact, L (qd_r - qd_j) / 2, J. (M^-1)_jj is not the joint's term of the articulated-body algorithm,
/// which holds for a parent at rest.
template <class Topology = DesignTopology, class P, class T>
T engage(const P& p, std::size_t side, LegClutch c, JointLaws<T>& laws, State<T>& s,
         const MaskOf<T>& robots = all_of<T>()) {
  using V = ValueOf<T>;
  const std::size_t pass = Legs<T>::pass(side), j = kClutchJoints[c];
  const Accelerations<T> unit = unit_response<Topology>(p, laws, s, side, j);
  const T mobility = Legs<T>::read(unit.qdd_radps2[pass][j], side);
  const T apart = Legs<T>::read(s.rotors_radps[pass][c], side) - Legs<T>::read(s.qd_radps[pass][j], side);
  const T armature = Legs<T>::read(p.drives[pass][j].armature_kgm2, side);
  const T impulse = select(robots, T(apart / (V(1) / armature + mobility)), T(V(0)));
  kick(s, unit, impulse);
  set_mode(p, side, c, Mode::active, laws, s, robots);
  const auto which = detail::lanes_of<T>(side, robots);
  s.rotors_rad[pass][c] = select(which, s.q_rad[pass][j], s.rotors_rad[pass][c]);
  s.rotors_radps[pass][c] = select(which, s.qd_radps[pass][j], s.rotors_radps[pass][c]);
  return impulse * apart * V(0.5);
}

/// A pin that enters: the joint's clutch (pin_clutch.hpp) is integrated in steps of 20 us within each step of the robot, with the
/// link's motion prescribed. For one robot, not for SIMD batches; the joint's mode is `engaging`.
template <class T>
class Engaging {
 public:
  using V = ValueOf<T>;  ///< the plain number behind the scalar T

  /// For clutch `c` of leg `side`, with link and motor as in `s`. Of `pin` the link's inertia, gravity and damping and the motor's
  /// numbers are replaced: the robot gives them.
  Engaging(const Parameters<T>& p, const PinClutchParameters<T>& pin, std::size_t side, LegClutch c,
           const State<T>& s)
      : side_(side),
        c_(c),
        drive_(p.drives[Legs<T>::pass(side)][joint()]),
        clutch_(with_drive(drive_, pin, side)) {
    clutch_.reset(angle(s), rate_of(s));
    clutch_.set_rotor(rotor(s), rotor_rate(s));
  }

  /// Before a step `h_s` of the robot: integrates the clutch and writes the pin's mean torque on the link over the step to `c`. The
  /// servo drives the pin towards the motor's rotator.
  void before_step(const State<T>& s, const T& h_s, Commands<T>& c) {
    clutch_.set_link(angle(s), rate_of(s));
    const T kp = read(drive_.kp_nmprad), kd = read(drive_.kd_nmsprad);
    clutch_.advance(T(kp * (angle(s) - clutch_.rotor_rad()) - kd * clutch_.rotor_radps()), V(1),
                    value_of(h_s));
    Legs<T>::write(c.pin_nm[pass()][c_], side_, clutch_.mean_contact_nm());
  }
  /// After the step: writes the motor's angle and rate to `s`.
  void after_step(State<T>& s) const {
    Legs<T>::write(s.rotors_rad[pass()][c_], side_, clutch_.rotor_rad());
    Legs<T>::write(s.rotors_radps[pass()][c_], side_, clutch_.rotor_radps());
  }
  /// Whether the pin is fully in: the motor can be joined (engage).
  bool is_in() const { return clutch_.pin() >= V(1); }
  /// The clutch's own simulation.
  const PinClutchJoint<T>& clutch() const { return clutch_; }

 private:
  std::size_t pass() const { return Legs<T>::pass(side_); }
  std::size_t joint() const { return kClutchJoints[c_]; }
  T read(const LegScalar<T>& x) const { return Legs<T>::read(x, side_); }
  T angle(const State<T>& s) const { return read(s.q_rad[pass()][joint()]); }
  T rate_of(const State<T>& s) const { return read(s.qd_radps[pass()][joint()]); }
  T rotor(const State<T>& s) const { return read(s.rotors_rad[pass()][c_]); }
  T rotor_rate(const State<T>& s) const { return read(s.rotors_radps[pass()][c_]); }

  /// The pin's own numbers, with this joint's motor, and a link that nothing here moves.
  static PinClutchParameters<T> with_drive(const Drive<LegScalar<T>>& d, PinClutchParameters<T> pin,
                                           std::size_t side) {
    pin.link_inertia_kgm2 = T(V(1e30));
    pin.link_gravity_nm = pin.link_damping_nmspr = T(V(0));
    pin.rotor_inertia_kgm2 = Legs<T>::read(d.armature_kgm2, side);
    pin.gear_friction_nm = Legs<T>::read(d.friction_nm, side);
    pin.gear_damping_nmspr = Legs<T>::read(d.damping_nmspr, side);
    pin.torque_limit_nm = Legs<T>::read(d.limit_nm, side);
    return pin;
  }

  std::size_t side_;
  LegClutch c_;
  Drive<LegScalar<T>> drive_;
  PinClutchJoint<T> clutch_;
};

}  // namespace furcula::dynamics::biped
