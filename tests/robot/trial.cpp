#include "tests/robot/trial.hpp"

#include <cmath>
#include <limits>

#include "host/core/message.hpp"
#include "host/walk/roll_pitch_yaw.hpp"
#include "host/walk/rollout.hpp"
#include "host/walk/simulation.hpp"
#include "host/walk/walker_config.hpp"

namespace furcula::robot {
namespace {

using namespace dynamics::biped;

void put_row(log::Log& log, double time_s, const control::WalkerInputs& in, const control::WalkerState& board,
             const control::WalkerOutputs& told) {
  const auto put = [&](const std::string& name, double value) { log.columns[name].push_back(value); };
  put("time_s", time_s);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const std::string name = walk::joint_name(i);
    put("angle_" + name + "_rad", static_cast<double>(in.sample.joints[i].angle_rad));
    put("velocity_" + name + "_radps", static_cast<double>(in.sample.joints[i].rate_radps));
    put("angle_cmd_" + name + "_rad", static_cast<double>(told.joints[i].target_rad));
    put("torque_" + name + "_nm", static_cast<double>(in.sample.joints[i].torque_nm));
  }
  const auto& g = in.sample.gyro_radps;
  const auto& a = in.sample.acc_mps2;
  put("gyro_x_radps", static_cast<double>(g.x)), put("gyro_y_radps", static_cast<double>(g.y)),
      put("gyro_z_radps", static_cast<double>(g.z));
  put("acc_x_mps2", static_cast<double>(a.x)), put("acc_y_mps2", static_cast<double>(a.y)),
      put("acc_z_mps2", static_cast<double>(a.z));
  const auto& q = board.filter.attitude;
  const walk::RollPitchYaw turn = walk::roll_pitch_yaw({static_cast<double>(q.w), static_cast<double>(q.x),
                                                        static_cast<double>(q.y), static_cast<double>(q.z)});
  put("roll_rad", turn.roll_rad), put("pitch_rad", turn.pitch_rad), put("yaw_rad", turn.yaw_rad);
  put("contact_left_foot", board.feet[0].carries > 0.5f),
      put("contact_right_foot", board.feet[1].carries > 0.5f);
}

}  // namespace

Trial try_walk(const Truth& truth, const Description& known, const walk::Walk& walk,
               const TrialOptions& options) {
  constexpr double kLongestOnStand_s = 3.0, kFallen_m = 0.8;
  constexpr double kThreshold_n = 30.0;
  const bool passive_hips = walk.mode == walk::WalkMode::semi_passive;
  const control::WalkerConfig config =
      walk::walker_config(known, walk, kThreshold_n, walk::DriveTurns::each_tick);
  std::array<double, kJoints> posture_rad{};
  const auto from = control::begin_walk(config.walk).from_rad;
  for (std::size_t i = 0; i < kJoints; ++i) posture_rad[i] = static_cast<double>(joint<float>(from, i));
  MujocoBiped robot(truth, passive_hips, posture_rad, options.disturbances, options.seed);
  control::WalkerState board = control::begin_walker(config);
  control::WalkerOutputs told;
  Trial out;
  out.log.rig = "tree";
  double begin_s = 0.0, begin_m = 0.0;
  const long every = std::lround(options.row_s / MujocoBiped::kTick_s);
  for (long tick = 0;; ++tick) {
    const control::WalkerInputs in = robot.sense();
    told = control::step_walker(config, board, in, static_cast<float>(MujocoBiped::kTick_s));
    const bool was_on_stand = robot.on_stand();
    robot.advance(told);
    if (robot.on_stand()) {
      if (robot.time_s() < kLongestOnStand_s && told.fault == control::Fault::none) continue;
      out.ending = "did not leave the stand, fault " + std::to_string(static_cast<int>(told.fault));
      break;
    }
    if (was_on_stand) begin_s = robot.time_s(), begin_m = robot.forward_m();
    out.time_s = robot.time_s() - begin_s;
    if (std::lround(out.time_s / MujocoBiped::kTick_s) % every == 0)
      put_row(out.log, out.time_s, in, board, told);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto& joint = in.sample.joints[i];
      const double nm = static_cast<double>(joint.torque_nm), radps = static_cast<double>(joint.rate_radps);
      out.energy_j += MujocoBiped::kTick_s * (nm * radps + known.copper_w_pnm2() * nm * nm);
    }
    out.energy_j += MujocoBiped::kTick_s * known.constant_power_w;
    if (told.fault != control::Fault::none) {
      out.ending = "fault " + std::to_string(static_cast<int>(told.fault)) + " after " +
                   core::rounded(out.time_s, 3) + " s";
      break;
    }
    if (!(robot.position_m()[2] > kFallen_m)) {
      out.ending = "below 0.8 m after " + core::rounded(out.time_s, 3) + " s";
      break;
    }
    if (out.time_s >= options.time_s) {
      out.stands = true;
      out.ending = "stands";
      break;
    }
  }
  out.distance_m = robot.forward_m() - begin_m;
  out.cot = out.distance_m > 0.0 ? out.energy_j / (known.mass_kg() * walk::kCotGravity_mps2 * out.distance_m)
                                 : std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace furcula::robot
