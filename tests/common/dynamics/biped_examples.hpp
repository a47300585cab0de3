// The biped for tests: random states, and the same robot on the tree's algorithms, with six joints of no mass for its floating base.
#pragma once

#include "furcula/dynamics/biped/clutching.hpp"
#include "furcula/dynamics/biped/design.hpp"
#include "furcula/dynamics/biped/energy.hpp"
#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

namespace furcula::test {

namespace biped = dynamics::biped;

/// The 18 coordinates x, y, z, yaw, pitch, roll and the joints, with rates.
struct Coordinates {
  std::array<double, 18> q{}, qd{};
};

inline Coordinates random_coordinates(Random& r, double most_rate = 3.0) {
  Coordinates out;
  for (std::size_t i = 0; i < 18; ++i) {
    out.q[i] = i == 4 ? r.within(-1.2, 1.2) : r.within(-1.5, 1.5);
    out.qd[i] = r.within(-most_rate, most_rate);
  }
  out.q[3] = r.within(-3.1, 3.1);
  out.q[5] = r.within(-3.1, 3.1);
  return out;
}

/// What takes the rates of yaw, pitch and roll to the angular velocity in the pelvis' axes, R = Rz Ry Rx.
inline Mat3<double> rates_to_w(double pitch, double roll) {
  return {{-std::sin(pitch), 0.0, 1.0},
          {std::cos(pitch) * std::sin(roll), std::cos(roll), 0.0},
          {std::cos(pitch) * std::cos(roll), -std::sin(roll), 0.0}};
}
/// Its rate times the angles' rates.
inline Vec3<double> rates_to_w_drift(const Coordinates& c) {
  const double p = c.q[4], r = c.q[5], yd = c.qd[3], pd = c.qd[4], rd = c.qd[5];
  return {-std::cos(p) * pd * yd,
          (-std::sin(p) * pd * std::sin(r) + std::cos(p) * std::cos(r) * rd) * yd - std::sin(r) * rd * pd,
          (-std::sin(p) * pd * std::cos(r) - std::cos(p) * std::sin(r) * rd) * yd - std::cos(r) * rd * pd};
}
inline Mat3<double> inverse(const Mat3<double>& m) {
  const Vec3<double> a = cross(m.y, m.z), b = cross(m.z, m.x), c = cross(m.x, m.y);
  const double k = 1.0 / dot(m.x, a);
  return transposed(Mat3<double>{a * k, b * k, c * k});
}

/// As the biped's state.
inline biped::State<double> state_of(const Coordinates& c) {
  biped::State<double> s;
  s.position_m = {c.q[0], c.q[1], c.q[2]};
  const double cy = std::cos(c.q[3] / 2), sy = std::sin(c.q[3] / 2), cp = std::cos(c.q[4] / 2),
               sp = std::sin(c.q[4] / 2), cr = std::cos(c.q[5] / 2), sr = std::sin(c.q[5] / 2);
  s.attitude = {cy * cp * cr + sy * sp * sr, cy * cp * sr - sy * sp * cr, cy * sp * cr + sy * cp * sr,
                sy * cp * cr - cy * sp * sr};
  s.w_radps = rates_to_w(c.q[4], c.q[5]) * Vec3<double>{c.qd[3], c.qd[4], c.qd[5]};
  s.v_mps = transposed_times(biped::rotation(s.attitude), Vec3<double>{c.qd[0], c.qd[1], c.qd[2]});
  for (std::size_t i = 0; i < biped::kJoints; ++i) {
    biped::set_joint<double>(s.q_rad, i, c.q[6 + i]);
    biped::set_joint<double>(s.qd_radps, i, c.qd[6 + i]);
  }
  return s;
}

/// Second derivatives of the coordinates from the biped's accelerations.
inline std::array<double, 18> second_derivatives(const Coordinates& c,
                                                 const biped::Accelerations<double>& a) {
  const biped::State<double> s = state_of(c);
  const Vec3<double> linear = biped::rotation(s.attitude) * (a.vd_mps2 + cross(s.w_radps, s.v_mps));
  const Vec3<double> angles = inverse(rates_to_w(c.q[4], c.q[5])) * (a.wd_radps2 - rates_to_w_drift(c));
  std::array<double, 18> out{linear.x, linear.y, linear.z, angles.x, angles.y, angles.z};
  for (std::size_t i = 0; i < biped::kJoints; ++i) out[6 + i] = biped::joint<double>(a.qdd_radps2, i);
  return out;
}

using Tree18 = Model<double, DynamicTopology<18>>;

/// Joints as they are in the design, and turned against their parents by any angles.
inline biped::JointFrames straight_frames() {
  biped::JointFrames out;
  for (auto& leg : out) leg.fill(identity<double>());
  return out;
}
inline biped::JointFrames random_frames(Random& r) {
  biped::JointFrames out;
  for (auto& leg : out)
    for (Mat3<double>& m : leg) {
      const double a = r.within(-3.1, 3.1), b = r.within(-3.1, 3.1), c = r.within(-3.1, 3.1);
      m = Mat3<double>{{std::cos(a), std::sin(a), 0}, {-std::sin(a), std::cos(a), 0}, {0, 0, 1}} *
          (Mat3<double>{{std::cos(b), 0, -std::sin(b)}, {0, 1, 0}, {std::sin(b), 0, std::cos(b)}} *
           Mat3<double>{{1, 0, 0}, {0, std::cos(c), std::sin(c)}, {0, -std::sin(c), std::cos(c)}});
    }
  return out;
}

/// The same robot as a tree: three sliding and three turning joints without mass under the pelvis.
inline Tree18 as_tree(const biped::Description& d, const biped::JointFrames& frames = straight_frames()) {
  Tree18 m;
  m.gravity_mps2 = {0.0, 0.0, -d.gravity_mps2};
  const Inertia<double> none{};
  const Vec3<double> axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto body = [](const biped::LinkDescription& l) {
    return inertia_of(l.mass_kg, l.centre_m, l.about_centre_kgm2);
  };
  for (int i = 0; i < 3; ++i) add(m, i - 1, JointKind::prismatic, at(0, 0, 0), axes[i], none);
  add(m, 2, JointKind::revolute, at(0, 0, 0), axes[2], none);
  add(m, 3, JointKind::revolute, at(0, 0, 0), axes[1], none);
  add(m, 4, JointKind::revolute, at(0, 0, 0), axes[0], body(d.pelvis));
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t j = 0; j < biped::kLegJoints; ++j) {
      const biped::LinkDescription& l = d.legs[side][j];
      const auto axis = static_cast<std::size_t>(biped::DesignTopology::kAxes[j]);
      add(m, j == 0 ? 5 : static_cast<int>(m.count()) - 1, JointKind::revolute, {frames[side][j], l.offset_m},
          axes[axis], body(l));
      m.laws[m.count() - 1].armature_kgm2 = d.drives[side][j].armature_kgm2;
    }
  return m;
}

/// In free flight, with these torques.
inline biped::Actions<double> in_flight(const biped::Description& d,
                                        const std::array<double, 12>& torque_nm) {
  biped::Actions<double> act{};
  act.gravity_mps2 = {0.0, 0.0, -d.gravity_mps2};
  act.foot[0] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  for (std::size_t i = 0; i < biped::kJoints; ++i) {
    biped::set_joint<double>(act.torque_nm, i, torque_nm[i]);
    biped::set_joint<double>(act.armature_kgm2, i,
                             d.drives[i / biped::kLegJoints][i % biped::kLegJoints].armature_kgm2);
  }
  return act;
}
inline std::array<double, 12> random_torques(Random& r, double most_nm) {
  std::array<double, 12> out{};
  for (double& t : out) t = r.within(-most_nm, most_nm);
  return out;
}

}  // namespace furcula::test
