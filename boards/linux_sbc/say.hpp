// What furculad says while the robot runs.
#pragma once

#include <poll.h>
#include <unistd.h>

#include <string_view>

namespace furcula::linux_sbc {

/// Writes the text, at most 4096 bytes, to the file; false where that is full: a pipe that nobody reads, a terminal that
/// is held. Nobody waits for a reader: signals and signs of life come first.
inline bool say(int file, std::string_view text) {
  // A pipe that is ready takes PIPE_BUF bytes, which is 4096, without waiting (pipe(7)).
  pollfd ready{file, POLLOUT, 0};
  return ::poll(&ready, 1, 0) == 1 && (ready.revents & POLLOUT) != 0 &&
         ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

}  // namespace furcula::linux_sbc
