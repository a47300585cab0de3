#include "host/walk/simulation.hpp"

#include <cmath>
#include <string>

#include "host/walk/roll_pitch_yaw.hpp"
#include "host/walk/sensors.hpp"

namespace furcula::walk {

using namespace dynamics::biped;

Simulation simulate_walk(const Description& robot, const RolloutOptions& options, const Parameters& walk,
                         double row_s, std::optional<std::uint64_t> seed) {
  Simulation out;
  out.log.rig = "tree";
  auto& columns = out.log.columns;
  const auto every = std::max<long>(1, std::lround(row_s / options.tick_s()));
  BatchedRollout<double> rollouts(robot, robot, options);
  control::Imu<double> imu;
  std::optional<Sensors> sensors;
  if (seed) sensors.emplace(SensorErrors{}, *seed);
  rollouts.senses = [&](control::WalkSample<double>& sample, control::Imu<double>& measured) {
    if (sensors) (*sensors)(sample, measured);
    imu = measured;
  };
  long tick = 0;
  // The sample, and what the controller made of it; the torques are those of the tick that follows.
  rollouts.watch = [&](const WalkMoment<double>& m) {
    if (tick++ % every != 0) return;
    const auto put = [&](const std::string& name, double value) { columns[name].push_back(value); };
    put("time_s", m.time_s - options.tick_s());
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::string name = joint_name(i);
      put("angle_" + name + "_rad", joint<double>(m.sample.q_rad, i));
      put("velocity_" + name + "_radps", joint<double>(m.sample.qd_radps, i));
      put("angle_cmd_" + name + "_rad", joint<double>(m.out.target_rad, i));
      put("torque_" + name + "_nm", joint<double>(m.report.torque.motor_nm, i));
    }
    put("gyro_x_radps", imu.gyro_radps.x), put("gyro_y_radps", imu.gyro_radps.y),
        put("gyro_z_radps", imu.gyro_radps.z);
    put("acc_x_mps2", imu.acc_mps2.x), put("acc_y_mps2", imu.acc_mps2.y), put("acc_z_mps2", imu.acc_mps2.z);
    const RollPitchYaw turn = roll_pitch_yaw(m.sample.attitude);
    put("roll_rad", turn.roll_rad), put("pitch_rad", turn.pitch_rad), put("yaw_rad", turn.yaw_rad);
    put("contact_left_foot", m.sample.left_carries), put("contact_right_foot", m.sample.right_carries);
    put("base_x_m", m.position_m.x), put("base_y_m", m.position_m.y), put("base_z_m", m.position_m.z);
  };
  out.rollout = rollouts.run_one(walk);
  return out;
}

}  // namespace furcula::walk
