// Torques from accelerations (recursive Newton-Euler), mass matrix (composite rigid bodies), bias forces.
//
// Featherstone, Rigid Body Dynamics Algorithms (2008), tables 5.1 and 6.2.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/tree/joint_torque.hpp"
#include "furcula/dynamics/tree/model.hpp"

namespace furcula::dynamics::tree {

/// Joint torques for the bodies alone: M(q) qdd + C(q, qd) qd + g(q) without armature, springs and damping, N m.
template <class M>
typename M::Joints body_torques(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                                const typename M::Joints& qdd) {
  using T = typename M::Scalar;
  using V = typename M::V;
  constexpr std::size_t kN = M::kCapacity;
  std::array<Frame<T>, kN> x;
  std::array<Motion<T>, kN> velocity, acceleration;
  std::array<Force<T>, kN> force;
  typename M::Joints tau{};
  const auto& shape = model.shape();
  const T zero = T(V(0));

  shape.outwards([&](std::size_t i) {
    const bool slides = shape.kind(i) == JointKind::prismatic;
    x[i] = model.frame(i, q[i]);
    Motion<T> v{{zero, zero, zero}, {zero, zero, zero}};
    Motion<T> a{{zero, zero, zero}, x[i].turn * -model.gravity_mps2};
    if (shape.parent(i) >= 0) {
      const auto parent = static_cast<std::size_t>(shape.parent(i));
      v = x[i].motion(velocity[parent]);
      a = x[i].motion(acceleration[parent]);
    }
    (slides ? v.v.z : v.w.z) += qd[i];
    if (slides) {
      a.v += Vec3<T>{v.w.y * qd[i], -v.w.x * qd[i], qdd[i]};
    } else {
      a.w += Vec3<T>{v.w.y * qd[i], -v.w.x * qd[i], qdd[i]};
      a.v += Vec3<T>{v.v.y * qd[i], -v.v.x * qd[i], zero};
    }
    velocity[i] = v;
    acceleration[i] = a;
    const Inertia<T>& b = model.aligned_inertia(i);
    force[i] = b.times(a) + cross(v, b.times(v));
  });
  shape.inwards([&](std::size_t i) {
    tau[i] = shape.kind(i) == JointKind::prismatic ? force[i].f.z : force[i].n.z;
    if (shape.parent(i) >= 0) force[static_cast<std::size_t>(shape.parent(i))] += x[i].force_back(force[i]);
  });
  return tau;
}

/// The torques under which forward_dynamics gives `qdd`: body_torques with armature, damping and springs, N m.
template <class M>
typename M::Joints inverse_dynamics(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                                    const typename M::Joints& qdd) {
  auto tau = body_torques(model, q, qd, qdd);
  for (std::size_t i = 0; i < model.count(); ++i)
    tau[i] += joint_armature(model.laws[i]) * qdd[i] + passive_torque(model.laws[i], q[i], qd[i]);
  return tau;
}

/// C(q, qd) qd + g(q), N m: the torques at no acceleration, without damping and springs.
template <class M>
typename M::Joints bias_forces(const M& model, const typename M::Joints& q, const typename M::Joints& qd) {
  typename M::Joints none;
  none.fill(typename M::Scalar(typename M::V(0)));
  return body_torques(model, q, qd, none);
}

/// Rows of the joint-space inertia, kg m^2, armature included; symmetric, both halves filled. Entries beyond the model's
/// joints are not set.
template <class M>
using MassMatrix = std::array<typename M::Joints, M::kCapacity>;

/// The mass matrix at position q.
template <class M>
MassMatrix<M> mass_matrix(const M& model, const typename M::Joints& q) {
  using T = typename M::Scalar;
  using V = typename M::V;
  std::array<Frame<T>, M::kCapacity> x;
  std::array<Inertia<T>, M::kCapacity> composite;
  MassMatrix<M> out;
  const auto& shape = model.shape();
  const T zero = T(V(0));
  for (std::size_t i = 0; i < model.count(); ++i)
    for (std::size_t j = 0; j < model.count(); ++j) out[i][j] = zero;
  const auto along = [&](const Force<T>& f, std::size_t i) {
    return shape.kind(i) == JointKind::prismatic ? f.f.z : f.n.z;
  };
  shape.outwards([&](std::size_t i) {
    x[i] = model.frame(i, q[i]);
    composite[i] = model.aligned_inertia(i);
  });
  shape.inwards([&](std::size_t i) {
    Motion<T> axis{{zero, zero, zero}, {zero, zero, zero}};
    (shape.kind(i) == JointKind::prismatic ? axis.v.z : axis.w.z) = T(V(1));
    Force<T> f = composite[i].times(axis);
    out[i][i] = along(f, i) + joint_armature(model.laws[i]);
    for (int at = static_cast<int>(i), up = shape.parent(i); up >= 0;
         at = up, up = shape.parent(static_cast<std::size_t>(up))) {
      f = x[static_cast<std::size_t>(at)].force_back(f);
      const auto k = static_cast<std::size_t>(up);
      out[i][k] = out[k][i] = along(f, k);
    }
    if (shape.parent(i) >= 0) {
      const auto p = static_cast<std::size_t>(shape.parent(i));
      composite[p] = composite[p] + inertia_back(x[i], composite[i]);
    }
  });
  return out;
}

}  // namespace furcula::dynamics::tree
