// Energy and momentum of the biped from every body's velocity, independent of the equations of motion, for checks.
#pragma once

#include "furcula/dynamics/biped/joint_laws.hpp"
#include "furcula/dynamics/biped/kinematics.hpp"

namespace furcula::dynamics::biped {

/// Sums over the bodies, world axes.
template <class T>
struct Totals {
  T mass_kg;           ///< of all bodies
  Vec3<T> moment_kgm;  ///< sum of mass times position of the centre of mass, from the world's origin
  Vec3<T> linear_ns;   ///< linear momentum
  /// Angular momentum about the world's origin; without the rotors' spin, as in the equations of motion.
  Vec3<T> angular_nms;
  T kinetic_j;  ///< of the bodies, without the motors

  /// Centre of mass, world.
  Vec3<T> centre_m() const { return moment_kgm * (ValueOf<T>(1) / mass_kg); }
  /// Angular momentum about the centre of mass.
  Vec3<T> spin_nms() const { return angular_nms - cross(centre_m(), linear_ns); }
};

namespace detail {

/// Adds a body at `at`, turned by `r` (its axes to the world's), that moves by (w, v) in its own axes.
template <class T>
void add(Totals<T>& sum, const Inertia<T>& b, const Mat3<T>& r, const Vec3<T>& at, const Vec3<T>& w,
         const Vec3<T>& v) {
  const Vec3<T> p = v * b.mass_kg + cross(w, b.moment_kgm);
  const Vec3<T> l = b.inertia_kgm2 * w + cross(b.moment_kgm, v);
  const Vec3<T> linear = r * p;
  sum.mass_kg += b.mass_kg;
  sum.moment_kgm += at * b.mass_kg + r * b.moment_kgm;
  sum.linear_ns += linear;
  sum.angular_nms += r * l + cross(at, linear);
  sum.kinetic_j += (dot(w, l) + dot(v, p)) * ValueOf<T>(0.5);
}

}  // namespace detail

/// The sums at a state. Computes one leg after the other in the robot's scalar; not for speed.
template <class P, class T>
Totals<T> totals(const P& p, const State<T>& s) {
  using V = ValueOf<T>;
  const T zero = T(V(0));
  const Vec3<T> none{zero, zero, zero};
  Totals<T> sum{zero, none, none, none, zero};
  const Mat3<T> pelvis = rotation(s.attitude);
  detail::add(sum, p.pelvis, pelvis, s.position_m, s.w_radps, s.v_mps);
  for (const std::size_t side : {kLeft, kRight}) {
    Mat3<T> r = pelvis;
    Vec3<T> at = s.position_m, w = s.w_radps, v = s.v_mps;
    outwards([&](auto index) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = DesignTopology::kAxes[J];
      const auto& o = p.offsets_m[Legs<T>::pass(side)][J];
      const auto of_side = [&](const auto& x) {
        return Vec3<T>{Legs<T>::read(x.x, side), Legs<T>::read(x.y, side), Legs<T>::read(x.z, side)};
      };
      const Vec3<T> offset = of_side(o);
      const auto angle = sine_cosine(joint<T>(s.q_rad, side * kLegJoints + J));
      const auto turn_in = [&](const Vec3<T>& parents) {
        const Turn<kAxis, T> turn{angle.cosine, angle.sine};
        if constexpr (requires { p.frames; }) {
          const auto& f = p.frames[Legs<T>::pass(side)][J];
          return turn.in(Mat3<T>{of_side(f.x), of_side(f.y), of_side(f.z)} * parents);
        } else {
          return turn.in(parents);
        }
      };
      v = turn_in(v + cross(w, offset));
      w = turn_in(w);
      along<kAxis>(w) += joint<T>(s.qd_radps, side * kLegJoints + J);
      at += r * offset;
      r = {turn_in(r.x), turn_in(r.y), turn_in(r.z)};
      detail::add(sum, p.link(side, J), r, at, w, v);
    });
  }
  return sum;
}

/// Kinetic energy of the motors, J: joined motors have their link's speed, the others their own.
template <class T>
T motors_kinetic_j(const Parameters<T>& p, const JointLaws<T>& laws, const State<T>& s) {
  using V = ValueOf<T>;
  using L = LegScalar<T>;
  T twice = T(V(0));
  for (const std::size_t side : {kLeft, kRight}) {
    const std::size_t pass = Legs<T>::pass(side);
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const L qd = s.qd_radps[pass][j];
      twice += Legs<T>::read(L(laws[pass][j].armature_kgm2 * qd * qd), side);
    }
    for (std::size_t c = 0; c < kClutches; ++c) {
      const std::size_t j = kClutchJoints[c];
      const L qd = select(laws[pass][j].joined, L(V(0)), s.rotors_radps[pass][c]);
      twice += Legs<T>::read(L(p.drives[pass][j].armature_kgm2 * qd * qd), side);
    }
  }
  return twice * V(0.5);
}

/// Potential energy of gravity, J: zero with the centre of mass at the world's origin.
template <class T>
T height_energy_j(const Parameters<T>& p, const Totals<T>& t) {
  return -dot(p.gravity_mps2, t.moment_kgm);
}

}  // namespace furcula::dynamics::biped
