#include "host/flash/tools.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "firmware/startup/image_header.hpp"

namespace furcula::flash {
namespace {

std::string base_address() {
  std::ostringstream text;
  text << "0x" << std::hex;
  text.width(8);
  text.fill('0');
  text << firmware::kFlashBase;
  return text.str();
}

std::vector<Command> openocd_commands(const FlashBoard& board, const std::string& length) {
  Command command{"openocd"};
  for (const std::string& file : board.openocd) command.insert(command.end(), {"-f", file});
  const std::string image(kImageFile), read_back(kReadBackFile), base = base_address();
  const std::string steps[] = {"init",
                               "reset halt",
                               "flash write_image erase " + image + " " + base + " bin",
                               "verify_image " + image + " " + base + " bin",
                               "dump_image " + read_back + " " + base + " " + length,
                               "reset run",
                               "shutdown"};
  for (const std::string& step : steps) command.insert(command.end(), {"-c", step});
  return {command};
}

}  // namespace

bool suits(std::string_view tool, const FlashBoard& board) {
  if (tool == "openocd") return !board.openocd.empty();
  if (tool == "st-flash") return board.st_flash;
  return tool == "dfu-util" && !board.dfu.empty();
}

std::vector<Command> commands(std::string_view tool, const FlashBoard& board, std::size_t length) {
  const std::string image(kImageFile), read_back(kReadBackFile), base = base_address();
  const std::string bytes = std::to_string(length);
  if (tool == "openocd") return openocd_commands(board, bytes);
  if (tool == "st-flash")
    return {{"st-flash", "write", image, base},
            {"st-flash", "read", read_back, base, bytes},
            {"st-flash", "reset"}};
  // The boot loader's memory 0; `leave` starts the board.
  return {{"dfu-util", "-d", board.dfu, "-a", "0", "-s", base, "-D", image},
          {"dfu-util", "-d", board.dfu, "-a", "0", "-s", base + ":" + bytes + ":leave", "-U", read_back}};
}

std::string as_typed(const Command& command) {
  std::string line;
  for (const std::string& word : command) {
    const bool plain = word.find_first_of(" '\"$*?;&|<>()") == std::string::npos && !word.empty();
    line += (line.empty() ? "" : " ") + (plain ? word : "'" + word + "'");
  }
  return line;
}

std::string find_in_path(std::string_view program) {
  const char* const folders = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): one thread
  std::istringstream path(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(path, folder, ':');) {
    const std::string candidate = (folder.empty() ? "." : folder) + "/" + std::string(program);
    std::error_code ignored;
    if (std::filesystem::is_regular_file(candidate, ignored) && ::access(candidate.c_str(), X_OK) == 0)
      return std::filesystem::absolute(candidate).string();
  }
  return {};
}

Ran run(const std::string& program, const Command& command, const std::string& folder) {
  const std::string words = folder + "/words";
  std::vector<std::string> copies = command;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, words.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  pid_t child = -1;
  const int error = ::posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return {127, program + ": cannot be started"};

  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::ifstream file(words, std::ios::binary);
  const std::string said{std::istreambuf_iterator<char>(file), {}};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), said};
}

}  // namespace furcula::flash
