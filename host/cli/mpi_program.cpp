// `furcula-mpi`: `furcula walk` on several processes, by MPI (docs/biped.md). Rank 0 is the program; the others run walks for it.
#include <cstdlib>

#include "host/cli/commands.hpp"
#include "host/cli/walk_command.hpp"
#include "host/walk/ranks.hpp"

void furcula::cli::add_commands(CLI::App& app) {
  // To the end of the process: what ends it (--help, an error) also lets the other ranks end.
  static walk::Ranks ranks;
  if (ranks.rank() > 0) {
    ranks.serve();
    std::exit(0);
  }
  app.footer(
      "This is furcula-mpi. `furcula` has the other commands, and `walk` on the threads of one process.");
  add_walk_command(app, [](const dynamics::biped::Description& robot, walk::SearchOptions& options) {
    ranks.run_for(robot, options);
  });
}
