// The progress bar, see progress.hpp.
#include "host/cli/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace furcula::cli {
namespace {
constexpr std::chrono::milliseconds kPause{100};
constexpr int kBarWidth = 30;
constexpr const char* kClearLine = "\r\033[K";
}  // namespace

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_) std::fputs(kClearLine, stderr);
}

void Progress::update(double fraction, std::string_view doing) {
  if (!terminal_) return;
  const std::scoped_lock lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_drawn_ < kPause) return;
  last_drawn_ = now;
  const double done = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(done * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  // Cut so that the line does not wrap on a terminal of 80 columns: a wrapped line cannot be cleared.
  std::string line = what_ + " [" + bar + "] " + std::to_string(static_cast<int>(100.0 * done)) + " % ";
  line.append(doing.substr(0, line.size() < 79 ? 79 - line.size() : 0));
  std::fprintf(stderr, "%s%s", kClearLine, line.c_str());
  std::fflush(stderr);
}

}  // namespace furcula::cli
