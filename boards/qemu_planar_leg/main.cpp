// The controller of a planar leg's gait on an emulated Cortex-M4F, in lock step with a rig on the host.
#include <cstdint>

#include "boards/qemu_netduinoplus2/instruction_counter.hpp"
#include "boards/qemu_netduinoplus2/semihosting.hpp"
#include "boards/qemu_planar_leg/wire.hpp"
#include "firmware/startup/startup.hpp"

namespace {

using namespace furcula;

// Exit statuses of QEMU.
enum Exit : std::uint32_t { kDone = 0, kNoPipes = 2, kPeerGone = 3, kBadMessage = 4, kException = 5 };

// Not on the stack.
constinit pil::LegBegin begin;
constinit control::GaitState state;

template <class Message>
void receive(std::int32_t pipe, Message& message) {
  if (!semihosting::read(pipe, &message, sizeof(message))) semihosting::exit(kPeerGone);
}
template <class Message>
void send(std::int32_t pipe, const Message& message) {
  if (!semihosting::write(pipe, &message, sizeof(message))) semihosting::exit(kPeerGone);
}

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(kException); }

int main() {
  using semihosting::Mode;
  const std::int32_t in = semihosting::open("to_board", 8, Mode::read_binary);
  const std::int32_t out = semihosting::open("from_board", 10, Mode::write_binary);
  if (in < 0 || out < 0) semihosting::exit(kNoPipes);
  receive(in, begin);
  if (begin.kind != pil::kLegBegin) semihosting::exit(kBadMessage);
  state.configuration = control::check(begin.config);
  const pil::InstructionCounter counter;
  for (;;) {
    pil::LegTick tick;
    receive(in, tick);
    if (tick.kind == pil::kLegEnd) break;
    if (tick.kind != pil::kLegTick) semihosting::exit(kBadMessage);
    const control::GaitInputs inputs = pil::inputs_of(tick);
    const std::uint32_t before = counter.read();
    const control::GaitOutputs outputs = control::step_gait(begin.config, state, inputs, 1e-3f);
    const std::uint32_t after = counter.read();
    pil::LegReply reply = pil::reply_of(outputs);
    reply.instructions = counter.between(before, after);
    send(out, reply);
  }
  const std::uint32_t before = counter.read();
  asm volatile(".rept 100\n nop\n .endr");
  const std::uint32_t after = counter.read();
  send(out, pil::LegFarewell{firmware::deepest_stack_bytes(), counter.between(before, after)});
  semihosting::exit(kDone);
}
