// The controller of a planar leg's gait on an emulated Cortex-M4F, in lock step with a rig on the host.
#include <cstdint>

#include "boards/qemu_netduinoplus2/lock_step.hpp"
#include "boards/qemu_planar_leg/wire.hpp"
#include "firmware/startup/startup.hpp"

namespace {

using namespace furcula;

// Not on the stack.
constinit pil::LegBegin begin;
constinit control::GaitState state;

}  // namespace

void furcula::firmware::on_exception() { semihosting::exit(pil::kException); }

int main() {
  pil::Pipes pipes;
  pipes.open();
  pipes.receive(begin);
  if (begin.kind != pil::kLegBegin) semihosting::exit(pil::kBadMessage);
  state.configuration = control::check(begin.config);
  const pil::InstructionCounter counter;
  for (;;) {
    pil::LegTick tick;
    pipes.receive(tick);
    if (tick.kind == pil::kLegEnd) break;
    if (tick.kind != pil::kLegTick) semihosting::exit(pil::kBadMessage);
    const control::GaitInputs inputs = pil::inputs_of(tick);
    const std::uint32_t before = counter.read();
    const control::GaitOutputs outputs = control::step_gait(begin.config, state, inputs, 1e-3f);
    const std::uint32_t after = counter.read();
    pil::LegReply reply = pil::reply_of(outputs);
    reply.instructions = counter.between(before, after);
    pipes.send(reply);
  }
  pipes.send(pil::Measured{firmware::deepest_stack_bytes(), pil::hundred_nops(counter)});
  semihosting::exit(pil::kDone);
}
