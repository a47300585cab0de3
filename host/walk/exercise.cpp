#include "host/walk/exercise.hpp"

#include <array>
#include <cmath>
#include <deque>
#include <string>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/walk/board_log.hpp"
#include "host/walk/walker_config.hpp"
#include "host/walk/walker_rig.hpp"

namespace furcula::walk {

log::Log simulate_exercise(const dynamics::biped::Description& robot, const Walk& walk,
                           double command_delay_s, double row_s, std::optional<std::uint64_t> seed) {
  if (walk.mode != WalkMode::active && walk.mode != WalkMode::semi_passive)
    throw core::DataError("an exercise of mode " +
                          core::quoted(kModeNames[static_cast<std::size_t>(walk.mode)]) +
                          "; expected active or semi_passive, which a board runs");
  const WalkerRigConfig config{.robot = robot, .mode = walk.mode, .walk = walk.parameters, .seed = seed};
  WalkerRig rig(config);
  const control::WalkerConfig board =
      walker_config(robot, walk, config.foot_threshold_n, DriveTurns::each_tick);
  control::WalkerState state = control::begin_walker(board);
  log::Log log;
  log.rig = "tree";
  std::deque<std::array<control::JointCommand, control::kWalkerJoints>> on_the_way(
      static_cast<std::size_t>(std::lround(command_delay_s / WalkerRig::kTick_s)));
  const auto every = std::lround(row_s / WalkerRig::kTick_s);
  const auto ticks = std::lround((walk.exercise_s + kExerciseRest_s) / WalkerRig::kTick_s);
  for (long tick = 0; tick <= ticks;) {
    const control::WalkerInputs in = rig.sense();
    // An IMU that repeats itself to the last bit is a frozen one; without errors it does so here.
    if (!seed) state.supervisor.imu_same = 0;
    const control::WalkerOutputs told =
        control::step_walker(board, state, in, static_cast<float>(WalkerRig::kTick_s));
    control::WalkerOutputs late = told;
    on_the_way.push_back(told.joints);
    late.joints = on_the_way.front();
    on_the_way.pop_front();
    rig.advance(late);
    if (told.fault != control::Fault::none)
      throw core::DataError("the board ends the exercise after " +
                            core::rounded(WalkerRig::kTick_s * static_cast<double>(tick), 3) +
                            " s: " + std::string(control::info(told.fault).name) +
                            "; expected a robot that follows its targets on its stand");
    if (told.stage != control::WalkerStage::exercising) continue;
    if (tick % every == 0)
      put_row(log, WalkerRig::kTick_s * static_cast<double>(tick), in.sample, state, told);
    ++tick;
  }
  return log;
}

}  // namespace furcula::walk
