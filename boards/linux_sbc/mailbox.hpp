// Between the thread that speaks with people and the loop: a request goes in, its answer comes out.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "boards/linux_sbc/slot.hpp"
#include "furcula/bus/modbus_pdu.hpp"

namespace furcula::linux_sbc {

class Mailbox {
 public:
  /// For the server's thread: hands a Modbus request (function code and data, at most bus::kPduBytesMax) to
  /// the loop and waits for its answer. A request that the loop does not take within 100 ms is withdrawn, and
  /// the exception of a server's failure: it is never done.
  bus::Response ask(std::span<const std::uint8_t> request);

  /// For the loop: answers what there is to answer, if anything. Never waits.
  template <class Answer>
  void attend(const Answer& answer) {
    if (Pdu request; request_.take(request)) {
      const bus::Response response = answer(std::span<const std::uint8_t>(request.bytes).first(request.size));
      static_cast<void>(answer_.put({request.number, response.bytes, response.size}));
    }
  }

 private:
  /// Without what wraps it on the wire.
  struct Pdu {
    std::uint32_t number = 0;  ///< an answer has that of its request
    std::array<std::uint8_t, bus::kPduBytesMax> bytes{};
    std::size_t size = 0;
  };

  Slot<Pdu> request_;  ///< put by the server, taken by the loop
  Slot<Pdu> answer_;   ///< the other way round
  std::uint32_t number_ = 0;
};

}  // namespace furcula::linux_sbc
