// `furcula-demo`: what scripts/demo needs, and no more.
#include "host/cli/commands.hpp"

void furcula::cli::add_commands(CLI::App& app) {
  app.footer(
      "This is furcula-demo. `furcula` has the commands for robots, boards and stands too:\n"
      "cmake --build build/release --target furcula_program");
  add_data_commands(app);
}
