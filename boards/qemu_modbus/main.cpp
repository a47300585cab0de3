// A node on a rig that stands still, on an emulated Cortex-M4F, and the Modbus server on its USART1: what a
// master that is not ours talks to in the PIL tests. The rig is always there, so that it can be armed; the
// images of the real boards, which QEMU gives neither CAN nor encoders, cannot.
#include <cstdint>

#include "boards/qemu_netduinoplus2/semihosting.hpp"
#include "firmware/app/node.hpp"
#include "firmware/app/node_registers.hpp"
#include "firmware/app/rtu_port.hpp"
#include "firmware/chip/stm32f4/usart.hpp"
#include "firmware/startup/startup.hpp"

namespace {

using namespace furcula;

/// The emulator hands over bytes when it finds the time: a line as slow as this bears its pauses.
constexpr std::uint32_t kBaud = 1200;
constexpr std::uint32_t kUsartClockHz = 84000000;

/// TIM2 counts nanoseconds in QEMU, here microseconds. (The real timer's clock is another.)
class Microseconds {
 public:
  Microseconds() {
    reg(kPrescaler) = 999;
    reg(kControl) = 1;
  }
  std::uint32_t now() const { return reg(kCount); }

 private:
  static constexpr std::uintptr_t kControl = 0x40000000, kCount = 0x40000024, kPrescaler = 0x40000028;
  static volatile std::uint32_t& reg(std::uintptr_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }
};

/// Toe on the ground, leg folded. A host that is busy makes no tick late: the application's clock counts
/// ticks.
class StandingRig {
 public:
  bool wait_for_tick() {
    if (static_cast<std::int32_t>(time_.now() - due_us_) < 0) return false;
    due_us_ += firmware::kTickPeriodUs;
    return true;
  }
  std::uint32_t now_us() const { return due_us_; }
  /// For the line's silences: a pause of the emulator itself is none.
  std::uint32_t line_us() {
    const std::uint32_t now_us = time_.now(), passed_us = now_us - seen_us_;
    seen_us_ = now_us;
    line_us_ += passed_us < 50 ? passed_us : 50;
    return line_us_;
  }
  static Result<control::Sample> sense() {
    control::Sample sample;
    sample.home_height_m = 0.22f;
    sample.leg_angle_rad = 0.747584f;  // acos(0.22 / 0.3)
    sample.contact = 1;
    return sample;
  }
  static Status actuate(const control::Command&) { return Status::ok; }
  static void kick_watchdog() {}
  static bool take_reset_request() { return false; }
  static void report(const firmware::Telemetry&) {}

 private:
  Microseconds time_;
  std::uint32_t due_us_ = time_.now(), seen_us_ = due_us_, line_us_ = 0;
};
static_assert(firmware::Board<StandingRig>);

control::Config hopping() {
  control::Config config;
  config.torque = {control::ProfileShape::harmonic, 2.0f, 0.3f};
  return config;
}

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(5); }

int main() {
  using Node = firmware::Node<StandingRig, firmware::NoStore>;
  static StandingRig rig;
  static firmware::NoStore store;
  static firmware::FaultLog faults{};
  faults.begin();
  static Node node(rig, store, hopping(), {.board = "qemu_modbus", .text = "emulated"},
                   static_cast<std::uint16_t>(rig.now_us()), faults);
  static firmware::NodeRegisters<Node> registers(node);
  static stm32f4::Usart<stm32f4::Hardware> usart(
      stm32f4::block_at<stm32f4::UsartRegisters>(stm32f4::address::kUsart1));
  usart.start(kUsartClockHz, kBaud, stm32f4::Parity::even);
  static firmware::RtuPort port(usart, 1, kBaud);
  for (;;) {
    if (rig.wait_for_tick()) node.tick();
    port.poll(registers, node.bus_counts(), rig.line_us());
  }
}
