// The controller of a biped's walk on an emulated Cortex-M4F, in lock step with a robot on the host.
#include <cstdint>

#include "boards/qemu_biped_walk/wire.hpp"
#include "boards/qemu_netduinoplus2/lock_step.hpp"
#include "firmware/startup/startup.hpp"

namespace {

using namespace furcula;

// Not on the stack.
constinit pil::WalkBegin begin;
constinit control::WalkerState state;
constinit pil::WalkTick tick;

/// Not inlined: what it needs of the stack is not needed beside a tick.
[[gnu::noinline]] void begin_anew() { state = control::begin_walker(begin.config); }

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(pil::kException); }

int main() {
  pil::Pipes pipes;
  pipes.open();
  pipes.receive(begin);
  if (begin.kind != pil::kWalkBegin) semihosting::exit(pil::kBadMessage);
  begin_anew();
  const pil::InstructionCounter counter;
  for (;;) {
    pipes.receive(tick);
    if (tick.kind == pil::kWalkEnd) break;
    if (tick.kind == pil::kWalkAnew)
      begin_anew();
    else if (tick.kind != pil::kWalkTick)
      semihosting::exit(pil::kBadMessage);
    const control::WalkerInputs inputs = pil::inputs_of(tick);
    const std::uint32_t before = counter.read();
    const control::WalkerOutputs outputs = control::step_walker(begin.config, state, inputs, 1e-3f);
    const std::uint32_t after = counter.read();
    pil::WalkReply reply = pil::reply_of(outputs);
    reply.instructions = counter.between(before, after);
    pipes.send(reply);
  }
  pipes.send(pil::Measured{firmware::deepest_stack_bytes(), pil::hundred_nops(counter)});
  semihosting::exit(pil::kDone);
}
