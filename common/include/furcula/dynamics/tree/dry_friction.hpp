// Dry friction at several joints at once: which joints at rest are held, and which begin to move.
//
// The torque that holds a joint at rest may not exceed its break-away torque in the direction in which it would move. A
// joint that begins to move has kinetic friction against its acceleration. Friction depends on the state and the drive's
// torque, not on accelerations: with equal static and kinetic friction this is a linear complementarity problem with
// bounds and the positive definite matrix of the joints' inverse inertia, which has one solution.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "furcula/dynamics/tree/foothold.hpp"
#include "furcula/dynamics/tree/forward_dynamics.hpp"

namespace furcula::dynamics::tree {

/// Position of a joint relative to its binding spot.
enum class Spot : std::uint8_t {
  none,    ///< the joint has no binding friction
  before,  ///< at a smaller position
  within,  ///< inside, edges included
  beyond   ///< at a larger position
};

/// State of dry friction of each joint.
template <std::size_t kJoints>
struct FrictionMode {
  std::array<bool, kJoints> held{};              ///< at rest by dry friction: the joint does not accelerate
  std::array<std::int8_t, kJoints> direction{};  ///< of motion, -1 or 1; 0: held, or no dry friction
  std::array<Spot, kJoints> spot{};  ///< relative to the binding spot; binding friction acts `within`
};

/// -1, 0 or 1.
template <class V>
constexpr std::int8_t sign_of(V x) {
  return static_cast<std::int8_t>(x > V(0) ? 1 : x < V(0) ? -1 : 0);
}

/// Whether dry friction may act in the joint, somewhere and under some load.
template <class T>
[[gnu::always_inline]] inline bool is_dry(const JointLaw<T>& law) {
  using V = ValueOf<T>;
  return value_of(law.friction_nm) > V(0) || value_of(law.static_friction_nm) > V(0) ||
         (law.asymmetric && value_of(law.friction_back_nm) > V(0)) ||
         value_of(law.load_friction_ratio) > V(0) || value_of(law.binding_friction_nm) > V(0);
}

/// Coulomb part of kinetic friction in the positive (`direction` 1) or negative (-1) direction, N m.
template <class T>
[[gnu::always_inline]] inline const T& coulomb_friction(const JointLaw<T>& law, int direction) {
  return law.asymmetric && direction < 0 ? law.friction_back_nm : law.friction_nm;
}
/// `level` plus the friction due to the load (the drive's torque `drive_nm` at the joint) and the binding spot, N m.
template <class T>
[[gnu::always_inline]] inline T with_load_and_binding(const JointLaw<T>& law, T level, const T& drive_nm,
                                                      Spot spot) {
  using V = ValueOf<T>;
  if (value_of(law.load_friction_ratio) > V(0)) {
    const T load = law.load_friction_ratio * drive_nm;
    level = value_of(load) < V(0) ? T(level - load) : T(level + load);
  }
  return spot == Spot::within ? T(level + law.binding_friction_nm) : level;
}
/// Kinetic dry friction against motion in this direction, 1 or -1, N m, >= 0: the torque is -direction times it. `qd`
/// may have the other sign (a step past the end of the motion).
template <class T>
[[gnu::noinline]] T friction_in_motion(const JointLaw<T>& law, const T& qd, const T& drive_nm, int direction,
                                       Spot spot) {
  using std::exp;
  T level = coulomb_friction(law, direction);
  if (value_of(law.stribeck_velocity_radps) > ValueOf<T>(0) &&
      value_of(law.static_friction_nm) > value_of(level)) {
    const T ratio = qd / law.stribeck_velocity_radps;
    level = level + (law.static_friction_nm - level) * exp(-(ratio * ratio));
  }
  return with_load_and_binding(law, level, drive_nm, spot);
}
/// Dry friction that a joint at rest must overcome to move in this direction, 1 or -1, N m, >= 0. The torque that
/// holds it lies between minus the value for 1 and the value for -1.
template <class T>
[[gnu::always_inline]] inline T break_away_torque(const JointLaw<T>& law, const T& drive_nm, int direction,
                                                  Spot spot) {
  const T& coulomb = coulomb_friction(law, direction);
  return with_load_and_binding(
      law, value_of(law.static_friction_nm) > value_of(coulomb) ? law.static_friction_nm : coulomb, drive_nm,
      spot);
}

/// Relation of position q (rad) to the binding spot; `none` without binding friction. The edges are within.
template <class T>
Spot spot_at(const JointLaw<T>& law, const T& q) {
  using V = ValueOf<T>;
  if (!(value_of(law.binding_friction_nm) > V(0))) return Spot::none;
  const V from_centre = value_of(q) - value_of(law.binding_centre_rad);
  const V half = V(0.5) * value_of(law.binding_width_rad);
  return from_centre < -half ? Spot::before : from_centre > half ? Spot::beyond : Spot::within;
}
/// Distance of the joint from the nearest edge at which it leaves `spot`, rad: negative once it has left.
template <class T>
T way_to_edge(const JointLaw<T>& law, const T& q, Spot spot) {
  using V = ValueOf<T>;
  const T from_centre = q - law.binding_centre_rad, half = law.binding_width_rad * V(0.5);
  if (spot == Spot::before) return -half - from_centre;
  if (spot == Spot::beyond) return from_centre - half;
  return value_of(from_centre) < V(0) ? T(half + from_centre) : T(half - from_centre);
}

/// forward_dynamics in this mode: held joints at rest, kinetic friction at the others, the stance foot (if any) fixed to
/// its foothold.
template <class M>
void forward_in_mode(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                     const typename M::Joints& tau_nm, const FrictionMode<M::kCapacity>& mode,
                     Accelerations<M>& out) {
  using V = typename M::V;
  typename M::Joints tau = tau_nm;
  for (std::size_t i = 0; i < model.count(); ++i) {
    if (mode.direction[i] == 0) continue;
    const auto& law = model.laws[i];
    // Most joints have Coulomb friction alone. The sum is one question for two: none is negative.
    const bool more = law.asymmetric || mode.spot[i] == Spot::within ||
                      value_of(law.stribeck_velocity_radps) + value_of(law.load_friction_ratio) > V(0);
    if (more)
      tau[i] -= friction_in_motion(law, qd[i], tau_nm[i], mode.direction[i], mode.spot[i]) *
                static_cast<V>(mode.direction[i]);
    else if (mode.direction[i] > 0)
      tau[i] -= law.friction_nm;
    else
      tau[i] += law.friction_nm;
  }
  forward_dynamics(model, q, qd, tau, mode.held, out);
  if (model.foothold.joint >= 0) stand(model, q, qd, mode.held, out);
}

/// Sets `spot` of each joint from its position.
template <class M>
void place_in_spots(const M& model, const typename M::Joints& q, FrictionMode<M::kCapacity>& mode) {
  for (std::size_t i = 0; i < model.count(); ++i) mode.spot[i] = spot_at(model.laws[i], q[i]);
}

/// Sets `held` and `direction` from the velocities alone: a joint with dry friction and velocity exactly zero is held.
/// Returns the number of held joints. `spot` does not change.
template <class M>
std::size_t mode_of_motion(const M& model, const typename M::Joints& qd, FrictionMode<M::kCapacity>& mode) {
  using V = typename M::V;
  std::size_t at_rest = 0;
  mode.held = {};
  mode.direction = {};
  for (std::size_t i = 0; i < model.count(); ++i) {
    if (!is_dry(model.laws[i])) continue;
    mode.held[i] = value_of(qd[i]) == V(0);
    mode.direction[i] = sign_of(value_of(qd[i]));
    at_rest += mode.held[i] ? 1 : 0;
  }
  return at_rest;
}

/// Largest number of rounds of settle_in_spots().
inline constexpr int kMostSettlingRounds = 500;
/// Finds the mode at this state, from that of mode_of_motion() and with `spot` as it is, and the accelerations. Joints
/// with dry friction and velocity exactly zero may be held; at first all of them are. Each round releases the joint
/// that exceeds its bound most, or holds a joint that would accelerate against its direction. From round 2 count() on
/// the first joint that violates its condition changes, which ends for every such problem (Murty 1974, least index;
/// with bounds: Judice and Pires, Computers & Operations Research 21, 1994). Returns the number of rounds, or 0 where
/// kMostSettlingRounds did not suffice; `mode` is then the last one. A joint at rest without friction at this moment
/// (no load, outside the binding spot) is free, with the direction of its acceleration.
template <class M>
int settle_in_spots(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                    const typename M::Joints& tau_nm, FrictionMode<M::kCapacity>& mode,
                    Accelerations<M>& out) {
  using V = typename M::V;
  const std::size_t n = model.count();
  const auto bound_at = [&](std::size_t i, int direction) {
    return value_of(break_away_torque(model.laws[i], tau_nm[i], direction, mode.spot[i]));
  };
  for (std::size_t i = 0; i < n; ++i)
    if (mode.held[i]) mode.held[i] = bound_at(i, 1) > V(0) || bound_at(i, -1) > V(0);
  for (int round = 1; round <= kMostSettlingRounds; ++round) {
    forward_in_mode(model, q, qd, tau_nm, mode, out);
    const bool first_one = round > 2 * static_cast<int>(n);
    std::size_t change = n;
    V worst = V(0);
    for (std::size_t i = 0; i < n && !(first_one && change < n); ++i) {
      if (!is_dry(model.laws[i]) || value_of(qd[i]) != V(0)) continue;
      V beyond;
      if (mode.held[i]) {
        const V torque = value_of(out.holding_nm[i]), size = torque < V(0) ? -torque : torque;
        const V bound = bound_at(i, torque < V(0) ? 1 : -1);
        beyond = bound > V(0) ? (size - bound) / bound : size > V(0) ? V(1e29) : V(0);
      } else {
        // Hold it again before another joint is released: the others' accelerations were computed with its motion.
        beyond = static_cast<V>(mode.direction[i]) * value_of(out.joint_radps2[i]) < V(0) ? V(1e30) : V(0);
      }
      if (beyond > worst) {
        worst = beyond;
        change = i;
      }
    }
    if (change == n) {
      for (std::size_t i = 0; i < n; ++i)
        if (!mode.held[i] && mode.direction[i] == 0 && is_dry(model.laws[i]))
          mode.direction[i] = sign_of(value_of(out.joint_radps2[i]));
      return round;
    }
    mode.direction[change] = static_cast<std::int8_t>(!mode.held[change]                        ? 0
                                                      : value_of(out.holding_nm[change]) > V(0) ? -1
                                                                                                : 1);
    mode.held[change] = !mode.held[change];
  }
  return 0;
}

/// The same from the state alone: `spot` is set from the positions first.
template <class M>
int settle_friction(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                    const typename M::Joints& tau_nm, FrictionMode<M::kCapacity>& mode,
                    Accelerations<M>& out) {
  place_in_spots(model, q, mode);
  mode_of_motion(model, qd, mode);
  return settle_in_spots(model, q, qd, tau_nm, mode, out);
}

}  // namespace furcula::dynamics::tree
