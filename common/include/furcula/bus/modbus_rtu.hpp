// A Modbus server on a serial line: bytes in, a frame ends by silence, the answer out. Bounded, no I/O; the
// caller has clock and port. MODBUS over Serial Line V1.02, section 2.5.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/modbus_pdu.hpp"

namespace furcula::bus {

/// Greatest size of a frame: address, PDU, CRC.
inline constexpr std::size_t kRtuBytesMax = kPduBytesMax + 3;
/// Smallest size of a frame: address, function code, CRC.
inline constexpr std::size_t kRtuBytesMin = 4;

/// Remainders of the sixteen halves of a byte.
inline constexpr std::array<std::uint16_t, 16> kCrc16Table = [] {
  std::array<std::uint16_t, 16> table{};
  for (std::uint32_t n = 0; n < 16; ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 4; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xa001u : crc >> 1;
    table[n] = static_cast<std::uint16_t>(crc);
  }
  return table;
}();

/// CRC-16 with the polynomial A001; its low byte goes first. 6.2.2.
inline constexpr std::uint16_t kCrc16Begin = 0xffff;
/// Of the bytes before, which have `crc`, and one more. Behind its own CRC that of any frame is 0.
constexpr std::uint16_t crc16(std::uint16_t crc, std::uint8_t byte) {
  std::uint32_t next = crc;
  next = next >> 4 ^ kCrc16Table[(next ^ byte) & 0xfu];
  next = next >> 4 ^ kCrc16Table[(next ^ static_cast<std::uint32_t>(byte) >> 4) & 0xfu];
  return static_cast<std::uint16_t>(next);
}
/// The CRC of all of `bytes`.
constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = kCrc16Begin;
  for (const std::uint8_t byte : bytes) crc = crc16(crc, byte);
  return crc;
}

/// 3.5 characters of 11 bits; above 19,200 baud 1.75 ms whatever the speed. 2.5.1.1.
constexpr std::uint32_t silence_us(std::uint32_t baud) {
  return baud > 19200 || baud == 0 ? 1750 : (38500000u + baud - 1) / baud;
}

/// No call loops over a frame's bytes but to copy them: a check sum grows as bytes come and go.
class RtuServer {
 public:
  /// `unit` 1 to 247. A gap of `silence` us or more ends a frame; a caller that looks at the port only now
  /// and then and sees bytes late gives a silence that is no shorter than between two looks.
  RtuServer(std::uint8_t unit, std::uint32_t silence) : unit_(unit), silence_us_(silence) {}

  /// A byte that came at `now_us`, a clock that wraps. What is left of an answer is dropped.
  void receive(std::uint8_t byte, std::uint32_t now_us) {
    if (answering()) clear();
    if (size_ < frame_.size()) {
      frame_[size_++] = byte;
      crc_ = crc16(crc_, byte);
    } else {
      spoilt_ = true;  // longer than any frame
    }
    last_us_ = now_us;
  }
  /// A byte that came spoilt (parity, framing, overrun): the frame that it belongs to is worthless.
  void spoil(std::uint32_t now_us) {
    if (answering()) clear();
    spoilt_ = true;
    last_us_ = now_us;
  }

  /// To be called whenever there may have been a silence: does what a whole frame asks for, and begins the
  /// answer, where there is one to send.
  template <Registers R>
  void poll(R& registers, BusCounts& counts, std::uint32_t now_us) {
    if (answering() || (size_ == 0 && !spoilt_) || now_us - last_us_ < silence_us_) return;
    const std::span<const std::uint8_t> frame(frame_.data(), size_);
    const bool whole = !spoilt_ && frame.size() >= kRtuBytesMin && crc_ == 0;
    clear();
    if (!whole) {
      ++counts.bad_frames;
      return;
    }
    const bool broadcast = frame[0] == 0;
    if (frame[0] != unit_ && !broadcast) return;
    const std::span<const std::uint8_t> pdu = frame.subspan(1, frame.size() - 3);
    // A broadcast that reads asks for nothing.
    if (broadcast && pdu[0] != modbus::kWriteOne && pdu[0] != modbus::kWriteSeveral) return;
    const Response response = handle_pdu(registers, counts, pdu);
    if (broadcast) return;
    frame_[0] = unit_;
    std::copy_n(response.bytes.begin(), response.size, frame_.begin() + 1);
    answer_size_ = 1 + response.size + 2;
  }

  /// Whether bytes of an answer, with address and check sum, are still to be sent.
  bool answering() const { return sent_ < answer_size_; }
  /// The next of them. Only while answering().
  std::uint8_t next() const {
    if (sent_ + 2 < answer_size_) return frame_[sent_];
    return static_cast<std::uint8_t>(sent_ + 2 == answer_size_ ? crc_ & 0xffu : crc_ >> 8);
  }
  /// It was handed over.
  void advance() {
    if (sent_ + 2 < answer_size_) crc_ = crc16(crc_, frame_[sent_]);
    if (++sent_ >= answer_size_) clear();
  }

 private:
  void clear() {
    size_ = answer_size_ = sent_ = 0;
    crc_ = kCrc16Begin;
    spoilt_ = false;
  }

  std::uint8_t unit_;
  std::uint32_t silence_us_;
  std::array<std::uint8_t, kRtuBytesMax> frame_{};  ///< that comes in, and then the answer
  std::size_t size_ = 0;                            ///< of what came in
  std::size_t answer_size_ = 0, sent_ = 0;
  std::uint16_t crc_ = kCrc16Begin;  ///< of what came in, or of what was sent
  std::uint32_t last_us_ = 0;
  bool spoilt_ = false;
};

}  // namespace furcula::bus
