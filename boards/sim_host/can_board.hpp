// sim_host with a CAN bus: the simulated rig whose drive and encoders are at the other end of one, behind the
// link that real boards use. Switch and solenoid are the board's own.
#pragma once

#include <cstdint>

#include "boards/sim_host/board.hpp"
#include "boards/sim_host/can_bus.hpp"
#include "boards/sim_host/can_drive.hpp"
#include "firmware/app/can_link.hpp"

namespace furcula::sim_host {

/// Encoders answer at the instant of a tick; the drive answers a command 0.3 ms after the tick that sent it,
/// with the angle of then (the plant's at the tick).
class CanBoard {
 public:
  explicit CanBoard(const RigConfig& config)
      : rig_(config), has_cable_(config.cable_count_m > 0.0), link_(link_config(has_cable_)) {}

  /// What the controller of such a board needs beside the rest.
  static void adapt(control::Config& config) {
    config.supervisor.sample_age_max_us = firmware::kCanSampleAgeMaxUs;
  }

  // The board's seam.

  bool wait_for_tick() {
    if (!rig_.wait_for_tick()) return false;
    look_at_bus();
    look_at_drive();
    if (!awake_) {  // before the first tick the drive is asked for its angle
      exchange(link_.command({}, false));
      awake_ = true;
    }
    return true;
  }

  std::uint32_t now_us() const { return rig_.now_us(); }

  Result<control::Sample> sense() {
    send_encoders();
    for (const bus::Frame& frame : to_robot_.receive(tick())) link_.receive(frame, now_us());
    for (const bus::Frame& frame : replies_.receive(tick()))
      link_.receive(frame, now_us() - (1000u - kReplyUs));
    const control::Sample& truth = rig_.sample();
    // The robot was homed before; a node that has lost its reference says so itself.
    if (truth.home_height_m - truth.home_height_m == 0.0f)
      link_.set_home(truth.home_count, truth.home_height_m, truth.cable_home_count);
    Result<control::Sample> sample = link_.sample(now_us());
    if (!sample.ok()) return sample;
    control::Sample whole = sample.value();
    whole.contact = truth.contact;
    return whole;
  }

  Status actuate(const control::Command& command) {
    commanded_ = command;
    exchange(link_.command(command, runs_));
    return Status::ok;
  }

  void kick_watchdog() { rig_.kick_watchdog(); }
  bool take_reset_request() { return rig_.take_reset_request(); }
  void report(const firmware::Telemetry& telemetry) {
    rig_.report(telemetry);
    if (!has_node_) runs_ = telemetry.outputs.fault == control::Fault::none;
  }

  /// Before each tick of a node: from then on the drive is on while that runs, and not for as long as there is no
  /// fault.
  void set_state(bus::NodeState state) {
    has_node_ = true;
    runs_ = state == bus::NodeState::running;
  }
  firmware::CanLink& link() { return link_; }

  // What a simulation sees.

  SimBoard& rig() { return rig_; }
  /// What the controller wants; the rig's command is what the drive makes of it.
  const control::Command& commanded() const { return commanded_; }
  /// The board has started anew: what its program knew is gone.
  void restart() {
    link_ = firmware::CanLink(link_config(has_cable_));
    awake_ = runs_ = false;
  }
  const firmware::CanStatistics& statistics() const { return link_.statistics(); }

 private:
  static constexpr std::uint8_t kDriveNode = 1, kRailNode = 1, kPulleyNode = 2, kSupplyNode = 3;
  static constexpr std::uint32_t kReplyUs = 300;
  static constexpr float kLegZeroRad = 0.9f, kLegSign = -1.0f;  ///< as a motor may be mounted
  static constexpr double kSecondShaftRad = 1.0;                ///< where another robot's leg stands
  /// A CAN controller's error counter: 8 for each frame that failed, off at 256 (ISO 11898-1).
  static constexpr std::uint32_t kErrorStep = 8, kErrorOff = 256;

  static firmware::CanLinkConfig link_config(bool has_cable) {
    firmware::CanLinkConfig config;
    config.drive_node = kDriveNode;
    config.height_node = kRailNode;
    config.cable_node = has_cable ? kPulleyNode : std::uint8_t{0};
    config.supply_node = kSupplyNode;
    config.leg_zero_rad = kLegZeroRad;
    config.leg_sign = kLegSign;
    return config;
  }

  std::uint32_t tick() const { return static_cast<std::uint32_t>(std::lround(rig_.time_s() * 1e3)); }

  CanDrive::State drive_state() const {
    if (rig_.active(RigFault::drive_silent)) return CanDrive::State::dead;
    if (rig_.active(RigFault::drive_error)) return CanDrive::State::error;
    return rig_.active(RigFault::drive_off) ? CanDrive::State::off : CanDrive::State::sound;
  }

  double shaft_rad() const {
    return (rig_.plant().leg_angle_rad() - static_cast<double>(kLegZeroRad)) * static_cast<double>(kLegSign);
  }

  void look_at_drive() {
    drive_.set_motor(rig_.active(RigFault::drive_of_other_motor) ? rig_.config().other_motor
                                                                 : bus::Motor::ak80_9);
    CanDrive::InjectedErrors injected_errors;
    if (rig_.active(RigFault::drive_hot)) injected_errors.temperature_c = kHotMotorC;
    if (rig_.active(RigFault::torque_offset)) injected_errors.offset_nm = rig_.config().torque_offset_nm;
    drive_.set_injected_errors(injected_errors);
    drive_.tick(tick(), drive_state(), shaft_rad());
    const bool doubled = rig_.active(RigFault::drive_doubled);
    second_drive_.tick(tick(), doubled ? CanDrive::State::sound : CanDrive::State::dead, kSecondShaftRad);
  }

  void look_at_bus() {
    const bool corrupted = rig_.active(RigFault::frame_corrupted);
    if (corrupted) {
      link_.note(firmware::BusEvent::error);
      errors_ += kErrorStep;
    }
    const bool off = rig_.active(RigFault::bus_off) || errors_ >= kErrorOff;
    if (off && !link_.bus_is_off()) link_.note(firmware::BusEvent::off);
    if (!corrupted) errors_ = 0;
    if (!off && link_.bus_is_off()) link_.note(firmware::BusEvent::recovered);
    bus_.lost = off || corrupted || rig_.active(RigFault::frame_lost);
    bus_.late = rig_.active(RigFault::frame_late);
    bus_.repeated = rig_.active(RigFault::frame_repeated);
    bus_.reordered = rig_.active(RigFault::frame_reordered);
  }

  void send_encoders() {
    if (rig_.active(RigFault::peer_lost)) return;
    const control::Sample& truth = rig_.sample();
    const bool homed = truth.home_height_m - truth.home_height_m == 0.0f;
    send_encoder(kRailNode, truth.height_count, homed ? 0u : 1u);
    if (has_cable_) send_encoder(kPulleyNode, truth.cable_count, 0);
    bus::Frame supply = bus::empty_frame(bus::message::kSupply, kSupplyNode);
    static_cast<void>(bus::put_stamp(supply, {bus::kProtocolVersion, sequence_, 0.0f}));
    const double volts = rig_.active(RigFault::supply_high) ? kSupplyHighV : kSupplyV;
    static_cast<void>(
        bus::put(supply, bus::signal(bus::message::kSupply, "Voltage"), static_cast<float>(volts)));
    to_robot_.send(supply, tick(), bus_);
    ++sequence_;
  }

  void send_encoder(std::uint8_t node, std::uint32_t count, std::uint32_t status) {
    using bus::message::kEncoderSample;
    bus::Frame frame = bus::empty_frame(kEncoderSample, node);
    const float age_s = static_cast<float>(rig_.sample().age_us) * 1e-6f;
    static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, sequence_, age_s}));
    static_cast<void>(bus::put_raw(frame, bus::signal(kEncoderSample, "Status"), status));
    static_cast<void>(bus::put_raw(frame, bus::signal(kEncoderSample, "Count"), count));
    to_robot_.send(frame, tick(), bus_);
  }

  /// Frames to the drive, its answers, and what it makes of them.
  void exchange(const firmware::FrameBatch& batch) {
    for (const bus::Frame& frame : batch) to_drive_.send(frame, tick(), bus_);
    for (const bus::Frame& frame : to_drive_.receive(tick())) {
      if (const auto reply = drive_.receive(frame, shaft_rad())) replies_.send(*reply, tick(), bus_);
      if (const auto reply = second_drive_.receive(frame, kSecondShaftRad))
        replies_.send(*reply, tick(), bus_);
    }
    static_cast<void>(rig_.actuate({kLegSign * drive_.torque_nm(), commanded_.coil_duty}));
  }

  SimBoard rig_;
  bool has_cable_;
  firmware::CanLink link_;
  CanDrive drive_{bus::Motor::ak80_9, kDriveNode};
  CanDrive second_drive_{bus::Motor::ak80_9, kDriveNode};  ///< dead but for drive_doubled
  CanWay to_robot_, to_drive_, replies_;
  CanWay::Faults bus_;
  control::Command commanded_;
  std::uint32_t errors_ = 0;
  std::uint8_t sequence_ = 0;
  bool awake_ = false, runs_ = false, has_node_ = false;
};

static_assert(firmware::Board<CanBoard>);

}  // namespace furcula::sim_host
