// The file of parameters, written by a thread of its own: fsync of an SD card may take seconds, and the loop's
// thread has a millisecond.
#pragma once

#include <semaphore.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>

#include "firmware/app/store.hpp"
#include "furcula/bus/parameter_image.hpp"
#include "host/core/parameter_file.hpp"

namespace furcula::linux_sbc {

/// A store (firmware/app/store.hpp) that saves while the loop goes on. `File` is core::ParameterFile, or what
/// a test puts in its place.
template <class File>
class ParameterWriter {
 public:
  explicit ParameterWriter(std::string path) : file_(std::move(path)) { ::sem_init(&wanted_, 0, 0); }
  ~ParameterWriter() { ::sem_destroy(&wanted_); }
  ParameterWriter(const ParameterWriter&) = delete;
  ParameterWriter& operator=(const ParameterWriter&) = delete;

  // For the loop's thread.

  /// Before the first tick.
  Result<std::size_t> load(std::span<std::uint8_t> into) const { return file_.load(into); }

  /// Hands the image to the writer: one system call, no memory. `disconnected`: the last one is still being
  /// written. What came of it says saved().
  Status save(std::span<const std::uint8_t> image) {
    if (state_.load(std::memory_order_acquire) == State::writing || image.size() > image_.size())
      return Status::disconnected;
    std::copy(image.begin(), image.end(), image_.begin());
    size_ = image.size();
    state_.store(State::writing, std::memory_order_release);
    ::sem_post(&wanted_);
    return Status::ok;
  }

  /// Of the last image that save() took.
  firmware::SaveProgress saved() const {
    switch (state_.load(std::memory_order_acquire)) {
      case State::writing:
        return firmware::SaveProgress::under_way;
      case State::done:
        return firmware::SaveProgress::done;
      case State::none:
      case State::failed:
        break;
    }
    return firmware::SaveProgress::failed;
  }

  // For the writer's thread.

  /// Writes what is handed over, until stop() was called and all is written.
  void serve() {
    for (;;) {
      while (::sem_wait(&wanted_) != 0) {  // EINTR
      }
      if (state_.load(std::memory_order_acquire) == State::writing) {
        const Status status = file_.save(std::span<const std::uint8_t>(image_).first(size_));
        state_.store(status == Status::ok ? State::done : State::failed, std::memory_order_release);
      }
      if (stop_.load(std::memory_order_acquire)) return;
    }
  }

  /// From any thread, once the loop has ended.
  void stop() {
    stop_.store(true, std::memory_order_release);
    ::sem_post(&wanted_);
  }

 private:
  enum class State : std::uint8_t { none, writing, done, failed };
  File file_;
  std::array<std::uint8_t, bus::kImageBytesMax> image_{};
  std::size_t size_ = 0;
  std::atomic<State> state_{State::none};
  std::atomic<bool> stop_{false};
  sem_t wanted_{};
};

}  // namespace furcula::linux_sbc
