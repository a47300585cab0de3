// The Modbus server on a serial port that is looked at instead of waited for.
#pragma once

#include <concepts>
#include <cstdint>

#include "furcula/bus/modbus_rtu.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// A port that does not wait, as stm32f4::Usart is one.
template <class P>
concept SerialPort = requires(P& port, std::uint8_t byte) {
  /// `disconnected`: no byte came. `invalid`: one came spoilt.
  { port.receive() } -> std::same_as<Result<std::uint8_t>>;
  /// `disconnected`: the last one has not left yet.
  { port.send(byte) } -> std::same_as<Status>;
};

template <SerialPort P>
class RtuPort {
 public:
  RtuPort(P& port, std::uint8_t unit, std::uint32_t baud)
      : port_(port), server_(unit, bus::silence_us(baud)) {}

  /// To be called over and over while the board waits for its tick: a port without a queue of its own loses
  /// bytes between two calls that are further apart than one byte takes.
  template <bus::Registers R>
  void poll(R& registers, bus::BusCounts& counts, std::uint32_t now_us) {
    const Result<std::uint8_t> byte = port_.receive();
    if (server_.answering()) {  // what comes while we talk is our own echo, or a master that does not wait
      if (port_.send(server_.next()) == Status::ok) server_.advance();
      return;
    }
    if (byte.ok())
      server_.receive(byte.value(), now_us);
    else if (byte.status() == Status::invalid)
      server_.spoil(now_us);
    else
      server_.poll(registers, counts, now_us);
  }

 private:
  P& port_;
  bus::RtuServer server_;
};

}  // namespace furcula::firmware
