// Registers over Modbus RTU and TCP. The only file that knows libmodbus's master.
#include <modbus/modbus.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

#include "furcula/bus/modbus_rtu.hpp"
#include "host/core/error.hpp"
#include "host/modbus/link.hpp"

namespace furcula::modbus {
namespace {

struct Close {
  void operator()(modbus_t* context) const {
    modbus_close(context);
    modbus_free(context);
  }
};

class ModbusLink final : public Link {
 public:
  ModbusLink(const Port& port, int unit)
      : port_(port.text),
        context_(port.device.empty()
                     ? modbus_new_tcp_pi(port.host.c_str(), std::to_string(port.tcp_port).c_str())
                     : modbus_new_rtu(port.device.c_str(), port.baud, port.parity, 8, port.stop_bits)) {
    if (context_ == nullptr) fail("opening it");
    require(modbus_set_slave(context_.get(), unit), "choosing the unit");
    modbus_set_response_timeout(context_.get(), 1, 0);
    require(modbus_connect(context_.get()), "opening it");
  }

  Answer read(Table table, std::uint16_t first, std::span<std::uint16_t> out) override {
    const auto count = static_cast<int>(out.size());
    return table == Table::input
               ? answer(modbus_read_input_registers(context_.get(), first, count, out.data()),
                        "reading its input registers")
               : answer(modbus_read_registers(context_.get(), first, count, out.data()),
                        "reading its parameters");
  }

  Answer write(std::uint16_t first, std::uint32_t bits) override {
    const std::array<std::uint16_t, 2> words{bus::high_word(bits), bus::low_word(bits)};
    return answer(modbus_write_registers(context_.get(), first, 2, words.data()), "writing a parameter");
  }

  Answer request(std::uint16_t session, bus::Request request) override {
    const auto number = static_cast<std::uint16_t>(request);
    const char* const doing = "sending a request";
    if (request == bus::Request::stop)
      return answer(modbus_write_register(context_.get(), bus::kRequestAddress, number), doing);
    const std::array<std::uint16_t, bus::kRequestWords> words{bus::kRequestKey, session, number};
    return answer(
        modbus_write_registers(context_.get(), bus::kRequestKeyAddress, bus::kRequestWords, words.data()),
        doing);
  }

  std::string text(std::uint8_t object) override;

 private:
  [[noreturn]] void fail(const std::string& doing) const {
    throw core::DataError(port_ + ": " + doing + ": " + modbus_strerror(errno));
  }
  void require(int result, const char* doing) const {
    if (result < 0) fail(doing);
  }
  Answer answer(int result, const char* doing) const {
    if (result >= 0) return {};
    const int exception = errno - MODBUS_ENOBASE;
    if (exception < MODBUS_EXCEPTION_ILLEGAL_FUNCTION || exception >= MODBUS_EXCEPTION_MAX) fail(doing);
    return {static_cast<bus::ModbusException>(exception), modbus_strerror(errno)};
  }

  std::string port_;
  std::unique_ptr<modbus_t, Close> context_;
};

std::string ModbusLink::text(std::uint8_t object) {
  // libmodbus has no call for the device identification and does not know how long its answer is: what comes
  // up to a pause is read here. Code 4: one object.
  modbus_t* const context = context_.get();
  const std::array<std::uint8_t, 5> request{static_cast<std::uint8_t>(modbus_get_slave(context)),
                                            bus::modbus::kEncapsulated, bus::modbus::kDeviceIdentification, 4,
                                            object};
  modbus_flush(context);
  require(modbus_send_raw_request(context, request.data(), static_cast<int>(request.size())),
          "asking who it is");
  std::vector<std::uint8_t> frame;
  pollfd waited{modbus_get_socket(context), POLLIN, 0};
  while (frame.size() < MODBUS_TCP_MAX_ADU_LENGTH && ::poll(&waited, 1, frame.empty() ? 1000 : 50) > 0) {
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> bytes;
    const ssize_t n = ::read(waited.fd, bytes.data(), bytes.size());
    if (n <= 0) break;
    frame.insert(frame.end(), bytes.begin(), bytes.begin() + n);
  }
  // Function, type, code, conformity, more, next, count; the object's number and length, and then its text.
  const auto header = static_cast<std::size_t>(modbus_get_header_length(context));
  const bool serial = header == 1;
  const std::size_t begin = header + 9,
                    end = frame.size() - std::min<std::size_t>(serial ? 2 : 0, frame.size());
  if (end < begin || (serial && bus::crc16(frame) != 0) || frame[header] != bus::modbus::kEncapsulated ||
      begin + frame[begin - 1] > end)
    throw core::DataError(port_ + ": asking who it is: no answer, or a broken one");
  const auto at = frame.begin() + static_cast<std::ptrdiff_t>(begin);
  return {at, at + frame[begin - 1]};
}

}  // namespace

std::unique_ptr<Link> open_modbus(const Port& port, int unit) {
  return std::make_unique<ModbusLink>(port, unit);
}

}  // namespace furcula::modbus
