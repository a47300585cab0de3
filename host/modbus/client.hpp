// A robot at the other end of Modbus or CAN: what it shows, its parameters, requests to it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "furcula/bus/node_words.hpp"
#include "furcula/bus/parameters.hpp"
#include "furcula/bus/registers.hpp"
#include "host/modbus/port.hpp"

namespace furcula::modbus {

class Link;
struct Answer;

/// The robot understood and did not do it; the message says why.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Vendor, board, version and build, as the robot says them.
struct DeviceNames {
  std::string vendor, board, revision;
};

/// The last trial on the clutch's bench: a row a millisecond.
struct Trial {
  struct Row {
    int count = 0;         ///< of the cable's encoder, since the first row
    int coil_percent = 0;  ///< duty from then on
  };
  std::uint16_t number = 0;  ///< since the start; 0: there was none
  std::vector<Row> rows;
};

/// Not for several threads. Every function may throw core::DataError (no answer within the time, a broken one,
/// another version of the table), naming the port.
class Client {
 public:
  /// Opens the port and checks that what answers has our table.
  explicit Client(const Port& port, int unit = 1);
  /// Over an open link; `name` is for messages.
  Client(std::string name, std::unique_ptr<Link> link);
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  bus::Snapshot snapshot();
  DeviceNames names();
  /// Its log of faults, the newest first.
  std::vector<bus::LoggedFault> faults();
  /// In the order of bus::kParameters.
  std::vector<float> parameters();
  /// @throws Refused
  void write(const bus::Parameter& parameter, float value);
  /// Reads the session and sends key, session and request; `stop` without them. Returns when it is done: a
  /// save that a computer writes aside is waited for, kSaveWait at most. @throws Refused
  void request(bus::Request request);
  static constexpr std::chrono::seconds kSaveWait{30};
  std::uint16_t trial_number();
  Trial trial();

 private:
  void read_input(std::uint16_t first, std::span<std::uint16_t> out);
  void wait_for_save(std::uint32_t refused);
  void check(const Answer& answer, const std::string& what);

  std::string name_;
  std::unique_ptr<Link> link_;
};

}  // namespace furcula::modbus
