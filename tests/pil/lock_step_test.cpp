// Processor in the loop: the controller on an emulated Cortex-M4F in lock step with the host's plant.
#include "tests/pil/lock_step.hpp"

#include <signal.h>

#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include "boards/sim_host/board.hpp"
#include "firmware/app/app.hpp"
#include "host/model/reader.hpp"
#include "host/safety/fault_table.hpp"
#include "host/sim/scenario.hpp"
#include "host/sim/simulate.hpp"

namespace {

using namespace furcula;
using namespace std::chrono_literals;

// The example of 002 section 3.2.1.
constexpr const char* kModel = R"(
[model]
kind = "hopper_linear"
schema = 1
[parameters]
mass_kg = 1.5
stiffness_npm = 600.0
rest_height_m = 0.28190778623577246
damping_stance_nspm = 5.0
damping_flight_nspm = 1.0
restitution_touchdown = 1.0
restitution_liftoff = 1.0
link_length_m = 0.15
touchdown_angle_rad = 0.3490658503988659
gravity_mps2 = 9.81
)";

/// As they are in memory: 0 and -0 differ, and a NaN equals itself.
auto bits(const pil::Outputs& outputs) { return std::bit_cast<std::array<std::uint32_t, 14>>(outputs); }

/// The robot of 002 chapter 5 with its clutch.
const std::string kModelWithClutch = [] {
  std::string text = kModel;
  text.replace(text.find("hopper_linear"), 13, "hopper_nonlinear");
  text.replace(text.find("0.28190778623577246"), 19, "0.289");
  return text + R"(inertia_a_kgm2 = 42e-4
inertia_b_kgm = 75e-4
inertia_e_kgm = 38e-3
release_delay_s = 0.02
catch_delay_s = 0.02
auxiliary_stiffness_npm = 20.0
tooth_pitch_m = 4.2857e-3
)";
}();

struct Run {
  std::size_t ticks = 0;
  std::size_t differing_ticks = 0;
  std::string first_difference;
  std::uint32_t worst_instructions = 0;
  std::map<int, std::size_t> ticks_with_fault;          ///< by fault number
  double fault_s = -1.0;                                ///< when the first was found
  std::map<std::uint32_t, std::size_t> ticks_in_stage;  ///< of the clutch's sequencer
  std::size_t touchdowns = 0;
  float highest_torque_nm = 0.0f;
  double highest_m = 0.0;  ///< of the last second
  pil::ShutdownReply shutdown_reply;
};

/// The host's application and the board's get the same samples; the plant obeys the board's command alone.
/// `reset_at_tick` asks both to clear their faults.
Run run_in_lock_step(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed,
                     std::size_t reset_at_tick, control::DebounceRule rule) {
  control::Config config = sim::controller_config(model, scenario);
  config.debounce.rule = rule;
  sim_host::SimBoard rig(sim::rig_config(model, scenario, seed));
  firmware::App host(rig, config);
  pil::Qemu qemu(pil::own_image(), config, 10s);

  Run run;
  while (rig.wait_for_tick()) {
    const bool reset = reset_at_tick != 0 && run.ticks == reset_at_tick;
    const auto sample = rig.sense();
    pil::Tick tick;
    tick.now_us = rig.now_us();
    tick.sample_valid = sample.ok() ? 1 : 0;
    if (sample.ok()) tick.sample = sample.value();
    tick.reset = reset ? 1 : 0;
    const pil::Reply there = qemu.exchange(tick);

    if (reset) rig.request_reset();
    host.tick();
    const pil::Outputs here = pil::outputs_of(rig.telemetry());
    if (bits(here) != bits(there.outputs) && run.differing_ticks++ == 0)
      run.first_difference = "tick " + std::to_string(run.ticks) + ": torque here " +
                             std::to_string(here.command.torque_nm) + ", there " +
                             std::to_string(there.outputs.command.torque_nm);
    REQUIRE(rig.actuate(there.outputs.command) == Status::ok);

    ++run.ticks;
    run.worst_instructions = std::max(run.worst_instructions, there.instructions);
    ++run.ticks_with_fault[there.outputs.fault];
    if (run.fault_s < 0.0 && there.outputs.fault != 0) run.fault_s = rig.time_s();
    run.touchdowns += there.outputs.touchdown;
    ++run.ticks_in_stage[there.outputs.clutch_stage];
    run.highest_torque_nm = std::max(run.highest_torque_nm, std::abs(there.outputs.command.torque_nm));
    if (rig.time_s() > scenario.duration_s - 1.0)
      run.highest_m = std::max(run.highest_m, rig.plant().height_m());
  }
  run.shutdown_reply = qemu.finish();
  return run;
}

Run run_in_lock_step(const std::string& scenario_text, std::uint64_t seed, std::size_t reset_at_tick = 0,
                     control::DebounceRule rule = control::DebounceRule::two_readings,
                     const std::string& model_text = kModel) {
  const model::Model model = model::parse_model(model_text, "example.toml");
  return run_in_lock_step(model, sim::parse_scenario(scenario_text, "scenario.toml", model), seed,
                          reset_at_tick, rule);
}

}  // namespace

TEST_CASE("20,000 ticks of hopping with ideal sensors are bit-equal on the Cortex-M4F and on the host") {
  if (test::cannot_lock_step(pil::own_image())) return;
  const Run run = run_in_lock_step(R"(
start = { height_m = 0.35 }
run = { duration_s = 20 }
torque = { profile = "harmonic", amplitude_nm = 2, period_s = 0.3 }
)",
                                   1);
  INFO(run.first_difference);
  CHECK(run.ticks == 20000);
  CHECK(run.differing_ticks == 0);
  // It was the hopping of 002 section 3.2.1 and not a row of zeros: steady apex 0.361 m, over 40 hops,
  // torque.
  CHECK(run.highest_m == Approx(0.361).margin(0.001));
  CHECK(run.touchdowns > 40);
  CHECK(run.highest_torque_nm == Approx(2.0f).margin(0.01));
  CHECK(run.ticks_with_fault.size() == 1);
  CHECK(run.shutdown_reply.watchdog_kicks == 20000);
}

TEST_CASE(
    "hopping with quantised, noisy, bouncing and jittering sensors is bit-equal, and within the budgets") {
  if (test::cannot_lock_step(pil::own_image())) return;
  std::uint32_t worst_tick = 0, stack = 0;
  const std::string rough = R"(
start = { height_m = 0.35 }
run = { duration_s = 20 }
sensors = { quantisation = true, noise = true, bounce = true, jitter = true }
)";
  const std::string harmonic =
      rough + R"(torque = { amplitude_nm = 2, period_s = 0.3, profile = "harmonic" })";
  const std::string constant =
      rough + R"(torque = { amplitude_nm = 2, period_s = 0.3, profile = "constant" })";
  const std::string clutch = rough + R"(
torque = { profile = "harmonic", amplitude_nm = 3, period_s = 0.3 }
clutch = { in_flight = "release" }
contraction = { amplitude_m = 0.05, period_s = 0.4 }
ground = { steps_m = 0.03 }
fault = [{ time_s = 5, kind = "coil_open", duration_s = 1 }, { time_s = 10, kind = "coil_stuck_on", duration_s = 0.4 }]
)";
  for (const std::string& scenario : {harmonic, constant, clutch}) {
    const Run run = run_in_lock_step(
        scenario, 7, 0,
        scenario == constant ? control::DebounceRule::settling : control::DebounceRule::two_readings,
        scenario == clutch ? kModelWithClutch : kModel);
    INFO(scenario << run.first_difference);
    if (scenario == clutch) CHECK(run.ticks_in_stage.size() >= 6);  // all that the sequencer does
    CHECK(run.ticks == 20000);
    CHECK(run.differing_ticks == 0);
    CHECK(run.touchdowns > 30);
    CHECK(run.ticks_with_fault.size() == 1);
    CHECK(run.shutdown_reply.measured.hundred_nops == 100);  // the counter counts instructions
    worst_tick = std::max(worst_tick, run.worst_instructions);
    stack = std::max(stack, run.shutdown_reply.measured.deepest_stack_bytes);
  }
  // For the table of scripts/size-budget.
  std::ofstream(std::string(pil::own_image()) + ".measured")
      << "worst_tick " << worst_tick << "\nstack_measured " << stack << "\n";
  auto budget = test::budget_of("qemu_netduinoplus2");
  CHECK(worst_tick > 100);
  CHECK(worst_tick <= budget["worst_tick"]);
  CHECK(stack > 100);
  CHECK(stack <= budget["stack_measured"]);
}

TEST_CASE(
    "each fault brings the Cortex-M4F to the same safe state as the host, and a reset back to hopping") {
  if (test::cannot_lock_step(pil::own_image())) return;
  struct Case {
    const char* kind;
    control::Fault fault;
  };
  const Case c =
      GENERATE(Case{"encoder_frozen", control::Fault::stale_input},
               Case{"encoder_stuck", control::Fault::encoder_implausible},
               Case{"height_nan", control::Fault::non_finite_input},
               Case{"switch_stuck_open", control::Fault::contact_switch_lost},
               Case{"switch_stuck_closed", control::Fault::contact_switch_lost},
               Case{"late_tick", control::Fault::late_tick}, Case{"peer_lost", control::Fault::peer_lost});
  const bool lasting = std::string(c.kind) != "late_tick";
  Run run = run_in_lock_step(std::string(R"(
start = { height_m = 0.35 }
run = { duration_s = 4 }
torque = { profile = "harmonic", amplitude_nm = 2, period_s = 0.3 }
[sensors]
quantisation = true
bounce = true
[[fault]]
time_s = 1.5
kind = ")") + c.kind + (lasting ? "\"\nduration_s = 0.5\n" : "\"\n"),
                             3, 3000);
  INFO(c.kind << ": " << run.first_difference);
  CHECK(run.differing_ticks == 0);
  CHECK(run.ticks_with_fault[static_cast<int>(c.fault)] > 400);
  CHECK(run.ticks_with_fault[0] > 2400);  // before the fault, and after the reset at 3 s
  CHECK(run.ticks_with_fault.size() == 2);
  CHECK(run.worst_instructions <= test::budget_of("qemu_netduinoplus2")["worst_tick"]);
}

TEST_CASE(
    "what breaks is found on the Cortex-M4F on the tick on which the simulation of docs/safety.md finds it") {
  if (test::cannot_lock_step(pil::own_image())) return;
  std::size_t n = 0;
  for (const safety::RigRow& row : safety::rig_rows()) {
    const auto& what = sim_host::info(row.breaks);
    // The protocol of this test level knows no new start.
    if (what.part == sim_host::RigPart::bus || row.breaks == sim_host::RigFault::brown_out) continue;
    // Rows take turns with the moments of the stride; the host alone has tried them all.
    const auto moment = static_cast<safety::Moment>(n++ % safety::kMoments.size());
    const double at_s = safety::instant_of(moment, 1, safety::Rig::local);
    sim::Scenario scenario = safety::hopping(at_s + 1e-3 * row.found_within_ticks + 0.3);
    scenario.faults = {{at_s, row.breaks, row.duration_s}};
    Run run = run_in_lock_step(safety::robot(), scenario, 1, 0, control::DebounceRule::two_readings);
    const safety::Trial trial = safety::run_trial(safety::robot(), scenario, 1, safety::Rig::local);
    INFO(what.name << ": " << run.first_difference);
    CHECK(run.differing_ticks == 0);
    CHECK(run.worst_instructions <= test::budget_of("qemu_netduinoplus2")["worst_tick"]);
    if (row.is_borne() || (row.may_come_to_rest && trial.fault == control::Fault::none)) {
      CHECK(run.ticks_with_fault.size() == 1);
      continue;
    }
    CHECK(run.ticks_with_fault[static_cast<int>(trial.fault)] > 0);
    CHECK(std::lround(1e3 * (run.fault_s - at_s)) == trial.found_tick);
    CHECK(trial.found_tick <= row.found_within_ticks);
  }
}

TEST_CASE("a board whose configuration makes no sense stays in the safe state") {
  if (test::cannot_lock_step(pil::own_image())) return;
  control::Config config;
  config.torque.shape = control::ProfileShape::constant;
  config.torque.amplitude_nm = 2.0f;
  config.height.metres_per_count = 0.0f;
  pil::Qemu qemu(pil::own_image(), config, 10s);
  pil::Tick tick;
  tick.sample_valid = 1;
  tick.sample.home_height_m = 0.2f;
  tick.sample.leg_angle_rad = 0.8f;
  tick.sample.contact = 1;
  for (int i = 0; i < 5; ++i) {
    const pil::Reply reply = qemu.exchange(tick);
    CHECK(reply.outputs.fault == static_cast<int>(control::Fault::bad_configuration));
    CHECK(reply.outputs.command.torque_nm == 0.0f);
  }
  CHECK(qemu.finish().watchdog_kicks == 5);
}

TEST_CASE("a board that falls silent ends the run with a reason within the time allowed") {
  if (test::cannot_lock_step(pil::own_image())) return;
  pil::Qemu qemu(pil::own_image(), control::Config{}, 10s);
  for (int i = 0; i < 3; ++i) qemu.exchange({});
  pil::Qemu silent(pil::own_image(), control::Config{}, 500ms);
  REQUIRE(::kill(silent.pid(), SIGSTOP) == 0);
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_WITH(silent.exchange({}), Catch::Contains("no answer within 500 ms at tick 0"));
  CHECK(std::chrono::steady_clock::now() - start < 10s);
}

TEST_CASE("a board that dies ends the run with a reason") {
  if (test::cannot_lock_step(pil::own_image())) return;
  pil::Qemu qemu(pil::own_image(), control::Config{}, 10s);
  for (int i = 0; i < 3; ++i) qemu.exchange({});
  REQUIRE(::kill(qemu.pid(), SIGKILL) == 0);
  CHECK_THROWS_WITH(qemu.exchange({}), Catch::Contains("was ended by signal 9 at tick 3"));
}

TEST_CASE("an image that is none ends the run with what QEMU says") {
  if (test::cannot_lock_step(pil::own_image())) return;
  CHECK_THROWS_WITH(
      [] {
        pil::Qemu qemu("/nonexistent.elf", control::Config{}, 10s);
        qemu.exchange({});
      }(),
      Catch::Contains("QEMU ended with status 1") && Catch::Contains("nonexistent.elf"));
}

TEST_CASE("a message that makes no sense ends the board with its own exit status") {
  if (test::cannot_lock_step(pil::own_image())) return;
  pil::Qemu qemu(pil::own_image(), control::Config{}, 10s);
  pil::Tick nonsense;
  nonsense.kind = 99;
  CHECK_THROWS_WITH(qemu.exchange(nonsense), Catch::Contains("QEMU ended with status 4"));
}
