// A simulated robot behind Modbus/TCP whose time goes on only when a test says so, or with each request.
#pragma once

#include <atomic>
#include <string>

#include "host/modbus/tcp_server.hpp"
#include "host/sim/live_rig.hpp"

namespace furcula::test {

inline sim::Scenario hopping(const model::Model& model, double peer_lost_s) {
  sim::Scenario scenario = sim::default_scenario(model);
  scenario.faults = {{peer_lost_s, sim_host::RigFault::peer_lost, 1e9}};
  scenario.amplitude = 2.0;
  return scenario;
}

struct Robot {
  model::Model model = sim::example_hopper();
  sim::LiveRig rig;
  std::atomic<int> ticks_a_request = 0;
  modbus::TcpService server;

  /// From `peer_lost_s` on its sensors do not answer.
  explicit Robot(const std::string& store = "", const std::string& address = "127.0.0.1",
                 double peer_lost_s = 1e9)
      : rig(model, hopping(model, peer_lost_s), 1, store,
            {.board = "sim_host", .text = "9.8.7 build 6", .firmware_version = 0x090807, .build_id = 6}, 77),
        server(address, 0, [this](std::span<const std::uint8_t> request) {
          rig.advance(ticks_a_request);
          return rig.answer(request);
        }) {}

  std::string port() const { return "modbus:127.0.0.1:" + std::to_string(server.port()); }
};

}  // namespace furcula::test
