// The simulated rig with a node on it, as a robot that people talk to: it goes on for ever, tick by tick.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "furcula/bus/modbus_pdu.hpp"
#include "furcula/bus/registers.hpp"
#include "host/model/model.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::sim {

/// The robot of docs/logs_and_models.md with its clutch: what a live rig is without a model file.
model::Model example_hopper();

/// Any of its functions may be called from any thread.
class LiveRig {
 public:
  /// A hopper model. `store` is the file that keeps its parameters; empty: nothing is kept. The scenario's
  /// torque is what the parameters are to begin with; its duration is not looked at.
  LiveRig(const model::Model& model, const Scenario& scenario, std::uint64_t seed, const std::string& store,
          const bus::Identity& identity, std::uint16_t session_seed);
  ~LiveRig();
  LiveRig(const LiveRig&) = delete;
  LiveRig& operator=(const LiveRig&) = delete;

  /// So many milliseconds of simulated time.
  void advance(int ticks);
  bus::Snapshot snapshot() const;
  /// Of a Modbus request: function code and its data.
  bus::Response answer(std::span<const std::uint8_t> request);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace furcula::sim
