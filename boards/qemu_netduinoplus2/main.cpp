// The application on an emulated Cortex-M4F, in lock step with a rig on the host: processor in the loop.
#include <cstdint>
#include <cstring>

#include "boards/qemu_netduinoplus2/lock_step.hpp"
#include "boards/qemu_netduinoplus2/wire.hpp"
#include "firmware/app/app.hpp"
#include "firmware/startup/startup.hpp"

namespace {

using namespace furcula;

/// Not on the stack, which would keep room for it all the time.
constinit pil::Begin last_configuration;

class QemuBoard {
 public:
  /// Opens the pipes and waits for the host's first message.
  const control::Config& begin() {
    pipes_.open();
    pipes_.receive(last_configuration);
    if (last_configuration.kind != pil::kBegin) semihosting::exit(pil::kBadMessage);
    return last_configuration.config;
  }

  bool wait_for_tick() {
    pipes_.receive(tick_);
    configured_ = tick_.kind == pil::kBegin;
    if (configured_) {
      // Its first bytes came in the place of a tick.
      auto* bytes = reinterpret_cast<std::uint8_t*>(&last_configuration);
      std::memcpy(bytes, &tick_, sizeof(tick_));
      pipes_.receive(bytes + sizeof(tick_), sizeof(last_configuration) - sizeof(tick_));
      pipes_.receive(tick_);
    }
    if (tick_.kind != pil::kTick && tick_.kind != pil::kEnd) semihosting::exit(pil::kBadMessage);
    return tick_.kind == pil::kTick;
  }
  /// The configuration that came before this tick, or null.
  const control::Config* new_configuration() const {
    return configured_ ? &last_configuration.config : nullptr;
  }
  std::uint32_t now_us() const { return tick_.now_us; }
  Result<control::Sample> sense() const {
    if (tick_.sample_valid == 0) return Status::disconnected;
    return tick_.sample;
  }
  Status actuate(const control::Command& command) {
    command_ = command;
    return Status::ok;
  }
  void kick_watchdog() { ++watchdog_kicks_; }
  bool take_reset_request() const { return tick_.reset != 0; }
  void report(const firmware::Telemetry& telemetry) { outputs_ = pil::outputs_of(telemetry); }

  /// Answers the host's tick. The command that travels is the one that was actuated.
  void reply(std::uint32_t instructions) {
    outputs_.command = command_;
    pipes_.send(pil::Reply{outputs_, instructions});
  }
  void shutdown_reply(std::uint32_t hundred_nops) {
    pipes_.send(pil::ShutdownReply{watchdog_kicks_, {firmware::deepest_stack_bytes(), hundred_nops}});
  }

 private:
  pil::Pipes pipes_;
  bool configured_ = false;
  pil::Tick tick_;
  pil::Outputs outputs_;
  control::Command command_;
  std::uint32_t watchdog_kicks_ = 0;
};

static_assert(firmware::Board<QemuBoard>);

/// Not in main(), whose frame would keep room for it beneath every tick.
[[gnu::noinline]] void configure(firmware::App<QemuBoard>& app, const control::Config& config) {
  app.configure(config);
}

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(pil::kException); }

int main() {
  QemuBoard board;
  firmware::App<QemuBoard> app(board, board.begin());
  const pil::InstructionCounter counter;
  while (board.wait_for_tick()) {
    if (const control::Config* config = board.new_configuration()) configure(app, *config);
    const std::uint32_t before = counter.read();
    app.tick();
    const std::uint32_t after = counter.read();
    board.reply(counter.between(before, after));
  }
  board.shutdown_reply(pil::hundred_nops(counter));
  semihosting::exit(pil::kDone);
}
