// The registers' request and answer over CAN as structures. The table of messages has their bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/registers.hpp"
#include "furcula/core/status.hpp"

namespace furcula::bus {

/// What a RegisterRequest asks for.
enum class RegisterOperation : std::uint8_t {
  read_input = 0,
  read_holding = 1,
  write = 2,
  request = 3,
  read_text = 4,
};

/// A request for one register or text, sent to a node.
struct RegisterRequest {
  std::uint8_t version = kProtocolVersion;                      ///< of the protocol, 4 bits
  RegisterOperation operation = RegisterOperation::read_input;  ///< what to do, 4 bits
  std::uint8_t sequence = 0;  ///< chosen by the sender; the answer repeats it
  std::uint16_t address = 0;  ///< of the first register; for `request` the key
  std::uint32_t value = 0;    ///< read: number of registers, 1 to 125 (read_text: the object's number);
      ///< write: two registers, the first one high; request: 65536 x session + request

  /// Compares all fields.
  constexpr bool operator==(const RegisterRequest&) const = default;
};

/// A node's answer to a RegisterRequest.
struct RegisterAnswer {
  std::uint8_t version = kProtocolVersion;         ///< of the protocol, 4 bits
  ModbusException status = ModbusException::none;  ///< `none`: done
  std::uint8_t sequence = 0;                       ///< of the request
  std::uint16_t address = 0;  ///< of the first of both registers; of a text from 0, two characters a step
  std::uint32_t value = 0;    ///< two registers, the first one high, the last of an odd number alone;
                              ///< of a text four characters; what was written, where nothing was read

  /// Compares all fields.
  constexpr bool operator==(const RegisterAnswer&) const = default;
};

namespace table {

// The frame is one number with the least significant byte first, and five of its parts are the signals.
constexpr bool in_these_places(const std::array<Signal, 5>& signals) {
  constexpr std::uint8_t kPlaces[][2] = {{0, 4}, {4, 4}, {8, 8}, {16, 16}, {32, 32}};
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (signals[i].start_bit != kPlaces[i][0] || signals[i].width != kPlaces[i][1] ||
        signals[i].order != ByteOrder::little)
      return false;
  return true;
}
static_assert(in_these_places(kRegisterRequest) && in_these_places(kRegisterAnswer));

constexpr Frame register_frame(const Message& message, std::uint8_t node, std::uint32_t version,
                               std::uint32_t code, std::uint32_t sequence, std::uint32_t address,
                               std::uint32_t value) {
  Frame frame = empty_frame(message, node);
  const std::uint32_t low = (version & 0xfu) | (code & 0xfu) << 4 | sequence << 8 | address << 16;
  frame.data = std::bit_cast<decltype(frame.data)>(std::uint64_t{value} << 32 | low);
  return frame;
}

template <class T, class Code>
constexpr T parts_of(const Frame& frame, Code T::*code) {
  const std::uint64_t row = in_a_row(frame, ByteOrder::little);
  const auto low = static_cast<std::uint32_t>(row);
  T parts;
  parts.version = static_cast<std::uint8_t>(low & 0xfu);
  parts.*code = static_cast<Code>(low >> 4 & 0xfu);
  parts.sequence = static_cast<std::uint8_t>(low >> 8 & 0xffu);
  parts.address = static_cast<std::uint16_t>(low >> 16);
  parts.value = static_cast<std::uint32_t>(row >> 32);
  return parts;
}

}  // namespace table

/// The frame of a request to `node`.
constexpr Frame pack(const RegisterRequest& r, std::uint8_t node) {
  return table::register_frame(message::kRegisterRequest, node, r.version,
                               static_cast<std::uint32_t>(r.operation), r.sequence, r.address, r.value);
}
/// The frame of an answer of `node`.
constexpr Frame pack(const RegisterAnswer& a, std::uint8_t node) {
  return table::register_frame(message::kRegisterAnswer, node, a.version,
                               static_cast<std::uint32_t>(a.status), a.sequence, a.address, a.value);
}

/// `invalid`: not a request of that node. Version and operation may be any that four bits hold.
constexpr Result<RegisterRequest> unpack_register_request(const Frame& frame, std::uint8_t node) {
  if (!is(frame, message::kRegisterRequest, node)) return Status::invalid;
  return table::parts_of(frame, &RegisterRequest::operation);
}

/// `invalid`: not an answer of that node.
constexpr Result<RegisterAnswer> unpack_register_answer(const Frame& frame, std::uint8_t node) {
  if (!is(frame, message::kRegisterAnswer, node)) return Status::invalid;
  return table::parts_of(frame, &RegisterAnswer::status);
}

}  // namespace furcula::bus
