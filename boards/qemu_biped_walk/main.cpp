// The controller of a biped's walk on an emulated Cortex-M4F, in lock step with a robot on the host.
#include <cstdint>

#include "boards/qemu_biped_walk/wire.hpp"
#include "boards/qemu_netduinoplus2/instruction_counter.hpp"
#include "boards/qemu_netduinoplus2/semihosting.hpp"
#include "firmware/startup/startup.hpp"

namespace {

using namespace furcula;

// Exit statuses of QEMU.
enum Exit : std::uint32_t { kDone = 0, kNoPipes = 2, kPeerGone = 3, kBadMessage = 4, kException = 5 };

// Not on the stack.
constinit pil::WalkBegin begin;
constinit control::WalkerState state;
constinit pil::WalkTick tick;

template <class Message>
void receive(std::int32_t pipe, Message& message) {
  if (!semihosting::read(pipe, &message, sizeof(message))) semihosting::exit(kPeerGone);
}
template <class Message>
void send(std::int32_t pipe, const Message& message) {
  if (!semihosting::write(pipe, &message, sizeof(message))) semihosting::exit(kPeerGone);
}

/// Not inlined: what it needs of the stack is not needed beside a tick.
[[gnu::noinline]] void begin_anew() { state = control::begin_walker(begin.config); }

/// What a hundred instructions measure.
[[gnu::noinline]] std::uint32_t hundred_nops(const pil::InstructionCounter& counter) {
  const std::uint32_t before = counter.read();
  asm volatile(".rept 100\n nop\n .endr");
  const std::uint32_t after = counter.read();
  return counter.between(before, after);
}

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(kException); }

int main() {
  using semihosting::Mode;
  const std::int32_t in = semihosting::open("to_board", 8, Mode::read_binary);
  const std::int32_t out = semihosting::open("from_board", 10, Mode::write_binary);
  if (in < 0 || out < 0) semihosting::exit(kNoPipes);
  receive(in, begin);
  if (begin.kind != pil::kWalkBegin) semihosting::exit(kBadMessage);
  begin_anew();
  const pil::InstructionCounter counter;
  for (;;) {
    receive(in, tick);
    if (tick.kind == pil::kWalkEnd) break;
    if (tick.kind == pil::kWalkAnew)
      begin_anew();
    else if (tick.kind != pil::kWalkTick)
      semihosting::exit(kBadMessage);
    const control::WalkerInputs inputs = pil::inputs_of(tick);
    const std::uint32_t before = counter.read();
    const control::WalkerOutputs outputs = control::step_walker(begin.config, state, inputs, 1e-3f);
    const std::uint32_t after = counter.read();
    pil::WalkReply reply = pil::reply_of(outputs);
    reply.instructions = counter.between(before, after);
    send(out, reply);
  }
  send(out, pil::WalkFarewell{firmware::deepest_stack_bytes(), hundred_nops(counter)});
  semihosting::exit(kDone);
}
