// How the table of messages describes a message and its signals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace furcula::bus {

/// How a signal's bits make its raw number.
enum class Encoding : std::uint8_t {
  unsigned_integer,
  signed_integer,  ///< two's complement
  real,            ///< IEEE 754, 32 bits
};

/// Byte order of a signal, and which of its bits is the start bit.
enum class ByteOrder : std::uint8_t {
  little,  ///< "Intel": the start bit is the least significant bit, bit n of byte b is number 8 b + n
  big,     ///< "Motorola": the start bit, of the same numbers, is the most significant bit, as in a DBC file
};

/// What a motor's range table gives the scale of (motors.hpp).
enum class Ranged : std::uint8_t { no, position, velocity, stiffness, damping, torque };

/// A number within a frame: physical value = raw * span / counts + offset. Span and counts stand apart,
/// because both are exact in a float where their quotient is not (25 rad / 65535).
struct Signal {
  std::string_view name;     ///< as in the DBC file and the documentation
  std::string_view unit;     ///< empty: a number, flags or a code
  std::uint8_t start_bit;    ///< 0 to 63, counted as `order` says
  std::uint8_t width;        ///< bits
  ByteOrder order;           ///< also tells which end of the signal `start_bit` is
  Encoding encoding;         ///< of the raw number
  std::string_view meaning;  ///< description for the documentation and the DBC file
  float span = 1.0f;    ///< change of the physical value over `counts` steps of the raw number, in `unit`
  float counts = 1.0f;  ///< steps of the raw number that make up `span`
  float offset = 0.0f;  ///< physical value of the raw number 0, in `unit`
  Ranged ranged = Ranged::no;  ///< where not `no`, with_range() sets span, counts and offset for a motor
};

/// The protocol that a message belongs to.
enum class Protocol : std::uint8_t { mini_cheetah, odrive, encoder, controller, walker };

/// How the id of a node enters the id of its messages.
enum class IdRule : std::uint8_t {
  fixed,      ///< base: the node is told by the message's first byte
  plus_node,  ///< base + node
  odrive,     ///< node << 5 | base
};

/// The device that sends a message.
enum class Sender : std::uint8_t { host, controller, node };

/// A row of the table of messages: identifier, size and signals of one kind of frame.
struct Message {
  std::string_view name;            ///< as in the DBC file and the documentation
  Protocol protocol;                ///< that the message belongs to
  IdRule rule;                      ///< how `base` and the node id make the frame's identifier
  std::uint16_t base;               ///< part of the frame's identifier without the node; see id_of()
  std::uint8_t size;                ///< bytes
  Sender sender;                    ///< which device sends it
  std::string_view meaning;         ///< description for the documentation and the DBC file
  std::span<const Signal> signals;  ///< of a frame of full size
  std::uint8_t least_size;  ///< shorter frames that count as well: signals beyond their end are not there
  std::uint8_t marker = 0;  ///< not 0: the frame is seven times FF and this byte
};

/// Lowest node id. Node ids are from 1 to 31 in every protocol: the mini-cheetah's drives then have the ids below 0x20,
/// ODrive's those below 0x400, and this project's own messages those from 0x400 on.
inline constexpr std::uint8_t kFirstNode = 1;
/// Highest node id.
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
