// pil_scenario MODEL SCENARIO: runs a scenario with the controller on the emulated Cortex-M4F, and asks its
// [expect]. Ends with status 0 where it holds, 4 where it does not, 77 where the image or QEMU is not there.
#include <chrono>
#include <exception>
#include <iostream>

#include "boards/sim_host/board.hpp"
#include "host/model/reader.hpp"
#include "host/pil/own_image.hpp"
#include "host/pil/qemu.hpp"
#include "host/sim/expectation.hpp"
#include "host/sim/recorder.hpp"
#include "host/sim/simulate.hpp"

namespace {

using namespace furcula;

int run(const char* model_path, const char* scenario_path) {
  if (const std::string why = pil::why_not_here(pil::own_image()); !why.empty()) {
    std::cout << "SKIPPED: " << why << "\n";
    return 77;
  }
  const model::Model model = model::read_model(model_path);
  const sim::Scenario scenario = sim::read_scenario(scenario_path, model);
  if (sim::needs_bus(scenario)) {
    std::cout << "SKIPPED: the emulated board has no bus\n";
    return 77;
  }
  sim_host::SimBoard rig(sim::rig_config(model, scenario, 0));
  pil::Qemu qemu(pil::own_image(), sim::controller_config(model, scenario), std::chrono::seconds(10));
  sim::HopperRecorder recorder(scenario.duration_s);
  while (rig.wait_for_tick()) {
    pil::Tick tick;
    tick.now_us = rig.now_us();
    const auto sample = rig.sense();
    tick.sample_valid = sample.ok() ? 1 : 0;
    if (sample.ok()) tick.sample = sample.value();
    const pil::Reply reply = qemu.exchange(tick);
    static_cast<void>(rig.actuate(reply.outputs.command));
    rig.kick_watchdog();
    firmware::Telemetry telemetry;
    telemetry.outputs.fault = static_cast<control::Fault>(reply.outputs.fault);
    telemetry.outputs.height.velocity_mps = reply.outputs.velocity_mps;
    rig.report(telemetry);
    recorder.add(rig);
  }
  qemu.finish();
  log::Log log;
  recorder.finish(log, model.clutch.has_value());
  const auto found = sim::violations(sim::read_expectation(scenario_path), log, sim::first_fault_s(scenario),
                                     model.clutch ? model.clutch->tooth_pitch_m : 0.0);
  for (const std::string& violation : found) std::cerr << scenario_path << ": " << violation << "\n";
  return found.empty() ? 0 : 4;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: pil_scenario MODEL.toml SCENARIO.toml\n";
    return 2;
  }
  try {
    return run(argv[1], argv[2]);
  } catch (const std::exception& e) {
    std::cerr << "pil_scenario: " << e.what() << "\n";
    return 4;
  }
}
