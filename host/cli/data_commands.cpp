// The commands for models and logs, which both programs have.
#include "host/cli/commands.hpp"

namespace furcula::cli {

void add_data_commands(CLI::App& app, PlayGait play) {
  add_sim_command(app, play);
  add_identify_command(app);
  add_diagnose_command(app);
  add_demo_command(app);
  add_effects_command(app);
  add_check_command(app);
  add_convert_command(app);
  add_replay_command(app);
  add_map_command(app);
}

}  // namespace furcula::cli
