// Modbus requests in a stream of bytes: the header of Modbus/TCP says where each ends. Bounded, no I/O.
// MODBUS Messaging on TCP/IP Implementation Guide V1.0b, section 3.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/modbus_pdu.hpp"

namespace furcula::bus {

/// Transaction, protocol (0), length of what follows it, unit.
inline constexpr std::size_t kTcpHeaderBytes = 7;
inline constexpr std::size_t kTcpBytesMax = kTcpHeaderBytes + kPduBytesMax;

/// One connection's requests, one after the other.
class TcpConnection {
 public:
  /// Takes bytes up to the end of a request at most. @returns how many were taken.
  constexpr std::size_t take(std::span<const std::uint8_t> bytes) {
    std::size_t taken = 0;
    while (taken < bytes.size() && !complete() && !broken()) frame_[size_++] = bytes[taken++];
    return taken;
  }
  /// A whole request is there: answer() it before taking more.
  constexpr bool complete() const { return size_ >= kTcpHeaderBytes && !broken() && size_ == wanted(); }
  /// What came is no Modbus/TCP: nothing after it can be read. Close the connection.
  constexpr bool broken() const {
    return size_ >= 6 && (modbus::word_at(frame_, 2) != 0 || length() < 2 || length() > kPduBytesMax + 1);
  }

  /// Does what the complete request asks for, whatever unit it is for: a connection has one. @returns the
  /// bytes to send; they hold until the next take().
  template <Registers R>
  std::span<const std::uint8_t> answer(R& registers, BusCounts& counts) {
    const Response response = handle_pdu(
        registers, std::span<const std::uint8_t>(frame_).subspan(kTcpHeaderBytes, size_ - kTcpHeaderBytes));
    ++counts.requests;
    if (response.is_exception()) ++counts.exceptions;
    frame_[4] = 0;
    frame_[5] = static_cast<std::uint8_t>(response.size + 1);
    std::size_t n = kTcpHeaderBytes;
    for (const std::uint8_t byte : response.pdu()) frame_[n++] = byte;
    size_ = 0;
    return {frame_.data(), n};
  }

 private:
  constexpr std::size_t length() const { return modbus::word_at(frame_, 4); }
  constexpr std::size_t wanted() const { return 6 + length(); }

  std::array<std::uint8_t, kTcpBytesMax> frame_{};
  std::size_t size_ = 0;
};

}  // namespace furcula::bus
