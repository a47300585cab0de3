// furculad's configuration file: how the robot is wired, and the controller's parameters
// (docs/linux_board.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "boards/linux_sbc/figures.hpp"
#include "boards/linux_sbc/gpio.hpp"
#include "firmware/app/can_link.hpp"
#include "firmware/app/walker_link.hpp"
#include "furcula/control/controller.hpp"
#include "furcula/control/walk/walker.hpp"

namespace furcula::linux_sbc {

/// Of a walking biped: the robot of dynamics/biped/design.hpp.
struct WalkerConfiguration {
  std::array<std::string, kMostBuses> can_interfaces;  ///< of the left leg, the right one, the body
  firmware::WalkerLinkConfig link;
  std::string walk_file;  ///< walk.toml; relative to the configuration file
  double foot_threshold_n = 30.0;
  std::string log_folder;  ///< where each walk is logged; relative to the configuration file; empty: nowhere
  int log_rate_hz = 100;
  control::WalkerConfig controller;  ///< the walk's, once it is read
};

/// Of a hopper, unless `walker` is there: then that and `priority`.
struct Configuration {
  std::optional<WalkerConfiguration> walker;
  std::string can_interface = "can0";
  firmware::CanLinkConfig link;
  GpioLine contact;
  GpioLine solenoid;
  bool has_solenoid = false;
  /// Where the rail's encoder reads `home_count` the body is at `home_height_m`; NaN: it is homed on a
  /// request.
  std::uint32_t home_count = 0;
  float home_height_m = __builtin_nanf("");
  std::uint32_t cable_home_count = 0;  ///< what the cable's encoder reads with the cable at rest
  std::string modbus_address = "127.0.0.1";
  int modbus_port = 1502;
  bool modbus = true;
  int priority = 80;           ///< SCHED_FIFO, 1 to 99; 0: the usual priority
  std::string store_file;      ///< where parameters are saved; empty: nowhere
  control::Config controller;  ///< the parameters as the file has them, the others at their defaults
};

/// Reads and checks the file, and a walker's walk. @throws core::DataError naming file, line, key, value and what was expected.
Configuration read_configuration(const std::string& path);

/// The same on text; `name` stands for the path in messages. A walk is not read.
Configuration parse_configuration(std::string_view text, const std::string& name);

/// What to warn of where Modbus listens on more than the loopback; empty: nothing.
std::string network_warning(const Configuration& configuration);

}  // namespace furcula::linux_sbc
