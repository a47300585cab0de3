// Running xacro, see xacro.hpp.
#include "host/model/xacro.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::model {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kWordsMax = 4096;

/// Both ends close by themselves.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ends = {-1, -1};
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

/// The process and all that it starts: ended and waited for, however this scope is left.
class Process {
 public:
  explicit Process(pid_t id) : id_(id) {}
  ~Process() {
    if (id_ <= 0) return;
    ::kill(-id_, SIGKILL);
    wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// The status as waitpid has it.
  int wait() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_;
};

/// Nothing where there is no such program.
std::optional<pid_t> start(std::string file, const Pipe& out, const Pipe& words) {
  std::string program = "xacro";
  std::array<char*, 3> arguments{program.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, out.ends[1], 1);
  ::posix_spawn_file_actions_adddup2(&actions, words.ends[1], 2);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  pid_t id = -1;
  const int error = ::posix_spawnp(&id, program.c_str(), &actions, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return std::nullopt;
  return id;
}

/// Reads what is there. false: the other end is closed.
bool take(int from, std::string& to, std::size_t most) {
  std::array<char, 8192> block{};
  const ssize_t n = ::read(from, block.data(), block.size());
  if (n < 0 && errno == EINTR) return true;
  if (n <= 0) return false;
  if (to.size() < most) to.append(block.data(), static_cast<std::size_t>(n));
  return true;
}

}  // namespace

std::optional<std::string> expand_xacro(const std::string& path, std::chrono::milliseconds allowed) {
  const auto fail = [&](const std::string& what) {
    throw core::DataError(core::printable(path) + ": " + what + "; see what it says: xacro " +
                          core::printable(core::shell_word(path)) + " > robot.urdf");
  };
  Pipe out, words;
  if (out.ends[0] < 0 || words.ends[0] < 0) return std::nullopt;
  // A name is no option.
  const auto id = start(path.starts_with("-") ? "./" + path : path, out, words);
  if (!id) return std::nullopt;
  Process process(*id);
  out.close(1);
  words.close(1);
  std::string text, said;
  const auto end = Clock::now() + allowed;
  while (out.ends[0] >= 0 || words.ends[0] >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0)
      fail("xacro has not ended in " + core::rounded(std::chrono::duration<double>(allowed).count()) +
           " s, expected a URDF");
    std::array<pollfd, 2> ready{pollfd{out.ends[0], POLLIN, 0}, pollfd{words.ends[0], POLLIN, 0}};
    if (::poll(ready.data(), ready.size(), static_cast<int>(left)) <= 0) continue;
    if (ready[0].revents != 0 && !take(out.ends[0], text, kXacroBytes + 1)) out.close(0);
    if (ready[1].revents != 0 && !take(words.ends[0], said, kWordsMax)) words.close(0);
    if (text.size() > kXacroBytes) fail("xacro writes more than 1 MiB, expected a URDF of one robot");
  }
  const int status = process.wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    constexpr std::size_t kShown = 300;
    while (!said.empty() && (said.back() == '\n' || said.back() == '\r')) said.pop_back();
    for (char& c : said)
      if (c == '\n') c = ' ';
    fail("xacro ended with status " + std::to_string(WIFEXITED(status) ? WEXITSTATUS(status) : -1) +
         (said.empty() ? "" : ", \"" + core::printable(said.substr(0, kShown)) + "\"") +
         ", expected a file that it expands");
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) fail("xacro writes nothing, expected a URDF");
  return text;
}

}  // namespace furcula::model
