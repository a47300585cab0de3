// Requests for registers and their answers as frames: byte for byte, and as the table of messages has them.
#include "furcula/bus/register_frames.hpp"

#include <catch2/catch.hpp>

#include "furcula/bus/codec.hpp"

using namespace furcula;
using namespace furcula::bus;

TEST_CASE("a request for registers is eight bytes, the least significant ones of a number first") {
  RegisterRequest request;
  request.operation = RegisterOperation::request;
  request.sequence = 0x5a;
  request.address = 0x4655;
  request.value = 0x12340004;
  const Frame frame = pack(request, 3);
  CHECK(frame.id == 0x4e3);
  CHECK(frame.size == 8);
  CHECK(frame.data == std::array<std::uint8_t, 8>{0x31, 0x5a, 0x55, 0x46, 0x04, 0x00, 0x34, 0x12});
  CHECK(unpack_register_request(frame, 3).value() == request);
  CHECK_FALSE(unpack_register_request(frame, 4).ok());
  Frame shorter = frame;
  shorter.size = 7;
  CHECK_FALSE(unpack_register_request(shorter, 3).ok());
}

TEST_CASE("an answer with registers has the signals of the table") {
  std::uint32_t seed = 1;
  const auto next = [&seed] { return seed = seed * 1664525u + 1013904223u; };
  for (int i = 0; i < 100; ++i) {
    RegisterAnswer answer;
    answer.status = static_cast<ModbusException>(next() >> 28);
    answer.sequence = static_cast<std::uint8_t>(next() >> 24);
    answer.address = static_cast<std::uint16_t>(next() >> 16);
    answer.value = next();
    const Frame frame = pack(answer, 31);
    CHECK(frame.id == 0x51f);
    const auto raw = [&](const Signal& s) { return get_raw(frame, s).value(); };
    CHECK(raw(signal(message::kRegisterAnswer, "Protocol_Version")) == kProtocolVersion);
    CHECK(raw(signal(message::kRegisterAnswer, "Status")) == static_cast<std::uint32_t>(answer.status));
    CHECK(raw(signal(message::kRegisterAnswer, "Sequence")) == answer.sequence);
    CHECK(raw(signal(message::kRegisterAnswer, "Address")) == answer.address);
    CHECK(raw(signal(message::kRegisterAnswer, "Value")) == answer.value);
    CHECK(unpack_register_answer(frame, 31).value() == answer);
  }
}
