// The torque of each joint's drive, clutch or brake: one equation whose coefficients depend on the joint's mode, so that a step has no
// branch on the mode.
//
//   tau = clamp(kp (target - q) - kd qd, +-limit) - damping qd - friction sat(qd / creep)
//
// active: the drive's coefficients, target commanded; passive: a spring about its rest; released: damping only; braked: stiff about the
// angle at which the brake closed; engaging: as released, plus the pin's torque (clutching.hpp). While the motor is not joined to the
// link, its armature, friction and drive do not act on the link.
#pragma once

#include "furcula/dynamics/biped/parameters.hpp"
#include "furcula/dynamics/biped/state.hpp"

namespace furcula::dynamics::biped {

/// What acts on a joint with a clutch (see above).
enum class Mode : unsigned char {
  active,    ///< the motor is joined to the link and driven
  passive,   ///< a spring about its rest angle
  released,  ///< damping only
  braked,    ///< held at the angle at which the brake closed
  engaging   ///< as released, while the clutch's pin enters
};

/// Coefficients of the equation above for a joint in its mode.
template <class L>
struct JointLaw {
  L armature_kgm2{},    ///< reflected rotor inertia of a joined motor, else 0
      damping_nmspr{},  ///< viscous
      friction_nm{},    ///< Coulomb friction of gear and motor
      kp_nmprad{},      ///< stiffness of drive, spring or brake
      kd_nmsprad{},     ///< damping of drive or brake, within the limit
      limit_nm{};       ///< largest torque of drive or brake; 1e30: none
  L rest_rad{};         ///< target where it is not commanded
  MaskOf<L> joined{};   ///< the motor is joined to the link: the target is commanded
};

/// [pass][joint]: the coefficients of all joints.
template <class T>
using JointLaws = PerLeg<T, std::array<JointLaw<LegScalar<T>>, kLegJoints>>;

/// The coefficients with all joints active.
template <class T>
JointLaws<T> active_laws(const Parameters<T>& p) {
  using L = LegScalar<T>;
  JointLaws<T> out;
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const Drive<L>& d = p.drives[pass][j];
      out[pass][j] = {d.armature_kgm2, d.damping_nmspr, d.friction_nm,    d.kp_nmprad,
                      d.kd_nmsprad,    d.limit_nm,      L(ValueOf<T>(0)), all_of<L>()};
    }
  return out;
}

namespace detail {

/// Mask of a leg's numbers that belong to `side` and `robots`: one entry of a SIMD pair, or `robots` where the legs are passes.
template <class T>
FURCULA_INLINE MaskOf<LegScalar<T>> lanes_of([[maybe_unused]] std::size_t side, const MaskOf<T>& robots) {
  if constexpr (std::is_same_v<LegScalar<T>, T>) {
    return robots;
  } else {
    LegScalar<T> is = LegScalar<T>(ValueOf<T>(0));
    is.set(side, robots ? ValueOf<T>(1) : ValueOf<T>(0));
    return is > ValueOf<T>(0);
  }
}
FURCULA_INLINE bool chosen(bool which, bool yes, bool no) { return which ? yes : no; }
template <class V, int N>
FURCULA_INLINE LaneMask<V, N> chosen(const LaneMask<V, N>& which, bool yes, const LaneMask<V, N>& no) {
  return {yes ? (which.bits | no.bits) : (~which.bits & no.bits)};
}

}  // namespace detail

/// Sets the mode of the joint with clutch `c` of leg `side`, in the robots `robots` of the SIMD batch. Positions and velocities of the
/// links do not change: to join a motor at another speed, call engage (clutching.hpp). A brake holds the angle in `s`. The motor of
/// a clutch that opens starts from its link's angle and speed.
template <class T>
void set_mode(const Parameters<T>& p, std::size_t side, LegClutch c, Mode mode, JointLaws<T>& laws,
              State<T>& s, const MaskOf<T>& robots = all_of<T>()) {
  using L = LegScalar<T>;
  using V = ValueOf<T>;
  const std::size_t pass = Legs<T>::pass(side), j = kClutchJoints[c];
  const Drive<L>& d = p.drives[pass][j];
  const Clutch<L>& k = p.clutches[pass][c];
  const L zero = L(V(0)), endless = L(V(1e30)), here = s.q_rad[pass][j];
  const bool joined = mode == Mode::active;
  JointLaw<L> to{zero, k.damping_nmspr, zero, zero, zero, endless, zero, all_of<L>()};
  switch (mode) {
    case Mode::active:
      to = {d.armature_kgm2, d.damping_nmspr, d.friction_nm, d.kp_nmprad,
            d.kd_nmsprad,    d.limit_nm,      zero,          all_of<L>()};
      break;
    case Mode::passive:
      to.kp_nmprad = k.spring_nmprad;
      to.rest_rad = k.spring_rest_rad;
      break;
    case Mode::braked:
      to.kp_nmprad = k.brake_nmprad, to.kd_nmsprad = k.brake_nmspr, to.limit_nm = k.brake_limit_nm;
      to.damping_nmspr = zero;
      to.rest_rad = here;
      break;
    case Mode::released:
    case Mode::engaging:
      break;
  }
  const auto which = detail::lanes_of<T>(side, robots);
  JointLaw<L>& l = laws[pass][j];
  for (const auto member :
       {&JointLaw<L>::armature_kgm2, &JointLaw<L>::damping_nmspr, &JointLaw<L>::friction_nm,
        &JointLaw<L>::kp_nmprad, &JointLaw<L>::kd_nmsprad, &JointLaw<L>::limit_nm, &JointLaw<L>::rest_rad})
    l.*member = select(which, to.*member, l.*member);
  const auto kept = detail::chosen(which, false, l.joined);  // joined, of the robots that are not selected
  if (!joined) {
    const L was_joined = select(l.joined, L(V(1)), zero), stays = select(kept, L(V(1)), zero);
    const auto opening = was_joined > stays;
    L &angle = s.rotors_rad[pass][c], &rate = s.rotors_radps[pass][c];
    angle = select(opening, s.q_rad[pass][j], angle);
    rate = select(opening, s.qd_radps[pass][j], rate);
  }
  l.joined = detail::chosen(which, joined, l.joined);
}

/// Torques of the joints by the equation above.
template <class T>
struct JointTorques {
  Joints<T> motor_nm;  ///< clamped part: of a joined motor, as seen at the joint; else of spring or brake
  Joints<T> joint_nm;  ///< on the joint: the same less damping and friction
};

/// Smoothed sign of qd for dry friction: qd / creep, limited to [-1, 1].
template <class L>
FURCULA_INLINE L saturated(const L& qd, const L& inverse_creep) {
  return clamped(L(qd * inverse_creep), L(ValueOf<L>(1)));
}

/// Torques at state `s`. `target_rad`: the drives' targets less the encoders' offsets, read where the motor is joined. kSwitched: some
/// joint may be in a mode other than active.
template <bool kSwitched, class T>
FURCULA_INLINE void joint_torques(const Parameters<T>& p, const State<T>& s, const JointLaws<T>& laws,
                                  const Joints<T>& target_rad, JointTorques<T>& out) {
  using L = LegScalar<T>;
  const L inverse_creep = L(ValueOf<T>(1) / p.creep_radps);
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const JointLaw<L>& l = laws[pass][j];
      const L q = s.q_rad[pass][j], qd = s.qd_radps[pass][j];
      L target = target_rad[pass][j];
      if constexpr (kSwitched) target = select(l.joined, target, l.rest_rad);
      const L motor = clamped(L(l.kp_nmprad * (target - q) - l.kd_nmsprad * qd), l.limit_nm);
      out.motor_nm[pass][j] = motor;
      out.joint_nm[pass][j] = motor - l.damping_nmspr * qd - l.friction_nm * saturated(qd, inverse_creep);
    }
}

}  // namespace furcula::dynamics::biped
