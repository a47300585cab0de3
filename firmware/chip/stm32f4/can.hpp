// bxCAN: frames in and out, never waiting for the bus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/bus/frame.hpp"
#include "furcula/core/status.hpp"

namespace furcula::stm32f4 {

/// Bit timing, 32.7.7: a bit is one quantum, then `before` quanta up to the sample point, then `after`.
struct CanTiming {
  std::uint32_t prescaler = 0, before = 0, after = 0;
  constexpr std::uint32_t quanta() const { return 1 + before + after; }
  constexpr bool exists() const { return prescaler != 0; }
  /// Resynchronisation by as much as the segment after the sample point allows, 4 at most.
  constexpr std::uint32_t btr() const {
    const std::uint32_t jump = after < 4 ? after : 4;
    return (prescaler - 1) | (before - 1) << 16 | (after - 1) << 20 | (jump - 1) << 24;
  }
};

/// The timing that gives the bit rate exactly, with the sample point nearest to 87.5 % of the bit (CiA 301,
/// table 1: 75 % to 90 % at 1 Mbit/s), and of several the finest. Does not exist where the clock has none.
constexpr CanTiming can_timing(std::uint32_t clock_hz, std::uint32_t bits_per_s) {
  CanTiming best;
  std::uint32_t best_error = 1000;
  for (std::uint32_t prescaler = 1; prescaler <= 1024; ++prescaler) {
    if (clock_hz % (bits_per_s * prescaler) != 0) continue;
    const std::uint32_t quanta = clock_hz / (bits_per_s * prescaler);
    if (quanta < 8 || quanta > 25) continue;  // 16 quanta before the sample point at most, 8 after it
    for (std::uint32_t after = 1; after <= 8 && after + 2 <= quanta; ++after) {
      const std::uint32_t before = quanta - 1 - after;
      if (before > 16) continue;
      const std::uint32_t permille = 1000 * (1 + before) / quanta;
      const std::uint32_t error = permille < 875 ? 875 - permille : permille - 875;
      if (error < best_error) {
        best_error = error;
        best = {prescaler, before, after};
      }
    }
  }
  return best;
}

/// Frames whose identifier agrees with `id` in the bits of `mask` (standard identifiers, data frames).
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7ff;
};

struct CanErrors {
  std::uint8_t transmit = 0, receive = 0;  ///< the protocol's counters, 32.9.2 CAN_ESR
  std::uint8_t last_code = 0;              ///< 1 stuff, 2 form, 3 acknowledgement, 4, 5 bit, 6 CRC
  bool warning = false, passive = false, bus_off = false;
};

template <class Word>
class Can {
 public:
  static constexpr std::size_t kMostFilters = 14;  // CAN1's share of the banks after a reset
  static constexpr std::uint32_t kPolls = 10'000;

  explicit Can(CanRegisters<Word>& can) : can_(can) {}

  /// Bus-off ends by itself after 128 pauses of 11 bits; mailboxes go out in the order in which they were
  /// filled; a full FIFO keeps the newest frame. `invalid`: no such timing, or too many filters.
  /// `disconnected`: the peripheral does not answer. A bus that is not there yet is no error: see joined().
  Status start(const CanTiming& timing, std::span<const CanFilter> filters) {
    constexpr std::uint32_t kInitialise = 1u << 0, kByOrder = 1u << 2, kBusOffEnds = 1u << 6;
    constexpr std::uint32_t kFilterInitialise = 1u << 0;
    if (!timing.exists() || filters.size() > kMostFilters) return Status::invalid;
    can_.mcr = kInitialise | kByOrder | kBusOffEnds;  // and not asleep
    if (!wait_for([&] { return (can_.msr & kInitialising) != 0; }, kPolls)) return Status::disconnected;
    can_.btr = timing.btr();

    set_bits(can_.fmr, kFilterInitialise);
    const std::uint32_t banks = (1u << filters.size()) - 1;
    can_.fa1r = 0;
    can_.fm1r = 0;                     // identifier and mask
    can_.fs1r = banks;                 // one of 32 bits a bank
    can_.ffa1r = banks & 0xaaaaaaaau;  // into both FIFOs in turn
    constexpr std::uint32_t kExtendedOrRemote = 6u;
    for (std::size_t i = 0; i < filters.size(); ++i) {
      can_.filter[i][0] = filters[i].id << 21;
      can_.filter[i][1] = filters[i].mask << 21 | kExtendedOrRemote;
    }
    can_.fa1r = banks;
    clear_bits(can_.fmr, kFilterInitialise);
    can_.mcr = kByOrder | kBusOffEnds;
    return Status::ok;
  }

  /// Whether the bus was seen quiet for 11 bits since start(), so that frames come and go.
  bool joined() const { return (can_.msr & kInitialising) == 0; }

  /// Puts a frame into an empty mailbox. `disconnected`: all three are taken, as on a bus on which nobody
  /// acknowledges; `invalid`: a frame that cannot be. Does not wait.
  Status send(const bus::Frame& frame) {
    if (frame.size > 8 || frame.id > (frame.extended ? 0x1fffffffu : 0x7ffu)) return Status::invalid;
    const std::uint32_t empty = can_.tsr >> 26 & 7u;
    if (empty == 0) return Status::disconnected;
    CanMailbox<Word>& box = can_.transmit[(empty & 1u) != 0 ? 0 : (empty & 2u) != 0 ? 1 : 2];
    constexpr std::uint32_t kRequest = 1u << 0, kRemote = 1u << 1, kExtended = 1u << 2;
    const std::uint32_t identifier =
        (frame.extended ? frame.id << 3 | kExtended : frame.id << 21) | (frame.remote ? kRemote : 0u);
    box.length = frame.size;
    box.data_low = word_of(frame, 0);
    box.data_high = word_of(frame, 4);
    box.identifier = identifier;
    box.identifier = identifier | kRequest;  // with all else in place
    return Status::ok;
  }

  /// Takes back what has not gone out, as commands of an earlier tick; a frame that is on the bus goes on.
  void abort_pending() { can_.tsr = kAbort[0] | kAbort[1] | kAbort[2]; }

  /// The next frame of either FIFO, or `disconnected` where there is none. Does not wait.
  Result<bus::Frame> receive() {
    for (unsigned fifo = 0; fifo < 2; ++fifo) {
      const std::uint32_t status = can_.rfr[fifo];
      if ((status & kOverrun) != 0) {
        ++overruns_;
        can_.rfr[fifo] = kOverrun;
      }
      if ((status & kPending) == 0) continue;
      const CanMailbox<Word>& box = can_.receive[fifo];
      const std::uint32_t identifier = box.identifier;
      bus::Frame frame;
      frame.extended = (identifier & 4u) != 0;
      frame.remote = (identifier & 2u) != 0;
      frame.id = frame.extended ? identifier >> 3 : identifier >> 21;
      const std::uint32_t length = box.length & 0xfu;
      frame.size = static_cast<std::uint8_t>(length < 8 ? length : 8);
      const std::uint32_t low = box.data_low, high = box.data_high;
      for (unsigned i = 0; i < frame.size && !frame.remote; ++i)
        frame.data[i] = static_cast<std::uint8_t>((i < 4 ? low : high) >> (8 * (i % 4)));
      can_.rfr[fifo] = kRelease;
      return frame;
    }
    return Status::disconnected;
  }

  CanErrors errors() const {
    const std::uint32_t esr = can_.esr;
    return {static_cast<std::uint8_t>(esr >> 16 & 0xffu),
            static_cast<std::uint8_t>(esr >> 24),
            static_cast<std::uint8_t>(esr >> 4 & 7u),
            (esr & 1u) != 0,
            (esr & 2u) != 0,
            (esr & 4u) != 0};
  }

  /// Whether an error was seen on the bus since this was last asked.
  bool take_error() {
    constexpr std::uint32_t kCode = 7u << 4;  // ESR: LEC; what is written stays until the next frame
    const std::uint32_t code = can_.esr & kCode;
    can_.esr = kCode;
    return code != 0 && code != kCode;
  }

  /// Times that a FIFO was full when a frame came.
  std::uint32_t overruns() const { return overruns_; }

 private:
  static constexpr std::uint32_t kInitialising = 1u << 0;                                // MSR
  static constexpr std::uint32_t kPending = 3u, kOverrun = 1u << 4, kRelease = 1u << 5;  // RFxR
  static constexpr std::uint32_t kAbort[3] = {1u << 7, 1u << 15, 1u << 23};              // TSR

  static std::uint32_t word_of(const bus::Frame& frame, unsigned first) {
    std::uint32_t word = 0;
    for (unsigned i = 0; i < 4; ++i) word |= static_cast<std::uint32_t>(frame.data[first + i]) << (8 * i);
    return word;
  }

  CanRegisters<Word>& can_;
  std::uint32_t overruns_ = 0;
};

}  // namespace furcula::stm32f4
