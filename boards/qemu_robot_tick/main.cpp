// The work of a robot's whole tick in instructions of an emulated Cortex-M4F: frames of drive, two encoders
// and a host in, the node's tick while it runs, commands and telemetry out, a serial line on which one Modbus
// request follows the other, and a host that reads or writes registers over CAN as often. Without the chip's
// drivers, whose registers QEMU does not have. It says what takes longest; then how many stops of another host it
// obeyed (stop_attack.hpp), and ends.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

#include "boards/qemu_netduinoplus2/semihosting.hpp"
#include "boards/qemu_robot_tick/stop_attack.hpp"
#include "firmware/app/can_link.hpp"
#include "firmware/app/can_telemetry.hpp"
#include "firmware/app/node.hpp"
#include "firmware/app/node_on_can.hpp"
#include "firmware/app/node_registers.hpp"
#include "firmware/chip/stm32f4/timers.hpp"
#include "firmware/startup/startup.hpp"
#include "furcula/bus/modbus_rtu.hpp"

namespace {

using namespace furcula;
using firmware::CanLinkConfig;

constexpr CanLinkConfig kLink{.height_node = 1, .cable_node = 2};

/// A robot that stands on the ground: its sensors come as frames.
class BusRig {
 public:
  static bool wait_for_tick() { return true; }
  std::uint32_t now_us() const { return now_us_; }
  Result<control::Sample> sense() {
    Result<control::Sample> heard = link_.sample(now_us_);
    if (!heard.ok()) return heard.status();
    sample_ = heard.value();
    sample_.contact = 1;
    return sample_;
  }
  Status actuate(const control::Command& command) {
    drives_ = false;
    for (const bus::Frame& frame : link_.command(command, state_ == bus::NodeState::running)) {
      drives_ = drives_ || !bus::is(frame, bus::message::kMotorExit, kLink.drive_node);
      send(frame);
    }
    return Status::ok;
  }
  static void kick_watchdog() {}
  static bool take_reset_request() { return false; }
  void report(const firmware::Telemetry& telemetry) {
    for (const bus::Frame& frame : telemetry_.tick(telemetry, sample_, state_)) send(frame);
    if (!link_.registers().answering()) return;
    send(link_.registers().next());
    link_.registers().advance();
    ++answers_;
  }
  std::uint32_t answers() const { return answers_; }
  /// Whether the last tick told the drive anything but to be off.
  bool drives() const { return drives_; }

  void set_state(bus::NodeState state) { state_ = state; }
  firmware::CanLink& link() { return link_; }
  void introduce(const bus::Identity& identity, const firmware::FaultLog& faults) {
    telemetry_.introduce(identity, faults);
  }
  /// What arrives in a millisecond: the leg is folded by `angle` of the drive's 16 bits.
  void receive(std::uint8_t sequence, std::uint32_t angle) {
    now_us_ += 1000;
    bus::Frame frame;
    frame.size = 8;
    frame.data = {kLink.drive_node,
                  static_cast<std::uint8_t>(angle >> 8),
                  static_cast<std::uint8_t>(angle),
                  0x7f,
                  0xf7,
                  0xff,
                  41,
                  0};
    link_.receive(frame, now_us_);
    for (const std::uint8_t node : {kLink.height_node, kLink.cable_node}) {
      frame.id = 0x460u + node;
      frame.data = {1, sequence, 1, 0, 0, 0, 0, 0};
      link_.receive(frame, now_us_);
    }
  }
  /// The host says `request` and asks for registers.
  void hear_host(std::uint8_t sequence, std::uint8_t request) {
    bus::Frame frame;
    frame.size = 8;
    frame.id = 0x400u + kLink.self_node;  // 2 N m over 0.3 s
    frame.data = {static_cast<std::uint8_t>(1 | request << 4), sequence, 1, 0xd0, 0x07, 0xb8, 0x0b, 1};
    link_.receive(frame, now_us_);
    link_.receive(register_request(sequence), now_us_);
  }

 private:
  /// The most that there is to read, a write and a request that is stale, in turn.
  static bus::Frame register_request(std::uint8_t sequence) {
    using Operation = bus::RegisterOperation;
    constexpr bus::RegisterRequest kAsked[] = {
        {.operation = Operation::read_input, .value = bus::kInputWords},
        {.operation = Operation::read_holding, .address = bus::kParameterBase, .value = bus::kParameterWords},
        {.operation = Operation::write, .address = bus::kParameterBase + 2, .value = 0x40000000},  // 2 N m
        {.operation = Operation::request, .address = bus::kRequestKey, .value = 4},
        {.operation = Operation::read_text, .value = 2},
        {.operation = Operation::read_input, .address = bus::kTrialCountBase, .value = 125},
    };
    bus::RegisterRequest request = kAsked[sequence / 8 % std::size(kAsked)];
    request.sequence = sequence;
    return bus::pack(request, kLink.self_node);
  }

  /// In the place of a mailbox.
  void send(const bus::Frame& frame) { mailbox_ = frame.data[0] + frame.id; }

  firmware::CanLink link_{kLink};
  firmware::CanTelemetry telemetry_{{1, 100, 100}};
  control::Sample sample_;
  bus::NodeState state_ = bus::NodeState::starting;
  std::uint32_t now_us_ = 0;
  volatile std::uint32_t mailbox_ = 0;
  bool drives_ = false;
  std::uint32_t answers_ = 0;
};
static_assert(firmware::Board<BusRig>);

using Node = firmware::Node<BusRig, firmware::NoStore>;

/// A Modbus master that asks for the most that there is to ask for, as fast as the line carries it.
class Master {
 public:
  explicit Master(bus::RtuServer& server) : server_(server) {}

  /// A millisecond of 115,200 baud, 11 bits a byte.
  void exchange(std::uint32_t now_us) {
    for (int i = 0; i < 11; ++i) {
      if (server_.answering()) {
        answered_ = true;
        line_ = server_.next();
        server_.advance();
      } else if (sent_ < size_) {
        server_.receive(frame_[sent_++], now_us);
      }
    }
  }

  /// The next request, where the last one is answered.
  void go_on() {
    if (size_ == 0 || (answered_ && !server_.answering())) begin();
  }

 private:
  void put(std::uint32_t byte) { frame_[size_++] = static_cast<std::uint8_t>(byte); }
  void put_word(std::uint32_t word) {
    put(word >> 8);
    put(word);
  }
  void put_head(std::uint32_t function, std::uint32_t first, std::uint32_t count) {
    put(function);
    put_word(first);
    put_word(count);
  }
  void begin() {
    answered_ = false;
    sent_ = size_ = 0;
    put(1);
    switch (kind_++ % 5) {
      case 0:
        put_head(bus::modbus::kReadInput, 0, bus::kInputWords);
        break;
      case 1:
        put_head(bus::modbus::kReadHolding, bus::kParameterBase, bus::kParameterWords);
        break;
      case 2:
        put_head(bus::modbus::kWriteSeveral, bus::kParameterBase, bus::kParameterWords);
        put(2u * bus::kParameterWords);
        for (const bus::Parameter& p : bus::kParameters) {
          const auto bits = std::bit_cast<std::uint32_t>(p.get(control::Config{}));
          put_word(bits >> 16);
          put_word(bits & 0xffffu);
        }
        break;
      case 3:
        for (const int byte : {43, 14, 1, 0}) put(static_cast<std::uint32_t>(byte));
        break;
      default:  // stale, and so refused
        put_head(bus::modbus::kWriteSeveral, 0, bus::kRequestWords);
        put(2u * bus::kRequestWords);
        for (const std::uint32_t word : {std::uint32_t{bus::kRequestKey}, std::uint32_t{0}, std::uint32_t{4}})
          put_word(word);
        break;
    }
    const std::uint16_t crc = bus::crc16(std::span<const std::uint8_t>(frame_).first(size_));
    put(crc & 0xffu);
    put(static_cast<std::uint32_t>(crc) >> 8);
  }

  bus::RtuServer& server_;
  std::array<std::uint8_t, bus::kRtuBytesMax> frame_{};
  std::size_t size_ = 0, sent_ = 0;
  std::uint32_t kind_ = 0;
  bool answered_ = false;
  volatile std::uint8_t line_ = 0;
};

control::Config hopping() {
  control::Config config;
  config.torque = {control::ProfileShape::harmonic, 2.0f, 0.3f};
  config.supervisor.sample_age_max_us = firmware::kCanSampleAgeMaxUs;
  config.clutch.fitted = 1;
  return config;
}

/// Of a robot in one state: the longest tick, and the longest of what Modbus took between two of them. That
/// they come together is a matter of time.
struct Longest {
  std::uint32_t tick = 0, modbus = 0;

  void note(std::uint32_t tick_now, std::uint32_t modbus_now) {
    tick = std::max(tick, tick_now);
    modbus = std::max(modbus, modbus_now);
  }
};

/// The robot under attack.
struct Attacked {
  BusRig& rig;
  Node& node;
  firmware::NodeRegisters<Node>& registers;
  std::uint32_t ticks = 0;

  void hear(const bus::Frame& frame) { rig.link().receive(frame, rig.now_us()); }
  void tick() {
    rig.receive(static_cast<std::uint8_t>(ticks), 34730 + ticks % 4);
    ++ticks;
    firmware::obey_stop(rig.link(), node);
    rig.set_state(node.state());
    node.tick();
    firmware::obey_stream(rig.link(), node);
    rig.link().registers().serve([&](std::span<const std::uint8_t> asked, bus::Response& response) {
      bus::handle_pdu(registers, node.bus_counts(), asked, response);
    });
  }
  bool drives() const { return rig.drives(); }
};

/// "NAME NUMBER\n" on the console.
void say(const char* name, std::uint32_t number) {
  char text[48];
  std::size_t n = 0;
  while (name[n] != '\0' && n < 30) {
    text[n] = name[n];
    ++n;
  }
  text[n++] = ' ';
  std::uint32_t power = 1'000'000'000;
  while (power > 1 && number < power) power /= 10;
  for (; power != 0; power /= 10) text[n++] = static_cast<char>('0' + number / power % 10);
  text[n++] = '\n';
  text[n] = '\0';
  semihosting::call(0x04, text);
}

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(5); }

int main() {
  static BusRig rig;
  static firmware::NoStore store;
  static firmware::FaultLog faults{};
  faults.begin();
  static constexpr bus::Identity kIdentity{.board = "qemu_robot_tick", .text = "emulated"};
  rig.introduce(kIdentity, faults);
  static Node node(rig, store, hopping(), kIdentity, 1, faults);
  static firmware::NodeRegisters<Node> registers(node);
  static bus::RtuServer server(1, 1750);
  // TIM2 counts nanoseconds in QEMU, and with `-icount shift=0` an instruction takes one.
  static stm32f4::MicrosecondClock counter(
      stm32f4::block_at<stm32f4::TimerRegisters>(stm32f4::address::kTim2));
  counter.start(1);
  const std::uint32_t first = counter.now_us();
  const std::uint32_t overhead = counter.now_us() - first;

  static Master master(server);
  Longest idle, running;
  std::uint32_t ticks_running = 0;
  for (std::uint32_t tick = 0; tick < 6000; ++tick) {
    // Homed on the ground, then told to hop.
    const std::uint8_t request = tick > 1300 ? 2 : 0;
    master.go_on();
    const std::uint32_t began = counter.now_us();
    rig.receive(static_cast<std::uint8_t>(tick), 34730 + tick % 4);  // 0.7476 rad
    rig.hear_host(static_cast<std::uint8_t>(tick), request);
    firmware::obey_stop(rig.link(), node);
    rig.set_state(node.state());
    node.tick();
    firmware::obey_stream(rig.link(), node);
    const std::uint32_t ticked = counter.now_us();
    // One request a tick, as on the boards.
    const std::uint32_t before = node.bus_counts().requests;
    server.poll(registers, node.bus_counts(), rig.now_us());
    if (node.bus_counts().requests == before)
      rig.link().registers().serve([&](std::span<const std::uint8_t> asked, bus::Response& response) {
        bus::handle_pdu(registers, node.bus_counts(), asked, response);
      });
    master.exchange(rig.now_us());
    const std::uint32_t ended = counter.now_us();
    Longest& longest = node.state() == bus::NodeState::running ? running : idle;
    longest.note(ticked - began - overhead, ended - ticked - overhead);
    if (&longest == &running) ++ticks_running;
    if (tick == 1200) static_cast<void>(node.request(bus::Request::home));
    if (tick == 1202) static_cast<void>(node.request(bus::Request::reset));
  }
  say("worst_tick", std::max(idle.tick + idle.modbus, running.tick + running.modbus));
  say("idle_tick", idle.tick);
  say("idle_modbus", idle.modbus);
  say("running_tick", running.tick);
  say("running_modbus", running.modbus);
  say("ticks_running", ticks_running);
  say("modbus_answers", node.bus_counts().requests);
  say("can_answers", rig.answers());
  static Attacked attacked{rig, node, registers};
  attacked.ticks = 6000;
  static firmware::StopAttack attack(attacked);
  say("stops_at_offsets", attack.offsets());
  say("stops_of_versions", attack.versions_and_ages());
  say("stops_by_registers", attack.registers());
  std::uint32_t beside = 0;
  for (const std::uint32_t offset : {0u, 1u, 2u, 127u, 128u, 129u, 255u})
    if (attack.beside(offset)) ++beside;
  say("stops_beside", beside);
  say("attacks_on_hopping", attack.started());
  semihosting::exit(0);
}
