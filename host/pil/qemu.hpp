// An emulated board as a child process, spoken to in lock step. A silent or dead board ends in an exception
// with the reason, within the time allowed: never in waiting.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "boards/qemu_netduinoplus2/wire.hpp"

namespace furcula::pil {

struct LinkError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Why processor-in-the-loop cannot run here, or an empty string.
std::string why_not_here(const std::string& image);

/// QEMU with an image, in a directory of its own with two pipes to the board's program.
class EmulatedBoard {
 public:
  /// `allowed` is how long any one answer may take. @throws LinkError
  EmulatedBoard(const std::string& image, std::chrono::milliseconds allowed);
  /// Ends the child if it still runs, removes the directory.
  ~EmulatedBoard();
  EmulatedBoard(const EmulatedBoard&) = delete;
  EmulatedBoard& operator=(const EmulatedBoard&) = delete;

  /// A message that is smaller than a pipe's atomic write (4 KiB). @throws LinkError
  template <class Message>
  void send(const Message& message) {
    send(&message, sizeof(message));
  }
  /// The next message, within the time allowed. @throws LinkError
  template <class Message>
  Message receive() {
    Message message;
    receive(&message, sizeof(message));
    return message;
  }
  /// Waits for QEMU to end, which must be with status 0. @throws LinkError
  void wait_for_end();

  pid_t pid() const { return child_; }

 private:
  void start(const std::string& image);
  void send(const void* data, std::size_t size);
  void receive(void* data, std::size_t size);
  /// @throws LinkError if the child has ended.
  void check_alive(const char* doing);
  std::string last_words() const;
  void clean_up();

  std::chrono::milliseconds allowed_;
  std::string directory_;
  pid_t child_ = -1;
  int to_board_ = -1, from_board_ = -1;
  std::size_t answers_ = 0;
};

/// The board qemu_netduinoplus2.
class Qemu {
 public:
  /// Hands the configuration to the board. @throws LinkError
  Qemu(const std::string& image, const control::Config& config, std::chrono::milliseconds allowed);

  /// Another configuration before the next tick. @throws LinkError
  void configure(const control::Config& config);
  /// One tick there and back. @throws LinkError
  Reply exchange(const Tick& tick);
  /// Ends the run; QEMU must end with status 0. @throws LinkError
  ShutdownReply finish();

  pid_t pid() const { return board_.pid(); }

 private:
  EmulatedBoard board_;
};

}  // namespace furcula::pil
