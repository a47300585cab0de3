// One Modbus request and its response, without what carries them: the same for a serial line and for TCP.
// MODBUS Application Protocol Specification V1.1b3.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "furcula/bus/registers.hpp"

namespace furcula::bus {

/// Of a function code and its data; 4.1.
inline constexpr std::size_t kPduBytesMax = 253;

/// What the requests read and write. All or nothing: an exception means that nothing was done.
template <class R>
concept Registers = requires(R& registers, std::uint16_t first, std::span<std::uint16_t> out,
                             std::span<const std::uint16_t> in, std::uint8_t object) {
  { registers.read_input(first, out) } -> std::same_as<ModbusException>;
  { registers.read_holding(first, out) } -> std::same_as<ModbusException>;
  { registers.write_holding(first, in) } -> std::same_as<ModbusException>;
  /// Empty: no such object. At most 60 bytes.
  { registers.identification(object) } -> std::same_as<std::string_view>;
};

/// The response's PDU: function code and data, or function code + 128 and exception code.
struct Response {
  std::array<std::uint8_t, kPduBytesMax> bytes;  ///< only the first `size` are set
  std::size_t size = 0;                          ///< bytes of the PDU so far, at most kPduBytesMax

  /// The bytes to be sent. They stay valid as long as this object.
  constexpr std::span<const std::uint8_t> pdu() const { return {bytes.data(), size}; }
  /// Whether the PDU is an exception response.
  constexpr bool is_exception() const { return size == 2 && (bytes[0] & 0x80u) != 0; }
  /// Appends the low eight bits of `byte`. The capacity is not checked.
  constexpr void put(std::uint32_t byte) { bytes[size++] = static_cast<std::uint8_t>(byte & 0xffu); }
  /// Appends registers, the more significant byte of each first. The capacity is not checked.
  constexpr void put_words(std::span<const std::uint16_t> words) {
    // A byte that is stored might be any object's, for all that the compiler knows: the place is a local one.
    std::size_t at = size;
    for (const std::uint16_t word : words) {
      bytes[at++] = static_cast<std::uint8_t>(word >> 8);
      bytes[at++] = static_cast<std::uint8_t>(word & 0xffu);
    }
    size = at;
  }
};

namespace modbus {

/// Function codes that are served; section 6.
enum Function : std::uint8_t {
  kReadHolding = 3,
  kReadInput = 4,
  kWriteOne = 6,
  kWriteSeveral = 16,
  kEncapsulated = 43,
};
inline constexpr std::uint8_t kDeviceIdentification = 14;  ///< the encapsulated interface's type, 6.21
/// Greatest number of registers in one request; 6.3 and 6.12.
inline constexpr std::uint16_t kReadMax = 125, kWriteMax = 123;

/// The number of 16 bits at byte `at`, the more significant byte first. The bounds are not checked.
constexpr std::uint16_t word_at(std::span<const std::uint8_t> pdu, std::size_t at) {
  return static_cast<std::uint16_t>(pdu[at] << 8 | pdu[at + 1]);
}

/// Read holding or input registers (6.3, 6.4): appends their count in bytes and their values to `response`.
template <Registers R>
ModbusException read(R& registers, std::span<const std::uint8_t> request, Response& response) {
  if (request.size() != 5) return ModbusException::illegal_value;
  const std::uint16_t first = word_at(request, 1), count = word_at(request, 3);
  if (count == 0 || count > kReadMax) return ModbusException::illegal_value;
  if (first + count > 65536) return ModbusException::illegal_address;
  std::array<std::uint16_t, kReadMax> words;
  const std::span<std::uint16_t> out = std::span(words).first(count);
  const ModbusException exception =
      request[0] == kReadHolding ? registers.read_holding(first, out) : registers.read_input(first, out);
  if (exception != ModbusException::none) return exception;
  response.put(2u * count);
  response.put_words(out);
  return ModbusException::none;
}

/// Write one register (6.6): appends address and value to `response`.
template <Registers R>
ModbusException write_one(R& registers, std::span<const std::uint8_t> request, Response& response) {
  if (request.size() != 5) return ModbusException::illegal_value;
  const std::uint16_t word = word_at(request, 3);
  const ModbusException exception = registers.write_holding(word_at(request, 1), {&word, 1});
  if (exception != ModbusException::none) return exception;
  for (std::size_t i = 1; i < 5; ++i) response.put(request[i]);
  return ModbusException::none;
}

/// Write several registers (6.12): appends address and count to `response`.
template <Registers R>
ModbusException write_several(R& registers, std::span<const std::uint8_t> request, Response& response) {
  if (request.size() < 6) return ModbusException::illegal_value;
  const std::uint16_t first = word_at(request, 1), count = word_at(request, 3);
  if (count == 0 || count > kWriteMax || request[5] != 2 * count || request.size() != 6u + request[5])
    return ModbusException::illegal_value;
  if (first + count > 65536) return ModbusException::illegal_address;
  std::array<std::uint16_t, kWriteMax> words;
  for (std::size_t i = 0; i < count; ++i) words[i] = word_at(request, 6 + 2 * i);
  const ModbusException exception =
      registers.write_holding(first, std::span<const std::uint16_t>(words).first(count));
  if (exception != ModbusException::none) return exception;
  for (std::size_t i = 1; i < 5; ++i) response.put(request[i]);
  return ModbusException::none;
}

/// The basic objects, all at once (code 1) or one (code 4).
template <Registers R>
ModbusException identify(R& registers, std::span<const std::uint8_t> request, Response& response) {
  if (request.size() < 2 || request[1] != kDeviceIdentification) return ModbusException::illegal_function;
  if (request.size() != 4) return ModbusException::illegal_value;
  const std::uint8_t code = request[2], object = request[3];
  if (code != 1 && code != 4) return ModbusException::illegal_value;
  constexpr std::uint8_t kObjects = 3;
  // An object that is not there: all from the first on; where one is asked for, an exception. 6.21.
  if (code == 4 && object >= kObjects) return ModbusException::illegal_address;
  const std::uint8_t first = object < kObjects ? object : std::uint8_t{0};
  const std::uint8_t count = code == 4 ? std::uint8_t{1} : static_cast<std::uint8_t>(kObjects - first);
  response.put(kDeviceIdentification);
  response.put(code);
  response.put(0x81);  // conformity: basic, as a whole and one by one
  response.put(0);     // nothing follows
  response.put(0);
  response.put(count);
  for (std::uint8_t i = first; i < first + count; ++i) {
    const std::string_view text = registers.identification(i).substr(0, 60);
    response.put(i);
    response.put(static_cast<std::uint32_t>(text.size()));
    for (const char c : text) response.put(static_cast<std::uint8_t>(c));
  }
  return ModbusException::none;
}

}  // namespace modbus

/// Does what the request asks for. `request` is the function code and its data; what is longer or shorter
/// than its function says is an exception. `response` is what is to be answered, whatever it was before.
template <Registers R>
void handle_pdu(R& registers, std::span<const std::uint8_t> request, Response& response) {
  response.size = 0;
  const std::uint8_t function = request.empty() ? std::uint8_t{0} : request[0];
  response.put(function);
  ModbusException exception = ModbusException::illegal_function;
  switch (function) {
    case modbus::kReadHolding:
    case modbus::kReadInput:
      exception = modbus::read(registers, request, response);
      break;
    case modbus::kWriteOne:
      exception = modbus::write_one(registers, request, response);
      break;
    case modbus::kWriteSeveral:
      exception = modbus::write_several(registers, request, response);
      break;
    case modbus::kEncapsulated:
      exception = modbus::identify(registers, request, response);
      break;
    default:
      break;
  }
  if (exception == ModbusException::none) return;
  response.size = 0;
  response.put(function | 0x80u);
  response.put(static_cast<std::uint32_t>(exception));
}
/// The same, counted in `counts`.
template <Registers R>
void handle_pdu(R& registers, BusCounts& counts, std::span<const std::uint8_t> request, Response& response) {
  handle_pdu(registers, request, response);
  ++counts.requests;
  if (response.is_exception()) ++counts.exceptions;
}
/// The same, with the response as the result.
template <Registers R>
Response handle_pdu(R& registers, BusCounts& counts, std::span<const std::uint8_t> request) {
  Response response;
  handle_pdu(registers, counts, request, response);
  return response;
}

}  // namespace furcula::bus
