// The board of a robot on an STM32F4: all drivers together, as the application's seam wants them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/app/board.hpp"
#include "firmware/app/can_link.hpp"
#include "firmware/app/can_telemetry.hpp"
#include "firmware/chip/stm32f4/can.hpp"
#include "firmware/chip/stm32f4/clock.hpp"
#include "firmware/chip/stm32f4/processor.hpp"
#include "firmware/chip/stm32f4/slot_flash.hpp"
#include "firmware/chip/stm32f4/timers.hpp"
#include "firmware/chip/stm32f4/usart.hpp"
#include "firmware/chip/stm32f4/watchdog.hpp"
#include "firmware/chip/stm32f4/wiring.hpp"
#include "firmware/store/fault_log.hpp"
#include "furcula/bus/modbus_rtu.hpp"

namespace furcula::stm32f4 {

/// A tick that is 5 ms late is a reset: by then the controller has been silent for five frames of the drive.
inline constexpr WatchdogTiming kBitesEarly = watchdog_timing(5);
/// While a sector is erased (2 s at most, twice as long with a low supply).
inline constexpr WatchdogTiming kBitesLate = watchdog_timing(5000);

class RobotBoard {
 public:
  /// `faults` lies in memory that survives a reset.
  RobotBoard(const Wiring& wiring, firmware::FaultLog& faults)
      : wiring_(wiring),
        faults_(faults),
        clock_(block_at<TimerRegisters>(address::kTim5)),
        tick_(block_at<SysTickRegisters>(address::kSysTick)),
        height_(block_at<TimerRegisters>(wiring.height.timer), wiring.height.bits()),
        cable_(block_at<TimerRegisters>(wiring.cable.timer), wiring.cable.bits()),
        coil_(block_at<TimerRegisters>(wiring.coil.timer), wiring.coil.channel),
        can_(block_at<CanRegisters>(address::kCan1)),
        serial_(block_at<UsartRegisters>(wiring.serial.usart)),
        watchdog_(block_at<WatchdogRegisters>(address::kIwdg)),
        flash_(block_at<FlashRegisters>(address::kFlash), {{{4, reinterpret_cast<Hardware*>(0x08010000)},
                                                            {5, reinterpret_cast<Hardware*>(0x08020000)}}}),
        link_(wiring.link),
        server_(wiring.serial.unit, bus::silence_us(wiring.serial.baud)),
        telemetry_({wiring.link.self_node, 100, 100}) {}

  /// Everything but the tick and the watchdog: clocks, pins, drivers.
  void begin();
  /// The tick begins, and with it the watchdog's demand.
  void start_ticks();

  // The application's seam (firmware/app/board.hpp).
  bool wait_for_tick();
  std::uint32_t now_us() const { return clock_.now_us(); }
  Result<control::Sample> sense();
  Status actuate(const control::Command& command);
  void kick_watchdog() { watchdog_.kick(); }
  bool take_reset_request() { return false; }  // a robot's resets come over its buses
  void report(const firmware::Telemetry& telemetry);

  /// Before each tick: what the robot's node is doing.
  void set_state(firmware::NodeState state) { state_ = state; }
  /// A fault that the start found, as lost parameters.
  void report_start_fault(control::Fault fault) { start_fault_ = fault; }

  /// The watchdog waits while a sector is erased, and ticks that became due meanwhile are forgotten.
  void begin_save() { static_cast<void>(watchdog_.set(kBitesLate)); }
  void end_save() {
    static_cast<void>(watchdog_.set(kBitesEarly));
    tick_.skip();
  }

  /// Another number at each start, as far as this chip can tell.
  std::uint16_t session_seed() const {
    const Result<std::uint32_t> drawn = draw_random(block_at<RandomRegisters>(address::kRandom));
    const std::uint32_t seed = drawn.ok() ? drawn.value() : faults_.starts() + now_us();
    return static_cast<std::uint16_t>(seed ^ seed >> 16);
  }

  /// Of this chip; 0 where there is none, as in an emulator, which has no oscillator either: 7.3.1, HSIRDY.
  std::array<std::uint32_t, 3> unique_id() const {
    if ((block_at<RccRegisters>(address::kRcc).cr & 2u) == 0) return {};
    return stm32f4::unique_id(reinterpret_cast<const Hardware*>(address::kUniqueId));
  }
  /// What its telemetry tells of it besides. Kept by reference.
  void introduce(const bus::Identity& identity) { telemetry_.introduce(identity, faults_); }

  void on_tick() { tick_.on_exception(); }

  SlotFlash<Hardware>& flash() { return flash_; }
  /// Answers the serial line or the bus, one request between two ticks. `registers` and `counts` are the
  /// node's.
  template <bus::Registers R>
  void serve(R& registers, bus::BusCounts& counts) {
    const std::uint32_t before = counts.requests;
    server_.poll(registers, counts, now_us());
    if (counts.requests == before)
      link_.registers().serve([&](std::span<const std::uint8_t> request, bus::Response& response) {
        bus::handle_pdu(registers, counts, request, response);
      });
    if (server_.answering()) drive_serial(true);
  }
  firmware::CanLink& link() { return link_; }
  const Clocks& clocks() const { return clocks_; }
  ResetCause reset_cause() const { return reset_cause_; }
  std::uint32_t missed_ticks() const { return tick_.missed(); }
  /// The longest that a tick's own work took, us.
  std::uint32_t longest_work_us() const { return longest_work_us_; }

 private:
  static GpioRegisters<Hardware>& gpio_of(Pin pin) {
    return block_at<GpioRegisters>(address::kGpioA + port_index(pin) * address::kGpioStride);
  }
  static void give(const AlternatePin& p, Pull pull) {
    make_alternate(gpio_of(p.pin), p.pin.number, p.function, pull);
  }
  void start_clocks_of_blocks();
  void start_pins();
  void start_can();
  void listen();
  void exchange_serial();
  void note_work(std::uint32_t us) {
    if (us > longest_work_us_) longest_work_us_ = us;
  }
  /// Switches the driver of RS-485.
  void drive_serial(bool on) { write_pin(gpio_of(wiring_.serial.drive), wiring_.serial.drive.number, on); }
  void watch_bus();
  bool send(const firmware::FrameBatch& batch);

  const Wiring& wiring_;
  firmware::FaultLog& faults_;
  MicrosecondClock<Hardware> clock_;
  Tick<Hardware> tick_;
  Encoder<Hardware> height_, cable_;
  Pwm<Hardware> coil_;
  Can<Hardware> can_;
  Usart<Hardware> serial_;
  Watchdog<Hardware> watchdog_;
  SlotFlash<Hardware> flash_;
  firmware::CanLink link_;
  bus::RtuServer server_;
  bool sending_ = false;  ///< the last byte is not out yet
  firmware::CanTelemetry telemetry_;
  Clocks clocks_;
  ResetCause reset_cause_ = ResetCause::unknown;
  bool can_runs_ = false;
  firmware::NodeState state_ = firmware::NodeState::starting;
  control::Fault start_fault_ = control::Fault::none;
  control::Sample sample_;
  std::uint32_t ticks_ = 0, began_us_ = 0, longest_work_us_ = 0;
};

static_assert(firmware::Board<RobotBoard>);

inline void RobotBoard::begin() {
  auto& rcc = block_at<RccRegisters>(address::kRcc);
  reset_cause_ = take_reset_cause(rcc);
  faults_.begin();
  static_cast<void>(
      start_clocks(rcc, block_at<FlashRegisters>(address::kFlash), wiring_.crystal_hz, clocks_));
  start_clocks_of_blocks();
  start_pins();
  const std::uint32_t coil_hz =
      on_apb2(wiring_.coil.timer) ? clocks_.apb2_timer_hz() : clocks_.apb1_timer_hz();
  coil_.start(coil_hz, wiring_.coil.frequency_hz);
  give(wiring_.coil.pin, Pull::down);
  clock_.start(measure_mhz(block_at<SysTickRegisters>(address::kSysTick),
                           block_at<TimerRegisters>(address::kTim5), clocks_.core_hz,
                           clocks_.apb1_timer_hz() / 1'000'000));
  height_.start(wiring_.height.reversed);
  cable_.start(wiring_.cable.reversed);
  serial_.start(clocks_.apb1_hz, wiring_.serial.baud, wiring_.serial.parity);
  start_can();
  if (reset_cause_ == ResetCause::watchdog) report_start_fault(control::Fault::task_stuck);
  if (faults_.last_run_ended_by(static_cast<std::uint8_t>(control::Fault::processor_fault)))
    report_start_fault(control::Fault::processor_fault);
}

inline void RobotBoard::start_clocks_of_blocks() {
  auto& rcc = block_at<RccRegisters>(address::kRcc);
  for (const Pin pin :
       {wiring_.height.a.pin, wiring_.height.b.pin, wiring_.cable.a.pin, wiring_.cable.b.pin, wiring_.contact,
        wiring_.coil.pin.pin, wiring_.can.receive.pin, wiring_.can.transmit.pin, wiring_.serial.receive.pin,
        wiring_.serial.transmit.pin, wiring_.serial.drive, wiring_.led})
    enable_block(rcc, address::kGpioA + port_index(pin) * address::kGpioStride);
  for (const std::uintptr_t block :
       {address::kTim5, wiring_.height.timer, wiring_.cable.timer, wiring_.coil.timer, address::kCan1,
        wiring_.serial.usart, address::kRandom})
    enable_block(rcc, block);
}

inline void RobotBoard::start_pins() {
  make_output(gpio_of(wiring_.led), wiring_.led.number, false);
  make_output(gpio_of(wiring_.serial.drive), wiring_.serial.drive.number, false);
  make_input(gpio_of(wiring_.contact), wiring_.contact.number, Pull::up);
  for (const EncoderWiring* encoder : {&wiring_.height, &wiring_.cable}) {
    give(encoder->a, Pull::up);
    give(encoder->b, Pull::up);
  }
  give(wiring_.can.receive, Pull::up);  // without a transceiver the bus is quiet, not dominant
  give(wiring_.can.transmit, Pull::none);
  give(wiring_.serial.receive, Pull::up);
  give(wiring_.serial.transmit, Pull::none);
}

/// The internal oscillator is too far off for 1 Mbit/s: the robot then stays off the bus, and does not move.
inline void RobotBoard::start_can() {
  if (!clocks_.from_crystal) return;
  std::array<CanFilter, firmware::HeardIds::kMost> filters;
  std::size_t used = 0;
  for (const std::uint32_t id : firmware::HeardIds(wiring_.link)) filters[used++] = {id};
  can_runs_ = can_.start(can_timing(clocks_.apb1_hz, wiring_.can.bits_per_s),
                         std::span<const CanFilter>(filters).first(used)) == Status::ok;
}

inline void RobotBoard::start_ticks() {
  static_cast<void>(watchdog_.start(kBitesEarly));
  tick_.start(clocks_.core_hz, firmware::kTickPeriodUs);
}

/// Receives what has come; a FIFO holds three frames, so more than six cannot wait.
inline void RobotBoard::listen() {
  if (!can_runs_) return;
  for (int i = 0; i < 6; ++i) {
    const Result<bus::Frame> frame = can_.receive();
    if (!frame.ok()) return;
    link_.receive(frame.value(), now_us());
  }
}

/// A byte each way at most. What is heard while the driver is on is the own voice.
inline void RobotBoard::exchange_serial() {
  const Result<std::uint8_t> byte = serial_.receive();
  const bool silent = byte.status() == Status::disconnected;
  if (!server_.answering() && !sending_) {
    if (byte.ok()) server_.receive(byte.value(), now_us());
    if (!byte.ok() && !silent) server_.spoil(now_us());
    return;
  }
  if (server_.answering()) {
    if (serial_.send(server_.next()) != Status::ok) return;
    server_.advance();
    sending_ = true;
  } else if (serial_.all_sent()) {
    sending_ = false;
    drive_serial(false);
  }
}

inline void RobotBoard::watch_bus() {
  if (!can_runs_) return;
  const CanErrors errors = can_.errors();
  if (can_.take_error()) link_.note(firmware::BusEvent::error);
  if (errors.bus_off != link_.bus_is_off())
    link_.note(errors.bus_off ? firmware::BusEvent::off : firmware::BusEvent::recovered);
}

inline bool RobotBoard::send(const firmware::FrameBatch& batch) {
  bool sent = can_runs_;
  for (const bus::Frame& frame : batch) sent = sent && can_.send(frame) == Status::ok;
  return sent;
}

/// Between two ticks frames are received as they come. A timer that ticks no more is the watchdog's affair.
inline bool RobotBoard::wait_for_tick() {
  if (ticks_ != 0) note_work(now_us() - began_us_);
  while (!tick_.take()) {
    listen();
    exchange_serial();
  }
  began_us_ = now_us();
  return true;
}

inline Result<control::Sample> RobotBoard::sense() {
  listen();
  watch_bus();
  Result<control::Sample> heard = link_.sample(now_us());
  if (heard.ok()) sample_ = heard.value();
  if (wiring_.link.height_node == 0) sample_.height_count = height_.count();
  if (wiring_.link.cable_node == 0) sample_.cable_count = cable_.count();
  sample_.contact = read_pin(gpio_of(wiring_.contact), wiring_.contact.number) ? 0 : 1;
  if (start_fault_ != control::Fault::none && ticks_ < firmware::kStartFaultTicks)
    sample_.reported_fault = static_cast<std::uint32_t>(start_fault_);
  if (!heard.ok()) return heard.status();
  return sample_;
}

inline Status RobotBoard::actuate(const control::Command& command) {
  coil_.set(command.coil_duty);
  if (link_.on_bench()) return Status::ok;
  if (!can_runs_) return Status::disconnected;
  can_.abort_pending();  // a command of the last tick is not to go out after this one
  const bool run = state_ == firmware::NodeState::running;
  return send(link_.command(command, run)) ? Status::ok : Status::disconnected;
}

inline void RobotBoard::report(const firmware::Telemetry& telemetry) {
  const auto fault = static_cast<std::uint8_t>(telemetry.outputs.fault);
  static_cast<void>(send(telemetry_.tick(telemetry, sample_, state_)));
  firmware::CanRegisters& registers = link_.registers();
  if (can_runs_ && registers.answering() && can_.send(registers.next()) == Status::ok) registers.advance();
  const bool lit = state_ == firmware::NodeState::running || (fault != 0 && ticks_ % 256 < 128);
  write_pin(gpio_of(wiring_.led), wiring_.led.number, lit);
  ++ticks_;
}

}  // namespace furcula::stm32f4
