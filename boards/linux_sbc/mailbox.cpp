// The server's side of the mailbox, see mailbox.hpp.
#include "boards/linux_sbc/mailbox.hpp"

#include <algorithm>
#include <ctime>

namespace furcula::linux_sbc {
namespace {

constexpr int kTries = 500;  ///< of 200 us each: 100 ms

void pause() {
  const timespec time{0, 200'000};
  ::nanosleep(&time, nullptr);
}

}  // namespace

bus::Response Mailbox::ask(std::span<const std::uint8_t> request) {
  Pdu asked;
  asked.number = ++number_;
  asked.size = std::min(request.size(), asked.bytes.size());
  std::copy_n(request.begin(), asked.size, asked.bytes.begin());
  bus::Response response;
  const bool handed = request_.put(asked);
  for (int tries = 0; handed; ++tries) {
    pause();
    if (Pdu answer; answer_.take(answer) && answer.number == asked.number) {
      response.bytes = answer.bytes;
      response.size = answer.size;
      return response;
    }
    // What is reported as failed must not be done later. A loop that has taken it answers, however late.
    if (tries >= kTries && request_.withdraw()) break;
  }
  response.put(asked.bytes[0] | 0x80u);
  response.put(static_cast<std::uint32_t>(bus::ModbusException::device_failure));
  return response;
}

}  // namespace furcula::linux_sbc
