// Two hosts on one bus: one makes the robot hop by its stream of commands and goes on, whatever happens; the other
// says stop. The same attack runs on the emulated board and on the simulated robot (tests/sil/stop_test.cpp).
#pragma once

#include <cstdint>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/register_frames.hpp"

namespace furcula::firmware {

/// A host's stream of commands.
struct AttackingHost {
  std::uint8_t sequence = 0;

  bus::Frame next(std::uint32_t request) { return frame(request, sequence++, bus::kProtocolVersion, 0); }
  /// `age_100us`: as it is sent.
  static bus::Frame frame(std::uint32_t request, std::uint32_t sequence, std::uint32_t version,
                          std::uint32_t age_100us) {
    bus::Frame f = bus::empty_frame(bus::message::kCommand, 1);
    f.data = {static_cast<std::uint8_t>(version | request << 4),
              static_cast<std::uint8_t>(sequence),
              static_cast<std::uint8_t>(age_100us),
              0xd0,
              0x07,
              0xb8,
              0x0b,
              0};  // 2 N m over 0.3 s
    return f;
  }
};

/// `World` is a robot that ticks: hear(frame) before tick(), and drives() after it: whether the drive is on.
template <class World>
class StopAttack {
 public:
  explicit StopAttack(World& world) : world_(world) {}

  /// Robots that hopped, in all attacks; of each attack those that it stopped on the next tick and that stayed
  /// still while the first host went on saying hop.
  std::uint32_t started() const { return started_; }

  /// Of 256: a stop whose number is ahead of the first host's by each number there is.
  std::uint32_t offsets() {
    return each(
        [this](std::uint32_t i) { world_.hear(AttackingHost::frame(kStop, hopper_.sequence + i, 1, 0)); });
  }
  /// Of 256: a stop of each version and each age, in no order.
  std::uint32_t versions_and_ages() {
    return each([this](std::uint32_t i) { world_.hear(AttackingHost::frame(kStop, 37 * i, i % 16, i)); });
  }
  /// Of 256: the request for a stop in the table of registers, in each version, with neither key nor session, and
  /// with another request in its millisecond.
  std::uint32_t registers() {
    return each([this](std::uint32_t i) {
      bus::RegisterRequest request;
      request.operation = bus::RegisterOperation::request;
      request.version = static_cast<std::uint8_t>(i % 16);
      request.sequence = static_cast<std::uint8_t>(i);
      request.address = static_cast<std::uint16_t>(i);
      request.value = (i * 257) << 16 | kStop;
      world_.hear(bus::pack(request, 1));
      world_.hear(bus::pack(bus::RegisterRequest{.value = 2}, 1));
    });
  }
  /// 500 stops, one each 10 ms, beside the first host's stream, ahead of it by `offset`. Whether the robot was off
  /// from the first one on, stayed off while the first host went on for a second, and hopped when that host had
  /// let go and said hop anew.
  bool beside(std::uint32_t offset) {
    start();
    AttackingHost stopper{static_cast<std::uint8_t>(hopper_.sequence + offset)};
    bool still = true;
    for (std::uint32_t ms = 0; ms < 6000; ++ms) {
      if (ms % 10 == 4 && ms < 5000) world_.hear(stopper.next(kStop));
      tick(kHop);
      if (ms >= 4) still = still && !world_.drives();
    }
    start();
    return still && world_.drives();
  }

 private:
  static constexpr std::uint32_t kNone = 0, kStop = 1, kHop = 2;

  /// The first host's millisecond: a command in each tenth.
  void tick(std::uint32_t request) {
    if (ms_++ % 10 == 0) world_.hear(hopper_.next(request));
    world_.tick();
  }

  /// The first host lets go and says hop.
  void start() {
    for (int ms = 0; ms < 120; ++ms) tick(kNone);
    for (int ms = 0; ms < 20; ++ms) tick(kHop);
    if (world_.drives()) ++started_;
  }

  template <class Say>
  std::uint32_t each(const Say& say) {
    std::uint32_t obeyed = 0;
    for (std::uint32_t i = 0; i < 256; ++i) {
      start();
      // At each instant between two commands.
      for (std::uint32_t ms = 0; ms < i % 10; ++ms) tick(kHop);
      say(i);
      bool still = true;
      for (int ms = 0; ms < 40; ++ms) {
        tick(kHop);
        still = still && !world_.drives();
      }
      if (still) ++obeyed;
    }
    return obeyed;
  }

  World& world_;
  AttackingHost hopper_;
  std::uint32_t ms_ = 0, started_ = 0;
};

}  // namespace furcula::firmware
