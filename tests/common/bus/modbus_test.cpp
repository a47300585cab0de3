// Requests and frames of Modbus against the documents' own examples, and against everything that is wrong.
// That a master which is not ours gets on with it: tests/host/modbus and tests/pil.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <deque>
#include <string>
#include <vector>

#include "firmware/app/rtu_port.hpp"
#include "furcula/bus/modbus_rtu.hpp"
#include "tests/common/bus/node_board.hpp"

using namespace furcula;
using Bytes = std::vector<std::uint8_t>;

namespace {

/// Holding and input registers 0 to 199, each of which reads as it was written.
struct Memory {
  std::array<std::uint16_t, 200> words{};
  int writes = 0;

  bus::ModbusException read_input(std::uint16_t first, std::span<std::uint16_t> out) const {
    return read_holding(first, out);
  }
  bus::ModbusException read_holding(std::uint16_t first, std::span<std::uint16_t> out) const {
    if (first + out.size() > words.size()) return bus::ModbusException::illegal_address;
    std::copy_n(words.begin() + first, out.size(), out.begin());
    return bus::ModbusException::none;
  }
  bus::ModbusException write_holding(std::uint16_t first, std::span<const std::uint16_t> in) {
    if (first + in.size() > words.size()) return bus::ModbusException::illegal_address;
    if (in[0] == 0xffff) return bus::ModbusException::device_failure;
    ++writes;
    std::copy(in.begin(), in.end(), words.begin() + first);
    return bus::ModbusException::none;
  }
  std::string_view identification(std::uint8_t object) const { return object == 0 ? "Furcula" : "x"; }
};

Bytes answer(Memory& memory, const Bytes& request) {
  bus::Response response;
  bus::handle_pdu(memory, request, response);
  return {response.bytes.begin(), response.bytes.begin() + static_cast<std::ptrdiff_t>(response.size)};
}

Bytes framed(Bytes frame) {
  const std::uint16_t crc = bus::crc16(frame);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xff));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

/// All of the answer that is still to be sent.
Bytes drain(bus::RtuServer& server) {
  Bytes out;
  while (server.answering()) {
    out.push_back(server.next());
    server.advance();
  }
  return out;
}

struct Line {
  Memory memory;
  bus::BusCounts counts;
  bus::RtuServer server{17, 1750};
  std::uint32_t now_us = 0xfffffff0u;  // wraps within the first frame

  Bytes send(const Bytes& frame) {
    for (const std::uint8_t byte : frame) {
      server.receive(byte, now_us);
      now_us += 90;
      server.poll(memory, counts, now_us);
      CHECK_FALSE(server.answering());
    }
    now_us += 1750;
    server.poll(memory, counts, now_us);
    return drain(server);
  }
};

}  // namespace

TEST_CASE("the checksum is that of the document's example and of the catalogue of CRCs") {
  const std::uint8_t example[] = {0x02, 0x07};  // Modbus over Serial Line V1.02, 6.2.2: sent as 41 12
  CHECK(bus::crc16(example) == 0x1241);
  const std::uint8_t check[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  CHECK(bus::crc16(check) == 0x4b37);  // CRC-16/MODBUS, G. Cook's catalogue
  CHECK(bus::crc16({}) == 0xffff);
}

TEST_CASE("a frame's silence is 3.5 characters, and 1.75 ms above 19,200 baud") {
  CHECK(bus::silence_us(9600) == 4011);  // 38.5 bits
  CHECK(bus::silence_us(19200) == 2006);
  CHECK(bus::silence_us(115200) == 1750);
}

TEST_CASE("the examples of the application protocol are answered as printed") {
  Memory memory;
  // 6.3: holding registers 108 to 110 (addresses 107 to 109) are 022B, 0, 64.
  memory.words[0x6b] = 0x022b;
  memory.words[0x6d] = 0x64;
  CHECK(answer(memory, {3, 0x00, 0x6b, 0x00, 0x03}) == Bytes{3, 6, 0x02, 0x2b, 0x00, 0x00, 0x00, 0x64});
  // 6.4: input register 9 is 000A.
  memory.words[8] = 0x0a;
  CHECK(answer(memory, {4, 0x00, 0x08, 0x00, 0x01}) == Bytes{4, 2, 0x00, 0x0a});
  // 6.6: register 2 is set to 3; 6.12: registers 2 and 3 to 000A and 0102.
  CHECK(answer(memory, {6, 0x00, 0x01, 0x00, 0x03}) == Bytes{6, 0x00, 0x01, 0x00, 0x03});
  CHECK(memory.words[1] == 3);
  CHECK(answer(memory, {16, 0x00, 0x01, 0x00, 0x02, 0x04, 0x00, 0x0a, 0x01, 0x02}) ==
        Bytes{16, 0x00, 0x01, 0x00, 0x02});
  CHECK(memory.words[1] == 0x0a);
  CHECK(memory.words[2] == 0x0102);
}

TEST_CASE("the device says who it is, as a whole and object by object") {
  Memory memory;
  const Bytes all = answer(memory, {0x2b, 0x0e, 0x01, 0x00});
  CHECK(Bytes(all.begin(), all.begin() + 9) == Bytes{0x2b, 0x0e, 0x01, 0x81, 0, 0, 3, 0, 7});
  CHECK(std::string(all.begin() + 9, all.begin() + 16) == "Furcula");
  CHECK(answer(memory, {0x2b, 0x0e, 0x04, 0x01}) == Bytes{0x2b, 0x0e, 0x04, 0x81, 0, 0, 1, 1, 1, 'x'});
  CHECK(answer(memory, {0x2b, 0x0e, 0x04, 0x09}) == Bytes{0xab, 2});
  CHECK(answer(memory, {0x2b, 0x0e, 0x02, 0x00}) == Bytes{0xab, 3});
  CHECK(answer(memory, {0x2b, 0x0d, 0x01, 0x00}) == Bytes{0xab, 1});
}

TEST_CASE("what is wrong with a request is told by an exception, and nothing is written") {
  Memory memory;
  CHECK(answer(memory, {}) == Bytes{0x80, 1});
  CHECK(answer(memory, {1, 0, 0, 0, 1}) == Bytes{0x81, 1});  // coils: there are none
  CHECK(answer(memory, {3, 0, 0, 0, 0}) == Bytes{0x83, 3});
  CHECK(answer(memory, {3, 0, 0, 0, 126}) == Bytes{0x83, 3});
  CHECK(answer(memory, {3, 0, 199, 0, 2}) == Bytes{0x83, 2});
  CHECK(answer(memory, {4, 0xff, 0xff, 0, 2}) == Bytes{0x84, 2});
  CHECK(answer(memory, {3, 0, 0, 0}) == Bytes{0x83, 3});
  CHECK(answer(memory, {6, 0, 200, 0, 1}) == Bytes{0x86, 2});
  CHECK(answer(memory, {6, 0, 0, 0xff, 0xff}) == Bytes{0x86, 4});
  CHECK(answer(memory, {16, 0, 0, 0, 2, 4, 0, 1, 0}) == Bytes{0x90, 3});     // a byte short
  CHECK(answer(memory, {16, 0, 0, 0, 2, 3, 0, 1, 0, 2}) == Bytes{0x90, 3});  // a wrong count of bytes
  CHECK(answer(memory, {16, 0, 0, 0, 0, 0}) == Bytes{0x90, 3});
  CHECK(answer(memory, {16, 0, 0, 0, 124, 248}) == Bytes{0x90, 3});
  CHECK(answer(memory, {16, 0xff, 0xff, 0, 2, 4, 0, 1, 0, 2}) == Bytes{0x90, 2});
  CHECK(memory.writes == 0);
}

TEST_CASE("a frame is answered when the line has been silent, over the wrap of the clock") {
  Line line;
  line.memory.words[8] = 0x1234;
  CHECK(line.send(framed({17, 4, 0, 8, 0, 1})) == framed({17, 4, 2, 0x12, 0x34}));
  CHECK(line.send(framed({17, 4, 0, 250, 0, 1})) == framed({17, 0x84, 2}));
  CHECK(line.counts.requests == 2);
  CHECK(line.counts.exceptions == 1);
  CHECK(line.counts.bad_frames == 0);
}

TEST_CASE("a frame with any one bit wrong is dropped and counted, and the next one is answered") {
  Line line;
  const Bytes good = framed({17, 6, 0, 8, 0, 1});
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ 1u << bit % 8);
    CHECK(line.send(bad).empty());
  }
  CHECK(line.counts.bad_frames == 64);
  CHECK(line.memory.writes == 0);
  CHECK(line.send(good) == good);
}

TEST_CASE("frames that are too short, too long, torn in two or run together are dropped") {
  Line line;
  const Bytes good = framed({17, 6, 0, 8, 0, 1});
  CHECK(line.send({17}).empty());
  CHECK(line.send(framed({17})).empty());
  CHECK(line.send(Bytes(good.begin(), good.begin() + 4)).empty());
  CHECK(line.send(Bytes(good.begin() + 4, good.end())).empty());
  Bytes twice = good;
  twice.insert(twice.end(), good.begin(), good.end());
  CHECK(line.send(twice).empty());
  CHECK(line.send(Bytes(1000, 17)).empty());
  CHECK(line.counts.bad_frames == 6);
  CHECK(line.memory.writes == 0);
  CHECK(line.send(good) == good);
}

TEST_CASE("the longest frame there is is taken") {
  Line line;
  Bytes longest{17, 16, 0, 0, 0, 123, 246};
  for (int i = 0; i < 123; ++i) {
    longest.push_back(0);
    longest.push_back(static_cast<std::uint8_t>(i));
  }
  CHECK(line.send(framed(longest)) == framed({17, 16, 0, 0, 0, 123}));
  CHECK(line.memory.words[122] == 122);
}

TEST_CASE("another unit's frames are left alone, a broadcast is done where it writes and never answered") {
  Line line;
  CHECK(line.send(framed({18, 6, 0, 8, 0, 1})).empty());
  CHECK(line.memory.writes == 0);
  CHECK(line.send(framed({0, 6, 0, 8, 0, 7})).empty());
  CHECK(line.memory.words[8] == 7);
  CHECK(line.send(framed({0, 4, 0, 8, 0, 1})).empty());
  CHECK(line.counts.requests == 1);
  CHECK(line.counts.bad_frames == 0);
}

TEST_CASE("a frame with a spoilt byte in it is dropped whole") {
  Line line;
  const Bytes good = framed({17, 6, 0, 8, 0, 1});
  line.server.spoil(line.now_us);
  CHECK(line.send(good).empty());
  CHECK(line.memory.writes == 0);
  CHECK(line.send(good) == good);
  line.server.spoil(line.now_us);  // alone
  line.now_us += 2000;
  line.server.poll(line.memory, line.counts, line.now_us);
  CHECK_FALSE(line.server.answering());
  CHECK(line.counts.bad_frames == 2);
}

TEST_CASE("what comes while an answer is being sent ends the answer and is a frame of its own") {
  Line line;
  line.memory.words[8] = 0x1234;
  for (const std::uint8_t byte : framed({17, 4, 0, 8, 0, 1})) line.server.receive(byte, line.now_us);
  line.now_us += 1750;
  line.server.poll(line.memory, line.counts, line.now_us);
  REQUIRE(line.server.answering());
  line.server.advance();
  line.server.advance();
  CHECK(line.server.next() == 2);
  CHECK(line.send(framed({17, 6, 0, 8, 0, 7})) == framed({17, 6, 0, 8, 0, 7}));
  CHECK(line.memory.words[8] == 7);
  CHECK(line.counts.bad_frames == 0);
}

TEST_CASE("a port's answer goes out byte by byte, and what comes meanwhile is not taken for a request") {
  struct Wire {
    std::deque<std::uint8_t> in;
    Bytes out;
    bool full = false;
    Result<std::uint8_t> receive() {
      if (in.empty()) return Status::disconnected;
      const std::uint8_t byte = in.front();
      in.pop_front();
      return byte;
    }
    Status send(std::uint8_t byte) {
      full = !full;  // every other time it is busy
      if (full) return Status::disconnected;
      out.push_back(byte);
      return Status::ok;
    }
  } wire;
  Memory memory;
  bus::BusCounts counts;
  firmware::RtuPort port(wire, 1, 115200);
  const Bytes request = framed({1, 4, 0, 8, 0, 1});
  wire.in.assign(request.begin(), request.end());
  std::uint32_t now_us = 0;
  for (int i = 0; i < 300 && wire.out.empty(); ++i) port.poll(memory, counts, now_us += 20);
  REQUIRE_FALSE(wire.out.empty());
  wire.in.assign(3, 0x55);
  for (int i = 0; i < 300; ++i) port.poll(memory, counts, now_us += 20);
  CHECK(wire.out == framed({1, 4, 2, 0, 0}));
  CHECK(counts.bad_frames == 0);
}

TEST_CASE("a whole node answers through frames: all of its input registers in one request") {
  test::Bench b;
  b.settle();
  bus::RtuServer server(1, 1750);
  const Bytes request = framed({1, 4, 0, 0, 0, static_cast<std::uint8_t>(bus::kInputWords)});
  for (const std::uint8_t byte : request) server.receive(byte, 0);
  server.poll(b.registers, b.node.bus_counts(), 2000);
  const Bytes out = drain(server);
  REQUIRE(out.size() == 3u + 2u * bus::kInputWords + 2u);
  std::array<std::uint16_t, bus::kInputWords> words;
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = static_cast<std::uint16_t>(out[3 + 2 * i] << 8 | out[4 + 2 * i]);
  const bus::Snapshot s = bus::from_words(words);
  CHECK(s.state == static_cast<int>(bus::NodeState::idle));
  CHECK(s.height_m == Approx(0.22f));
  CHECK(s.board_id == bus::board_id("test_board"));
  CHECK(s.build_id == 0x0badcafe);
}
