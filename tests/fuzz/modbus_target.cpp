// The Modbus server and the node behind it, under bytes and silences that nobody wrote. The input: a byte n
// below 250 is followed by n bytes of a frame and then a silence; 250 and above let time and sensors go on.
#include <cmath>

#include "furcula/bus/modbus_rtu.hpp"
#include "tests/common/bus/node_board.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

void check(const test::Bench& b) {
  require(control::check(b.node.config()) == Status::ok, "the configuration makes sense");
  for (const bus::Parameter& p : bus::kParameters)
    require(bus::allows(p, p.get(b.node.config())), "every parameter is within its bounds");
  const bool runs = b.node.state() == bus::NodeState::running;
  require(std::isfinite(b.board.command.torque_nm), "the torque is a number");
  require(runs || b.node.reason() != bus::Reason::none, "a robot that does not run says why");
}

}  // namespace

bool accepts(std::string_view input) {
  test::Bench b;
  b.settle();
  bus::RtuServer server(1, 1750);
  bool answered = false;
  std::uint32_t now_us = 0;
  for (std::size_t i = 0; i < input.size();) {
    const auto n = static_cast<std::uint8_t>(input[i++]);
    if (n >= 250) {
      b.board.answers = n != 255;
      b.board.sample.contact = n != 254;
      b.tick(n == 253 ? 100 : 1);
      require(b.node.state() == bus::NodeState::running || b.board.command.torque_nm == 0.0f,
              "no torque unless it runs");
      check(b);
      continue;
    }
    std::vector<std::uint8_t> frame;
    for (int k = 0; k < n && i < input.size(); ++k) frame.push_back(static_cast<std::uint8_t>(input[i++]));
    // Half of the frames get the checksum that they lack: else hardly one would be answered.
    if (n % 2 == 0) {
      const std::uint16_t crc = bus::crc16(frame);
      frame.push_back(static_cast<std::uint8_t>(crc & 0xff));
      frame.push_back(static_cast<std::uint8_t>(crc >> 8));
    }
    for (const std::uint8_t byte : frame) server.receive(byte, now_us += 90);
    now_us += 2000;
    const auto before = b.node.bus_counts();
    server.poll(b.registers, b.node.bus_counts(), now_us);
    std::vector<std::uint8_t> out;
    for (; server.answering(); server.advance()) out.push_back(server.next());
    require(out.size() <= bus::kRtuBytesMax, "an answer is no longer than a frame");
    require(out.empty() || (out.size() >= 5 && bus::crc16(out) == 0), "an answer has its checksum");
    require(out.empty() || b.node.bus_counts().requests == before.requests + 1, "an answer is counted");
    answered = answered || !out.empty();
    check(b);
  }
  return answered;
}

}  // namespace furcula::fuzz
