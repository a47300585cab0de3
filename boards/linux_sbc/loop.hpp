// What furculad does between two ticks of its board's timer (daemon.cpp); a benchmark measures it
// (benchmarks/furculad_tick.cpp).
#pragma once

#include "boards/linux_sbc/mailbox.hpp"
#include "boards/linux_sbc/walk_recorder.hpp"
#include "firmware/app/node_on_can.hpp"
#include "furcula/bus/modbus_pdu.hpp"

namespace furcula::linux_sbc {

/// Right after the board's wait_for_tick(): the robot's tick, then what was asked over Modbus and over CAN.
void run_tick(auto& board, auto& node, auto& registers, Mailbox& mailbox) {
  firmware::obey_stop(board.link(), node);
  firmware::obey_stream(board.link(), node);
  board.set_state(node.state());
  board.link().set_on_bench(node.config().bench.on_bench != 0);
  node.tick();
  mailbox.attend([&](std::span<const std::uint8_t> request) {
    return bus::handle_pdu(registers, node.bus_counts(), request);
  });
  board.link().registers().serve([&](std::span<const std::uint8_t> request, bus::Response& response) {
    bus::handle_pdu(registers, node.bus_counts(), request, response);
  });
}

/// The same for a robot that walks, which has neither registers nor Modbus. Walks are logged where there is a recorder.
void run_walker_tick(auto& board, auto& node, WalkRecorder* recorder = nullptr) {
  firmware::obey_stream(board.link(), node);
  board.set_state(node.state());
  node.tick();
  if (recorder != nullptr) recorder->note(node.walker(), node.outputs());
}

}  // namespace furcula::linux_sbc
