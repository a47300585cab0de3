// A Modbus server on a serial line: bytes in, a frame ends by silence, the answer out. Bounded, no I/O; the
// caller has clock and port. MODBUS over Serial Line V1.02, section 2.5.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/modbus_pdu.hpp"

namespace furcula::bus {

/// Address, PDU, CRC.
inline constexpr std::size_t kRtuBytesMax = kPduBytesMax + 3;
inline constexpr std::size_t kRtuBytesMin = 4;

/// Remainders of the sixteen halves of a byte: the CRC of a long answer is made within a tick.
inline constexpr std::array<std::uint16_t, 16> kCrc16Table = [] {
  std::array<std::uint16_t, 16> table{};
  for (std::uint32_t n = 0; n < 16; ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 4; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xa001u : crc >> 1;
    table[n] = static_cast<std::uint16_t>(crc);
  }
  return table;
}();

/// CRC-16 with the polynomial A001, begun with FFFF; its low byte goes first. 6.2.2.
constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffff;
  for (const std::uint32_t byte : bytes) {
    crc = crc >> 4 ^ kCrc16Table[(crc ^ byte) & 0xfu];
    crc = crc >> 4 ^ kCrc16Table[(crc ^ byte >> 4) & 0xfu];
  }
  return static_cast<std::uint16_t>(crc);
}

/// 3.5 characters of 11 bits; above 19,200 baud 1.75 ms whatever the speed. 2.5.1.1.
constexpr std::uint32_t silence_us(std::uint32_t baud) {
  return baud > 19200 || baud == 0 ? 1750 : (38500000u + baud - 1) / baud;
}

class RtuServer {
 public:
  /// `unit` 1 to 247. A gap of `silence` us or more ends a frame; a caller that looks at the port only now
  /// and then and sees bytes late gives a silence that is no shorter than between two looks.
  RtuServer(std::uint8_t unit, std::uint32_t silence) : unit_(unit), silence_us_(silence) {}

  /// A byte that came at `now_us`, a clock that wraps.
  void receive(std::uint8_t byte, std::uint32_t now_us) {
    if (size_ < frame_.size())
      frame_[size_++] = byte;
    else
      spoilt_ = true;  // longer than any frame
    last_us_ = now_us;
  }
  /// A byte that came spoilt (parity, framing, overrun): the frame that it belongs to is worthless.
  void spoil(std::uint32_t now_us) {
    spoilt_ = true;
    last_us_ = now_us;
  }

  /// To be called whenever there may have been a silence. @returns the answer to send, address and CRC
  /// included; empty: none. It holds until the next byte.
  template <Registers R>
  std::span<const std::uint8_t> poll(R& registers, BusCounts& counts, std::uint32_t now_us) {
    if ((size_ == 0 && !spoilt_) || now_us - last_us_ < silence_us_) return {};
    const std::span<const std::uint8_t> frame(frame_.data(), size_);
    const bool whole = !spoilt_ && frame.size() >= kRtuBytesMin && is_intact(frame);
    size_ = 0;
    spoilt_ = false;
    if (!whole) {
      ++counts.bad_frames;
      return {};
    }
    const bool broadcast = frame[0] == 0;
    if (frame[0] != unit_ && !broadcast) return {};
    const std::span<const std::uint8_t> pdu = frame.subspan(1, frame.size() - 3);
    // A broadcast that reads asks for nothing.
    if (broadcast && pdu[0] != modbus::kWriteOne && pdu[0] != modbus::kWriteSeveral) return {};
    const Response response = handle_pdu(registers, pdu);
    ++counts.requests;
    if (response.is_exception()) ++counts.exceptions;
    return broadcast ? std::span<const std::uint8_t>{} : answer(response);
  }

 private:
  static bool is_intact(std::span<const std::uint8_t> frame) {
    const std::size_t n = frame.size();
    return crc16(frame.first(n - 2)) == (frame[n - 1] << 8 | frame[n - 2]);
  }

  std::span<const std::uint8_t> answer(const Response& response) {
    std::size_t n = 0;
    frame_[n++] = unit_;
    for (const std::uint8_t byte : response.pdu()) frame_[n++] = byte;
    const std::uint16_t crc = crc16(std::span<const std::uint8_t>(frame_).first(n));
    frame_[n++] = static_cast<std::uint8_t>(crc & 0xffu);
    frame_[n++] = static_cast<std::uint8_t>(crc >> 8);
    return {frame_.data(), n};
  }

  std::uint8_t unit_;
  std::uint32_t silence_us_;
  std::array<std::uint8_t, kRtuBytesMax> frame_{};  ///< that comes in, and then the answer
  std::size_t size_ = 0;
  std::uint32_t last_us_ = 0;
  bool spoilt_ = false;
};

}  // namespace furcula::bus
