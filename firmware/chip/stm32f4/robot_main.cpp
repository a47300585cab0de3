// The robot's firmware on a board of an STM32F4, whatever its wiring.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/app/node.hpp"
#include "firmware/app/node_on_can.hpp"
#include "firmware/app/node_registers.hpp"
#include "firmware/chip/stm32f4/robot_board.hpp"
#include "firmware/startup/image_header.hpp"
#include "firmware/startup/startup.hpp"
#include "firmware/store/parameter_slots.hpp"

namespace {

using namespace furcula;
using stm32f4::RobotBoard;

[[gnu::section(".noinit")]] firmware::FaultLog fault_log;

/// For exceptions; empty until the board is there.
constinit RobotBoard* the_board = nullptr;

/// The parameters' slots, with a watchdog that waits for them.
class KeptParameters {
 public:
  explicit KeptParameters(RobotBoard& board) : board_(board), slots_(board.flash()) {}
  Result<std::size_t> load(std::span<std::uint8_t> into) const { return slots_.load(into); }
  bus::Refusal may_save() const {
    if (!board_.supply().resets_when_low()) return bus::Refusal::brown_out_off;
    if (!board_.supply().is_high()) return bus::Refusal::supply_low;
    return slots_.is_worn() ? bus::Refusal::store_worn : bus::Refusal::none;
  }
  Status save(std::span<const std::uint8_t> image) {
    board_.begin_save();
    const Status status = slots_.save(image);
    board_.end_save();
    return status;
  }

 private:
  RobotBoard& board_;
  firmware::ParameterSlots<stm32f4::SlotFlash<stm32f4::Hardware>> slots_;
};

using RobotNode = firmware::Node<RobotBoard, KeptParameters>;

control::Config default_config() {
  control::Config config;
  config.supervisor.sample_age_max_us = firmware::kCanSampleAgeMaxUs;
  return config;
}

/// The image's own header, as the linker and scripts/finish-image left it.
const firmware::ImageHeader& own_header() {
  return *reinterpret_cast<const firmware::ImageHeader*>(firmware::kFlashBase + firmware::kImageHeaderOffset);
}

/// "0.1.0 build 1a2b3c4d".
constexpr std::string_view kTextBegins = FURCULA_VERSION " build ";
constinit std::array<char, kTextBegins.size() + 8> identity_text{};
bus::Identity identity_of(const RobotBoard& board) {
  const std::uint32_t build = firmware::build_id(own_header());
  std::copy(kTextBegins.begin(), kTextBegins.end(), identity_text.begin());
  for (unsigned i = 0; i < 8; ++i)
    identity_text[kTextBegins.size() + i] = "0123456789abcdef"[build >> (28 - 4 * i) & 0xfu];
  return {.board = FURCULA_BOARD,
          .text = {identity_text.data(), identity_text.size()},
          .firmware_version = FURCULA_VERSION_NUMBER,
          .build_id = build,
          .reset_cause = board.reset_cause(),
          .unique_id = board.unique_id()};
}

}  // namespace

extern "C" {
void tick_handler();
/// The exception of the processor's timer (firmware/startup/startup.cpp).
void tick_handler() { the_board->on_tick(); }

[[gnu::section(".image_header"), gnu::used]] constexpr firmware::ImageNames image_names =
    firmware::image_names(FURCULA_BOARD, FURCULA_VERSION_NUMBER);
[[gnu::section(".image_crc"), gnu::used]] const std::uint32_t image_crc = 0;  // scripts/finish-image
}

/// The coil off, a line in the log, and a new start; the drive switches its motor off when the commands end.
void furcula::firmware::on_exception() {
  asm volatile("cpsid i");
  if (the_board != nullptr) static_cast<void>(the_board->actuate(control::Command{}));
  fault_log.note(bus::kNoTick, static_cast<std::uint8_t>(control::Fault::processor_fault));
  // To the compiler nobody reads the log after this, and it would write none.
  asm volatile("dsb" ::: "memory");
  for (;;) stm32f4::request_reset(stm32f4::block_at<stm32f4::SingleRegister>(stm32f4::address::kAircr).word);
}

int main() {
  static RobotBoard board(stm32f4::kWiring, fault_log);
  board.begin();
  static KeptParameters kept(board);
  static const bus::Identity identity = identity_of(board);
  board.introduce(identity);
  static RobotNode node(board, kept, default_config(), identity, board.session_seed(), fault_log);
  if (node.snapshot().parameter_origin == static_cast<std::uint16_t>(bus::ParameterOrigin::store_unusable))
    board.report_start_fault(control::Fault::parameters_lost);
  the_board = &board;
  static firmware::NodeRegisters<RobotNode> registers(node);
  board.start_ticks();
  while (board.wait_for_tick()) {
    firmware::obey_stop(board.link(), node);
    board.set_state(node.state());
    board.link().set_on_bench(node.config().bench.on_bench != 0);
    node.tick();
    firmware::obey_stream(board.link(), node);
    board.serve(registers, node.bus_counts());
  }
}
