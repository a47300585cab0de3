// Attitude of a pelvis from its IMU: the explicit complementary filter of Mahony, Hamel and Pflimlin ("Nonlinear
// complementary filters on the special orthogonal group", IEEE Transactions on Automatic Control 53-5, 2008, eq. 32), a
// pure step.
//
//   up = R' e_z;  e = acc / |acc| x up;  R <- R exp((gyro - b + kP e) h);  b <- b - kI e h
//
// Yaw is the integral of the gyro about the vertical: 0 at the start. The same code runs on the board, in simulation and
// over logs.
#pragma once

#include "furcula/dynamics/biped/state.hpp"

namespace furcula::control {

using dynamics::biped::Quaternion;
using dynamics::tree::Vec3;

/// What an IMU measures, in its own axes.
template <class T>
struct Imu {
  Vec3<T> gyro_radps,  ///< angular velocity
      acc_mps2;        ///< specific force: at rest, the opposite of gravity
};

/// Gains of step_attitude().
template <class T>
struct AttitudeGains {
  T towards_up_1ps = T(dynamics::ValueOf<T>(0.5));  ///< kP
  T bias_1ps2 = T(dynamics::ValueOf<T>(0.02));      ///< kI
};

/// State of the attitude filter. attitude_at_rest() makes it.
template <class T>
struct AttitudeFilter {
  Quaternion<T> attitude{};  ///< from the IMU's axes to level axes, z up
  Vec3<T> bias_radps{};      ///< estimated bias of the gyro, in the IMU's axes
};

/// The filter's state at rest: roll and pitch from the accelerometer, yaw 0, no bias. Only the direction of `acc_mps2`
/// counts; it must not be along the x axis.
template <class T>
AttitudeFilter<T> attitude_at_rest(const Vec3<T>& acc_mps2) {
  using V = dynamics::ValueOf<T>;
  using dynamics::square_root;
  const T across2 = acc_mps2.y * acc_mps2.y + acc_mps2.z * acc_mps2.z;
  const T size = square_root(T(across2 + acc_mps2.x * acc_mps2.x)), across = square_root(across2);
  // Cosines and sines of half of roll and pitch.
  const auto half = [](const T& cosine, const T& sine) {
    const T c = square_root(T(V(0.5) * (V(1) + cosine)));
    return std::array<T, 2>{c, V(0.5) * sine / c};
  };
  const auto roll = half(acc_mps2.z / across, acc_mps2.y / across);
  const auto pitch = half(across / size, -(acc_mps2.x / size));
  const T zero = T(V(0));
  return {{pitch[0] * roll[0], pitch[0] * roll[1], pitch[1] * roll[0], -(pitch[1] * roll[1])},
          {zero, zero, zero}};
}

/// The upward unit vector in the IMU's axes.
template <class T>
FURCULA_INLINE Vec3<T> up_of(const Quaternion<T>& a) {
  using V = dynamics::ValueOf<T>;
  return {V(2) * (a.x * a.z - a.w * a.y), V(2) * (a.y * a.z + a.w * a.x),
          V(1) - V(2) * (a.x * a.x + a.y * a.y)};
}

/// One sample: from the attitude at its time to that `h_s` later. The accelerometer is not used below 1 m/s^2, as in a
/// free fall.
template <class T>
FURCULA_INLINE void step_attitude(const AttitudeGains<T>& gains, const Imu<T>& imu, const T& h_s,
                                  AttitudeFilter<T>& f) {
  using V = dynamics::ValueOf<T>;
  using dynamics::biped::normalised;
  using dynamics::biped::rate;
  const Vec3<T>& a = imu.acc_mps2;
  const T size = dynamics::square_root(T(dot(a, a)));
  const T share = dynamics::select(size > V(1), T(V(1) / size), T(V(0)));
  const Vec3<T> e = cross(a, up_of(f.attitude)) * share;
  const Vec3<T> turn = (imu.gyro_radps - f.bias_radps + e * gains.towards_up_1ps) * h_s;
  const Quaternion<T> d = rate(f.attitude, turn);
  const Quaternion<T>& q = f.attitude;
  f.attitude = normalised(Quaternion<T>{q.w + d.w, q.x + d.x, q.y + d.y, q.z + d.z});
  f.bias_radps = f.bias_radps - e * T(gains.bias_1ps2 * h_s);
}

}  // namespace furcula::control
