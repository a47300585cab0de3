#include "host/walk/walker_devices.hpp"

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/motor_frames.hpp"
#include "furcula/bus/stream.hpp"
#include "furcula/bus/walker_nodes.hpp"

namespace furcula::walk {
namespace {

using namespace bus::message;

constexpr std::uint8_t kNode = 1;
constexpr std::uint32_t kWatchdogTicks = 5;
constexpr std::uint8_t kNoSignal = 2, kSomeError = 2;

void set(bus::Frame& frame, const bus::Signal& signal, float value) {
  static_cast<void>(bus::put(frame, signal, value));
}
void set_code(bus::Frame& frame, const bus::Signal& signal, std::uint32_t raw) {
  static_cast<void>(bus::put_raw(frame, signal, raw));
}
float told_value(const bus::Frame& frame, std::size_t signal) {
  return bus::get(frame, bus::with_range(bus::table::kMotorCommand[signal], bus::info(bus::kWalkerMotor)))
      .value();
}
WalkerRigConfig asked_in_each_tick(WalkerRigConfig config) {
  config.two_buses = false;
  return config;
}

}  // namespace

WalkerDevices::WalkerDevices(const WalkerRigConfig& config) : rig_(asked_in_each_tick(config)) {}

bus::Frame WalkerDevices::stamped(const bus::Message& message, std::uint8_t sequence) const {
  bus::Frame frame = bus::empty_frame(message, kNode);
  static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, sequence, age_s_}));
  return frame;
}

std::vector<bus::Frame> WalkerDevices::speak() {
  sample_ = rig_.sense().sample;
  const auto& g = sample_.gyro_radps;
  const auto& a = sample_.acc_mps2;
  const std::uint8_t sequence = sequence_++;
  std::vector<bus::Frame> out;
  const auto answers = [&](std::uint32_t device) { return (sample_.answered >> device & 1u) != 0; };
  if (answers(control::kImuDevice)) {
    bus::Frame gyro = bus::empty_frame(kGyro, kNode);
    set_code(gyro, bus::table::version(), bus::kProtocolVersion);
    set_code(gyro, bus::table::sequence(), sequence);
    if (g.x != g.x) set_code(gyro, bus::table::device_status(), kNoSignal);
    set(gyro, bus::signal(kGyro, "Rate_X"), g.x);
    set(gyro, bus::signal(kGyro, "Rate_Y"), g.y);
    set(gyro, bus::signal(kGyro, "Rate_Z"), g.z);
    bus::Frame acc = stamped(kAcceleration, sequence);
    set(acc, bus::signal(kAcceleration, "Acceleration_X"), a.x);
    set(acc, bus::signal(kAcceleration, "Acceleration_Y"), a.y);
    set(acc, bus::signal(kAcceleration, "Acceleration_Z"), a.z);
    out.push_back(gyro);
    out.push_back(acc);
  }
  if (answers(control::kFeetDevice)) {
    bus::Frame feet = stamped(kFeet, sequence);
    set(feet, bus::signal(kFeet, "Left"), sample_.foot_n[0]);
    set(feet, bus::signal(kFeet, "Right"), sample_.foot_n[1]);
    out.push_back(feet);
  }
  if (answers(control::kPinsDevice)) {
    bus::Frame pins = stamped(kPins, sequence);
    set(pins, bus::signal(kPins, "Left_Hip"), sample_.pins[0]);
    set(pins, bus::signal(kPins, "Left_Knee"), sample_.pins[1]);
    set(pins, bus::signal(kPins, "Right_Hip"), sample_.pins[2]);
    set(pins, bus::signal(kPins, "Right_Knee"), sample_.pins[3]);
    out.push_back(pins);
  }
  return out;
}

bus::Frame WalkerDevices::reply(std::size_t i) const {
  bus::Frame frame = bus::empty_frame(kMotorReply, bus::kWalkerDrives[i].node);
  const control::JointReading& r = sample_.joints[i];
  const float measured[] = {r.angle_rad, r.rate_radps, r.torque_nm};
  for (std::size_t k = 0; k < 3; ++k)
    set(frame, bus::with_range(bus::table::kMotorReply[k + 1], bus::info(bus::kWalkerMotor)), measured[k]);
  frame.data[6] = 25;
  if (sample_.reported_fault != 0 && sample_.reported_by == i) frame.data[7] = kSomeError;
  return frame;
}

std::optional<bus::Frame> WalkerDevices::hear(std::size_t bus, const bus::Frame& frame) {
  if (bus == kWalkerBodyBus) {
    if (bus::is(frame, kPinTargets, kNode)) {
      static constexpr std::array<const bus::Signal*, control::kWalkerPins> kSignals{
          &bus::signal(kPinTargets, "Left_Hip"), &bus::signal(kPinTargets, "Left_Knee"),
          &bus::signal(kPinTargets, "Right_Hip"), &bus::signal(kPinTargets, "Right_Knee")};
      for (std::size_t pin = 0; pin < kSignals.size(); ++pin)
        told_.pin_targets[pin] = bus::get(frame, *kSignals[pin]).value();
    } else if (bus::is(frame, kWalkState, kNode)) {
      told_.stage =
          static_cast<control::WalkerStage>(bus::get_raw(frame, bus::signal(kWalkState, "Stage")).value());
    }
    return std::nullopt;
  }
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i) {
    const bus::WalkerDrive& d = bus::kWalkerDrives[i];
    Drive& drive = drives_[i];
    if (d.bus != bus || frame.id != bus::id_of(kMotorCommand, d.node)) continue;
    drive.silent_ticks = 0;
    if (bus::is(frame, kMotorEnter, d.node)) {
      if (!drive.on) drive.told = {};
      drive.on = true;
    } else if (bus::is(frame, kMotorExit, d.node)) {
      drive.on = false;
    } else {
      drive.told = {told_value(frame, 0), told_value(frame, 2), told_value(frame, 3)};
    }
    if ((sample_.answered >> i & 1u) == 0) return std::nullopt;
    return reply(i);
  }
  return std::nullopt;
}

void WalkerDevices::advance() {
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i) {
    Drive& drive = drives_[i];
    if (++drive.silent_ticks > kWatchdogTicks) drive.on = false;
    told_.joints[i] = drive.on ? drive.told : control::JointCommand{};
  }
  rig_.advance(told_);
}

}  // namespace furcula::walk
