// The board's program as a child process.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace furcula::rig {

class Child {
 public:
  /// Starts it; it dies with this process. @throws RigError.
  explicit Child(const std::vector<std::string>& command);
  /// Ends it without asking.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void send(int signal);
  /// How it ended, once it has: "ended with status 3"; empty while it runs.
  std::string ending();
  /// Whether it ended with status 0.
  bool ended_well() const { return ended_ && status_ == 0; }
  /// Waits until it has ended. false: it has not, in that time.
  bool wait(std::chrono::milliseconds allowed);

 private:
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

}  // namespace furcula::rig
