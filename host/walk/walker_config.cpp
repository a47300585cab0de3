#include "host/walk/walker_config.hpp"

#include <cmath>

namespace furcula::walk {
namespace {

using namespace dynamics::biped;

constexpr double kTick_s = 1e-3;  // a board's

std::uint32_t passive_pins(WalkMode mode) {
  return mode == WalkMode::semi_passive ? 1u << kHipClutch | 1u << (kClutches + kHipClutch) : 0u;
}

}  // namespace

control::WalkerConfig walker_config(const Description& robot, const Walk& walk, double foot_threshold_n,
                                    DriveTurns turns) {
  control::WalkerConfig c;
  auto values = control::WalkParameters<float>{}.values();
  const auto given = walk.parameters.values();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(given[i]);
  c.walk = {control::WalkParameters<float>::of(values), dynamics::biped::Parameters<float>(robot)};
  c.walk.walk_until_s = static_cast<float>(walk.walk_until_s);
  c.exercise_s = static_cast<float>(walk.exercise_s);
  c.passive_pins = passive_pins(walk.mode);
  c.foot_threshold_n = static_cast<float>(foot_threshold_n);
  c.sole_m = static_cast<float>(-robot.vertices_m[kLeft][0].z);
  // One lost answer, as with answers in each tick.
  if (turns != DriveTurns::each_tick) c.supervisor.missed_max = 3;
  constexpr double kBeyondBuses = control::kTorqueLagMost - 2, kDelay = kMostCommandDelay_s / kTick_s;
  static_assert(kDelay > kBeyondBuses - 0.5 && kDelay < kBeyondBuses + 0.5);
  // What is read now was answered in the last tick, to what was told two ticks before that.
  if (turns == DriveTurns::over_buses) c.supervisor.torque_lag_ticks = 2;
  c.supervisor.torque_lag_ticks += static_cast<std::uint32_t>(std::lround(walk.command_delay_s / kTick_s));
  c.supervisor.gravity_mps2 = static_cast<float>(robot.gravity_mps2);
  return c;
}

}  // namespace furcula::walk
