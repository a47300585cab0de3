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

enum class RegisterOperation : std::uint8_t {
  read_input = 0,
  read_holding = 1,
  write = 2,
  request = 3,
  read_text = 4,
};

struct RegisterRequest {
  std::uint8_t version = kProtocolVersion;
  RegisterOperation operation = RegisterOperation::read_input;
  std::uint8_t sequence = 0;
  std::uint16_t address = 0;
  std::uint32_t value = 0;

  constexpr bool operator==(const RegisterRequest&) const = default;
};

struct RegisterAnswer {
  std::uint8_t version = kProtocolVersion;
  ModbusException status = ModbusException::none;
  std::uint8_t sequence = 0;
  std::uint16_t address = 0;
  std::uint32_t value = 0;

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

constexpr Frame pack(const RegisterRequest& r, std::uint8_t node) {
  return table::register_frame(message::kRegisterRequest, node, r.version,
                               static_cast<std::uint32_t>(r.operation), r.sequence, r.address, r.value);
}
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
