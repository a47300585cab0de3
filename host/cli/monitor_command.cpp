// `furcula monitor`: what a robot does, live on a terminal, and why it does not move.
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "host/cli/commands.hpp"
#include "host/cli/robot.hpp"
#include "host/modbus/monitor.hpp"

namespace furcula::cli {
namespace {

struct MonitorOptions {
  RobotOptions robot;
  bool once = false, json = false;
  double every_s = 0.2;
};

/// For ever, or until stdout is closed: a robot that does not answer may come back.
void follow(const MonitorOptions& options) {
  const bool terminal = ::isatty(STDOUT_FILENO) != 0;
  std::optional<modbus::Client> robot;
  modbus::DeviceNames names;
  for (auto next = std::chrono::steady_clock::now(); std::cout; std::this_thread::sleep_until(next)) {
    next += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(options.every_s));
    std::string shown;
    try {
      if (!robot) {
        robot.emplace(connect(options.robot));
        names = robot->names();
      }
      const modbus::View view{names, robot->snapshot(), robot->faults()};
      shown = options.json ? modbus::to_json(view) + "\n" : modbus::to_text(view);
    } catch (const core::DataError& e) {
      robot.reset();
      if (options.json) throw;
      shown = std::string("no answer  ") + e.what() + "\n";
      next = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    }
    // Home, and what stood there before is wiped.
    if (terminal && !options.json) std::cout << "\x1b[H\x1b[J";
    std::cout << shown << std::flush;
  }
}

void run(const MonitorOptions& options) {
  if (!options.once) return follow(options);
  modbus::Client robot = connect(options.robot);
  const modbus::View view{robot.names(), robot.snapshot(), robot.faults()};
  std::cout << (options.json ? modbus::to_json(view) + "\n" : modbus::to_text(view));
}

}  // namespace

void add_monitor_command(CLI::App& app) {
  const auto options = std::make_shared<MonitorOptions>();
  CLI::App* command = app.add_subcommand("monitor", "Show live what a robot does, and why it does not move");
  add_robot_options(*command, options->robot);
  command->add_flag("--once", options->once, "Print what it shows now, and end");
  command->add_flag("--json", options->json, "One JSON object a line");
  command->add_option("--every", options->every_s, "Seconds between two looks")
      ->check(CLI::Range(0.02, 3600.0))
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
