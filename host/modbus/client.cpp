#include "host/modbus/client.hpp"

#include <modbus/modbus.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <memory>

#include "furcula/bus/modbus_rtu.hpp"
#include "host/log/error.hpp"

namespace furcula::modbus {
namespace {

struct Close {
  void operator()(modbus_t* context) const {
    modbus_close(context);
    modbus_free(context);
  }
};

}  // namespace

struct Client::Link {
  std::string port;
  std::unique_ptr<modbus_t, Close> context;

  [[noreturn]] void fail(const std::string& doing) const {
    throw log::DataError(port + ": " + doing + ": " + modbus_strerror(errno));
  }
  void require(int result, const char* doing) const {
    if (result < 0) fail(doing);
  }
  void read_input(std::uint16_t first, std::span<std::uint16_t> out) const {
    require(modbus_read_input_registers(context.get(), first, static_cast<int>(out.size()), out.data()),
            "reading its input registers");
  }
  /// A write that the robot may refuse: its last refusal says why.
  void write(std::uint16_t first, std::span<const std::uint16_t> in, const std::string& what) const {
    const int result =
        in.size() == 1 ? modbus_write_register(context.get(), first, in[0])
                       : modbus_write_registers(context.get(), first, static_cast<int>(in.size()), in.data());
    if (result >= 0) return;
    if (errno != EMBXILVAL && errno != EMBXSFAIL && errno != EMBXILADD) fail(what);
    const std::string exception = modbus_strerror(errno);
    std::uint16_t number = 0;
    read_input(4, {&number, 1});
    const bool known = number != 0 && number < bus::kRefusals.size();
    throw Refused(what + ": refused: " + (known ? std::string(bus::kRefusals[number].meaning) : exception));
  }
};

Client::Client(const Port& port, int unit) : link_(std::make_unique<Link>()) {
  link_->port = port.text;
  link_->context.reset(port.device.empty()
                           ? modbus_new_tcp_pi(port.host.c_str(), std::to_string(port.tcp_port).c_str())
                           : modbus_new_rtu(port.device.c_str(), port.baud, port.parity, 8, port.stop_bits));
  if (link_->context == nullptr) link_->fail("opening it");
  link_->require(modbus_set_slave(link_->context.get(), unit), "choosing the unit");
  modbus_set_response_timeout(link_->context.get(), 1, 0);
  link_->require(modbus_connect(link_->context.get()), "opening it");
  std::uint16_t version = 0;
  link_->read_input(0, {&version, 1});
  if (version != bus::kRegistersVersion)
    throw log::DataError(port.text + ": it has version " + std::to_string(version) +
                         " of the table of registers; expected " + std::to_string(bus::kRegistersVersion));
}

Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

bus::Snapshot Client::snapshot() {
  std::array<std::uint16_t, bus::kInputWords> words{};
  link_->read_input(0, words);
  return bus::from_words(words);
}

std::vector<bus::LoggedFault> Client::faults() {
  std::array<std::uint16_t, bus::kLogWords> words{};
  link_->read_input(bus::kLogBase, words);
  std::vector<bus::LoggedFault> entries;
  for (std::size_t i = 0; i < bus::kLoggedFaults; ++i) {
    const bus::LoggedFault entry = bus::logged_fault(std::span(words).subspan(i * bus::kLogEntryWords));
    if (entry.fault != 0) entries.push_back(entry);
  }
  return entries;
}

DeviceNames Client::names() {
  // libmodbus has no call for the device identification and does not know how long its answer is: what comes
  // up to a pause is read here. Code 1: the basic objects.
  modbus_t* const context = link_->context.get();
  const std::array<std::uint8_t, 5> request{static_cast<std::uint8_t>(modbus_get_slave(context)),
                                            bus::modbus::kEncapsulated, bus::modbus::kDeviceIdentification, 1,
                                            0};
  modbus_flush(context);
  link_->require(modbus_send_raw_request(context, request.data(), static_cast<int>(request.size())),
                 "asking who it is");
  std::vector<std::uint8_t> frame;
  pollfd waited{modbus_get_socket(context), POLLIN, 0};
  while (frame.size() < MODBUS_TCP_MAX_ADU_LENGTH && ::poll(&waited, 1, frame.empty() ? 1000 : 50) > 0) {
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> bytes;
    const ssize_t n = ::read(waited.fd, bytes.data(), bytes.size());
    if (n <= 0) break;
    frame.insert(frame.end(), bytes.begin(), bytes.begin() + n);
  }
  const auto header = static_cast<std::size_t>(modbus_get_header_length(context));
  const bool serial = header == 1;
  if (frame.size() < header + 7 || (serial && bus::crc16(frame) != 0) ||
      frame[header] != bus::modbus::kEncapsulated)
    throw log::DataError(link_->port + ": asking who it is: no answer, or a broken one");
  DeviceNames names;
  const std::array<std::string*, 3> texts{&names.vendor, &names.board, &names.revision};
  const std::size_t end = frame.size() - (serial ? 2 : 0);
  for (std::size_t at = header + 7; at + 2 <= end && at + 2 + frame[at + 1] <= end; at += 2u + frame[at + 1])
    if (frame[at] < texts.size())
      texts[frame[at]]->assign(frame.begin() + static_cast<std::ptrdiff_t>(at) + 2,
                               frame.begin() + static_cast<std::ptrdiff_t>(at + 2 + frame[at + 1]));
  return names;
}

std::vector<float> Client::parameters() {
  std::array<std::uint16_t, bus::kParameterWords> words{};
  link_->require(
      modbus_read_registers(link_->context.get(), bus::kParameterBase, bus::kParameterWords, words.data()),
      "reading its parameters");
  std::vector<float> values;
  for (std::size_t i = 0; i < words.size(); i += 2)
    values.push_back(std::bit_cast<float>(bus::bits_of(words[i], words[i + 1])));
  return values;
}

void Client::write(const bus::Parameter& parameter, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::array<std::uint16_t, 2> words{bus::high_word(bits), bus::low_word(bits)};
  link_->write(bus::address_of(parameter), words, std::string(parameter.name));
}

void Client::request(bus::Request request) {
  const std::string what(bus::info(request).name);
  const auto number = static_cast<std::uint16_t>(request);
  if (request == bus::Request::stop) return link_->write(bus::kRequestAddress, {&number, 1}, what);
  std::uint16_t session = 0;
  link_->read_input(5, {&session, 1});
  const std::array<std::uint16_t, bus::kRequestWords> words{bus::kRequestKey, session, number};
  link_->write(bus::kRequestKeyAddress, words, what);
}

std::uint16_t Client::trial_number() {
  std::uint16_t number = 0;
  link_->read_input(bus::kTrialNumberAddress, {&number, 1});
  return number;
}

Trial Client::trial() {
  std::array<std::uint16_t, 2> head{};
  link_->read_input(bus::kTrialNumberAddress, head);
  if (head[1] > bus::kTrialRowsMost)
    throw log::DataError(link_->port + ": its trial has " + std::to_string(head[1]) +
                         " rows; expected at most " + std::to_string(bus::kTrialRowsMost));
  const auto read_all = [&](std::uint16_t base) {
    std::vector<std::uint16_t> words(head[1]);
    for (std::size_t at = 0; at < words.size(); at += MODBUS_MAX_READ_REGISTERS)
      link_->read_input(
          static_cast<std::uint16_t>(base + at),
          std::span(words).subspan(at, std::min<std::size_t>(MODBUS_MAX_READ_REGISTERS, words.size() - at)));
    return words;
  };
  const std::vector<std::uint16_t> counts = read_all(bus::kTrialCountBase),
                                   coil = read_all(bus::kTrialCoilBase);
  Trial trial;
  trial.number = head[0];
  for (std::size_t i = 0; i < counts.size(); ++i)
    trial.rows.push_back({static_cast<std::int16_t>(counts[i]), coil[i]});
  return trial;
}

}  // namespace furcula::modbus
