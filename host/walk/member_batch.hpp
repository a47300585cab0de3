// What the members of an ensemble that are in the lanes measure wrong, and what pushes them.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/control/walk/walk.hpp"
#include "furcula/dynamics/biped/step.hpp"
#include "host/walk/member.hpp"

namespace furcula::walk {

/// From the pelvis' axes to the IMU's.
inline dynamics::tree::Mat3<double> imu_axes(const Member& m) {
  const auto& t = m.sensors.imu_turn_rad;
  return transposed(rotation(
      dynamics::biped::normalised(control::Quaternion<double>{1.0, 0.5 * t.x, 0.5 * t.y, 0.5 * t.z})));
}

/// T is a number in lanes, or double.
template <class T>
class MemberBatch {
  using V = dynamics::ValueOf<T>;
  static constexpr std::size_t kRobots = control::WalkState<T>::kRobots;

 public:
  /// A member begins in a lane. It is not copied.
  void begin(std::size_t lane, const Member& member, const dynamics::tree::Vec3<double>& gravity_mps2) {
    using namespace dynamics::biped;
    member_[lane] = &member;
    next_push_[lane] = 0;
    put(change_s_, lane, 0.0);
    put(gravity_mps2_, lane, gravity_mps2);
    put(gyro_bias_radps_, lane, member.sensors.gyro_bias_radps);
    put(foot_change_n_, lane, member.foot_change_n);
    const auto to_imu = imu_axes(member);
    put(to_imu_.x, lane, to_imu.x), put(to_imu_.y, lane, to_imu.y), put(to_imu_.z, lane, to_imu.z);
    for (std::size_t i = 0; i < kJoints; ++i) {
      T all = joint<T>(offset_rad_, i);
      put(all, lane, member.sensors.encoder_rad[i]);
      set_joint<T>(offset_rad_, i, all);
    }
  }

  void sense(control::WalkSample<T>& sample, control::Imu<T>& imu) const {
    using dynamics::biped::Legs;
    for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
      for (std::size_t j = 0; j < dynamics::biped::kLegJoints; ++j)
        sample.q_rad[pass][j] += offset_rad_[pass][j];
    imu = {to_imu_ * imu.gyro_radps + gyro_bias_radps_, to_imu_ * imu.acc_mps2};
    sample.gyro_radps = imu.gyro_radps;
  }
  T measured_n(const T& normal_n) const { return normal_n + foot_change_n_; }

  /// The drives hold what their encoders read.
  void command(dynamics::biped::Commands<T>& c) const {
    using dynamics::biped::Legs;
    for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
      for (std::size_t j = 0; j < dynamics::biped::kLegJoints; ++j)
        c.target_rad[pass][j] -= offset_rad_[pass][j];
  }

  /// Gravity without pushes.
  const dynamics::tree::Vec3<T>& gravity_mps2() const { return gravity_mps2_; }

  /// Writes gravity and pushes of the tick that is `tick_s` long to `field_mps2`, where they change.
  void push(const T& time_s, double tick_s, dynamics::tree::Vec3<T>& field_mps2) {
    const double half = 0.5 * tick_s;
    if (!dynamics::any(T(time_s + static_cast<V>(half)) > change_s_)) return;
    for (std::size_t lane = 0; lane < kRobots; ++lane) {
      // As the line above says it, so that it hangs on no other lane.
      if (!(dynamics::lane_of(T(time_s + static_cast<V>(half)), lane) > dynamics::lane_of(change_s_, lane)))
        continue;
      const double now_s = read(time_s, lane) + half;
      const auto& pushes = member_[lane]->pushes;
      std::size_t& k = next_push_[lane];
      while (k < pushes.size() && pushes[k].end_s <= now_s) ++k;
      dynamics::tree::Vec3<double> field{read(gravity_mps2_.x, lane), read(gravity_mps2_.y, lane),
                                         read(gravity_mps2_.z, lane)};
      double change_s = 1e9;
      if (k < pushes.size()) {
        const bool is_on = pushes[k].begin_s <= now_s;
        if (is_on) field.x += pushes[k].x_mps2, field.y += pushes[k].y_mps2;
        change_s = is_on ? pushes[k].end_s : pushes[k].begin_s;
      }
      put(field_mps2, lane, field);
      put(change_s_, lane, change_s);
    }
  }

 private:
  static double read(const T& x, std::size_t lane) { return static_cast<double>(dynamics::lane_of(x, lane)); }
  static void put(T& x, std::size_t lane, double v) { dynamics::set_lane(x, lane, static_cast<V>(v)); }
  static void put(dynamics::tree::Vec3<T>& x, std::size_t lane, const dynamics::tree::Vec3<double>& v) {
    put(x.x, lane, v.x), put(x.y, lane, v.y), put(x.z, lane, v.z);
  }

  std::array<const Member*, kRobots> member_{};
  std::array<std::size_t, kRobots> next_push_{};
  T change_s_{};  ///< when its push begins or ends next
  dynamics::tree::Vec3<T> gravity_mps2_{}, gyro_bias_radps_{};
  dynamics::tree::Mat3<T> to_imu_{};
  T foot_change_n_{};
  dynamics::biped::Joints<T> offset_rad_{};
};

}  // namespace furcula::walk
