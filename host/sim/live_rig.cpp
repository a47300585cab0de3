#include "host/sim/live_rig.hpp"

#include <mutex>

#include "boards/sim_host/board.hpp"
#include "firmware/app/node_registers.hpp"
#include "host/core/parameter_file.hpp"
#include "host/model/reader.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::sim {
namespace {

sim_host::RigConfig endless(sim_host::RigConfig rig) {
  rig.duration_s = 4e6;  // 46 days: what a counter of ticks holds
  return rig;
}

}  // namespace

model::Model example_hopper() {
  return model::parse_model(R"([model]
kind = "hopper_nonlinear"
schema = 1

[parameters]
mass_kg = 1.554
stiffness_npm = 605.0
rest_height_m = 0.282
damping_stance_nspm = 5.0
damping_flight_nspm = 1.0
restitution_touchdown = 0.95
restitution_liftoff = 0.98
link_length_m = 0.15
touchdown_angle_rad = 0.349
gravity_mps2 = 9.81
inertia_a_kgm2 = 42e-4
inertia_b_kgm = 75e-4
inertia_e_kgm = 38e-3
release_delay_s = 0.02
catch_delay_s = 0.02
auxiliary_stiffness_npm = 20.0
tooth_pitch_m = 4.2857e-3
)",
                            "example");
}

struct LiveRig::Parts {
  Parts(const model::Model& model, const Scenario& scenario, std::uint64_t seed, const std::string& path,
        const bus::Identity& identity, std::uint16_t session_seed)
      : board(endless(rig_config(model, scenario, seed))),
        store(path),
        node(board, store, controller_config(model, scenario), identity, session_seed, faults) {
    faults.begin();
    if (node.snapshot().parameter_origin == static_cast<std::uint16_t>(bus::ParameterOrigin::store_unusable))
      board.report_start_fault(control::Fault::parameters_lost);
  }

  std::mutex mutex;
  sim_host::SimBoard board;
  core::ParameterFile store;
  firmware::FaultLog faults{};
  firmware::Node<sim_host::SimBoard, core::ParameterFile> node;
  firmware::NodeRegisters<firmware::Node<sim_host::SimBoard, core::ParameterFile>> registers{node};
};

LiveRig::LiveRig(const model::Model& model, const Scenario& scenario, std::uint64_t seed,
                 const std::string& store, const bus::Identity& identity, std::uint16_t session_seed)
    : parts_(std::make_unique<Parts>(model, scenario, seed, store, identity, session_seed)) {}
LiveRig::~LiveRig() = default;

void LiveRig::advance(int ticks) {
  const std::lock_guard lock(parts_->mutex);
  for (int i = 0; i < ticks && parts_->board.wait_for_tick(); ++i) parts_->node.tick();
}

bus::Snapshot LiveRig::snapshot() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->node.snapshot();
}

bus::Response LiveRig::answer(std::span<const std::uint8_t> request) {
  const std::lock_guard lock(parts_->mutex);
  return bus::handle_pdu(parts_->registers, parts_->node.bus_counts(), request);
}

}  // namespace furcula::sim
