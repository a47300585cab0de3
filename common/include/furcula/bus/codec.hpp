// Puts signals into frames and gets them out: bounded, and defined for every input.
#pragma once

#include <bit>
#include <cstdint>

#include "furcula/bus/frame.hpp"
#include "furcula/bus/message.hpp"
#include "furcula/core/status.hpp"

namespace furcula::bus {

/// The number in the frame of the signal's bit `i`, counted from the least significant one (numbers as in
/// ByteOrder).
constexpr std::uint32_t frame_bit(const Signal& signal, std::uint32_t i) {
  if (signal.order == ByteOrder::little) return signal.start_bit + i;
  // From the most significant bit on: down to bit 0 of the byte, then bit 7 of the next one.
  const std::uint32_t down = (7u - signal.start_bit % 8u) + signal.width - 1u - i;
  return 8u * (signal.start_bit / 8u + down / 8u) + 7u - down % 8u;
}

/// Bytes that a frame must have so that the signal lies within it.
constexpr std::uint32_t bytes_to_end(const Signal& signal) {
  return frame_bit(signal, signal.order == ByteOrder::little ? signal.width - 1u : 0u) / 8u + 1u;
}

/// Whether the signal lies within the frame.
constexpr bool has(const Frame& frame, const Signal& signal) {
  return !frame.remote && frame.size <= frame.data.size() && signal.width >= 1 && signal.width <= 32 &&
         bytes_to_end(signal) <= frame.size;
}

/// A frame's eight bytes as one number in a signal's order of bytes: the signal's bits then stand in a row.
constexpr std::uint64_t in_a_row(const Frame& frame, ByteOrder order) {
  const auto number = std::bit_cast<std::uint64_t>(frame.data);
  return order == ByteOrder::little ? number : __builtin_bswap64(number);
}
static_assert(std::endian::native == std::endian::little && sizeof(Frame::data) == 8);
/// Of the signal's least significant bit in that number.
constexpr std::uint32_t place_in_row(const Signal& signal) {
  const std::uint32_t bit = frame_bit(signal, 0);
  return signal.order == ByteOrder::little ? bit : 8u * (7u - bit / 8u) + bit % 8u;
}
/// A number with as many ones, from bit 0 on, as the signal has bits.
constexpr std::uint32_t ones(const Signal& signal) { return 0xffffffffu >> (32u - signal.width); }

/// The bits of a signal. `invalid`: the frame is shorter than the signal needs, or carries no data.
constexpr Result<std::uint32_t> get_raw(const Frame& frame, const Signal& signal) {
  if (!has(frame, signal)) return Status::invalid;
  return static_cast<std::uint32_t>(in_a_row(frame, signal.order) >> place_in_row(signal)) & ones(signal);
}

/// Sets the bits of a signal; bits of `raw` above its width are ignored. `invalid`: as in get_raw().
constexpr Status put_raw(Frame& frame, const Signal& signal, std::uint32_t raw) {
  if (!has(frame, signal)) return Status::invalid;
  const std::uint32_t place = place_in_row(signal);
  const std::uint64_t others = in_a_row(frame, signal.order) & ~(std::uint64_t{ones(signal)} << place);
  const std::uint64_t row = others | std::uint64_t{raw & ones(signal)} << place;
  frame.data =
      std::bit_cast<decltype(frame.data)>(signal.order == ByteOrder::little ? row : __builtin_bswap64(row));
  return Status::ok;
}

/// The bits of a signed signal as a number.
constexpr std::int32_t extended_sign(const Signal& signal, std::uint32_t raw) {
  const std::uint32_t sign = 1u << (signal.width - 1u);
  return static_cast<std::int32_t>((raw ^ sign) - sign);
}

/// The physical value, in the signal's unit. A real number is given as it stands there, NaN as well. `invalid`: as in
/// get_raw().
constexpr Result<float> get(const Frame& frame, const Signal& signal) {
  const Result<std::uint32_t> raw = get_raw(frame, signal);
  if (!raw.ok()) return raw.status();
  if (signal.encoding == Encoding::real) return std::bit_cast<float>(raw.value());
  const float number = signal.encoding == Encoding::signed_integer
                           ? static_cast<float>(extended_sign(signal, raw.value()))
                           : static_cast<float>(raw.value());
  return number * signal.span / signal.counts + signal.offset;
}

/// Outcome of put().
enum class Put : std::uint8_t {
  whole,    ///< to the nearest step
  clamped,  ///< out of range: the nearest end of the range stands in the frame
  refused,  ///< not a finite number, or the frame is too short: the frame is as it was
};

/// Puts a physical value. What lies in the middle between two steps goes to the lower one, so that zero is
/// 7FF and 7FFF in the mini-cheetah's packing, as its drives' own code, which cuts off, has it.
constexpr Put put(Frame& frame, const Signal& signal, float value) {
  if (!(value - value == 0.0f)) return Put::refused;
  if (signal.encoding == Encoding::real)
    return put_raw(frame, signal, std::bit_cast<std::uint32_t>(value)) == Status::ok ? Put::whole
                                                                                     : Put::refused;
  // Below 2^24 a float holds every integer; a wider signal's ends are powers of two, which it holds too.
  const bool is_signed = signal.encoding == Encoding::signed_integer;
  const std::uint32_t raw_max = is_signed ? ones(signal) >> 1 : ones(signal);
  const float below = is_signed ? -static_cast<float>(raw_max) - 1.0f : 0.0f;
  const float steps = (value - signal.offset) * signal.counts / signal.span;
  std::uint32_t raw = 0;
  Put result = Put::whole;
  if (steps >= static_cast<float>(raw_max)) {
    // Beyond the last step by no more than rounding is that step.
    if (steps > static_cast<float>(raw_max) + 0.5f) result = Put::clamped;
    raw = raw_max;
  } else if (steps <= below) {
    if (steps < below - 0.5f) result = Put::clamped;
    raw = is_signed ? raw_max + 1u : 0u;
  } else if (steps >= 0.0f) {
    // Cut off, then corrected by what that left: exact, because no float above 2^23 has a fraction.
    raw = static_cast<std::uint32_t>(steps);
    if (steps - static_cast<float>(raw) > 0.5f) ++raw;
  } else {
    const auto cut = static_cast<std::int32_t>(steps);
    raw = static_cast<std::uint32_t>(cut);
    if (steps - static_cast<float>(cut) <= -0.5f) --raw;
  }
  return put_raw(frame, signal, raw) == Status::ok ? result : Put::refused;
}

/// Whether the frame is the node's message: its id, its length, its first byte where that tells the node.
constexpr bool is(const Frame& frame, const Message& message, std::uint8_t node) {
  if (frame.extended || frame.remote || frame.id != id_of(message, node)) return false;
  if (frame.size < message.least_size || frame.size > message.size) return false;
  if (message.rule == IdRule::fixed && frame.data[0] != node) return false;
  if (message.marker == 0) return true;
  for (std::size_t i = 0; i < 7; ++i)
    if (frame.data[i] != 0xff) return false;
  return frame.data[7] == message.marker;
}

/// A frame of the message with all of its bits 0, or the whole of it where it has a marker.
constexpr Frame empty_frame(const Message& message, std::uint8_t node) {
  Frame frame{id_of(message, node), message.size, false, false, {}};
  if (message.rule == IdRule::fixed) frame.data[0] = node;
  if (message.marker != 0) frame.data = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, message.marker};
  return frame;
}

}  // namespace furcula::bus
