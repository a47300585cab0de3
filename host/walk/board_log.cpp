#include "host/walk/board_log.hpp"

#include <string>

#include "host/walk/roll_pitch_yaw.hpp"
#include "host/walk/simulation.hpp"

namespace furcula::walk {

void put_row(log::Log& log, double time_s, const control::WalkerSample& sample,
             const control::WalkerState& board, const control::WalkerOutputs& told) {
  const auto put = [&](const std::string& name, double value) { log.columns[name].push_back(value); };
  const auto number = [&](const std::string& name, float value) { put(name, static_cast<double>(value)); };
  put("time_s", time_s);
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i) {
    const std::string name = joint_name(i);
    number("angle_" + name + "_rad", sample.joints[i].angle_rad);
    number("velocity_" + name + "_radps", sample.joints[i].rate_radps);
    number("angle_cmd_" + name + "_rad", told.joints[i].target_rad);
    number("torque_" + name + "_nm", sample.joints[i].torque_nm);
  }
  const auto &g = sample.gyro_radps, &a = sample.acc_mps2;
  number("gyro_x_radps", g.x), number("gyro_y_radps", g.y), number("gyro_z_radps", g.z);
  number("acc_x_mps2", a.x), number("acc_y_mps2", a.y), number("acc_z_mps2", a.z);
  const auto& q = board.filter.attitude;
  const RollPitchYaw turn = roll_pitch_yaw({static_cast<double>(q.w), static_cast<double>(q.x),
                                            static_cast<double>(q.y), static_cast<double>(q.z)});
  put("roll_rad", turn.roll_rad), put("pitch_rad", turn.pitch_rad), put("yaw_rad", turn.yaw_rad);
  put("contact_left_foot", board.feet[0].carries > 0.5f);
  put("contact_right_foot", board.feet[1].carries > 0.5f);
}

}  // namespace furcula::walk
