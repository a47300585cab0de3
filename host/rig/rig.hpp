// A mocked robot on a real bus: plays drive, encoder nodes, switch and solenoid, with the plant behind them,
// against a board's own program.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

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
};

struct RigResult {
  log::Log log;
  std::uint32_t silent_ticks = 0;  ///< without a frame for the drive
  std::uint32_t late_ticks = 0;    ///< on which the rig itself was late by a millisecond or more
  std::string complaint;           ///< of the drive; empty: none
};

/// Which of the scenario's faults the rig cannot plant; empty: it can all of them.
std::string what_cannot_be_planted(const sim::Scenario& scenario);

/// furculad's configuration file for this rig and a controller.
std::string board_configuration(const RigOptions& options, const control::Config& config, bool clutch,
                                std::uint32_t home_count, float home_height_m);

/// Runs a scenario in the time of this kernel. Waits until the board is idle, tells it to hop, and lets the
/// body go when the drive is switched on. @throws RigError: no interface, no chip; a board that does not
/// start, dies, or says nothing for longer than a second.
RigResult run(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed,
              const RigOptions& options);

}  // namespace furcula::rig
