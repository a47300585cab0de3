// A progress bar on stderr, only where stderr is a terminal.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace furcula::cli {

/// One bar, from construction to destruction; it leaves an empty line behind. All members may be called from
/// any thread. Draws at most ten times a second.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fraction` from 0 to 1, `doing` what is being done now.
  void update(double fraction, std::string_view doing);

 private:
  std::string what_;
  bool terminal_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_drawn_{};
};

}  // namespace furcula::cli
