// The program furculad: arguments and exit statuses.
#include <cstring>
#include <exception>
#include <iostream>
#include <string>

#include "boards/linux_sbc/daemon.hpp"
#include "host/core/message.hpp"

namespace {

constexpr const char* kUsage =
    "usage: furculad [--check] CONFIGURATION.toml\n"
    "Runs the robot that the file describes (docs/linux_board.md). --check only reads the file.\n"
    "SIGTERM, SIGINT, SIGQUIT, SIGHUP, SIGPIPE: safe state and end. SIGUSR1: figures of the loop.\n"
    "Ends with status 0 after SIGTERM, 2 for unusable arguments, 3 for an unusable file, 4 where a board is not there.\n";

int tell(const char* message, int status) {
  std::cerr << "furculad: " << furcula::core::printable_lines(message) << "\n";
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  bool check = false;
  const char* path = nullptr;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--help") == 0) {
      std::cout << kUsage;
      return 0;
    }
    if (std::strcmp(argv[i], "--version") == 0) {
      std::string text;
      std::cout << furcula::linux_sbc::own_identity(text).text << "\n";
      return 0;
    }
    if (std::strcmp(argv[i], "--check") == 0)
      check = true;
    else if (argv[i][0] == '-' || path != nullptr)
      return tell("one configuration file is expected, and --check or nothing besides (furculad --help)", 2);
    else
      path = argv[i];
  }
  if (path == nullptr) return tell("no configuration file (furculad --help)", 2);
  bool sound = false;
  try {
    const auto configuration = furcula::linux_sbc::read_configuration(path);
    sound = true;
    if (check) {
      if (const std::string warning = furcula::linux_sbc::network_warning(configuration); !warning.empty())
        std::cerr << "furculad: warning: " << furcula::core::printable_lines(warning) << "\n";
      std::cout << "furculad: " << furcula::core::printable(path) << " is sound\n";
      return 0;
    }
    furcula::linux_sbc::run_daemon(configuration);
    return 0;
  } catch (const std::exception& e) {
    return tell(e.what(), sound ? 4 : 3);
  }
}
