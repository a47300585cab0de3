// Position and velocity of a biped's centre of mass relative to its feet, from joints, gyro and attitude: the inputs of
// a walk's feedback.
#pragma once

#include "furcula/dynamics/biped/kinematics.hpp"

namespace furcula::control {

/// Pose of a leg, in the pelvis frame's axes and from its origin; rates are those relative to the pelvis.
template <class L>
struct LegPose {
  dynamics::tree::Vec3<L> ankle_m,     ///< position of the ankle
      ankle_mps;                       ///< velocity of the ankle
  dynamics::tree::Vec3<L> forward;     ///< the foot's x axis
  dynamics::tree::Vec3<L> moment_kgm,  ///< sum of mass times position over the leg's links
      moment_kgmps;                    ///< derivative of moment_kgm
};

/// Poses of both legs from joint angles and rates, computed from the feet inwards: a joint turns what lies beyond it.
template <class T>
FURCULA_INLINE void leg_poses(const dynamics::biped::Parameters<T>& p,
                              const dynamics::biped::Joints<T>& q_rad,
                              const dynamics::biped::Joints<T>& qd_radps,
                              dynamics::biped::PerLeg<T, LegPose<dynamics::biped::LegScalar<T>>>& out) {
  using namespace dynamics::biped;
  using L = LegScalar<T>;
  using V = dynamics::ValueOf<T>;
  const L zero = L(V(0)), one = L(V(1));
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
    LegPose<L>& o = out[pass];
    o = {{zero, zero, zero},
         {zero, zero, zero},
         {one, zero, zero},
         p.links[pass][kLegJoints - 1].moment_kgm,
         {zero, zero, zero}};
    L beyond = p.links[pass][kLegJoints - 1].mass_kg;
    inwards([&](auto index) __attribute__((always_inline)) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = DesignTopology::kAxes[J];
      constexpr unsigned kMask = DesignTopology::kOffsets[J];
      const auto angle = dynamics::sine_cosine(q_rad[pass][J]);
      const Turn<kAxis, L> turn{angle.cosine, angle.sine};
      const L qd = qd_radps[pass][J];
      // Its rate gets that of the turn, axis x place, before both are turned.
      const auto turned = [&](Vec3<L> & at, Vec3<L> & rate) __attribute__((always_inline)) {
        Vec3<L> z = axis_to_z<kAxis>(rate);
        const Vec3<L> a = axis_to_z<kAxis>(at);
        z.x -= a.y * qd;
        z.y += a.x * qd;
        rate = turn.back(z_to_axis<kAxis>(z));
        at = turn.back(at);
      };
      turned(o.ankle_m, o.ankle_mps);
      o.forward = turn.back(o.forward);
      turned(o.moment_kgm, o.moment_kgmps);
      const Vec3<L>& r = p.offsets_m[pass][J];
      o.ankle_m = plus<kMask>(o.ankle_m, r);
      o.moment_kgm = plus<kMask>(o.moment_kgm, Vec3<L>(r * beyond));
      if constexpr (J > 0) {
        o.moment_kgm += p.links[pass][J - 1].moment_kgm;
        beyond += p.links[pass][J - 1].mass_kg;
      }
    });
  }
}

/// Position of the left ankle relative to the right one, in the pelvis frame's axes, m.
template <class T>
FURCULA_INLINE dynamics::tree::Vec3<T> ankles_apart(
    const dynamics::biped::PerLeg<T, LegPose<dynamics::biped::LegScalar<T>>>& legs) {
  using namespace dynamics::biped;
  const auto& l = legs[Legs<T>::pass(kLeft)].ankle_m;
  const auto& r = legs[Legs<T>::pass(kRight)].ankle_m;
  return {Legs<T>::read(l.x, kLeft) - Legs<T>::read(r.x, kRight),
          Legs<T>::read(l.y, kLeft) - Legs<T>::read(r.y, kRight),
          Legs<T>::read(l.z, kLeft) - Legs<T>::read(r.z, kRight)};
}

/// Position of the left ankle relative to the pelvis frame's origin, in its axes, m.
template <class T>
FURCULA_INLINE dynamics::tree::Vec3<T> left_ankle(
    const dynamics::biped::PerLeg<T, LegPose<dynamics::biped::LegScalar<T>>>& legs) {
  using namespace dynamics::biped;
  const auto& l = legs[Legs<T>::pass(kLeft)].ankle_m;
  return {Legs<T>::read(l.x, kLeft), Legs<T>::read(l.y, kLeft), Legs<T>::read(l.z, kLeft)};
}

/// Horizontal position and velocity of the centre of mass relative to a point of the feet, by the feet's heading.
template <class T>
struct Balance {
  T forward_m,      ///< along the heading
      forward_mps,  ///< velocity along the heading
      left_m,       ///< to the left of the heading
      left_mps;     ///< velocity to the left
};

/// Balance about the point `left` times the left ankle plus `right` times the right one, shares that add up to 1. The
/// point is taken to be at rest on the ground. `inverse_mass` is that of the whole robot, 1/kg; `gyro_radps` is in the
/// pelvis frame's axes, `attitude` from these to level axes.
template <class T>
FURCULA_INLINE Balance<T> balance(
    const dynamics::biped::Parameters<T>& p, const T& inverse_mass,
    const dynamics::biped::PerLeg<T, LegPose<dynamics::biped::LegScalar<T>>>& legs,
    const dynamics::biped::Quaternion<T>& attitude, const dynamics::tree::Vec3<T>& gyro_radps, const T& left,
    const T& right) {
  using namespace dynamics::biped;
  using L = LegScalar<T>;
  using V = dynamics::ValueOf<T>;
  const auto of = [&](Vec3<L> LegPose<L>::*what, const T& by_left, const T& by_right) {
    const auto one = [&](L Vec3<L>::*c) {
      return by_left * Legs<T>::read((legs[Legs<T>::pass(kLeft)].*what).*c, kLeft) +
             by_right * Legs<T>::read((legs[Legs<T>::pass(kRight)].*what).*c, kRight);
    };
    return Vec3<T>{one(&Vec3<L>::x), one(&Vec3<L>::y), one(&Vec3<L>::z)};
  };
  const T k = inverse_mass;
  const Vec3<T> arm =
      p.pelvis.moment_kgm * k + of(&LegPose<L>::moment_kgm, k, k) - of(&LegPose<L>::ankle_m, left, right);
  const Vec3<T> seen = of(&LegPose<L>::moment_kgmps, k, k) - of(&LegPose<L>::ankle_mps, left, right);
  const Vec3<T> forward = of(&LegPose<L>::forward, left, right);
  const Mat3<T> r = rotation(attitude);
  const Vec3<T> at = r * arm, speed = r * (seen + cross(gyro_radps, arm)), x = r * forward;
  const T inverse = V(1) / dynamics::square_root(T(x.x * x.x + x.y * x.y + V(1e-12)));
  const T c = x.x * inverse, s = x.y * inverse;
  return {c * at.x + s * at.y, c * speed.x + s * speed.y, c * at.y - s * at.x, c * speed.y - s * speed.x};
}

}  // namespace furcula::control
