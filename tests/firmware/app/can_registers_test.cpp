// A node's registers over CAN: each answer is that of Modbus, of one tick, and none is given twice for one
// request done.
#include "firmware/app/can_registers.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <vector>

#include "firmware/app/can_link.hpp"
#include "tests/common/bus/node_board.hpp"

using namespace furcula;
using bus::ModbusException;
using bus::NodeState;
using bus::RegisterAnswer;
using bus::RegisterOperation;
using bus::RegisterRequest;
using firmware::CanRegisters;
using Words = std::vector<std::uint16_t>;

namespace {

constexpr std::uint8_t kNode = 7;
constexpr std::uint16_t kAmplitude = 258;

void serve(CanRegisters& registers, test::Bench& bench) {
  registers.serve([&](std::span<const std::uint8_t> request, bus::Response& response) {
    bus::handle_pdu(bench.registers, bench.node.bus_counts(), request, response);
  });
}

/// A node that ticks, and the host's end of the bus.
struct Host {
  test::Bench bench;
  CanRegisters registers{kNode};
  std::uint8_t sequence = 250;  // wraps soon

  explicit Host(const control::Config& config = test::harmonic_torque()) : bench({}, config) {
    bench.settle();
  }

  CanRegisters::Heard send(const RegisterRequest& request) {
    return registers.receive(bus::pack(request, kNode));
  }
  /// One millisecond of the board. @returns the frame that it sent in it.
  std::vector<RegisterAnswer> tick() {
    std::vector<RegisterAnswer> sent;
    bench.tick();
    if (registers.answering()) {
      sent.push_back(bus::unpack_register_answer(registers.next(), kNode).value());
      registers.advance();
    }
    serve(registers, bench);
    return sent;
  }
  std::vector<RegisterAnswer> listen(int ticks) {
    std::vector<RegisterAnswer> heard;
    for (int i = 0; i < ticks; ++i)
      for (const RegisterAnswer& answer : tick()) heard.push_back(answer);
    return heard;
  }
  std::vector<RegisterAnswer> ask(RegisterOperation operation, std::uint16_t address, std::uint32_t value) {
    CHECK(send({.operation = operation, .sequence = ++sequence, .address = address, .value = value}) ==
          CanRegisters::Heard::taken);
    const std::vector<RegisterAnswer> heard = listen(70);
    for (const RegisterAnswer& answer : heard) CHECK(answer.sequence == sequence);
    return heard;
  }
  ModbusException status_of(RegisterOperation operation, std::uint16_t address, std::uint32_t value) {
    const auto heard = ask(operation, address, value);
    REQUIRE(heard.size() == 1);
    CHECK(heard[0].address == address);
    return heard[0].status;
  }
  std::uint32_t request_value(bus::Request wanted) const {
    return bus::bits_of(bench.node.session(), static_cast<std::uint16_t>(wanted));
  }
};

/// `count` registers from `first` on, in frames of two; the rest of the last one is 0.
Words words_of(const std::vector<RegisterAnswer>& heard, std::uint16_t first, std::size_t count) {
  REQUIRE(heard.size() == (count + 1) / 2);
  Words words;
  for (std::size_t i = 0; i < heard.size(); ++i) {
    CHECK(heard[i].status == ModbusException::none);
    CHECK(heard[i].address == first + 2 * i);
    words.push_back(bus::high_word(heard[i].value));
    words.push_back(bus::low_word(heard[i].value));
  }
  if (count % 2 != 0) {
    CHECK(words.back() == 0);
    words.pop_back();
  }
  return words;
}

}  // namespace

TEST_CASE("registers over CAN are read as over Modbus, a frame for two of them") {
  Host host;
  Words same(bus::kInputWords);
  CHECK(host.send({.operation = RegisterOperation::read_input, .sequence = 9, .value = bus::kInputWords}) ==
        CanRegisters::Heard::taken);
  // All of them are of the tick after which the request was served, however long they take.
  CHECK(host.tick().empty());
  REQUIRE(host.bench.registers.read_input(0, same) == ModbusException::none);
  same[53] -= 1;  // bus_requests: itself was not counted yet
  CHECK(words_of(host.listen(100), 0, bus::kInputWords) == same);
  Words later(bus::kInputWords);
  REQUIRE(host.bench.registers.read_input(0, later) == ModbusException::none);
  CHECK(later[17] == same[17] + 100);  // the uptime went on

  Words parameters(bus::kParameterWords);
  REQUIRE(host.bench.registers.read_holding(bus::kParameterBase, parameters) == ModbusException::none);
  CHECK(words_of(host.ask(RegisterOperation::read_holding, bus::kParameterBase, bus::kParameterWords),
                 bus::kParameterBase, bus::kParameterWords) == parameters);
  CHECK(words_of(host.ask(RegisterOperation::read_input, 16, 3), 16, 3).size() == 3);
  CHECK(words_of(host.ask(RegisterOperation::read_input, 1, 1), 1, 1) ==
        Words{static_cast<std::uint16_t>(NodeState::idle)});
  // The longest of all: 125 rows of the trial.
  CHECK(words_of(host.ask(RegisterOperation::read_input, bus::kTrialCountBase, 125), bus::kTrialCountBase,
                 125) == Words(125, 0));
}

TEST_CASE("what Modbus refuses is refused over CAN with the same number, and counted with it") {
  Host host;
  using enum RegisterOperation;
  CHECK(host.status_of(read_input, 63, 9) == ModbusException::illegal_address);
  CHECK(host.status_of(read_input, 0, 0) == ModbusException::illegal_value);
  CHECK(host.status_of(read_input, 0, 126) == ModbusException::illegal_value);
  CHECK(host.status_of(read_input, 0, 0x10001) == ModbusException::illegal_value);
  CHECK(host.status_of(read_input, 0xffff, 2) == ModbusException::illegal_address);
  CHECK(host.status_of(read_holding, 100, 1) == ModbusException::illegal_address);
  CHECK(host.status_of(write, kAmplitude + 1, 0) == ModbusException::illegal_address);
  CHECK(host.status_of(write, kAmplitude, 0x7fc00000) == ModbusException::illegal_value);  // not a number
  CHECK(host.status_of(write, bus::kRequestKeyAddress, 0x46550001) == ModbusException::illegal_address);
  CHECK(host.status_of(request, bus::kRequestKey + 1, host.request_value(bus::Request::arm)) ==
        ModbusException::device_failure);
  CHECK(host.status_of(request, bus::kRequestKey, host.request_value(bus::Request::arm) ^ 0x10000) ==
        ModbusException::device_failure);
  CHECK(host.bench.node.snapshot().last_refusal == static_cast<int>(bus::Refusal::wrong_session));
  CHECK(host.bench.node.snapshot().bus_requests == 11);
  CHECK(host.bench.node.snapshot().bus_exceptions == 11);
  CHECK(host.bench.node.state() == NodeState::idle);
}

TEST_CASE("over CAN a parameter is written, and the robot is armed, told to hop and stopped") {
  Host host;
  using enum RegisterOperation;
  CHECK(host.status_of(write, kAmplitude, std::bit_cast<std::uint32_t>(2.5f)) == ModbusException::none);
  CHECK(host.bench.node.config().torque.amplitude_nm == 2.5f);
  CHECK(host.status_of(request, bus::kRequestKey, host.request_value(bus::Request::arm)) ==
        ModbusException::none);
  CHECK(host.bench.node.state() == NodeState::armed);
  CHECK(host.status_of(request, bus::kRequestKey, host.request_value(bus::Request::hop)) ==
        ModbusException::none);
  CHECK(host.bench.node.state() == NodeState::running);
  CHECK(host.status_of(write, kAmplitude, std::bit_cast<std::uint32_t>(3.0f)) ==
        ModbusException::device_failure);
  CHECK(host.bench.node.config().torque.amplitude_nm == 2.5f);
  // Without key and session.
  CHECK(host.status_of(request, 0, static_cast<std::uint32_t>(bus::Request::stop)) == ModbusException::none);
  CHECK(host.bench.node.state() == NodeState::idle);
}

TEST_CASE("a request that is heard twice is done once and answered twice, a stop is done each time") {
  Host host;
  const RegisterRequest arm{.operation = RegisterOperation::request,
                            .sequence = 1,
                            .address = bus::kRequestKey,
                            .value = host.request_value(bus::Request::arm)};
  CHECK(host.send(arm) == CanRegisters::Heard::taken);
  host.listen(1);  // whose answer is lost
  CHECK(host.listen(1).size() == 1);
  host.send(arm);
  const auto again = host.listen(5);
  REQUIRE(again.size() == 1);
  CHECK(again[0].status == ModbusException::none);
  CHECK(again[0].value == arm.value);
  CHECK(host.bench.node.state() == NodeState::armed);
  CHECK(host.bench.node.snapshot().requests_taken == 1);
  CHECK(host.bench.node.snapshot().requests_refused == 0);

  // A recorded one is another's by then.
  RegisterRequest hop = arm;
  hop.value = host.request_value(bus::Request::hop);
  ++hop.sequence;
  host.send(hop);
  host.listen(5);
  CHECK(host.bench.node.state() == NodeState::running);
  const RegisterRequest stop{.operation = RegisterOperation::request,
                             .sequence = 3,
                             .value = static_cast<std::uint32_t>(bus::Request::stop)};
  for (int i = 0; i < 2; ++i) {
    host.send(stop);
    host.listen(5);
    CHECK(host.bench.node.state() == NodeState::idle);
    host.bench.node.request(bus::Request::arm);
    host.bench.node.request(bus::Request::hop);
    CHECK(host.bench.node.state() == NodeState::running);
  }
  host.send(stop);
  host.listen(5);
  for (const RegisterRequest& recorded : {arm, hop, arm, hop}) {
    host.send(recorded);
    const auto heard = host.listen(5);
    REQUIRE(heard.size() == 1);
    CHECK(heard[0].status == ModbusException::device_failure);
    CHECK(host.bench.node.state() == NodeState::idle);
  }
}

TEST_CASE("a new request takes the place of the one that is being answered, and of one that waits") {
  Host host;
  host.send({.operation = RegisterOperation::read_input, .sequence = 1, .value = 40});
  CHECK(host.listen(6).size() == 5);
  host.send({.operation = RegisterOperation::read_input, .sequence = 2, .value = 40});
  host.send({.operation = RegisterOperation::read_input, .sequence = 3, .value = 6});
  const auto heard = host.listen(50);
  REQUIRE(heard.size() == 4);
  CHECK(heard[0].sequence == 1);  // it was on its way
  for (std::size_t i = 1; i < 4; ++i) {
    CHECK(heard[i].sequence == 3);
    CHECK(heard[i].address == 2 * (i - 1));
  }
}

TEST_CASE("a stop is done whatever else floods the bus in the same millisecond") {
  Host host;
  host.bench.start();
  CHECK(host.bench.node.state() == NodeState::running);
  const RegisterRequest read{.operation = RegisterOperation::read_input, .value = bus::kInputWords};
  for (int i = 0; i < 5; ++i) host.send(read);
  host.send(
      {.operation = RegisterOperation::request, .value = static_cast<std::uint32_t>(bus::Request::stop)});
  for (int i = 0; i < 5; ++i) host.send(read);
  host.tick();
  CHECK(host.bench.node.state() == NodeState::idle);
}

TEST_CASE("a node says over CAN who it is, with a 0 behind each text") {
  Host host;
  const auto text = [&](std::uint32_t object) {
    std::string out;
    for (const RegisterAnswer& answer : host.ask(RegisterOperation::read_text, 0x77, object)) {
      CHECK(answer.status == ModbusException::none);
      CHECK(answer.address == out.size() / 2);
      for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(answer.value >> shift & 0xffu);
    }
    REQUIRE(out.find('\0') != out.npos);
    CHECK(out.size() - out.find('\0') <= 4);
    return out.substr(0, out.find('\0'));
  };
  CHECK(text(0) == "Furcula");
  CHECK(text(1) == "test_board");
  CHECK(text(2) == "1.2.3 build 0badcafe");  // of 20 characters: the 0 is in a frame of its own
  CHECK(host.status_of(RegisterOperation::read_text, 0x77, 3) == ModbusException::illegal_address);
  CHECK(host.status_of(RegisterOperation::read_text, 0x77, 0x100) == ModbusException::illegal_address);
}

TEST_CASE("what is no request, or of another version, is counted by the link and not answered") {
  firmware::CanLinkConfig config;
  config.self_node = kNode;
  firmware::CanLink link(config);
  test::Bench bench;
  bench.settle();
  const bus::Frame sound = bus::pack(RegisterRequest{.value = 2}, kNode);
  bus::Frame shorter = sound, version = sound, operation = sound, other = sound;
  shorter.size = 7;
  version.data[0] = 2;
  operation.data[0] = 0x51;
  other.id += 1;
  for (const bus::Frame& frame : {shorter, version, operation, other}) link.receive(frame, 1000);
  serve(link.registers(), bench);
  CHECK_FALSE(link.registers().answering());
  CHECK(link.statistics().received == 4);
  CHECK(link.statistics().malformed == 2);
  CHECK(link.statistics().other_version == 1);
  CHECK(link.statistics().foreign == 1);
  CHECK(bench.node.snapshot().bus_requests == 0);
  link.receive(sound, 2000);
  serve(link.registers(), bench);
  REQUIRE(link.registers().answering());
  CHECK(link.registers().next().id == 0x507);
}
