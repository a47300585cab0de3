// The simulated bench with a node on it, as a board that people talk to. It winds its load up after each
// trial.
#pragma once

#include <memory>
#include <span>

#include "furcula/bus/modbus_pdu.hpp"
#include "furcula/bus/registers.hpp"
#include "host/bench/board.hpp"

namespace furcula::bench {

/// Any of its functions may be called from any thread.
class LiveStand {
 public:
  LiveStand(const Conditions& conditions, const bus::Identity& identity, std::uint16_t session_seed);
  ~LiveStand();
  LiveStand(const LiveStand&) = delete;
  LiveStand& operator=(const LiveStand&) = delete;

  /// So many milliseconds of simulated time.
  void advance(int ticks);
  /// Of a Modbus request: function code and its data.
  bus::Response answer(std::span<const std::uint8_t> request);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace furcula::bench
