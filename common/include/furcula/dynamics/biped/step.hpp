// Integration steps of the biped: semi-implicit Euler for simulation; explicit midpoint and fourth-order Runge-Kutta to check it.
//
// Semi-implicit Euler, of first order: velocities, then positions with the new velocities; 0.5 ms by default. With all vertices on the
// ground it is stable up to 5.2 ms while the motors are joined (docs/biped.md); 1 ms is usable.
#pragma once

#include "furcula/dynamics/biped/contact.hpp"
#include "furcula/dynamics/biped/joint_laws.hpp"

namespace furcula::dynamics::biped {

/// Default step of simulations.
inline constexpr double kStep_s = 5e-4;

/// Inputs of a step, constant over it.
template <class T>
struct Commands {
  Joints<T> target_rad;  ///< targets of the drives less the encoders' offsets
  /// [pass][LegClutch]: torque of a clutch's pin on its link, the opposite on its motor; read only in switched steps.
  PerLeg<T, std::array<LegScalar<T>, kClutches>> pin_nm;

  /// All zero.
  Commands() {
    const LegScalar<T> zero = LegScalar<T>(ValueOf<T>(0));
    for (auto& leg : target_rad) leg.fill(zero);
    for (auto& leg : pin_nm) leg.fill(zero);
  }
};

/// Torques, contact and accelerations at the beginning of a step, which the step applied.
template <class T>
struct StepReport {
  JointTorques<T> torque;               ///< of the joints
  PerLeg<T, Force<LegScalar<T>>> foot;  ///< [pass]: contact wrench about the foot's origin, in its axes
  FootContact<T> contact;               ///< normal forces and new anchors
  Accelerations<T> acceleration;        ///< of pelvis and joints
};

/// Advances positions, attitude and joint angles of `s` by its velocities over `h_s`. `pelvis_rotation` is that of `s`.
template <class T>
FURCULA_INLINE void drift(const Mat3<T>& pelvis_rotation, const T& h_s, State<T>& s) {
  s.position_m += pelvis_rotation * (s.v_mps * h_s);
  const Quaternion<T> d = rate(s.attitude, s.w_radps * h_s);
  s.attitude = normalised(
      Quaternion<T>{s.attitude.w + d.w, s.attitude.x + d.x, s.attitude.y + d.y, s.attitude.z + d.z});
  const LegScalar<T> h = LegScalar<T>(h_s);
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
    for (std::size_t j = 0; j < kLegJoints; ++j) s.q_rad[pass][j] += s.qd_radps[pass][j] * h;
}

/// Advances the motors behind open clutches: A qdd_r = clamp(kp (q - q_r) - kd qd_r, +-limit) - b qd_r - Fc sat(qd_r / vs) - pin.
/// They follow the link's angle `q_rad`, so that the pin can enter again. A joined motor gets its link's angle and rate.
template <class T>
FURCULA_INLINE void step_motors(const Parameters<T>& p, const JointLaws<T>& laws, const Joints<T>& q_rad,
                                const PerLeg<T, std::array<LegScalar<T>, kClutches>>& pin_nm, const T& h_s,
                                State<T>& s) {
  using L = LegScalar<T>;
  const L h = L(h_s), inverse_creep = L(ValueOf<T>(1) / p.creep_radps);
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
    for (std::size_t c = 0; c < kClutches; ++c) {
      const std::size_t j = kClutchJoints[c];
      const Drive<L>& d = p.drives[pass][j];
      L &q = s.rotors_rad[pass][c], &qd = s.rotors_radps[pass][c];
      const L motor = clamped(L(d.kp_nmprad * (q_rad[pass][j] - q) - d.kd_nmsprad * qd), d.limit_nm);
      const L dry = d.friction_nm * saturated(qd, inverse_creep);
      const L speed = qd + h * ((motor - d.damping_nmspr * qd - dry - pin_nm[pass][c]) / d.armature_kgm2);
      const auto& joined = laws[pass][j].joined;
      qd = select(joined, s.qd_radps[pass][j], speed);
      q = select(joined, s.q_rad[pass][j], L(q + h * speed));
    }
}

/// Writes torques, contact and accelerations at state `s` to `out`, and its kinematics to `k`.
template <bool kSwitched, class Topology, bool kHeld = false, class P, class T>
FURCULA_INLINE void evaluate(const P& p, const JointLaws<T>& laws, const Commands<T>& c, const State<T>& s,
                             Kinematics<T>& k, StepReport<T>& out) {
  kinematics<Topology>(p, s, k);
  Actions<T> act;
  contact(p, s, k, act.foot, out.contact);
  out.foot = act.foot;
  joint_torques<kSwitched>(p, s, laws, c.target_rad, out.torque);
  act.torque_nm = out.torque.joint_nm;
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
    for (std::size_t j = 0; j < kLegJoints; ++j) act.armature_kgm2[pass][j] = laws[pass][j].armature_kgm2;
    if constexpr (kSwitched)
      for (std::size_t i = 0; i < kClutches; ++i) act.torque_nm[pass][kClutchJoints[i]] += c.pin_nm[pass][i];
  }
  act.gravity_mps2 = p.gravity_mps2;
  forward_dynamics<Topology, kHeld>(p, s, k, act, out.acceleration);
}

/// One semi-implicit Euler step of length `h_s`. kSwitched: joints may be in modes other than active; motors behind open clutches move.
/// kHeld: a stand holds the pelvis.
template <bool kSwitched = false, class Topology = DesignTopology, bool kHeld = false, class P, class T>
void step(const P& p, const JointLaws<T>& laws, const Commands<T>& c, const T& h_s, State<T>& s,
          StepReport<T>& out) {
  Kinematics<T> k;
  evaluate<kSwitched, Topology, kHeld>(p, laws, c, s, k, out);
  kick(s, out.acceleration, h_s);
  const Joints<T> before = s.q_rad;
  drift(k.pelvis_rotation, h_s, s);
  if constexpr (kSwitched) step_motors(p, laws, before, c.pin_nm, h_s, s);
  s.anchors_m = out.contact.anchors_m;
}

/// Time derivative of a state.
template <class T>
struct StateRate {
  Vec3<T> position;           ///< m/s, world
  Quaternion<T> attitude;     ///< 1/s
  Accelerations<T> velocity;  ///< of w, v and qd
  Joints<T> q;                ///< rad/s

  /// Sum by components.
  friend StateRate operator+(const StateRate& a, const StateRate& b) {
    StateRate out{a.position + b.position,
                  {a.attitude.w + b.attitude.w, a.attitude.x + b.attitude.x, a.attitude.y + b.attitude.y,
                   a.attitude.z + b.attitude.z},
                  {a.velocity.wd_radps2 + b.velocity.wd_radps2, a.velocity.vd_mps2 + b.velocity.vd_mps2, {}},
                  {}};
    for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        out.velocity.qdd_radps2[pass][j] = a.velocity.qdd_radps2[pass][j] + b.velocity.qdd_radps2[pass][j];
        out.q[pass][j] = a.q[pass][j] + b.q[pass][j];
      }
    return out;
  }
};

/// s + r h_s; the attitude is not normalised.
template <class T>
State<T> along(const State<T>& s, const StateRate<T>& r, const T& h_s) {
  State<T> out = s;
  kick(out, r.velocity, h_s);
  out.position_m += r.position * h_s;
  out.attitude = {s.attitude.w + r.attitude.w * h_s, s.attitude.x + r.attitude.x * h_s,
                  s.attitude.y + r.attitude.y * h_s, s.attitude.z + r.attitude.z * h_s};
  const LegScalar<T> h = LegScalar<T>(h_s);
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
    for (std::size_t j = 0; j < kLegJoints; ++j) out.q_rad[pass][j] += r.q[pass][j] * h;
  return out;
}

/// Integration rule of check_step().
enum class Rule : unsigned char {
  midpoint,    ///< explicit, order 2
  runge_kutta  ///< classic, order 4
};

/// One step by kRule. The anchors are constant over the step and updated once after it, from the new state; motors behind open
/// clutches do not move.
template <Rule kRule, class Topology = DesignTopology, class P, class T>
void check_step(const P& p, const JointLaws<T>& laws, const Commands<T>& c, const T& h_s, State<T>& s) {
  using V = ValueOf<T>;
  Kinematics<T> k;
  StepReport<T> report;
  const auto rates = [&](const State<T>& at) {
    evaluate<true, Topology>(p, laws, c, at, k, report);
    return StateRate<T>{k.pelvis_rotation * at.v_mps, rate(at.attitude, at.w_radps), report.acceleration,
                        at.qd_radps};
  };
  const T half = h_s * V(0.5);
  const StateRate<T> a = rates(s), b = rates(along(s, a, half));
  if constexpr (kRule == Rule::midpoint) {
    s = along(s, b, h_s);
  } else {
    const StateRate<T> d = rates(along(s, b, half)), e = rates(along(s, d, h_s));
    s = along(along(s, a + e, T(h_s / V(6))), b + d, T(h_s / V(3)));
  }
  s.attitude = normalised(s.attitude);
  rates(s);
  s.anchors_m = report.contact.anchors_m;
}

}  // namespace furcula::dynamics::biped
