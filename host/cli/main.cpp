// The program `furcula`: the subcommands, and the exit status that each way to end has.
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace {

// docs/contracts.md, section 4.
enum ExitStatus { kWritten = 0, kUnusableArguments = 2, kUnusableData = 3, kRefused = 4 };

std::string unknown_command(CLI::App& app, const std::string& name) {
  std::vector<std::string_view> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return "no command " + furcula::core::quoted(name) + "; expected one of " + furcula::core::listed(names) +
         furcula::core::did_you_mean(name, names);
}

/// The first argument that looks like an option and is none of the command's; empty: there is none.
std::string unknown_option(CLI::App& command) {
  for (const std::string& argument : command.remaining()) {
    if (argument.size() < 2 || argument.front() != '-') continue;
    const std::string option = argument.substr(0, argument.find('='));
    std::vector<std::string> names;
    for (const CLI::Option* o : command.get_options())
      for (const std::string& name : o->get_lnames()) names.push_back("--" + name);
    const std::vector<std::string_view> views(names.begin(), names.end());
    return "no option " + furcula::core::quoted(option) + " of furcula " + command.get_name() +
           "; expected one of " + furcula::core::listed(views) + furcula::core::did_you_mean(option, views);
  }
  return {};
}

void run(int argc, char** argv) {
  CLI::App app("Finds what a simulation gets wrong about a legged robot, and why.", "furcula");
  app.set_version_flag("--version", "furcula " FURCULA_VERSION);
  app.require_subcommand(1);
  furcula::cli::add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    // --help and --version come as "errors" with status 0.
    if (e.get_exit_code() == 0) {
      app.exit(e);
      return;
    }
    // CLI11 asks for what is missing before it looks at what it does not know: a required option misspelt
    // would be said to be missing.
    for (CLI::App* command : app.get_subcommands())
      if (const std::string message = unknown_option(*command); !message.empty())
        throw furcula::cli::UsageError(message);
    // CLI11 asks for a subcommand before it looks at what stands in its place.
    const std::vector<std::string> rest =
        app.get_subcommands().empty() ? app.remaining() : std::vector<std::string>{};
    throw furcula::cli::UsageError(rest.empty()
                                       ? e.what() + std::string(" (furcula --help, furcula COMMAND --help)")
                                       : unknown_command(app, rest.front()));
  }
}

/// File names, columns and what devices say of themselves are in it.
int tell(const std::string& message, ExitStatus status) {
  std::cerr << "furcula: " << furcula::core::printable_lines(message) << "\n";
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
    std::cout.flush();
    return std::cout ? kWritten : tell("stdout: cannot be written", kUnusableArguments);
  } catch (const furcula::cli::UsageError& e) {
    return tell(e.what(), kUnusableArguments);
  } catch (const furcula::core::OutputError& e) {
    return tell(e.what(), kUnusableArguments);
  } catch (const furcula::core::DataError& e) {
    return tell(e.what(), kUnusableData);
  } catch (const furcula::cli::Refusal& e) {
    return tell(e.what(), kRefused);
  } catch (const std::bad_alloc&) {
    return tell("not enough memory for these data", kUnusableData);
  } catch (const std::exception& e) {
    return tell(std::string("unexpected error: ") + e.what(), kUnusableData);
  } catch (...) {
    return tell("unexpected error of unknown kind", kUnusableData);
  }
}
