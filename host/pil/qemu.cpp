// The emulated board as a child process, see qemu.hpp.
#include "host/pil/qemu.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace furcula::pil {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& what) { throw LinkError("emulated board: " + what); }

std::string last_error() { return std::generic_category().message(errno); }

std::string how_it_ended(int status) {
  if (WIFEXITED(status)) return "ended with status " + std::to_string(WEXITSTATUS(status));
  if (WIFSIGNALED(status)) return "was ended by signal " + std::to_string(WTERMSIG(status));
  return "ended";
}

/// Waits in slices, so that a child that died is noticed long before the time is up.
constexpr std::chrono::milliseconds kSlice{50};

}  // namespace

std::string why_not_here(const std::string& image) {
  bool found = false;
  const char* const folders = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): one thread
  std::istringstream path(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(path, folder, ':');)
    found = found || ::access((folder + "/qemu-system-arm").c_str(), X_OK) == 0;
  if (!found) return "qemu-system-arm is not installed (scripts/setup installs it)";
  if (!std::filesystem::exists(image))
    return "no image at " + image + " (cmake --preset cortex-m4f && cmake --build --preset cortex-m4f)";
  return "";
}

EmulatedBoard::EmulatedBoard(const std::string& image, std::chrono::milliseconds allowed)
    : allowed_(allowed) {
  try {
    start(image);
  } catch (...) {
    clean_up();
    throw;
  }
}

EmulatedBoard::~EmulatedBoard() { clean_up(); }

void EmulatedBoard::start(const std::string& image) {
  std::string pattern = (std::filesystem::temp_directory_path() / "furcula-pil-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) fail("no temporary directory: " + last_error());
  directory_ = pattern;
  const auto open_pipe = [this](const char* name) {
    const std::string path = directory_ + "/" + name;
    // Read and write: opening does not wait for the other end.
    const int fd =
        ::mkfifo(path.c_str(), 0600) == 0 ? ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
    if (fd < 0) fail("cannot make the pipe " + path + ": " + last_error());
    return fd;
  };
  to_board_ = open_pipe(kToBoard);
  from_board_ = open_pipe(kFromBoard);

  const std::string kernel = std::filesystem::absolute(image).string();
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ < 0) fail("cannot fork: " + last_error());
  if (child_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent || ::chdir(directory_.c_str()) != 0) ::_exit(127);
    const int words = ::open("words", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, 0);
    ::dup2(words, 1);
    ::dup2(words, 2);
    ::execlp("qemu-system-arm", "qemu-system-arm", "-M", "netduinoplus2", "-kernel", kernel.c_str(),
             "-icount", "shift=0", "-semihosting-config", "enable=on,target=native", "-display", "none",
             "-monitor", "none", "-serial", "none", static_cast<char*>(nullptr));
    ::_exit(127);
  }
}

void EmulatedBoard::wait_for_end() {
  const auto deadline = Clock::now() + allowed_;
  int status = 0;
  while (::waitpid(child_, &status, WNOHANG) == 0) {
    if (Clock::now() > deadline) fail("QEMU did not end after the last tick");
    ::poll(nullptr, 0, 5);
  }
  child_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail("QEMU " + how_it_ended(status) + last_words());
}

void EmulatedBoard::send(const void* data, std::size_t size) {
  // Smaller than PIPE_BUF: written whole or not at all. The board reads each before the next is sent.
  if (::write(to_board_, data, size) != static_cast<ssize_t>(size))
    fail("cannot write to the pipe at tick " + std::to_string(answers_) + ": " + last_error());
}

void EmulatedBoard::receive(void* data, std::size_t size) {
  auto* bytes = static_cast<char*>(data);
  const auto deadline = Clock::now() + allowed_;
  while (size > 0) {
    const ssize_t n = ::read(from_board_, bytes, size);
    if (n > 0) {
      bytes += n;
      size -= static_cast<std::size_t>(n);
      if (size == 0) ++answers_;
      continue;
    }
    check_alive("waiting for its answer");
    if (Clock::now() > deadline)
      fail("no answer within " + std::to_string(allowed_.count()) + " ms at tick " +
           std::to_string(answers_) + last_words());
    pollfd waited{from_board_, POLLIN, 0};
    ::poll(&waited, 1, static_cast<int>(kSlice.count()));
  }
}

void EmulatedBoard::check_alive(const char* doing) {
  int status = 0;
  if (child_ > 0 && ::waitpid(child_, &status, WNOHANG) == child_) {
    child_ = -1;
    fail("QEMU " + how_it_ended(status) + " at tick " + std::to_string(answers_) + " while " + doing +
         last_words());
  }
}

std::string EmulatedBoard::last_words() const {
  std::ifstream file(directory_ + "/words");
  std::ostringstream words;
  words << file.rdbuf();
  return words.str().empty() ? "" : "; it said: " + words.str().substr(0, 500);
}

void EmulatedBoard::clean_up() {
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  if (to_board_ >= 0) ::close(to_board_);
  if (from_board_ >= 0) ::close(from_board_);
  std::error_code ignored;
  if (!directory_.empty()) std::filesystem::remove_all(directory_, ignored);
}

Qemu::Qemu(const std::string& image, const control::Config& config, std::chrono::milliseconds allowed)
    : board_(image, allowed) {
  configure(config);
}

void Qemu::configure(const control::Config& config) { board_.send(Begin{kBegin, config}); }

Reply Qemu::exchange(const Tick& tick) {
  board_.send(tick);
  return board_.receive<Reply>();
}

ShutdownReply Qemu::finish() {
  Tick last;
  last.kind = kEnd;
  board_.send(last);
  const auto shutdown_reply = board_.receive<ShutdownReply>();
  board_.wait_for_end();
  return shutdown_reply;
}

}  // namespace furcula::pil
