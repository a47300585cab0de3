// Whether a CAN interface is on the bus, by what the kernel says of it: error frames, and the errors of receiving
// and sending. No input or output.
#pragma once

#include <linux/can/error.h>

#include <cerrno>
#include <cstdint>

namespace furcula::socketcan {

enum class CanState : std::uint8_t {
  on = 0,
  off = 1,   ///< the controller went off the bus after too many errors, and was not restarted
  down = 2,  ///< the link is down: `ip link set can0 up` brings it back
  gone = 3,  ///< there is no such interface any more, as of an adapter that was pulled out
};

class LinkWatch {
 public:
  CanState state() const { return state_; }
  /// Times that it left the bus, however short.
  std::uint64_t times_off() const { return times_off_; }

  /// An error frame, by its id (linux/can/error.h).
  void note_error_frame(std::uint32_t id) {
    if ((id & CAN_ERR_BUSOFF) != 0) leave(CanState::off);
    if ((id & CAN_ERR_RESTARTED) != 0 && state_ == CanState::off) state_ = CanState::on;
  }
  /// What receiving or sending came to, 0 or an errno. The kernel tells a link that goes down once, to whoever
  /// receives; then each frame is refused until it is up, and no frame says that it is. A controller that is off
  /// the bus seems to take frames: only a restart, or the link down and up, ends that. A queue that is full
  /// (ENOBUFS, EAGAIN) says nothing of the link.
  void note_receive(int error) { note_error(error); }
  void note_send(int error) {
    note_error(error);
    if (error == 0 && (state_ == CanState::down || state_ == CanState::gone)) state_ = CanState::on;
  }

 private:
  void note_error(int error) {
    if (error == ENETDOWN) leave(CanState::down);
    if (error == ENODEV || error == ENXIO) leave(CanState::gone);
  }
  void leave(CanState to) {
    if (state_ == CanState::on) ++times_off_;
    state_ = to;
  }

  CanState state_ = CanState::on;
  std::uint64_t times_off_ = 0;
};

}  // namespace furcula::socketcan
