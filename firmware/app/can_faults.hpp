// What a CAN controller, a drive's error code and a stranger on the bus are to a robot's link.
#pragma once

#include <cstdint>

#include "firmware/app/can_sources.hpp"
#include "furcula/control/fault.hpp"

namespace furcula::firmware {

/// What a board's CAN controller says of itself.
enum class BusEvent : std::uint8_t { error, off, recovered };

class BusWatch {
 public:
  void note(BusEvent event, CanStatistics& statistics) {
    if (event == BusEvent::error) ++statistics.error_frames;
    if (event == BusEvent::off && !off_) ++statistics.bus_off;
    if (event == BusEvent::off) went_off_ = true;
    if (event != BusEvent::error) off_ = event == BusEvent::off;
  }
  bool is_off() const { return off_; }
  /// Whether it is off, or was since it was last asked: one that ended before anybody asked is told once.
  bool take_off() {
    const bool was = off_ || went_off_;
    went_off_ = false;
    return was;
  }

 private:
  bool off_ = false, went_off_ = false;
};

/// What the error code of a CubeMars drive's reply means ("AK Series Actuator Driver Manual", the
/// table of error codes); the rest is drive_fault.
inline constexpr std::uint8_t kErrorMotorHot = 1, kErrorSupplyHigh = 3, kErrorInverterHot = 6;

inline control::Fault fault_of_drive(std::uint8_t error) {
  if (error == kErrorMotorHot || error == kErrorInverterHot) return control::Fault::drive_hot;
  return error == kErrorSupplyHigh ? control::Fault::supply_too_high : control::Fault::drive_fault;
}

/// A byte from 128 on is a temperature below zero.
inline bool is_hot(std::uint8_t temperature, float most_c) {
  return temperature < 128 && static_cast<float>(temperature) > most_c;
}

/// Of frames that the node alone sends, heard from another: longer than two of another node's heartbeats, so that as long as
/// it is there a reset does not help.
inline constexpr std::uint32_t kOwnIdsForgottenUs = 250000;

/// Said several times when a drive is switched on: one of them may be lost, and no reply tells whether the motor is on.
inline constexpr std::uint32_t kEnterTimes = 3;

}  // namespace furcula::firmware
