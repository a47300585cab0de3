// The node's registers over CAN: a host's frame asks, and is answered by what answers Modbus. One request a
// tick, one frame of the answer a tick, so that whoever floods the bus with them takes little from the robot.
// No clock and no I/O.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/modbus_pdu.hpp"
#include "furcula/bus/register_frames.hpp"

namespace furcula::firmware {

class CanRegisters {
 public:
  explicit CanRegisters(std::uint8_t node) : node_(node) {}

  enum class Heard : std::uint8_t { taken, malformed, other_version };

  /// A frame with the id of a request. It waits for serve(), and takes the place of one that waits already;
  /// but nothing takes the place of a `stop`, which is one in any version of the protocol.
  Heard receive(const bus::Frame& frame) {
    const Result<bus::RegisterRequest> heard = bus::unpack_register_request(frame, node_);
    if (!heard.ok()) return Heard::malformed;
    if (heard.value().version != bus::kProtocolVersion && !is_stop(heard.value()))
      return Heard::other_version;
    if (heard.value().operation > Operation::read_text) return Heard::malformed;
    if (waits_ && is_stop(request_)) return Heard::taken;
    request_ = heard.value();
    waits_ = true;
    return Heard::taken;
  }

  bool stop_waits() const { return waits_ && is_stop(request_); }

  /// Does what the waiting request asks for, and begins its answer; what is left of the last one is dropped.
  /// To be called between two ticks: all that an answer holds is of one. `handle(pdu, response)` does what a
  /// Modbus request asks for (bus/modbus_pdu.hpp, handle_pdu()).
  template <class Handle>
  void serve(const Handle& handle) {
    if (!waits_) return;
    waits_ = false;
    sequence_ = request_.sequence;
    address_ = request_.address;
    const bool reads = request_.operation != Operation::write && request_.operation != Operation::request;
    // Who heard no answer says the same again. It is answered, and not done twice: its session is used up.
    if (was_done_ && request_ == done_ && !is_stop(request_)) {
      status_ = done_status_;
    } else {
      carry_out(handle);
    }
    if (request_.operation == Operation::request) {
      done_ = request_;
      done_status_ = status_;
      was_done_ = true;
    }
    if (!reads || status_ != bus::ModbusException::none) {
      response_.size = 0;
      if (status_ == bus::ModbusException::none)
        response_.put_words(std::array{bus::high_word(request_.value), bus::low_word(request_.value)});
      begin(0, 1);
    } else if (request_.operation == Operation::read_text) {
      address_ = 0;
      begin(kTextAt, response_.bytes[kTextAt - 1] / 4u + 1u);  // behind the text there is a 0
    } else {
      begin(kWordsAt, (request_.value + 1u) / 2u);
    }
  }

  /// Whether frames of an answer are still to be sent, one a tick.
  bool answering() const { return left_ > 0; }
  /// The next of them. Only while answering().
  bus::Frame next() const {
    const auto byte = [&](std::size_t i) -> std::uint32_t {
      return at_ + i < response_.size ? response_.bytes[at_ + i] : 0u;
    };
    bus::RegisterAnswer answer;
    answer.status = status_;
    answer.sequence = sequence_;
    answer.address = address_;
    answer.value = byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    return bus::pack(answer, node_);
  }
  /// It was handed over.
  void advance() {
    --left_;
    at_ += 4;
    address_ = static_cast<std::uint16_t>(address_ + 2);
  }

 private:
  using Operation = bus::RegisterOperation;

  // In the response to a read: behind function and length; to a read of the identification: behind the
  // object's length (modbus_pdu.hpp, identify()).
  static constexpr std::uint32_t kWordsAt = 2, kTextAt = 9;

  static bool is_stop(const bus::RegisterRequest& r) {
    return r.operation == Operation::request &&
           bus::low_word(r.value) == static_cast<std::uint16_t>(bus::Request::stop);
  }

  void begin(std::uint32_t at, std::uint32_t frames) {
    at_ = at;
    left_ = frames;
  }

  /// As a Modbus request.
  template <class Handle>
  void carry_out(const Handle& handle) {
    using namespace bus::modbus;
    std::array<std::uint8_t, 12> pdu;
    std::size_t size = 0;
    const auto put = [&](std::uint32_t byte) { pdu[size++] = static_cast<std::uint8_t>(byte); };
    const auto put_word = [&](std::uint32_t word) {
      put(word >> 8);
      put(word);
    };
    const std::uint32_t high = bus::high_word(request_.value), low = bus::low_word(request_.value);
    switch (request_.operation) {
      case Operation::read_input:
      case Operation::read_holding:
        put(request_.operation == Operation::read_input ? kReadInput : kReadHolding);
        put_word(request_.address);
        put_word(high == 0 ? low : 0);  // none are refused, as too many are
        break;
      case Operation::write:
        put(kWriteSeveral);
        put_word(request_.address);
        put_word(2);
        put(4);
        put_word(high);
        put_word(low);
        break;
      case Operation::request:
        put(kWriteSeveral);
        put_word(bus::kRequestKeyAddress);
        put_word(bus::kRequestWords);
        put(2 * bus::kRequestWords);
        put_word(request_.address);
        put_word(high);
        put_word(low);
        break;
      case Operation::read_text:
        put(kEncapsulated);
        put(kDeviceIdentification);
        put(4);  // one object
        put(request_.value < 0xff ? low : 0xff);
        break;
    }
    handle(std::span<const std::uint8_t>(pdu).first(size), response_);
    status_ = response_.is_exception() ? static_cast<bus::ModbusException>(response_.bytes[1])
                                       : bus::ModbusException::none;
  }

  std::uint8_t node_;
  bool waits_ = false, was_done_ = false;
  bus::RegisterRequest request_, done_;  ///< that waits, or was served last; the last that used up a session
  bus::ModbusException status_ = bus::ModbusException::none, done_status_ = bus::ModbusException::none;
  std::uint8_t sequence_ = 0;
  std::uint16_t address_ = 0;  ///< of the next frame of the answer
  bus::Response response_;     ///< of which the answer is made
  std::size_t at_ = 0;         ///< of the next frame, in the response
  std::uint32_t left_ = 0;     ///< frames
};

}  // namespace furcula::firmware
