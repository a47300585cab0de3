// A robot at the other end of a bus, see client.hpp.
#include "host/modbus/client.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <thread>

#include "furcula/bus/modbus_pdu.hpp"
#include "host/core/error.hpp"
#include "host/modbus/link.hpp"

namespace furcula::modbus {

Client::Client(const Port& port, int unit)
    : Client(port.text, port.can_interface.empty() ? open_modbus(port, unit) : open_can(port)) {}

Client::Client(std::string name, std::unique_ptr<Link> link)
    : name_(std::move(name)), link_(std::move(link)) {
  std::uint16_t version = 0;
  read_input(0, {&version, 1});
  if (version != bus::kRegistersVersion)
    throw core::DataError(name_ + ": it has version " + std::to_string(version) +
                          " of the table of registers; expected " + std::to_string(bus::kRegistersVersion));
}

Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

void Client::read_input(std::uint16_t first, std::span<std::uint16_t> out) {
  const Answer answer = link_->read(Link::Table::input, first, out);
  if (answer.exception != bus::ModbusException::none)
    throw core::DataError(name_ + ": reading its input registers: " + answer.text);
}

/// Where the robot refused: its last refusal says why.
void Client::check(const Answer& answer, const std::string& what) {
  using bus::ModbusException;
  if (answer.exception == ModbusException::none) return;
  if (answer.exception != ModbusException::illegal_address &&
      answer.exception != ModbusException::illegal_value &&
      answer.exception != ModbusException::device_failure)
    throw core::DataError(name_ + ": " + what + ": " + answer.text);
  std::uint16_t number = 0;
  read_input(4, {&number, 1});
  const bool known = number != 0 && number < bus::kRefusals.size();
  throw Refused(what + ": refused: " + (known ? std::string(bus::kRefusals[number].meaning) : answer.text));
}

bus::Snapshot Client::snapshot() {
  std::array<std::uint16_t, bus::kInputWords> words{};
  read_input(0, words);
  return bus::from_words(words);
}

std::vector<bus::LoggedFault> Client::faults() {
  std::array<std::uint16_t, bus::kLogWords> words{};
  read_input(bus::kLogBase, words);
  std::vector<bus::LoggedFault> entries;
  for (std::size_t i = 0; i < bus::kLoggedFaults; ++i) {
    const bus::LoggedFault entry = bus::logged_fault(std::span(words).subspan(i * bus::kLogEntryWords));
    if (entry.fault != 0) entries.push_back(entry);
  }
  return entries;
}

DeviceNames Client::names() {
  DeviceNames names;
  names.vendor = link_->text(0);
  names.board = link_->text(1);
  names.revision = link_->text(2);
  return names;
}

std::vector<float> Client::parameters() {
  std::array<std::uint16_t, bus::kParameterWords> words{};
  const Answer answer = link_->read(Link::Table::holding, bus::kParameterBase, words);
  if (answer.exception != bus::ModbusException::none)
    throw core::DataError(name_ + ": reading its parameters: " + answer.text);
  std::vector<float> values;
  for (std::size_t i = 0; i < words.size(); i += 2)
    values.push_back(std::bit_cast<float>(bus::bits_of(words[i], words[i + 1])));
  return values;
}

void Client::write(const bus::Parameter& parameter, float value) {
  check(link_->write(bus::address_of(parameter), std::bit_cast<std::uint32_t>(value)),
        std::string(parameter.name));
}

void Client::request(bus::Request request) {
  std::uint16_t session = 0;
  std::uint32_t refused = 0;
  if (request == bus::Request::save) {
    const bus::Snapshot before = snapshot();
    session = before.session;
    refused = before.requests_refused;
  } else if (request != bus::Request::stop) {
    read_input(5, {&session, 1});
  }
  const Answer answer = link_->request(session, request);
  if (request == bus::Request::save && answer.exception == bus::ModbusException::acknowledge)
    wait_for_save(refused);
  else
    check(answer, std::string(bus::info(request).name));
}

/// A save that goes on beside the ticks; `refused` is how many requests had been refused before it.
void Client::wait_for_save(std::uint32_t refused) {
  const auto limit = std::chrono::steady_clock::now() + kSaveWait;
  bus::Snapshot now = snapshot();
  while (now.parameter_origin == static_cast<std::uint16_t>(bus::ParameterOrigin::being_saved)) {
    if (std::chrono::steady_clock::now() >= limit)
      throw core::DataError(
          name_ + ": save: not done after " + std::to_string(kSaveWait.count()) +
          " s, and still going on; parameter_origin of furcula monitor says when it is done");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    now = snapshot();
  }
  if (now.requests_refused != refused &&
      now.last_refusal == static_cast<std::uint16_t>(bus::Refusal::store_failed))
    throw Refused("save: refused: " + std::string(bus::kRefusals[now.last_refusal].meaning));
  if (now.parameter_origin != static_cast<std::uint16_t>(bus::ParameterOrigin::store))
    throw Refused("save: the parameters were changed while they were saved; save them once more");
}

std::uint16_t Client::trial_number() {
  std::uint16_t number = 0;
  read_input(bus::kTrialNumberAddress, {&number, 1});
  return number;
}

Trial Client::trial() {
  std::array<std::uint16_t, 2> head{};
  read_input(bus::kTrialNumberAddress, head);
  if (head[1] > bus::kTrialRowsMost)
    throw core::DataError(name_ + ": its trial has " + std::to_string(head[1]) + " rows; expected at most " +
                          std::to_string(bus::kTrialRowsMost));
  constexpr std::size_t kMost = bus::modbus::kReadMax;
  const auto read_all = [&](std::uint16_t base) {
    std::vector<std::uint16_t> words(head[1]);
    for (std::size_t at = 0; at < words.size(); at += kMost)
      read_input(static_cast<std::uint16_t>(base + at),
                 std::span(words).subspan(at, std::min(kMost, words.size() - at)));
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
