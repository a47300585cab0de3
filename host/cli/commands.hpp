// The subcommands of `furcula`. Each function adds one to the program, with its options and a callback that
// runs it. A callback throws UsageError, core::DataError, core::OutputError or Refusal; main.cpp makes exit
// statuses of them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "host/log/log.hpp"

namespace furcula::cli {

/// Those of the program that main() is linked into (program.cpp, demo_program.cpp).
void add_commands(CLI::App& app);

/// What a planar leg does that plays a gait: model file and gait file, and the seed of ground and sensors. The program for models and logs
/// alone has no gaits.
using PlayGait = log::Log (*)(const std::string& model, const std::string& gait, std::uint64_t seed);
log::Log play_gait(const std::string& model, const std::string& gait, std::uint64_t seed);

/// Those for models and logs.
void add_data_commands(CLI::App& app, PlayGait play = nullptr);
void add_sim_command(CLI::App& app, PlayGait play);
void add_identify_command(CLI::App& app);
void add_diagnose_command(CLI::App& app);
void add_demo_command(CLI::App& app);
void add_effects_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_convert_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_map_command(CLI::App& app);

// Those for robots, boards and stands.
void add_bench_command(CLI::App& app);
void add_bus_command(CLI::App& app);
void add_flash_command(CLI::App& app);
void add_energy_command(CLI::App& app);
void add_excite_command(CLI::App& app);
void add_gait_command(CLI::App& app);
void add_gait_study_command(CLI::App& app);
void add_reproduce_command(CLI::App& app);
void add_monitor_command(CLI::App& app);
void add_param_command(CLI::App& app);
void add_request_command(CLI::App& app);
void add_serve_command(CLI::App& app);
void add_safety_command(CLI::App& app);
void add_rig_command(CLI::App& app);
CLI::App* add_walk_command(CLI::App& app);  ///< the command itself, for `walk gait`

}  // namespace furcula::cli
