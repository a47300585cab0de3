// SocketCAN raw: non-blocking, filtered by id, with the bus's errors as frames.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "furcula/bus/frame.hpp"
#include "host/socketcan/link_watch.hpp"

namespace furcula::socketcan {

/// An interface that is not there, or down; the message says which and what to do.
struct CanError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct CanCounters {
  std::uint64_t received = 0, sent = 0;
  std::uint64_t refused = 0;       ///< the send queue was full, or the interface down
  std::uint64_t error_frames = 0;  ///< of which:
  std::uint64_t bus_off = 0, controller_errors = 0, no_acknowledge = 0;
  std::uint64_t overflowed = 0;  ///< frames that the kernel dropped because nobody fetched them
};

/// A frame, and when the kernel got it.
struct Received {
  bus::Frame frame;
  std::int64_t age_ns = 0;  ///< how long it lay in the queue
};

class CanSocket {
 public:
  static constexpr std::size_t kBatch = 32;

  /// `ids`: the 11-bit ids that are received; without any, all. At most 16. @throws CanError.
  CanSocket(const std::string& interface, std::span<const std::uint32_t> ids);
  /// Over a socket of the kernel's CAN frames that is open and non-blocking, and is closed with this.
  explicit CanSocket(int fd) : fd_(fd) {}
  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// Takes what is there, at most kBatch frames, with one system call. Error frames are counted and left out.
  /// Never blocks.
  std::span<const Received> receive();

  /// Sends all with one system call; never blocks. false: some were not taken. An interface that was gone and is
  /// there again is opened anew.
  bool send(std::span<const bus::Frame> frames);

  CanState state() const { return watch_.state(); }
  /// Times that it left the bus, so that none is missed that ended within one receive().
  std::uint64_t times_off() const { return watch_.times_off(); }
  const CanCounters& counters() const { return counters_; }
  int fd() const { return fd_; }

 private:
  static constexpr std::size_t kMostIds = 16;
  /// Sends that are refused between two looks for an interface that is gone.
  static constexpr std::uint32_t kLookAfter = 100;

  /// Filters, what the kernel is to add, and the interface. 0, or an errno.
  int bind_to_interface();
  void count_error(std::uint32_t id, const unsigned char* data);

  int fd_ = -1;
  std::string interface_;  ///< empty: the socket was open
  std::array<std::uint32_t, kMostIds> ids_{};
  std::size_t id_count_ = 0;
  LinkWatch watch_;
  std::uint32_t until_look_ = kLookAfter;
  CanCounters counters_;
  std::uint32_t dropped_ = 0;  ///< as the kernel counts them
  Received received_[kBatch];
};

}  // namespace furcula::socketcan
