// The simulated bench with a node on it, as a board that people talk to. It winds its load up after each
// trial.
#pragma once

#include <memory>
#include <span>

#include "furcula/bus/modbus_tcp.hpp"
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
  /// Of a connection's complete request; holds as TcpConnection::answer() says.
  std::span<const std::uint8_t> answer(bus::TcpConnection& connection);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace furcula::bench
