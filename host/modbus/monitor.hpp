// What a robot shows, as a person or a program reads it.
#pragma once

#include <string>
#include <vector>

#include "furcula/bus/registers.hpp"
#include "host/modbus/client.hpp"

namespace furcula::modbus {

/// Why it does not move, in words; where a fault holds it, with the fault's meaning and remedy.
std::string reason_text(const bus::Snapshot& snapshot);

/// What a robot showed.
struct View {
  DeviceNames names;
  bus::Snapshot snapshot;
  std::vector<bus::LoggedFault> faults;  ///< the newest first
};

/// A page of some lines, without control characters.
std::string to_text(const View& view);

/// One line: an object with every input register by its name, and `state_name`, `reason_text`, `fault_name`,
/// `board`, `revision`, `reset_cause_name`, `unique_id` and the array `faults`. What is not a number is null.
std::string to_json(const View& view);

}  // namespace furcula::modbus
