// The ways to a node's registers: libmodbus over a serial line or TCP (modbus_link.cpp), and CAN
// (can_link.cpp).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "furcula/bus/node_words.hpp"
#include "furcula/bus/registers.hpp"
#include "host/modbus/port.hpp"

namespace furcula::modbus {

/// The node answered with an exception. `none`: it did what it was asked for.
struct Answer {
  bus::ModbusException exception = bus::ModbusException::none;
  std::string text;  ///< of the exception
};

/// Where nothing answers, or something else does, every function throws core::DataError, naming the port.
class Link {
 public:
  virtual ~Link() = default;

  enum class Table : std::uint8_t { input, holding };
  /// At most bus::modbus::kReadMax registers, all of one tick.
  virtual Answer read(Table table, std::uint16_t first, std::span<std::uint16_t> out) = 0;
  /// Two holding registers.
  virtual Answer write(std::uint16_t first, std::uint32_t bits) = 0;
  /// `stop` goes without its session.
  virtual Answer request(std::uint16_t session, bus::Request request) = 0;
  /// Text `object` of the device identification: 0 vendor, 1 board, 2 version and build.
  virtual std::string text(std::uint8_t object) = 0;
};

std::unique_ptr<Link> open_modbus(const Port& port, int unit);
std::unique_ptr<Link> open_can(const Port& port);

}  // namespace furcula::modbus
