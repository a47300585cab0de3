#include "host/modbus/port.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "furcula/bus/message.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::modbus {
namespace {

constexpr std::string_view kPrefix = "modbus:", kCan = "can:";
constexpr std::array kBauds{1200,   2400,   4800,   9600,   19200,  38400,  57600,
                            115200, 230400, 460800, 500000, 576000, 921600, 1000000};

[[noreturn]] void fail(std::string_view text, const std::string& what) {
  throw core::DataError("port " + core::quoted(text) + ": " + what +
                        "; expected modbus:/dev/NAME@BAUD, modbus:/dev/NAME@BAUD,8N1, modbus:HOST:PORT, "
                        "can:INTERFACE or can:INTERFACE@NODE");
}

std::optional<int> whole(std::string_view digits) {
  int value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

Port serial(std::string_view text, std::string_view rest) {
  Port port;
  const std::size_t at = rest.rfind('@');
  port.device = rest.substr(0, at);
  if (at == std::string_view::npos) return port;
  std::string_view speed = rest.substr(at + 1);
  if (const std::size_t comma = speed.find(','); comma != std::string_view::npos) {
    const std::string_view format = speed.substr(comma + 1);
    if (format.size() != 3 || format[0] != '8' || std::string_view("ENO").find(format[1]) == format.npos ||
        (format[2] != '1' && format[2] != '2'))
      fail(text, "no format " + core::quoted(format));
    port.parity = format[1];
    port.stop_bits = format[2] - '0';
    speed = speed.substr(0, comma);
  }
  const std::optional<int> baud = whole(speed);
  bool known = false;
  for (const int b : kBauds) known = known || baud == b;
  if (!known) fail(text, "no speed of a serial line: " + core::quoted(speed));
  port.baud = *baud;
  return port;
}

Port can(std::string_view text, std::string_view rest) {
  Port port;
  const std::size_t at = std::min(rest.find('@'), rest.size());
  port.can_interface = rest.substr(0, at);
  if (port.can_interface.empty()) fail(text, "no CAN interface");
  if (at == rest.size()) return port;
  const std::optional<int> node = whole(rest.substr(at + 1));
  if (!node || *node < bus::kFirstNode || *node > bus::kLastNode)
    fail(text, "no node from 1 to 31: " + core::quoted(rest.substr(at + 1)));
  port.can_node = static_cast<std::uint8_t>(*node);
  return port;
}

}  // namespace

Port parse_port(std::string_view text) {
  if (text.starts_with(kCan)) {
    Port port = can(text, text.substr(kCan.size()));
    port.text = text;
    return port;
  }
  if (!text.starts_with(kPrefix)) fail(text, "it begins neither with modbus: nor with can:");
  const std::string_view rest = text.substr(kPrefix.size());
  Port port;
  if (rest.starts_with('/')) {
    port = serial(text, rest);
  } else {
    const std::size_t colon = rest.rfind(':');
    if (colon == std::string_view::npos || colon == 0) fail(text, "no host and port");
    port.host = rest.substr(0, colon);
    const std::optional<int> number = whole(rest.substr(colon + 1));
    if (!number || *number < 1 || *number > 65535)
      fail(text, "no port number from 1 to 65535: " + core::quoted(rest.substr(colon + 1)));
    port.tcp_port = *number;
  }
  port.text = text;
  return port;
}

}  // namespace furcula::modbus
