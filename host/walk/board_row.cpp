#include "host/walk/board_row.hpp"

#include "furcula/dynamics/biped/topology.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::walk {

std::string joint_name(std::size_t i) {
  using namespace dynamics::biped;
  return (i < kLegJoints ? "left_" : "right_") + std::string(kLegJointNames[i % kLegJoints]);
}

std::vector<std::string> board_columns() {
  std::vector<std::string> out{"time_s"};
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i) {
    const std::string name = joint_name(i);
    for (const std::string& column : {"angle_" + name + "_rad", "velocity_" + name + "_radps",
                                      "angle_cmd_" + name + "_rad", "torque_" + name + "_nm"})
      out.push_back(column);
  }
  for (const char* column :
       {"gyro_x_radps", "gyro_y_radps", "gyro_z_radps", "acc_x_mps2", "acc_y_mps2", "acc_z_mps2", "roll_rad",
        "pitch_rad", "yaw_rad", "contact_left_foot", "contact_right_foot"})
    out.emplace_back(column);
  return out;
}

BoardRow board_row(double time_s, const control::WalkerSample& sample, const control::WalkerState& board,
                   const control::WalkerOutputs& told) {
  BoardRow out{};
  std::size_t n = 0;
  const auto put = [&](double value) { out[n++] = value; };
  put(time_s);
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i)
    for (const float value : {sample.joints[i].angle_rad, sample.joints[i].rate_radps,
                              told.joints[i].target_rad, sample.joints[i].torque_nm})
      put(static_cast<double>(value));
  const auto &g = sample.gyro_radps, &a = sample.acc_mps2;
  for (const float value : {g.x, g.y, g.z, a.x, a.y, a.z}) put(static_cast<double>(value));
  const auto& q = board.filter.attitude;
  const RollPitchYaw turn = roll_pitch_yaw({static_cast<double>(q.w), static_cast<double>(q.x),
                                            static_cast<double>(q.y), static_cast<double>(q.z)});
  put(turn.roll_rad), put(turn.pitch_rad), put(turn.yaw_rad);
  for (const auto& foot : board.feet) put(foot.carries > 0.5f ? 1.0 : 0.0);
  return out;
}

}  // namespace furcula::walk
