// How the table of messages describes a message and its signals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace furcula::bus {

enum class Encoding : std::uint8_t {
  unsigned_integer,
  signed_integer,  ///< two's complement
  real,            ///< IEEE 754, 32 bits
};

enum class ByteOrder : std::uint8_t {
  little,  ///< "Intel": the start bit is the least significant bit, bit n of byte b is number 8 b + n
  big,     ///< "Motorola": the start bit, of the same numbers, is the most significant bit, as in a DBC file
};

/// What a motor's range table gives the scale of (motors.hpp).
enum class Ranged : std::uint8_t { no, position, velocity, stiffness, damping, torque };

/// A number within a frame: physical value = raw * span / counts + offset. Span and counts stand apart,
/// because both are exact in a float where their quotient is not (25 rad / 65535).
struct Signal {
  std::string_view name;
  std::string_view unit;  ///< empty: a number, flags or a code
  std::uint8_t start_bit;
  std::uint8_t width;  ///< bits
  ByteOrder order;
  Encoding encoding;
  std::string_view meaning;
  float span = 1.0f;
  float counts = 1.0f;
  float offset = 0.0f;
  Ranged ranged = Ranged::no;
};

enum class Protocol : std::uint8_t { mini_cheetah, odrive, encoder, controller, walker };

/// How the id of a node enters the id of its messages.
enum class IdRule : std::uint8_t {
  fixed,      ///< base: the node is told by the message's first byte
  plus_node,  ///< base + node
  odrive,     ///< node << 5 | base
};

enum class Sender : std::uint8_t { desk, controller, node };

struct Message {
  std::string_view name;
  Protocol protocol;
  IdRule rule;
  std::uint16_t base;
  std::uint8_t size;  ///< bytes
  Sender sender;
  std::string_view meaning;
  std::span<const Signal> signals;
  std::uint8_t least_size;  ///< shorter frames that count as well: signals beyond their end are not there
  std::uint8_t marker = 0;  ///< not 0: the frame is seven times FF and this byte
};

/// Node ids are from 1 to 31 in every protocol: the mini-cheetah's drives then have the ids below 0x20,
/// ODrive's those below 0x400, and this project's own messages those from 0x400 on.
inline constexpr std::uint8_t kFirstNode = 1;
inline constexpr std::uint8_t kLastNode = 31;

/// The id of a node's message; within 11 bits for every node id.
constexpr std::uint32_t id_of(const Message& message, std::uint8_t node) {
  switch (message.rule) {
    case IdRule::fixed:
      return message.base;
    case IdRule::plus_node:
      return message.base + static_cast<std::uint32_t>(node);
    case IdRule::odrive:
      return static_cast<std::uint32_t>(node) << 5 | message.base;
  }
  return message.base;
}

}  // namespace furcula::bus
