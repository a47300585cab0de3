// A stance foot: a point of a body that is fixed to the ground, and the constraint force.
//
// Accelerations come from forward_dynamics with a free foot; the ground's force is the one that makes the point's
// acceleration zero, by the mass matrix. The same as an impulse is a touch-down without bounce.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"

namespace furcula::dynamics::tree {

/// Kinematics of a point of a body, world axes: position, Jacobian, and acceleration without joint accelerations.
template <class M>
struct PointMotion {
  using T = typename M::Scalar;                ///< the model's scalar
  Vec3<T> place_m;                             ///< position
  std::array<Vec3<T>, M::kCapacity> by_joint;  ///< [joint]: column of the Jacobian, m (prismatic: no unit)
  Vec3<T> drift_mps2;  ///< acceleration at joint accelerations zero, from the joints' velocities

  /// Jacobian times `rates` of the first `count` joints (at least one).
  Vec3<T> times(const typename M::Joints& rates, std::size_t count) const {
    Vec3<T> out = by_joint[0] * rates[0];
    for (std::size_t i = 1; i < count; ++i) out += by_joint[i] * rates[i];
    return out;
  }
};

/// Kinematics of `point`, whose joint must be >= 0, at state q, qd.
template <class M>
PointMotion<M> point_motion(const M& model, const Foothold<typename M::V>& point, const typename M::Joints& q,
                            const typename M::Joints& qd) {
  using T = typename M::Scalar;
  using V = typename M::V;
  const T zero = T(V(0));
  const Vec3<T> none{zero, zero, zero};
  const auto& shape = model.shape();
  std::array<std::size_t, M::kCapacity> way;  // joints from the base to the point
  std::size_t count = 0;
  for (int i = point.joint; i >= 0; i = shape.parent(static_cast<std::size_t>(i)))
    way[count++] = static_cast<std::size_t>(i);
  PointMotion<M> out;
  for (std::size_t i = 0; i < model.count(); ++i) out.by_joint[i] = none;
  // Body frames in the world; their turning, and the velocity and acceleration of their origins at rest of qd.
  Mat3<T> turn = {{T(V(1)), zero, zero}, {zero, T(V(1)), zero}, {zero, zero, T(V(1))}};  // world from body
  Vec3<T> at = none, w = none, alpha = none, a = none;
  std::array<Vec3<T>, M::kCapacity> axis, origin;
  for (std::size_t k = count; k-- > 0;) {
    const std::size_t i = way[k];
    const Frame<T> x = model.frame(i, q[i]);
    const Vec3<T> arm = turn * x.at;
    at += arm;
    a += cross(alpha, arm) + cross(w, cross(w, arm));
    turn = turn * transposed(x.turn);
    axis[i] = {turn.x.z, turn.y.z, turn.z.z};
    origin[i] = at;
    if (shape.kind(i) == JointKind::prismatic) {
      // The frame is at its slid place: what lies between turns with the parent, and slides.
      a += cross(w, axis[i]) * (qd[i] * V(2));
    } else {
      alpha += cross(w, axis[i]) * qd[i];
      w += axis[i] * qd[i];
    }
  }
  const auto last = static_cast<std::size_t>(point.joint);
  const Vec3<V> in_aligned = model.aligned(last).turn * point.at_m;
  const Vec3<T> arm = turn * Vec3<T>{T(in_aligned.x), T(in_aligned.y), T(in_aligned.z)};
  out.place_m = at + arm;
  out.drift_mps2 = a + cross(alpha, arm) + cross(w, cross(w, arm));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = way[k];
    out.by_joint[i] =
        shape.kind(i) == JointKind::prismatic ? axis[i] : cross(axis[i], out.place_m - origin[i]);
  }
  return out;
}

namespace detail {

/// The factor of a matrix that is symmetric and not negative. What has no pivot is left out of solutions: a direction
/// in which the point cannot move.
template <class T, std::size_t N>
class Factor {
 public:
  template <class Of>
  Factor(std::size_t count, const Of& of) : count_(count) {
    using V = ValueOf<T>;
    V largest = V(0);
    for (std::size_t i = 0; i < count; ++i)
      if (value_of(of(i, i)) > largest) largest = value_of(of(i, i));
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        T sum = of(i, j);
        for (std::size_t k = 0; k < j; ++k) sum -= l_[i][k] * l_[j][k];
        if (j < i)
          l_[i][j] = inverse_[j] * sum;
        else
          inverse_[i] = value_of(sum) > kLeast * largest ? T(V(1) / sqrt_of(sum)) : T(V(0));
        if (j == i) l_[i][i] = sum * inverse_[i];
      }
    }
  }
  template <class X>
  void solve(X& x) const {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= l_[i][k] * x[k];
      x[i] = x[i] * inverse_[i];
    }
    for (std::size_t i = count_; i-- > 0;) {
      for (std::size_t k = i + 1; k < count_; ++k) x[i] -= l_[k][i] * x[k];
      x[i] = x[i] * inverse_[i];
    }
  }

 private:
  static constexpr auto kLeast = ValueOf<T>(sizeof(ValueOf<T>) == 4 ? 1e-6 : 1e-12);
  static T sqrt_of(const T& x) {
    using std::sqrt;
    return sqrt(x);
  }
  std::size_t count_;
  std::array<std::array<T, N>, N> l_;
  std::array<T, N> inverse_;
};

/// What a force at the foot changes.
template <class M>
struct FootForce {
  using T = typename M::Scalar;
  PointMotion<M> point;
  MassMatrix<M> mass;
  std::array<std::size_t, M::kCapacity> movable;
  std::size_t movable_count = 0;
  std::array<typename M::Joints, 3> per_newton;  ///< accelerations of movable joints, of each direction
  std::array<std::array<T, 3>, 3> of_point{};    ///< of the point

  FootForce(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
            const typename M::Flags& held)
      : point(point_motion(model, model.foothold, q, qd)), mass(mass_matrix(model, q)) {
    for (std::size_t i = 0; i < model.count(); ++i)
      if (!held[i]) movable[movable_count++] = i;
    const Factor<T, M::kCapacity> factor(
        movable_count, [&](std::size_t i, std::size_t j) { return mass[movable[i]][movable[j]]; });
    for (std::size_t d = 0; d < 3; ++d) {
      typename M::Joints x;
      bool moves = false;  // a planar robot's point does not across its plane
      for (std::size_t i = 0; i < movable_count; ++i) {
        x[i] = part(point.by_joint[movable[i]], d);
        moves |= value_of(x[i]) != typename M::V(0);
      }
      if (moves) factor.solve(x);
      for (std::size_t i = 0; i < movable_count; ++i) per_newton[d][movable[i]] = x[i];
    }
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) {
        of_point[d][e] = T(typename M::V(0));
        for (std::size_t i = 0; i < movable_count; ++i)
          of_point[d][e] += part(point.by_joint[movable[i]], d) * per_newton[e][movable[i]];
      }
  }
  static const T& part(const Vec3<T>& v, std::size_t d) { return d == 0 ? v.x : d == 1 ? v.y : v.z; }

  /// The force that changes the point's motion by so much.
  std::array<T, 3> force(const Vec3<T>& change) const {
    std::array<T, 3> f{change.x, change.y, change.z};
    Factor<T, 3>(3, [&](std::size_t i, std::size_t j) { return of_point[i][j]; }).solve(f);
    return f;
  }
};

}  // namespace detail

/// Changes the accelerations and holding torques in `out` from those of a free foot to those of a foot fixed to the ground.
/// @return the ground's force on it, world axes, N
template <class M>
Vec3<typename M::Scalar> stand(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                               const typename M::Flags& held, Accelerations<M>& out) {
  using T = typename M::Scalar;
  const detail::FootForce<M> foot(model, q, qd, held);
  const std::size_t n = model.count();
  const auto f = foot.force(-(foot.point.times(out.joint_radps2, n) + foot.point.drift_mps2));
  typename M::Joints change{};
  for (std::size_t k = 0; k < foot.movable_count; ++k) {
    const std::size_t i = foot.movable[k];
    change[i] = foot.per_newton[0][i] * f[0] + foot.per_newton[1][i] * f[1] + foot.per_newton[2][i] * f[2];
    out.joint_radps2[i] += change[i];
  }
  const Vec3<T> force{f[0], f[1], f[2]};
  for (std::size_t i = 0; i < n; ++i) {
    if (!held[i]) continue;
    out.holding_nm[i] -= dot(foot.point.by_joint[i], force);
    for (std::size_t k = 0; k < foot.movable_count; ++k)
      out.holding_nm[i] += foot.mass[i][foot.movable[k]] * change[foot.movable[k]];
  }
  return force;
}

/// A touch-down without bounce: changes `qd` so that the foot is at rest; joint torques give no impulse.
/// @return the ground's impulse on the foot, world axes, N s
template <class M>
Vec3<typename M::Scalar> stop_foot(const M& model, const typename M::Joints& q, typename M::Joints& qd) {
  const detail::FootForce<M> foot(model, q, qd, typename M::Flags{});
  const auto f = foot.force(-foot.point.times(qd, model.count()));
  for (std::size_t i = 0; i < model.count(); ++i)
    qd[i] += foot.per_newton[0][i] * f[0] + foot.per_newton[1][i] * f[1] + foot.per_newton[2][i] * f[2];
  return {f[0], f[1], f[2]};
}

}  // namespace furcula::dynamics::tree
