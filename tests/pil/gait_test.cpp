// A gait of a planar leg on an emulated Cortex-M4F: the plant on the host obeys the board's torques alone, and beside it
// the host's own controller gets the same samples.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <fstream>
#include <map>
#include <string>

#include "boards/qemu_planar_leg/wire.hpp"
#include "boards/sim_host/leg_rig.hpp"
#include "host/gait/gait_table.hpp"
#include "host/gait/stability.hpp"
#include "tests/host/gait/legs.hpp"
#include "tests/pil/lock_step.hpp"

namespace {

using namespace furcula;
using namespace std::chrono_literals;
using control::Fault;
using sim_host::LegFault;

constexpr const char* kBoard = "qemu_planar_leg";
std::string image() { return test::lock_step_image(kBoard); }

const gait::Gait& hop() {
  static const gait::Search found = test::found(gait::LegSpring::switched, test::in_place(0.075));
  return *found.gait;
}

struct Run {
  std::size_t ticks = 0, differing = 0, touchdowns = 0;
  std::uint32_t worst_instructions = 0;
  std::map<int, std::size_t> ticks_with_fault;
  double most_torque_after_fault = 0.0;
  unsigned strides = 0;
  pil::Measured shutdown_reply;
};

Run run_in_lock_step(std::size_t ticks, LegFault fault, double fault_s) {
  const control::GaitConfig config = gait::controller_config(hop(), gait::kStanceGains);
  sim_host::LegRig rig(
      {hop().machine.leg, hop().machine.spring, hop().task.lift_off, 0.01, 5e-3, true, 3, fault, fault_s});
  const auto apex = gait::apex_of(hop());
  rig.drop(apex.height, apex.speed, apex.angle);
  control::GaitState state = control::begin_gait(config);
  pil::EmulatedBoard board(image(), 10s);
  board.send(pil::LegBegin{pil::kLegBegin, config});
  Run run;
  for (; run.ticks < ticks; ++run.ticks) {
    const control::GaitInputs in = rig.sense();
    const pil::LegTick tick{pil::kLegTick, in.sample_valid ? 1u : 0u, 0, 1, in.tick_interval_us, in.sample};
    board.send(tick);
    const auto there = board.receive<pil::LegReply>();
    const pil::LegReply here = pil::reply_of(control::step_gait(config, state, pil::inputs_of(tick), 1e-3f));
    if (test::bits(here) != test::bits(there)) ++run.differing;
    rig.advance(there.torque_nm);
    run.worst_instructions = std::max(run.worst_instructions, there.instructions);
    ++run.ticks_with_fault[there.fault];
    run.touchdowns += there.events & 1u;
    if (there.fault != 0)
      run.most_torque_after_fault = std::max<double>(
          run.most_torque_after_fault, std::abs(there.torque_nm.hip) + std::abs(there.torque_nm.knee));
  }
  run.strides = rig.strides();
  pil::LegTick last;
  last.kind = pil::kLegEnd;
  board.send(last);
  run.shutdown_reply = board.receive<pil::Measured>();
  board.wait_for_end();
  return run;
}

}  // namespace

TEST_CASE("20,000 ticks of a gait are bit-equal on the Cortex-M4F and on the host, within the budgets") {
  if (test::cannot_lock_step(image())) return;
  const Run run = run_in_lock_step(20000, LegFault::none, 0.0);
  CHECK(run.ticks == 20000);
  CHECK(run.differing == 0);
  // It hopped: 20 s of strides of some 0.57 s, each with its touch-down, without a fault.
  CHECK(run.strides >= 33);
  CHECK(run.strides <= 37);
  CHECK(run.touchdowns >= run.strides - 1);
  CHECK(run.ticks_with_fault.size() == 1);
  CHECK(run.shutdown_reply.hundred_nops == 100);
  std::ofstream(image() + ".measured") << "worst_tick " << run.worst_instructions << "\nstack_measured "
                                       << run.shutdown_reply.deepest_stack_bytes << "\n";
  auto budget = test::budget_of(kBoard);
  CHECK(run.worst_instructions > 100);
  CHECK(run.worst_instructions <= budget["worst_tick"]);
  CHECK(run.shutdown_reply.deepest_stack_bytes > 50);
  CHECK(run.shutdown_reply.deepest_stack_bytes <= budget["stack_measured"]);
}

TEST_CASE(
    "each fault of a leg's sensors is found on the Cortex-M4F as on the host, and takes the torque away") {
  if (test::cannot_lock_step(image())) return;
  struct Case {
    LegFault breaks;
    Fault found;
  };
  for (const Case& c :
       {Case{LegFault::height_nan, Fault::non_finite_input}, Case{LegFault::sample_stale, Fault::stale_input},
        Case{LegFault::sample_missing, Fault::peer_lost},
        Case{LegFault::height_jumps, Fault::encoder_jump}}) {
    Run run = run_in_lock_step(1800, c.breaks, 1.5);
    INFO(static_cast<int>(c.breaks));
    CHECK(run.differing == 0);
    CHECK(run.ticks_with_fault[static_cast<int>(c.found)] > 290);
    CHECK(run.ticks_with_fault.size() == 2);
    CHECK(run.most_torque_after_fault == 0.0);
    CHECK(run.worst_instructions <= test::budget_of(kBoard)["worst_tick"]);
  }
}
