#include "tests/robot/trial.hpp"

#include <cmath>
#include <limits>

#include "host/core/message.hpp"
#include "host/walk/board_log.hpp"
#include "host/walk/exercise.hpp"
#include "host/walk/rollout.hpp"
#include "host/walk/walker_config.hpp"

namespace furcula::robot {
using namespace dynamics::biped;

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
  const bool exercises = walk.exercise_s > 0.0;
  const double asked_s = exercises ? walk.exercise_s + walk::kExerciseRest_s : options.time_s;
  MujocoBiped robot(truth, passive_hips, exercises, posture_rad, options.disturbances, options.seed);
  control::WalkerState board = control::begin_walker(config);
  control::WalkerOutputs told;
  Trial out;
  out.log.rig = "tree";
  double begin_s = 0.0, begin_m = 0.0;
  const long every = std::lround(options.row_s / MujocoBiped::kTick_s);
  for (long tick = 0;; ++tick) {
    const control::WalkerInputs in = robot.sense();
    told = control::step_walker(config, board, in, static_cast<float>(MujocoBiped::kTick_s));
    const bool held = robot.holds();
    robot.advance(told);
    if (robot.holds()) {
      if (robot.time_s() < kLongestOnStand_s && told.fault == control::Fault::none) continue;
      out.ending = "does not begin, fault " + std::to_string(static_cast<int>(told.fault));
      break;
    }
    if (held) begin_s = robot.time_s(), begin_m = robot.forward_m();
    out.time_s = robot.time_s() - begin_s;
    if (std::lround(out.time_s / MujocoBiped::kTick_s) % every == 0)
      walk::put_row(out.log, out.time_s, in.sample, board, told);
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
    if (!exercises && !(robot.position_m()[2] > kFallen_m)) {
      out.ending = "below 0.8 m after " + core::rounded(out.time_s, 3) + " s";
      break;
    }
    if (out.time_s >= asked_s) {
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
