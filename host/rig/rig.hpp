// A mocked robot on a real bus: plays drive, encoder nodes, switch and solenoid, with the plant behind them,
// against a board's own program.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "boards/sim_host/board.hpp"
#include "furcula/control/controller.hpp"
#include "host/log/log.hpp"
#include "host/model/model.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::rig {

/// The rig cannot run, or its peer does not play along; the message says why.
struct RigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct RigOptions {
  std::string can_interface = "vcan0";
  std::string gpio_folder;  ///< of the gpio-sim bank (gpio_sim.hpp)
  std::vector<std::string>
      command;  ///< starts the board's program, which gets a configuration file as its last argument
  std::string configuration_path;  ///< where that file is written
  std::string gpio_chip;           ///< as the configuration names it
  /// Where given, the scenario's faults begin on the tick after the first one, from 0.6 s on, of which this
  /// is true, and their times count from there. It is asked on each tick. The run then ends soon after the
  /// board has told its drive to be off.
  std::function<bool(const sim_host::SimBoard&)> moment;
  double watched_s = std::numeric_limits<double>::infinity();  ///< after the first fault began; then the end
};

struct RigResult {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  log::Log log;
  double onset_s = kNever;         ///< when the first fault began
  double told_off_s = kNever;      ///< when the drive was first told to be off, after that
  double last_torque_s = 0.0;      ///< when the motor gave torque last
  std::uint32_t fault = 0;         ///< that the board told of last, a number of the table of faults
  bool fault_before = false;       ///< it told of one before anything was broken
  std::uint32_t landings = 0;      ///< after that
  std::uint32_t silent_ticks = 0;  ///< without a frame for the drive
  std::uint32_t late_ticks = 0;    ///< on which the rig itself was late by a millisecond or more
  std::string complaint;           ///< of the drive; empty: none
};

/// furculad's configuration file for this rig and a controller.
std::string board_configuration(const RigOptions& options, const control::Config& config, bool clutch,
                                std::uint32_t home_count, float home_height_m);

/// Runs a scenario in the time of this kernel. Waits until the board is idle, tells it to hop, and lets the
/// body go when the drive is switched on. @throws RigError: no interface, no chip; a board that does not
/// start, dies, or says nothing for longer than a second.
RigResult run(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed,
              const RigOptions& options);

}  // namespace furcula::rig
