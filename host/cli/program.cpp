// `furcula`: all commands.
#include "host/cli/commands.hpp"
#include "host/cli/walk_gait_command.hpp"
#include "host/cli/walk_identify_command.hpp"
#include "host/cli/walk_loop_command.hpp"

void furcula::cli::add_commands(CLI::App& app) {
  add_data_commands(app, play_gait);
  add_bench_command(app);
  add_bus_command(app);
  add_flash_command(app);
  add_energy_command(app);
  add_excite_command(app);
  add_gait_command(app);
  add_gait_study_command(app);
  CLI::App* walk = add_walk_command(app);
  add_walk_gait_command(*walk);
  add_walk_identify_command(*walk);
  add_walk_loop_command(*walk);
  add_reproduce_command(app);
  add_monitor_command(app);
  add_param_command(app);
  add_request_command(app);
  add_serve_command(app);
  add_safety_command(app);
  add_rig_command(app);
}
