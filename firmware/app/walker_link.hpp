// Between the CAN frames of a walking biped and its controller's words: replies of twelve drives on a bus a leg, IMU, feet and pins
// on the body's bus in, commands out. What is lost, late, repeated, reordered or malformed is counted, and did not answer. No clock and
// no I/O: a board hands in frames and time. The buses' ids and loads: docs/bus.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/app/can_faults.hpp"
#include "firmware/app/can_frames.hpp"
#include "firmware/app/can_presence.hpp"
#include "firmware/app/can_sources.hpp"
#include "firmware/app/host_stream.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/motor_frames.hpp"
#include "furcula/bus/stream.hpp"
#include "furcula/bus/walker_nodes.hpp"
#include "furcula/control/fault.hpp"
#include "furcula/control/walk/walker.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// The left leg's, the right one's, the body's.
inline constexpr std::size_t kWalkerLinks = bus::kWalkerBuses + 1;
inline constexpr std::size_t kBodyBus = bus::kWalkerBuses;

struct WalkerLinkConfig {
  std::uint8_t self_node = 1;                  ///< whose command frames are obeyed
  std::uint8_t body_node = 1;                  ///< of IMU, feet and pins
  float temperature_max_c = 90.0f;             ///< of the drives' replies
  bus::StreamLimits requests{0.020f, 0.100f};  ///< of command frames, as bus/stream.hpp has them
};

inline Status check(const WalkerLinkConfig& c) {
  const auto is_node = [](std::uint8_t n) { return n >= bus::kFirstNode && n <= bus::kLastNode; };
  return is_node(c.self_node) && is_node(c.body_node) && is_finite(c.temperature_max_c) ? Status::ok
                                                                                        : Status::invalid;
}

/// Until each drive was told to switch on as often as it is: it has its turn in every second tick.
inline constexpr std::uint32_t kSwitchOnTicks = 2 * kEnterTimes;

/// The ids that WalkerLink hears on one of its buses, for the filters of a board's receiver.
class WalkerHeardIds {
 public:
  WalkerHeardIds(const WalkerLinkConfig& c, std::size_t bus) {
    using namespace bus::message;
    if (bus == kBodyBus) {
      for (const bus::Message* m : {&kGyro, &kAcceleration, &kFeet, &kPins}) add(*m, c.body_node);
      // This node alone sends its heartbeat: who else does has its id.
      for (const bus::Message* m : {&kCommand, &kHeartbeat}) add(*m, c.self_node);
      return;
    }
    add(kMotorReply, bus::kFirstNode);
    for (const bus::WalkerDrive& d : bus::kWalkerDrives)
      if (d.bus == bus) add(kMotorCommand, d.node);
  }
  const std::uint32_t* begin() const { return ids_.data(); }
  const std::uint32_t* end() const { return ids_.data() + size_; }

 private:
  void add(const bus::Message& message, std::uint8_t node) { ids_[size_++] = bus::id_of(message, node); }
  std::array<std::uint32_t, 8> ids_{};
  std::size_t size_ = 0;
};

class WalkerLink {
 public:
  /// With a configuration that check() refuses it hears nothing and sends nothing.
  explicit WalkerLink(const WalkerLinkConfig& config)
      : config_(config), sound_(check(config) == Status::ok), host_(config.requests) {}

  /// A frame that came on bus `bus` at `now_us`, any frame at all. A length code of 9 to 15 means 8 bytes (ISO 11898-1).
  void receive(std::size_t bus, const bus::Frame& frame, std::uint32_t now_us) {
    bus::Frame whole = frame;
    if (whole.size > whole.data.size()) whole.size = static_cast<std::uint8_t>(whole.data.size());
    ++statistics_.received;
    if (!sound_ || whole.extended || whole.remote)
      ++statistics_.foreign;
    else if (bus == kBodyBus)
      hear_body(whole, now_us);
    else
      hear_leg(bus, whole, now_us);
  }
  /// What a CAN controller reports.
  void note(std::size_t bus, BusEvent event) { watches_[bus].note(event, statistics_); }
  bool bus_is_off(std::size_t bus) const { return watches_[bus].is_off(); }

  /// What came since it was last asked: to be called on every tick, once.
  control::WalkerSample sample(std::uint32_t now_us) {
    bool off = false;
    for (BusWatch& watch : watches_) off = watch.take_off() || off;
    static_cast<void>(host_.age_us(now_us));
    control::WalkerSample out = sample_;
    sample_.answered = 0;
    control::Fault fault = control::Fault::none;
    out.reported_by = control::kNoJoint;
    if (off)
      fault = control::Fault::bus_off;
    else if (own_ids_heard_.age_us(now_us) < kOwnIdsForgottenUs)
      fault = control::Fault::node_id_taken;
    for (std::size_t i = 0; i < control::kWalkerJoints && fault == control::Fault::none; ++i) {
      if (errors_[i] != 0)
        fault = fault_of_drive(errors_[i]);
      else if (is_hot(temperatures_[i], config_.temperature_max_c))
        fault = control::Fault::drive_hot;
      if (fault != control::Fault::none) out.reported_by = static_cast<std::uint32_t>(i);
    }
    out.reported_fault = static_cast<std::uint32_t>(fault);
    return out;
  }

  /// The next tick's frames, a batch a bus, to be sent at once. A drive whose turn it is gets its command, and answers it. `run`: the
  /// drives shall be on, which takes kSwitchOnTicks; while they are not they are told to switch their motors off, which they answer
  /// too, so that their angles are known all the time. After a fault drives that were on brake, and others stay off.
  std::array<FrameBatch, kWalkerLinks> command(const control::WalkerOutputs& told, bool run) {
    std::array<FrameBatch, kWalkerLinks> out;
    if (!sound_) return out;
    if (run || told.stage != control::WalkerStage::damped) on_ = run;
    for (std::size_t i = 0; i < control::kWalkerJoints; ++i)
      if (bus::has_turn(i, tick_)) out[bus::kWalkerDrives[i].bus].add(frame_for(i, told));
    if (tick_ % kPinTicks == 0 || told.pin_targets != pin_targets_) out[kBodyBus].add(pin_frame(told));
    ++tick_;
    return out;
  }

  const CanStatistics& statistics() const { return statistics_; }
  HostStream& host() { return host_; }
  CanRequest take_request() { return host_.take(); }

 private:
  static constexpr std::uint32_t kPinTicks = 10;

  void hear_leg(std::size_t bus, const bus::Frame& frame, std::uint32_t now_us) {
    using namespace bus::message;
    for (std::size_t i = 0; i < control::kWalkerJoints; ++i) {
      const bus::WalkerDrive& drive = bus::kWalkerDrives[i];
      if (drive.bus != bus) continue;
      if (frame.id == bus::id_of(kMotorCommand, drive.node)) {
        ++statistics_.own_ids;
        own_ids_heard_.note(now_us);
        return;
      }
      const Result<bus::MotorReply> reply = bus::unpack_reply(frame, bus::kWalkerMotor, drive.node);
      if (!reply.ok()) continue;
      const bus::MotorReply& r = reply.value();
      sample_.joints[i] = {r.position_rad, still_or(r.velocity_radps), r.torque_nm};
      sample_.answered |= 1u << i;
      temperatures_[i] = r.temperature;
      errors_[i] = r.error;
      if (r.error != 0) ++statistics_.drive_errors;
      return;
    }
    ++statistics_.foreign;
  }

  /// The packing has no rate of zero: half a step to either side of it is none. An angle that is bridged then stands still as the
  /// shaft does, as what looks for an encoder that is stuck takes for granted.
  static float still_or(float rate_radps) {
    constexpr float kMost = 0.6f * 2.0f * bus::info(bus::kWalkerMotor).velocity_max_radps / 4095.0f;
    return rate_radps < kMost && rate_radps > -kMost ? 0.0f : rate_radps;
  }

  void hear_body(const bus::Frame& frame, std::uint32_t now_us) {
    using namespace bus::message;
    const auto of = [&](const bus::Message& message, std::uint8_t node) {
      return frame.id == bus::id_of(message, node);
    };
    if (of(kCommand, config_.self_node)) {
      host_.hear(frame, now_us, statistics_);
    } else if (of(kHeartbeat, config_.self_node)) {
      ++statistics_.own_ids;
      own_ids_heard_.note(now_us);
    } else if (of(kGyro, config_.body_node)) {
      if (well_formed(frame, kGyro)) hear_gyro(frame);
    } else if (of(kAcceleration, config_.body_node)) {
      if (well_formed(frame, kAcceleration) && is_fresh(imu_, frame, now_us)) hear_acceleration(frame);
    } else if (of(kFeet, config_.body_node)) {
      if (!well_formed(frame, kFeet) || !is_fresh(feet_, frame, now_us)) return;
      sample_.foot_n = {value(frame, bus::signal(kFeet, "Left")), value(frame, bus::signal(kFeet, "Right"))};
      sample_.answered |= 1u << control::kFeetDevice;
    } else if (of(kPins, config_.body_node)) {
      if (!well_formed(frame, kPins) || !is_fresh(pins_, frame, now_us)) return;
      sample_.pins = {
          value(frame, bus::signal(kPins, "Left_Hip")), value(frame, bus::signal(kPins, "Left_Knee")),
          value(frame, bus::signal(kPins, "Right_Hip")), value(frame, bus::signal(kPins, "Right_Knee"))};
      sample_.answered |= 1u << control::kPinsDevice;
    } else {
      ++statistics_.foreign;
    }
  }

  bool well_formed(const bus::Frame& frame, const bus::Message& message) {
    if (frame.size == message.size) return true;
    ++statistics_.malformed;
    return false;
  }
  static float value(const bus::Frame& frame, const bus::Signal& signal) {
    return bus::get(frame, signal).value();
  }
  static bool has_signal(const bus::Frame& frame) {
    return bus::get_raw(frame, bus::table::device_status()).value() == 0;
  }

  struct Source {
    bus::Stream stream;
    LastHeard heard;
  };
  /// Whether the next sample of a device that measures is in it, not too old.
  bool is_fresh(Source& source, const bus::Frame& frame, std::uint32_t now_us) {
    const std::uint32_t since_us = source.heard.age_us(now_us);
    source.heard.note(now_us);
    return judge(source.stream, bus::StreamLimits{}, frame, since_us, statistics_).ok() && has_signal(frame);
  }

  /// Half of a sample: the other one is to follow, with the same number.
  void hear_gyro(const bus::Frame& frame) {
    using bus::message::kGyro;
    if (bus::get_raw(frame, bus::table::version()).value() != bus::kProtocolVersion) {
      ++statistics_.other_version;
      return;
    }
    gyro_good_ = has_signal(frame);
    gyro_number_ = frame.data[1];
    gyro_radps_ = {value(frame, bus::signal(kGyro, "Rate_X")), value(frame, bus::signal(kGyro, "Rate_Y")),
                   value(frame, bus::signal(kGyro, "Rate_Z"))};
  }
  void hear_acceleration(const bus::Frame& frame) {
    using bus::message::kAcceleration;
    if (!gyro_good_ || gyro_number_ != frame.data[1]) {
      ++statistics_.lost;
      return;
    }
    gyro_good_ = false;
    sample_.gyro_radps = gyro_radps_;
    sample_.acc_mps2 = {value(frame, bus::signal(kAcceleration, "Acceleration_X")),
                        value(frame, bus::signal(kAcceleration, "Acceleration_Y")),
                        value(frame, bus::signal(kAcceleration, "Acceleration_Z"))};
    sample_.answered |= 1u << control::kImuDevice;
  }

  bus::Frame frame_for(std::size_t i, const control::WalkerOutputs& told) {
    const std::uint8_t node = bus::kWalkerDrives[i].node;
    const control::JointCommand& c = told.joints[i];
    const bool off = told.stage == control::WalkerStage::damped && c.damping_nmsprad == 0.0f;
    if (!on_ || off) {
      entered_[i] = 0;
      return bus::empty_frame(bus::message::kMotorExit, node);
    }
    // In the place of commands: the bus has no room for both.
    if (entered_[i] < kEnterTimes) {
      ++entered_[i];
      return bus::empty_frame(bus::message::kMotorEnter, node);
    }
    bus::MotorCommand motor;
    motor.position_rad = c.target_rad;
    motor.stiffness_nmpr = c.stiffness_nmprad;
    motor.damping_nmspr = c.damping_nmsprad;
    const Result<bus::Frame> frame = bus::pack(motor, bus::kWalkerMotor, node);
    // A command that is no number is none.
    return frame.ok() ? frame.value() : bus::empty_frame(bus::message::kMotorExit, node);
  }

  bus::Frame pin_frame(const control::WalkerOutputs& told) {
    using bus::message::kPinTargets;
    pin_targets_ = told.pin_targets;
    bus::Frame frame = stamped(kPinTargets, config_.body_node, pin_sequence_, 0.0f);
    put_value(frame, bus::signal(kPinTargets, "Left_Hip"), pin_targets_[0]);
    put_value(frame, bus::signal(kPinTargets, "Left_Knee"), pin_targets_[1]);
    put_value(frame, bus::signal(kPinTargets, "Right_Hip"), pin_targets_[2]);
    put_value(frame, bus::signal(kPinTargets, "Right_Knee"), pin_targets_[3]);
    return frame;
  }

  WalkerLinkConfig config_;
  bool sound_;
  CanStatistics statistics_;
  std::array<BusWatch, kWalkerLinks> watches_;
  control::WalkerSample sample_;  ///< the newest of each device
  std::array<std::uint8_t, control::kWalkerJoints> temperatures_{}, errors_{}, entered_{};
  Source imu_, feet_, pins_;
  dynamics::tree::Vec3<float> gyro_radps_{};
  std::uint8_t gyro_number_ = 0;
  bool gyro_good_ = false, on_ = false;
  LastHeard own_ids_heard_;
  HostStream host_;
  std::array<float, control::kWalkerPins> pin_targets_{};
  std::uint8_t pin_sequence_ = 0;
  std::uint32_t tick_ = 0;
};

}  // namespace furcula::firmware
