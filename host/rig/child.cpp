// A child process, see child.hpp.
#include "host/rig/child.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "host/rig/rig.hpp"

namespace furcula::rig {

Child::Child(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  if (::posix_spawn(&pid_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
    throw RigError("cannot start " + command.front() + "; expected the path of furculad");
}

Child::~Child() {
  if (ended_) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, &status_, 0);
}

void Child::send(int signal) {
  if (!ended_) ::kill(pid_, signal);
}

std::string Child::ending() {
  if (!ended_ && ::waitpid(pid_, &status_, WNOHANG) == pid_) ended_ = true;
  if (!ended_) return {};
  if (WIFEXITED(status_)) return "ended with status " + std::to_string(WEXITSTATUS(status_));
  return "was ended by signal " + std::to_string(WTERMSIG(status_));
}

bool Child::wait(std::chrono::milliseconds allowed) {
  for (auto waited = std::chrono::milliseconds(0); ending().empty(); waited += std::chrono::milliseconds(5)) {
    if (waited >= allowed) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace furcula::rig
