// The link between the bus and the controller: no sequence of frames, events and pauses makes it say anything
// that is not a number, or count backwards; and no request for registers brings the node behind it out of its
// bounds.
#include <cmath>
#include <string_view>

#include "firmware/app/can_link.hpp"
#include "furcula/control/controller.hpp"
#include "tests/common/bus/node_board.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

/// What follows in the input, a byte at a time; zeros at its end.
class Bytes {
 public:
  explicit Bytes(std::string_view input) : input_(input) {}
  bool empty() const { return at_ >= input_.size(); }
  std::uint8_t next() { return empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(input_[at_++]); }

 private:
  std::string_view input_;
  std::size_t at_ = 0;
};

/// Half of the ids are those of the robot's nodes.
bus::Frame frame_of(Bytes& bytes) {
  constexpr std::uint16_t kIds[] = {0x000, 0x461, 0x462, 0x401};
  bus::Frame frame;
  const std::uint8_t head = bytes.next();
  frame.id = (head & 1) != 0 ? kIds[head >> 6] : static_cast<std::uint32_t>(bytes.next()) << 3;
  frame.size = head >> 1 & 15;
  frame.extended = (head & 0x3e) == 0x3e;
  frame.remote = (head & 0x3e) == 0x2e;
  for (std::uint8_t& byte : frame.data) byte = bytes.next();
  return frame;
}

/// Mostly sound ones. A session of 0xffff stands for the right one.
bus::Frame register_request_of(Bytes& bytes, std::uint16_t session) {
  bus::Frame frame = bus::empty_frame(bus::message::kRegisterRequest, 1);
  for (std::uint8_t& byte : frame.data) byte = bytes.next();
  if (frame.data[0] == 0xff) frame.size = frame.data[7];
  if (frame.data[6] == 0xff && frame.data[7] == 0xff) {
    frame.data[6] = static_cast<std::uint8_t>(session & 0xff);
    frame.data[7] = static_cast<std::uint8_t>(session >> 8);
  }
  if (frame.data[0] < 0xf0) frame.data[0] = static_cast<std::uint8_t>((frame.data[0] & 0xf0) % 0x50 | 1);
  return frame;
}

/// A tick of the node behind the registers.
void serve(test::Bench& bench, firmware::CanLink& link) {
  bench.tick();
  if (link.registers().answering()) {
    const bus::Frame frame = link.registers().next();
    require(frame.id == 0x501 && frame.size == 8, "the registers' frames");
    link.registers().advance();
  }
  const bus::BusCounts before = bench.node.bus_counts();
  link.registers().serve([&](std::span<const std::uint8_t> request, bus::Response& response) {
    bus::handle_pdu(bench.registers, bench.node.bus_counts(), request, response);
  });
  require(bench.node.bus_counts().requests <= before.requests + 1, "one request a tick");
  require(control::check(bench.node.config()) == Status::ok, "the configuration makes sense");
  require(bench.node.state() == bus::NodeState::running || bench.node.reason() != bus::Reason::none,
          "a robot that does not run says why");
}

}  // namespace

bool accepts(std::string_view input) {
  Bytes bytes(input);
  firmware::CanLinkConfig config;
  config.cable_node = 2;
  config.supply_node = 3;
  config.leg_sign = (bytes.next() & 1) != 0 ? 1.0f : -1.0f;
  firmware::CanLink link(config);
  link.set_home(0, 0.25f, 0);
  test::Bench bench;
  bench.settle();
  control::Config controller_config;
  control::State controller = control::begin(controller_config);
  std::uint32_t now_us = 0xffff0000u;
  bool heard = false;
  while (!bytes.empty()) {
    const std::uint8_t what = bytes.next();
    const std::uint32_t received = link.statistics().received;
    if (what < 0xc0) {
      link.receive(frame_of(bytes), now_us);
      require(link.statistics().received == received + 1, "each frame is counted");
    } else if (what < 0xd0) {
      link.note(static_cast<firmware::BusEvent>(what % 3));
    } else if (what < 0xd8) {
      now_us += bytes.next() << 16;
    } else if (what < 0xf0) {
      link.receive(register_request_of(bytes, bench.node.session()), now_us);
    }
    if (what % 4 != 0) continue;
    now_us += 1000u + bytes.next();
    serve(bench, link);
    const auto sample = link.sample(now_us);
    control::Inputs inputs;
    inputs.tick_interval_us = 1000;
    inputs.reset = what == 0x44;
    inputs.sample_valid = sample.ok();
    if (sample.ok()) {
      heard = true;
      inputs.sample = sample.value();
      require(std::isfinite(sample.value().leg_angle_rad), "the leg's angle is a number");
      require(sample.value().reported_fault < control::kFaultCount, "a fault of the table");
      // The height's home is a number unless the node says that it has none: then the controller is told.
      if (!std::isfinite(sample.value().home_height_m))
        require(control::step(controller_config, controller, inputs, 0.001f).fault != control::Fault::none,
                "a height that is no number is a fault");
    }
    const control::Outputs out = control::step(controller_config, controller, inputs, 0.001f);
    require(std::isfinite(out.command.torque_nm) && std::isfinite(out.command.coil_duty), "finite commands");
    for (const bus::Frame& frame : link.command(out.command, out.fault == control::Fault::none))
      require(frame.id == 1 && frame.size == 8, "the drive's frames");
    const firmware::CanRequest request = link.take_request();
    require(std::isfinite(request.torque_amplitude_nm) && std::isfinite(request.torque_period_s),
            "a request's numbers");
  }
  return heard;
}

}  // namespace furcula::fuzz
