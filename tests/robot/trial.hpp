// A walk tried on the robot in MuJoCo, by the board's controller: whether it stands, how far it got, and its log.
#pragma once

#include <cstdint>
#include <string>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/log/log.hpp"
#include "host/walk/walk_toml.hpp"
#include "tests/robot/mujoco_biped.hpp"

namespace furcula::robot {

struct TrialOptions {
  double time_s = 10.0;  ///< of walking, from when the stand lets go; an exercise has its own
  Disturbances disturbances;
  std::uint64_t seed = 1;  ///< of the disturbances
  double row_s = 0.01;
};

struct Trial {
  bool stands = false;      ///< or, of an exercise, it went to its end
  std::string ending;       ///< "stands", "below 0.8 m after 2.4 s", or the board's fault
  double time_s = 0.0;      ///< of walking
  double distance_m = 0.0;  ///< of the centre of mass, forward
  double energy_j = 0.0;    ///< motors' work (signed), copper and constant power, as document 000, eq. 1
  double cot = 0.0;         ///< infinite where it did not get ahead
  log::Log log;             ///< as `furcula walk sim` writes it
};

/// `known`: the robot as the board has it. @throws std::runtime_error where MuJoCo does not take the robot.
Trial try_walk(const Truth& truth, const dynamics::biped::Description& known, const walk::Walk& walk,
               const TrialOptions& options);

}  // namespace furcula::robot
