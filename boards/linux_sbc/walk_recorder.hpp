// Logs of a biped's walks and exercises, for `furcula walk identify`: rows go from the loop to a thread of its own, which writes files.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "furcula/control/walk/walker.hpp"
#include "host/walk/board_row.hpp"

namespace furcula::linux_sbc {

/// A walk is logged from its first tick until it is stopped, or a fault ends it. Its file, walk_N.csv with the next number that is free, has the
/// ending .part until it is whole.
class WalkRecorder {
 public:
  /// `say` gets what a person has to know, from the writer's thread. @throws std::runtime_error: no folder to write to.
  WalkRecorder(std::string folder, int rate_hz, std::function<void(const std::string&)> say);

  // For the loop's thread: neither waits nor takes memory.

  /// After each tick.
  void note(const control::WalkerState& walker, const control::WalkerOutputs& told);

  // For the writer's thread.

  /// Writes what is there, and looks again, until stop() was called and all is written.
  void serve();

  /// From any thread, once the loop has ended.
  void stop() { stop_.store(true, std::memory_order_release); }

 private:
  struct Row {
    std::uint32_t walk = 0;
    walk::BoardRow values{};
  };
  /// A second at the controller's rate, ten at the usual one: a disk may be busy for so long.
  static constexpr std::size_t kRows = 1024;

  void write_all();
  void begin(std::uint32_t walk);
  void write(const Row& row);
  void end();
  void fail(const std::string& what);

  std::string folder_;
  std::function<void(const std::string&)> say_;
  unsigned ticks_a_row_;

  // Of the loop.
  control::WalkerStage stage_ = control::WalkerStage::idle;
  std::uint32_t walk_ = 0;
  std::uint64_t tick_ = 0;

  // Of both: a ring of rows, put at `put_` and taken at `taken_`.
  std::array<Row, kRows> rows_{};
  std::atomic<std::uint64_t> put_{0}, taken_{0};
  std::atomic<std::uint32_t> ended_{0};  ///< walks
  std::atomic<std::uint32_t> lost_{0};   ///< rows for which there was no place
  std::atomic<bool> stop_{false};

  // Of the writer.
  std::uint32_t open_ = 0;  ///< the walk whose file is open; 0: none
  int file_ = -1;
  std::string path_, part_;
  std::uint32_t told_lost_ = 0;
  unsigned next_ = 1;
  bool failed_ = false;
};

}  // namespace furcula::linux_sbc
