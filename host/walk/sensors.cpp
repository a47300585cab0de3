#include "host/walk/sensors.hpp"

#include "host/core/random.hpp"

namespace furcula::walk {
namespace {

dynamics::tree::Vec3<double> drawn(core::Random& r, double sd) {
  const double x = sd * r.gaussian(), y = sd * r.gaussian(), z = sd * r.gaussian();
  return {x, y, z};
}

}  // namespace

Sensors::Sensors(const SensorErrors& errors, std::uint64_t seed) : e_(errors), seed_(seed) {
  core::Random r(seed, 0);
  for (double& o : offset_rad_) o = e_.encoder_offset_rad * r.gaussian();
  const dynamics::tree::Vec3<double> turn = drawn(r, 0.5 * e_.mounting_rad);
  mounting_ = transposed(
      rotation(dynamics::biped::normalised(control::Quaternion<double>{1.0, turn.x, turn.y, turn.z})));
  bias_radps_ = drawn(r, e_.gyro_bias_radps);
}

void Sensors::operator()(control::WalkSample<double>& sample, control::Imu<double>& imu) {
  using namespace dynamics::biped;
  core::Random r(seed_, ++tick_);
  for (std::size_t i = 0; i < kJoints; ++i) {
    set_joint<double>(sample.q_rad, i,
                      joint<double>(sample.q_rad, i) + offset_rad_[i] + e_.encoder_rad * r.gaussian());
    set_joint<double>(sample.qd_radps, i,
                      joint<double>(sample.qd_radps, i) + e_.encoder_radps * r.gaussian());
  }
  imu.gyro_radps = mounting_ * imu.gyro_radps + bias_radps_ + drawn(r, e_.gyro_radps);
  imu.acc_mps2 = mounting_ * imu.acc_mps2 + drawn(r, e_.acc_mps2);
  sample.gyro_radps = imu.gyro_radps;
}

}  // namespace furcula::walk
