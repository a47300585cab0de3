// QEMU as a child process in real time, with a folder of its own; both end with the object.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/skip.hpp"

namespace furcula::test {

/// Skips the test, and says so, where QEMU or one of the images is not there.
inline bool cannot_emulate(const std::vector<std::string>& images) {
  const char* reason = nullptr;
  if (std::system("command -v qemu-system-arm > /dev/null") != 0)  // NOLINT(concurrency-mt-unsafe)
    reason = "qemu-system-arm is not installed (scripts/setup installs it)";
  for (const std::string& image : images)
    if (!std::filesystem::exists(image))
      reason = "no image (cmake --preset cortex-m4f && cmake --build --preset cortex-m4f)";
  if (reason != nullptr) skip(reason);
  return reason != nullptr;
}

class Emulator {
 public:
  Emulator() {
    std::string pattern = (std::filesystem::temp_directory_path() / "furcula-qemu-XXXXXX").string();
    REQUIRE(::mkdtemp(pattern.data()) != nullptr);
    folder_ = pattern;
  }
  ~Emulator() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  /// The image on the machine that is an STM32F405, with more arguments of QEMU's.
  void start(const std::string& image, const std::vector<std::string>& more) {
    std::vector<std::string> words{"qemu-system-arm", "-M",   "netduinoplus2", "-kernel", image,
                                   "-display",        "none", "-monitor",      "none"};
    words.insert(words.end(), more.begin(), more.end());
    child_ = ::fork();
    REQUIRE(child_ >= 0);
    if (child_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int said = ::open(said_path().c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(said, 1);
    ::dup2(said, 2);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }

  const std::string& folder() const { return folder_; }
  /// What QEMU says goes there.
  std::string said_path() const { return folder_ + "/said"; }

 private:
  std::string folder_;
  pid_t child_ = -1;
};

}  // namespace furcula::test
