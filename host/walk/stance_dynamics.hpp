// Inverse dynamics of the biped on its left foot, which stands flat on the ground: from the joints' angles, rates and accelerations to their
// torques and the wrench under the foot, with a given wrench under the other one.
//
// Recursive Newton-Euler (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1), from the standing foot over the pelvis to the other
// foot and back, in link coordinates with classical accelerations. World: origin at the left ankle, x along the foot, z up; level ground.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/biped/kinematics.hpp"
#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::walk {

namespace biped = dynamics::biped;

template <class T>
using JointNumbers = std::array<T, biped::kJoints>;

/// Where a frame is, and how it moves; velocities and accelerations in its axes.
template <class T>
struct Moving {
  biped::Mat3<T> rotation;  ///< its coordinates to the world's, by rows
  biped::Vec3<T> at_m;      ///< world
  biped::Vec3<T> w_radps, v_mps, wd_radps2;
  biped::Vec3<T> a_mps2;  ///< of its origin, seen from free fall
};

template <class T>
struct Stance {
  Moving<T> pelvis, swing_foot;
  JointNumbers<T> torque_nm;  ///< on each joint, the armature's share included
  JointNumbers<T> body_nm;    ///< without it
  biped::Force<T> foot;       ///< on the left foot about its ankle, in the foot's axes
};

template <class T>
class StanceDynamics {
 public:
  explicit StanceDynamics(const biped::Description& d) : d_(d) {
    const auto inertia = [](const biped::LinkDescription& l) {
      return dynamics::tree::inertia_of(l.mass_kg, l.centre_m, l.about_centre_kgm2);
    };
    pelvis_ = inertia(d.pelvis);
    for (const std::size_t side : {biped::kLeft, biped::kRight})
      for (std::size_t j = 0; j < biped::kLegJoints; ++j) links_[side][j] = inertia(d.legs[side][j]);
  }

  /// `other`: on the right foot about its ankle, in that foot's axes.
  Stance<T> operator()(const JointNumbers<T>& q, const JointNumbers<T>& qd, const JointNumbers<T>& qdd,
                       const biped::Force<T>& other) const {
    using namespace dynamics::biped;
    const T zero(0.0), one(1.0);
    const Vec3<T> none{zero, zero, zero};
    Stance<T> out;
    std::array<std::array<Turned, kLegJoints>, 2> turn;
    for (const std::size_t side : {kLeft, kRight})
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        const auto angle = dynamics::sine_cosine(q[side * kLegJoints + j]);
        turn[side][j] = {angle.cosine, angle.sine};
      }

    // From the foot up: a joint's parent moves as the link does, less the joint.
    Moving<T> m{{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}},
                none,
                none,
                none,
                none,
                {zero, zero, T(d_.gravity_mps2)}};
    std::array<Force<T>, kLegJoints> left, right;
    inwards([&](auto index) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = DesignTopology::kAxes[J];
      left[J] = force(links_[kLeft][J], m);
      const Turn<kAxis, T> t{turn[kLeft][J].c, turn[kLeft][J].s};
      const Vec3<T> w = m.w_radps - along_axis<kAxis>(qd[J]);
      const Vec3<T> wd = m.wd_radps2 - cross(w, along_axis<kAxis>(qd[J])) - along_axis<kAxis>(qdd[J]);
      const Vec3<double>& r = d_.legs[kLeft][J].offset_m;
      Moving<T> p;
      p.rotation = {t.back(m.rotation.x), t.back(m.rotation.y), t.back(m.rotation.z)};
      p.at_m = m.at_m - p.rotation * r;
      p.w_radps = t.back(w);
      p.wd_radps2 = t.back(wd);
      p.v_mps = t.back(m.v_mps) - cross(p.w_radps, r);
      p.a_mps2 = t.back(m.a_mps2) - cross(p.wd_radps2, r) - cross(p.w_radps, cross(p.w_radps, r));
      m = p;
    });
    out.pelvis = m;
    Force<T> sum = force(pelvis_, m);

    outwards([&](auto index) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = DesignTopology::kAxes[J];
      const std::size_t i = kLegJoints + J;
      const Turn<kAxis, T> t{turn[kRight][J].c, turn[kRight][J].s};
      const Vec3<double>& r = d_.legs[kRight][J].offset_m;
      Moving<T> p;
      p.at_m = m.at_m + m.rotation * r;
      // A row of the link's rotation is the parent's, turned as a vector is.
      p.rotation = {t.in(m.rotation.x), t.in(m.rotation.y), t.in(m.rotation.z)};
      const Vec3<T> w = t.in(m.w_radps);
      p.w_radps = w + along_axis<kAxis>(qd[i]);
      p.wd_radps2 = t.in(m.wd_radps2) + cross(w, along_axis<kAxis>(qd[i])) + along_axis<kAxis>(qdd[i]);
      p.v_mps = t.in(m.v_mps + cross(m.w_radps, r));
      p.a_mps2 = t.in(m.a_mps2 + cross(m.wd_radps2, r) + cross(m.w_radps, cross(m.w_radps, r)));
      m = p;
      right[J] = force(links_[kRight][J], m);
    });
    out.swing_foot = m;

    right[kLegJoints - 1] = {right[kLegJoints - 1].n - other.n, right[kLegJoints - 1].f - other.f};
    inwards([&](auto index) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = DesignTopology::kAxes[J];
      const Turn<kAxis, T> t{turn[kRight][J].c, turn[kRight][J].s};
      set(kRight, J, along<kAxis>(right[J].n), qdd, out);
      const Vec3<T> f = t.back(right[J].f);
      const Force<T> back{t.back(right[J].n) + cross(d_.legs[kRight][J].offset_m, f), f};
      if constexpr (J > 0)
        right[J - 1] += back;
      else
        sum += back;
    });
    // What all beyond a joint of the standing leg needs comes through that joint.
    outwards([&](auto index) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = DesignTopology::kAxes[J];
      const Turn<kAxis, T> t{turn[kLeft][J].c, turn[kLeft][J].s};
      const Force<T> through{t.in(sum.n - cross(d_.legs[kLeft][J].offset_m, sum.f)), t.in(sum.f)};
      set(kLeft, J, -along<kAxis>(through.n), qdd, out);
      sum = through + left[J];
    });
    out.foot = sum;
    return out;
  }

 private:
  struct Turned {
    T c, s;
  };
  template <biped::Axis A>
  static biped::Vec3<T> along_axis(const T& x) {
    return biped::z_to_axis<A>(biped::Vec3<T>{T(0.0), T(0.0), x});
  }
  /// That a body needs to move so, about the frame's origin.
  static biped::Force<T> force(const biped::Inertia<double>& b, const Moving<T>& m) {
    const auto h = b.moment_kgm;
    return {b.inertia_kgm2 * m.wd_radps2 + cross(m.w_radps, b.inertia_kgm2 * m.w_radps) + cross(h, m.a_mps2),
            m.a_mps2 * b.mass_kg + cross(m.wd_radps2, h) + cross(m.w_radps, cross(m.w_radps, h))};
  }
  void set(std::size_t side, std::size_t j, const T& nm, const JointNumbers<T>& qdd, Stance<T>& out) const {
    const std::size_t i = side * biped::kLegJoints + j;
    out.body_nm[i] = nm;
    out.torque_nm[i] = nm + qdd[i] * d_.drives[side][j].armature_kgm2;
  }

  biped::Description d_;
  biped::Inertia<double> pelvis_;
  std::array<std::array<biped::Inertia<double>, biped::kLegJoints>, 2> links_;
};

}  // namespace furcula::walk
