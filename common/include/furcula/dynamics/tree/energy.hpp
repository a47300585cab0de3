// Positions, energy and momentum of the bodies of a tree.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/tree/joint_torque.hpp"
#include "furcula/dynamics/tree/model.hpp"

namespace furcula::dynamics::tree {

/// The link frame of each joint's body in the world, by joint.
template <class M>
std::array<Frame<typename M::Scalar>, M::kCapacity> link_frames(const M& model, const typename M::Joints& q) {
  using T = typename M::Scalar;
  std::array<Frame<T>, M::kCapacity> out;
  model.shape().outwards([&](std::size_t i) {
    out[i] = model.frame(i, q[i]);
    if (model.shape().parent(i) >= 0)
      out[i] = within(out[static_cast<std::size_t>(model.shape().parent(i))], out[i]);
  });
  for (std::size_t i = 0; i < model.count(); ++i)  // from the aligned frames back to those of the links
    out[i].turn = transposed(model.aligned(i).turn) * out[i].turn;
  return out;
}

/// Velocity of each body at the origin of its aligned frame, in its axes, by joint.
template <class M>
std::array<Motion<typename M::Scalar>, M::kCapacity> body_velocities(const M& model,
                                                                     const typename M::Joints& q,
                                                                     const typename M::Joints& qd) {
  using T = typename M::Scalar;
  using V = typename M::V;
  const T zero = T(V(0));
  std::array<Motion<T>, M::kCapacity> out;
  const auto& shape = model.shape();
  shape.outwards([&](std::size_t i) {
    out[i] = {{zero, zero, zero}, {zero, zero, zero}};
    if (shape.parent(i) >= 0)
      out[i] = model.frame(i, q[i]).motion(out[static_cast<std::size_t>(shape.parent(i))]);
    (shape.kind(i) == JointKind::prismatic ? out[i].v.z : out[i].w.z) += qd[i];
  });
  return out;
}

/// Kinetic energy of bodies and armatures, J, without the rotors of elastic drives.
template <class M>
typename M::Scalar kinetic_energy_j(const M& model, const typename M::Joints& q,
                                    const typename M::Joints& qd) {
  using T = typename M::Scalar;
  using V = typename M::V;
  T twice = T(V(0));
  const auto v = body_velocities(model, q, qd);
  for (std::size_t i = 0; i < model.count(); ++i)
    twice += dot(v[i], model.aligned_inertia(i).times(v[i])) + joint_armature(model.laws[i]) * qd[i] * qd[i];
  return twice * V(0.5);
}

/// Potential energy of gravity (zero with all centres of mass at the world's origin) and of the joints' springs, J.
template <class M>
typename M::Scalar potential_energy_j(const M& model, const typename M::Joints& q) {
  using T = typename M::Scalar;
  using V = typename M::V;
  T out = T(V(0));
  const auto frames = link_frames(model, q);
  for (std::size_t i = 0; i < model.count(); ++i) {
    const Inertia<T> b = model.body(i);
    const Vec3<T> moment = frames[i].at * b.mass_kg + transposed_times(frames[i].turn, b.moment_kgm);
    const JointLaw<T>& law = model.laws[i];
    const T stretch = q[i] - law.rest_rad, beyond = q[i] - law.one_way_rest_rad;
    out += law.stiffness_nmprad * stretch * stretch * V(0.5) + one_way_torque(law, q[i]) * beyond * V(0.5) -
           dot(model.gravity_mps2, moment);
  }
  return out;
}

/// Momentum of the bodies about the world's origin, world axes: angular (n, N m s) and linear (f, N s). Without the
/// rotors' spin, as in the equations of motion.
template <class M>
Force<typename M::Scalar> momentum(const M& model, const typename M::Joints& q,
                                   const typename M::Joints& qd) {
  using T = typename M::Scalar;
  using V = typename M::V;
  const T zero = T(V(0));
  const auto v = body_velocities(model, q, qd);
  std::array<Force<T>, M::kCapacity> h;
  Force<T> out{{zero, zero, zero}, {zero, zero, zero}};
  for (std::size_t i = 0; i < model.count(); ++i) h[i] = model.aligned_inertia(i).times(v[i]);
  for (std::size_t i = model.count(); i-- > 0;) {
    const Force<T> up = model.frame(i, q[i]).force_back(h[i]);
    const int parent = model.shape().parent(i);
    (parent < 0 ? out : h[static_cast<std::size_t>(parent)]) += up;
  }
  return out;
}

}  // namespace furcula::dynamics::tree
