// The simulated bench that people talk to, see live_stand.hpp.
#include "host/bench/live_stand.hpp"

#include <limits>
#include <mutex>

#include "firmware/app/node_registers.hpp"
#include "host/bench/sim_stand.hpp"

namespace furcula::bench {
namespace {

/// Within the parameters' bounds.
control::Config live_config(const SimStand& stand) {
  control::Config c = stand_config(stand, {});
  c.coil.peak_s = 0.2f;
  c.coil.longest_s = 1.0f;
  c.coil.heat_max = 1.0f;
  c.supervisor.cable_travel_max_m = static_cast<float>(stand.travel_m());
  return c;
}

}  // namespace

struct LiveStand::Parts {
  Parts(const Conditions& c, const bus::Identity& identity, std::uint16_t session_seed)
      : conditions(c), node(stand, store, live_config(stand), identity, session_seed, faults) {
    wind_up();
  }
  void wind_up() { stand.prepare(conditions, std::numeric_limits<std::size_t>::max()); }

  std::mutex mutex;
  Conditions conditions;
  SimStand stand;
  firmware::NoStore store;
  firmware::FaultLog faults;
  firmware::Node<SimStand, firmware::NoStore> node;
  firmware::NodeRegisters<firmware::Node<SimStand, firmware::NoStore>> registers{node};
};

LiveStand::LiveStand(const Conditions& conditions, const bus::Identity& identity, std::uint16_t session_seed)
    : parts_(std::make_unique<Parts>(conditions, identity, session_seed)) {}
LiveStand::~LiveStand() = default;

void LiveStand::advance(int ticks) {
  const std::lock_guard lock(parts_->mutex);
  for (int i = 0; i < ticks && parts_->stand.wait_for_tick(); ++i) {
    const bool ran = parts_->node.state() == bus::NodeState::running;
    parts_->node.tick();
    if (!ran || parts_->node.state() == bus::NodeState::running) continue;
    // Who asks for home next shall find it where the load hangs now.
    parts_->wind_up();
    if (parts_->stand.wait_for_tick()) parts_->node.tick();
  }
}

bus::Response LiveStand::answer(std::span<const std::uint8_t> request) {
  const std::lock_guard lock(parts_->mutex);
  return bus::handle_pdu(parts_->registers, parts_->node.bus_counts(), request);
}

}  // namespace furcula::bench
