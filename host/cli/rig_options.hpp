// Options of the commands that run a board's own program in a mocked robot.
#pragma once

#include <CLI/CLI.hpp>

#include "host/rig/rig.hpp"

namespace furcula::cli {

/// Bus, GPIO chip and program; `options` must outlive the command.
inline void add_rig_options(CLI::App& command, rig::RigOptions& options) {
  command.add_option("--can", options.can_interface, "CAN interface")->capture_default_str();
  command
      .add_option("--gpio-sim", options.gpio_folder,
                  "Folder in sysfs of the gpio-sim bank with the two lines")
      ->required();
  command.add_option("--gpio-chip", options.gpio_chip, "The same chip as the board's program names it")
      ->required();
  command.add_option("program", options.command, "The board's program, furculad, and its arguments")
      ->required();
}

}  // namespace furcula::cli
