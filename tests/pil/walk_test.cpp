// The walk of a biped on an emulated Cortex-M4F: the robot on the host obeys the board's commands alone, and beside it the host's own
// controller gets the same samples.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <fstream>
#include <map>
#include <string>

#include "boards/qemu_biped_walk/wire.hpp"
#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/walker_faults.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/pil/lock_step.hpp"

namespace {

using namespace furcula;
using namespace std::chrono_literals;
using control::Fault;
using control::WalkerStage;

constexpr const char* kBoard = "qemu_biped_walk";
std::string image() { return test::lock_step_image(kBoard); }

walk::WalkerRigConfig active_walk() {
  const walk::Walk found = test::found_walk();
  return {.robot = dynamics::biped::design(), .mode = found.mode, .walk = found.parameters, .seed = 1};
}

struct Run {
  std::size_t ticks = 0, differing = 0, walking = 0;
  std::uint64_t instructions = 0;  ///< of all walking ticks
  std::uint32_t worst_instructions = 0;
  Fault found = Fault::none;
  std::uint32_t after_ticks = 0;  ///< that had the fault, before the one on which it was found
  double work_after_j = 0.0, way_m = 0.0, height_m = 0.0;

  std::uint32_t mean_instructions() const { return static_cast<std::uint32_t>(instructions / walking); }
};

/// Until it has walked for `ticks`, or has had a fault for 100.
Run run_in_lock_step(pil::EmulatedBoard& board, const walk::WalkerRigConfig& config, std::size_t ticks) {
  const control::WalkerConfig known = walk::walker_config(config, 5.0);
  control::WalkerState state = control::begin_walker(known);
  walk::WalkerRig rig(config);
  Run run;
  std::size_t faulty = 0;
  double work_j = 0.0;
  for (std::uint32_t broken = 0; run.walking < ticks && faulty < 100; ++run.ticks) {
    const control::WalkerInputs in = rig.sense();
    const pil::WalkTick tick{run.ticks == 0 ? pil::kWalkAnew : pil::kWalkTick, 0, in.run ? 1u : 0u,
                             in.tick_interval_us, in.sample};
    board.send(tick);
    const auto there = board.receive<pil::WalkReply>();
    const pil::WalkReply here =
        pil::reply_of(control::step_walker(known, state, pil::inputs_of(tick), 1e-3f));
    if (test::bits(here) != test::bits(there)) ++run.differing;
    control::WalkerOutputs told;
    told.joints = there.joints;
    told.pin_targets = there.pin_targets;
    told.stage = static_cast<WalkerStage>(there.stage);
    if (there.fault != 0 && faulty++ == 0) {
      run.found = static_cast<Fault>(there.fault);
      run.after_ticks = broken;
      work_j = rig.positive_work_j();
    }
    if (rig.broken()) ++broken;
    rig.advance(told);
    run.worst_instructions = std::max(run.worst_instructions, there.instructions);
    if (told.stage != WalkerStage::walking) continue;
    run.instructions += there.instructions;
    ++run.walking;
  }
  run.work_after_j = rig.positive_work_j() - work_j;
  run.way_m = rig.state().position_m.x;
  run.height_m = rig.state().position_m.z;
  return run;
}

pil::Measured end(pil::EmulatedBoard& board) {
  pil::WalkTick last;
  last.kind = pil::kWalkEnd;
  board.send(last);
  const auto shutdown_reply = board.receive<pil::Measured>();
  board.wait_for_end();
  return shutdown_reply;
}

}  // namespace

TEST_CASE("10 s of a biped's walk are bit-equal on the Cortex-M4F and on the host, within the budgets") {
  if (test::cannot_lock_step(image())) return;
  const walk::WalkerRigConfig config = active_walk();
  pil::EmulatedBoard board(image(), 10s);
  board.send(pil::WalkBegin{pil::kWalkBegin, walk::walker_config(config, 5.0)});
  const Run run = run_in_lock_step(board, config, 10000);
  CHECK(run.walking == 10000);
  CHECK(run.differing == 0);
  // It walked as it does in the search's own simulation, and stands.
  CHECK(run.found == Fault::none);
  CHECK(run.way_m > 0.5);
  CHECK(run.height_m > 0.9);
  const pil::Measured shutdown_reply = end(board);
  CHECK(shutdown_reply.hundred_nops == 100);
  std::ofstream(image() + ".measured")
      << "worst_tick " << run.worst_instructions << "\nmean_tick " << run.mean_instructions()
      << "\nstack_measured " << shutdown_reply.deepest_stack_bytes << "\n";
  auto budget = test::budget_of(kBoard);
  CHECK(budget["worst_tick"] <= 12000.0);
  CHECK(run.mean_instructions() > 1000);
  CHECK(run.mean_instructions() <= budget["mean_tick"]);
  CHECK(run.worst_instructions <= budget["worst_tick"]);
  CHECK(shutdown_reply.deepest_stack_bytes > 500);
  CHECK(shutdown_reply.deepest_stack_bytes <= budget["stack_measured"]);
}

TEST_CASE(
    "what breaks in a walking robot is found on the Cortex-M4F as on the host, and its drives only brake") {
  if (test::cannot_lock_step(image())) return;
  pil::EmulatedBoard board(image(), 10s);
  board.send(pil::WalkBegin{pil::kWalkBegin, walk::walker_config(active_walk(), 5.0)});
  for (const walk::WalkerFaultRow& row : walk::walker_fault_rows()) {
    const walk::WalkerRigConfig config = walk::trials_of(row, active_walk())[row.joints.size()];
    const Run run = run_in_lock_step(board, config, 5000);
    INFO(row.name << ": found " << control::info(run.found).name << " after " << run.after_ticks);
    CHECK(run.differing == 0);
    CHECK(std::find(row.finds.begin(), row.finds.end(), run.found) != row.finds.end());
    CHECK(run.after_ticks <= row.within_ticks);
    CHECK(run.work_after_j == 0.0);
    CHECK(run.worst_instructions <= test::budget_of(kBoard)["worst_tick"]);
  }
  end(board);
}
