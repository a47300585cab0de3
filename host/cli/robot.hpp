// What the commands that talk to a robot share: the option --port, and its errors.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "host/cli/errors.hpp"
#include "host/core/error.hpp"
#include "host/modbus/client.hpp"

namespace furcula::cli {

struct RobotOptions {
  std::string port;
  int unit = 1;
};

inline void add_robot_options(CLI::App& command, RobotOptions& options) {
  command
      .add_option("--port", options.port,
                  "Where the robot answers: modbus:/dev/NAME@BAUD (8E1; or @BAUD,8N1), modbus:HOST:PORT or "
                  "can:INTERFACE (node 1; or can:INTERFACE@NODE)")
      ->required();
  command.add_option("--unit", options.unit, "Modbus address on a serial line")
      ->check(CLI::Range(1, 247))
      ->capture_default_str();
}

/// @throws UsageError where the port is not written as one, core::DataError where nothing answers there.
inline modbus::Client connect(const RobotOptions& options) {
  modbus::Port port;
  try {
    port = modbus::parse_port(options.port);
  } catch (const core::DataError& e) {
    throw UsageError(e.what());
  }
  return modbus::Client(port, options.unit);
}

/// A robot's refusal is the command's.
template <class Run>
auto guarded(Run run) {
  return [run] {
    try {
      run();
    } catch (const modbus::Refused& e) {
      throw Refusal(e.what());
    }
  };
}

}  // namespace furcula::cli
