// Between CAN frames and the controller's words: replies of the motor's drive and samples of encoder nodes
// in, commands to the drive out; requests of a host in. What is lost, late, repeated, reordered or malformed
// is counted, and becomes an age or a fault. No clock and no I/O: a board hands in frames and time.
// What the robot tells the bus of itself: can_telemetry.hpp.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/app/can_faults.hpp"
#include "firmware/app/can_frames.hpp"
#include "firmware/app/can_registers.hpp"
#include "firmware/app/can_sources.hpp"
#include "firmware/app/drive_watch.hpp"
#include "firmware/app/host_stream.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/motor_frames.hpp"
#include "furcula/bus/stream.hpp"
#include "furcula/control/fault.hpp"
#include "furcula/control/sample.hpp"
#include "furcula/core/count.hpp"
#include "furcula/core/sine.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// The frame of a source that is sent every millisecond is up to 1.2 ms old when it is read; where one is
/// lost 2.2 ms. For control::SupervisorConfig::sample_age_max_us of a controller whose sensors are on a bus:
/// one lost frame is bridged, two running are a fault.
inline constexpr std::uint32_t kCanSampleAgeMaxUs = 2500;

struct CanLinkConfig {
  bus::Motor motor = bus::Motor::ak80_9;
  std::uint8_t drive_node = 1;   ///< of the motor's drive
  std::uint8_t height_node = 1;  ///< of the rail's encoder; 0: read by the board itself
  std::uint8_t cable_node = 0;   ///< of the encoder on the clutch's pulley; 0: read by the board, or none
  std::uint8_t self_node = 1;    ///< whose command frames are obeyed, and whose registers are asked for
  /// leg angle = zero + sign * motor angle / gear; torques the other way round. The gear is beyond the
  /// drive's own: turns of its shaft to one of the leg's joint.
  float leg_zero_rad = 0.0f;
  float leg_sign = 1.0f;  ///< 1 or -1
  float gear = 1.0f;
  std::uint32_t silent_us = kCanSampleAgeMaxUs;  ///< a source that has said nothing for longer is lost
  /// What the drive reports may be so far outside of what it was commanded in its last replies, for so long
  /// (its lag, its friction, ripple), before it counts as not obeying.
  float torque_tolerance_nm = 1.5f;
  float torque_tolerance = 0.2f;  ///< and this share of the command
  std::uint32_t disobeys_us = 50000;
  /// By which its mean may be off over kMeanReplies, which no lag, ripple or pulse is: an offset.
  float torque_offset_nm = 0.5f;
  std::uint8_t supply_node = 0;     ///< measures the drive's supply; 0: none
  float supply_max_v = 52.0f;       ///< above: the motor feeds back into a supply that takes nothing
  float temperature_max_c = 90.0f;  ///< of the drive's replies
  /// By which the velocity that the drive reports may be off that of its position: another motor's range.
  float velocity_tolerance = 0.25f;
  /// Of command frames, as bus/stream.hpp has them.
  bus::StreamLimits requests{0.020f, 0.100f};
  /// So many frames lost, unanswered or out of order, less one in ten ticks, are a bus that cannot be relied
  /// on.
  std::uint32_t troubles_max = 10;
};

/// Whether every number makes sense.
inline Status check(const CanLinkConfig& c) {
  const auto is_node = [](std::uint8_t n) { return n >= bus::kFirstNode && n <= bus::kLastNode; };
  const bool nodes = is_node(c.drive_node) && is_node(c.self_node) &&
                     (c.height_node == 0 || is_node(c.height_node)) &&
                     (c.cable_node == 0 || (is_node(c.cable_node) && c.cable_node != c.height_node)) &&
                     (c.supply_node == 0 || is_node(c.supply_node));
  const bool numbers = is_finite(c.leg_zero_rad) && (c.leg_sign == 1.0f || c.leg_sign == -1.0f) &&
                       is_finite(c.gear) && c.gear > 0.0f && is_finite(c.torque_tolerance_nm) &&
                       c.torque_tolerance_nm > 0.0f && is_finite(c.torque_tolerance) &&
                       c.torque_tolerance >= 0.0f && is_finite(c.torque_offset_nm) &&
                       c.torque_offset_nm > 0.0f && is_finite(c.supply_max_v) && c.supply_max_v > 0.0f &&
                       is_finite(c.temperature_max_c) && c.velocity_tolerance > 0.0f;
  const bool motor = static_cast<std::size_t>(c.motor) < bus::kMotors.size();
  return nodes && numbers && motor && c.silent_us > 0 ? Status::ok : Status::invalid;
}

/// The ids that CanLink hears, for the filters of a board's receiver. Two of them this node alone sends: who else
/// does has its id, or commands its drive.
class HeardIds {
 public:
  constexpr explicit HeardIds(const CanLinkConfig& c) {
    add(bus::message::kMotorReply, c.drive_node);
    add(bus::message::kCommand, c.self_node);
    add(bus::message::kRegisterRequest, c.self_node);
    add(bus::message::kHeartbeat, c.self_node);
    add(bus::message::kMotorCommand, c.drive_node);
    for (const std::uint8_t node : {c.height_node, c.cable_node})
      if (node != 0) add(bus::message::kEncoderSample, node);
    if (c.supply_node != 0) add(bus::message::kSupply, c.supply_node);
  }
  constexpr const std::uint32_t* begin() const { return ids_.data(); }
  constexpr const std::uint32_t* end() const { return ids_.data() + size_; }
  static constexpr std::size_t kMost = 8;

 private:
  constexpr void add(const bus::Message& message, std::uint8_t node) {
    ids_[size_++] = bus::id_of(message, node);
  }
  std::array<std::uint32_t, kMost> ids_{};
  std::size_t size_ = 0;
};

/// The newest reply of the drive, in the leg's terms.
struct DriveReading {
  float leg_angle_rad = 0.0f;
  float leg_velocity_radps = 0.0f;
  float torque_nm = 0.0f;        ///< as the drive reports it, positive flexes the leg
  std::uint8_t temperature = 0;  ///< as the drive sends it; 0 in short replies
  std::uint8_t error = 0;        ///< 0: none
};

class CanLink {
 public:
  /// With a configuration that check() refuses it hears nothing and sends nothing.
  explicit CanLink(const CanLinkConfig& config)
      : config_(config),
        sound_(check(config) == Status::ok),
        host_(config.requests),
        registers_(config.self_node) {}

  /// Where the counters read what is home, as control::Sample has it.
  void set_home(std::uint32_t height_count, float height_m, std::uint32_t cable_count) {
    home_count_ = height_count;
    home_height_m_ = height_m;
    cable_home_count_ = cable_count;
  }

  /// On the clutch's bench there is neither drive nor rail: they are not waited for, and nothing is sent.
  void set_on_bench(bool on_bench) { on_bench_ = on_bench; }
  bool on_bench() const { return on_bench_; }

  /// A frame that came at `now_us`, any frame at all. A length code of 9 to 15 means 8 bytes (ISO 11898-1): a driver that
  /// hands it on as it is loses no stop.
  void receive(const bus::Frame& frame, std::uint32_t now_us) {
    bus::Frame whole = frame;
    if (whole.size > whole.data.size()) whole.size = static_cast<std::uint8_t>(whole.data.size());
    hear(whole, now_us);
  }

  /// What the CAN controller reports.
  void note(BusEvent event) { bus_watch_.note(event, statistics_); }

  /// All that the bus knows of a sample: to be called on every tick, once. Fields of sensors that the board
  /// reads itself are 0, for the board to fill in. `disconnected`: a sensor or the drive was never heard.
  Result<control::Sample> sample(std::uint32_t now_us) {
    control::Sample sample;
    sample.home_count = home_count_;
    sample.home_height_m = home_height_m_;
    sample.cable_home_count = cable_home_count_;
    sample.leg_angle_rad = drive_.leg_angle_rad;
    const std::uint32_t drive_age_us = drive_heard_.age_us(now_us);
    sample.age_us = on_bench_ ? 0 : drive_age_us;
    const control::Fault of_drive = on_bench_ ? control::Fault::none : drive_fault(now_us);
    control::Fault fault = bus_watch_.take_off() ? control::Fault::bus_off
                           : own_ids_heard_.age_us(now_us) < kOwnIdsForgottenUs
                               ? control::Fault::node_id_taken
                               : of_drive;
    static_cast<void>(host_.age_us(now_us));
    if (on_bench_) height_.let_pass(now_us);
    const bool unreliable = note_troubles();
    bool heard = on_bench_ || drive_heard_.heard;
    if (config_.height_node != 0 && !on_bench_) {
      sample.height_count = height_.count();
      if (!height_.homed()) sample.home_height_m = kNotHomed;
      heard = listen(height_, now_us, sample, fault) && heard;
    }
    if (config_.cable_node != 0) {
      sample.cable_count = cable_.count();
      heard = listen(cable_, now_us, sample, fault) && heard;
      if (!cable_.homed() && fault == control::Fault::none) fault = control::Fault::cable_implausible;
    }
    if (config_.supply_node != 0 && !on_bench_) heard = watch_supply(now_us, fault) && heard;
    if (unreliable && fault == control::Fault::none) fault = control::Fault::bus_unreliable;
    sample.reported_fault = static_cast<std::uint32_t>(fault);
    // Silence of what was heard before is told by its fault, and so by its name.
    if (!sound_ || (!heard && fault == control::Fault::none)) return Status::disconnected;
    return sample;
  }

  /// The frames of one tick for the drive, to be sent at once. `run`: the drive shall be on; it is to be
  /// false while the robot is idle or in a fault. The drive then is told on each tick to switch its motor
  /// off, which it answers as it does a command, so that the leg's angle is known all the time. (A torque of
  /// 0 alone is one of half a step, 4 mN m, on the drive.)
  FrameBatch command(const control::Command& command, bool run) {
    FrameBatch batch;
    if (!sound_) return batch;
    if (on_bench_) {
      entered_ = awaited_ = 0;
      return batch;
    }
    statistics_.unanswered += awaited_;
    const float torque_nm = run && is_finite(command.torque_nm) ? command.torque_nm : 0.0f;
    commanded_[next_commanded_] = torque_nm;
    next_commanded_ = (next_commanded_ + 1u) % kCommandsKept;
    if (!run) {
      entered_ = 0;
      batch.add(bus::empty_frame(bus::message::kMotorExit, config_.drive_node));
      awaited_ = batch.count;
      return batch;
    }
    if (entered_ < kEnterTimes) {
      ++entered_;
      batch.add(bus::empty_frame(bus::message::kMotorEnter, config_.drive_node));
    }
    bus::MotorCommand motor;
    motor.torque_nm = config_.leg_sign * torque_nm / config_.gear;
    const Result<bus::Frame> frame = bus::pack(motor, config_.motor, config_.drive_node);
    if (frame.ok()) batch.add(frame.value());
    awaited_ = batch.count;
    return batch;
  }

  const CanStatistics& statistics() const { return statistics_; }
  /// To be served between two ticks, and its answer sent, a frame a tick.
  CanRegisters& registers() { return registers_; }
  const DriveReading& drive() const { return drive_; }
  bool bus_is_off() const { return bus_watch_.is_off(); }

  /// The newest request that was not taken yet; `kind` none where there is none.
  CanRequest take_request() { return host_.take(); }
  /// Whether somebody said stop since the last take_request().
  bool stop_waits() const { return host_.stop_waits(); }
  /// Since the last command frame that counts, kForgottenUs where there was none for that long. To be asked
  /// once a second at least.
  std::uint32_t request_age_us(std::uint32_t now_us) { return host_.age_us(now_us); }

 private:
  static constexpr float kNotHomed = __builtin_nanf("");
  static constexpr std::uint32_t kCommandsKept = 4;

  void hear_drive(const bus::Frame& frame, std::uint32_t now_us) {
    const Result<bus::MotorReply> reply = bus::unpack_reply(frame, config_.motor, config_.drive_node);
    if (!reply.ok()) {
      // All motors reply with the same id and their own number in the first byte.
      const bool others = frame.size >= bus::message::kMotorReply.least_size &&
                          frame.size <= bus::message::kMotorReply.size && frame.data[0] != config_.drive_node;
      ++(others ? statistics_.foreign : statistics_.malformed);
      return;
    }
    const bus::MotorReply& r = reply.value();
    const bool answers = awaited_ != 0;
    if (answers) {
      --awaited_;
    } else {
      ++statistics_.repeated;
      if (drive_heard_.heard && watch_.is_stranger(r.position_rad)) {
        watch_.note_stranger();
        return;
      }
    }
    drive_.leg_angle_rad = config_.leg_zero_rad + config_.leg_sign * r.position_rad / config_.gear;
    drive_.leg_velocity_radps = config_.leg_sign * r.velocity_radps / config_.gear;
    drive_.torque_nm = config_.leg_sign * r.torque_nm * config_.gear;
    drive_.temperature = r.temperature;
    drive_.error = r.error;
    if (r.error != 0) ++statistics_.drive_errors;
    const float told_nm = commanded_[(next_commanded_ + kCommandsKept - 1u) % kCommandsKept];
    watch_.hear(r, drive_.torque_nm - told_nm, answers, drive_heard_.age_us(now_us));
    drive_heard_.note(now_us);
    const bool obeys = torque_as_commanded();
    if (obeys || !disobeys_) disobeys_since_us_ = now_us;
    disobeys_ = !obeys;
  }

  /// Within what the last commands were, and the tolerance.
  bool torque_as_commanded() const {
    float least_nm = commanded_[0], most_nm = commanded_[0];
    for (const float torque_nm : commanded_) {
      if (torque_nm < least_nm) least_nm = torque_nm;
      if (torque_nm > most_nm) most_nm = torque_nm;
    }
    const float largest_nm = most_nm > -least_nm ? most_nm : -least_nm;
    const float margin_nm = config_.torque_tolerance_nm + config_.torque_tolerance * largest_nm;
    return drive_.torque_nm >= least_nm - margin_nm && drive_.torque_nm <= most_nm + margin_nm;
  }

  control::Fault drive_fault(std::uint32_t now_us) {
    const bool was_heard = drive_heard_.heard;
    if (was_heard && drive_heard_.age_us(now_us) > config_.silent_us) return control::Fault::drive_silent;
    if (watch_.doubled()) return control::Fault::drive_doubled;
    if (drive_.error != 0) return fault_of_drive(drive_.error);
    if (is_hot(drive_.temperature, config_.temperature_max_c)) return control::Fault::drive_hot;
    if (disobeys_ && now_us - disobeys_since_us_ > config_.disobeys_us) return control::Fault::drive_disobeys;
    if (watch_.mean_off_nm() > config_.torque_offset_nm || watch_.mean_off_nm() < -config_.torque_offset_nm)
      return control::Fault::drive_disobeys;
    if (watch_.is_other_motor(config_.velocity_tolerance)) return control::Fault::drive_mismatch;
    return control::Fault::none;
  }

  void hear_supply(const bus::Frame& frame, std::uint32_t now_us) {
    using bus::message::kSupply;
    if (frame.size != kSupply.size) {
      ++statistics_.malformed;
      return;
    }
    const std::uint32_t since_us = supply_heard_.age_us(now_us);
    supply_heard_.note(now_us);
    if (judge(supply_stream_, bus::StreamLimits{}, frame, since_us, statistics_).ok())
      supply_v_ = bus::get(frame, bus::signal(kSupply, "Voltage")).value();
  }

  /// @returns whether the supply's node was ever heard.
  bool watch_supply(std::uint32_t now_us, control::Fault& fault) {
    const std::uint32_t silence_us = supply_heard_.age_us(now_us);
    if (fault == control::Fault::none && supply_heard_.heard) {
      if (silence_us > config_.silent_us)
        fault = control::Fault::peer_lost;
      else if (supply_v_ > config_.supply_max_v)
        fault = control::Fault::supply_too_high;
    }
    return supply_heard_.heard;
  }

  /// One tick's. @returns whether there were too many of late.
  bool note_troubles() {
    watch_.tick();
    const std::uint32_t all = statistics_.lost + statistics_.out_of_order + statistics_.unanswered;
    std::uint32_t added = all - troubles_before_;
    troubles_before_ = all;
    if (added > 2u * config_.troubles_max) added = 2u * config_.troubles_max;
    if (trouble_tenths_ > 0) --trouble_tenths_;
    trouble_tenths_ += 10u * added;
    // A bus that is well again is believed after a while.
    const std::uint32_t most = 20u * config_.troubles_max;
    if (trouble_tenths_ > most) trouble_tenths_ = most;
    return trouble_tenths_ > 10u * config_.troubles_max;
  }

  /// Adds an encoder to the sample's age. @returns whether it was ever heard.
  bool listen(CanEncoder& encoder, std::uint32_t now_us, control::Sample& sample, control::Fault& fault) {
    const std::uint32_t age_us = encoder.age_us(now_us);
    if (age_us > sample.age_us) sample.age_us = age_us;
    const std::uint32_t silence_us = encoder.silence_us(now_us);
    const bool heard = silence_us < kForgottenUs;
    if (heard && silence_us > config_.silent_us && fault == control::Fault::none)
      fault = control::Fault::peer_lost;
    return heard;
  }

  void hear(const bus::Frame& frame, std::uint32_t now_us) {
    using namespace bus::message;
    ++statistics_.received;
    if (!sound_ || frame.extended || frame.remote) {
      ++statistics_.foreign;
      return;
    }
    // By the id alone: what is wrong with the rest of it is then malformed.
    const auto of = [&](const bus::Message& message, std::uint8_t node) {
      return node != 0 && frame.id == bus::id_of(message, node);
    };
    if (of(kMotorReply, config_.drive_node)) {
      hear_drive(frame, now_us);
    } else if (of(kEncoderSample, config_.height_node) || of(kEncoderSample, config_.cable_node)) {
      if (frame.size != kEncoderSample.size)
        ++statistics_.malformed;
      else
        (of(kEncoderSample, config_.height_node) ? height_ : cable_).receive(frame, now_us, statistics_);
    } else if (of(kSupply, config_.supply_node)) {
      hear_supply(frame, now_us);
    } else if (of(kCommand, config_.self_node)) {
      host_.hear(frame, now_us, statistics_);
    } else if (of(kRegisterRequest, config_.self_node)) {
      const CanRegisters::Heard heard = registers_.receive(frame);
      if (heard == CanRegisters::Heard::malformed) ++statistics_.malformed;
      if (heard == CanRegisters::Heard::other_version) ++statistics_.other_version;
    } else if (of(kHeartbeat, config_.self_node) || (!on_bench_ && of(kMotorCommand, config_.drive_node))) {
      ++statistics_.own_ids;
      own_ids_heard_.note(now_us);
    } else {
      ++statistics_.foreign;
    }
  }

  CanLinkConfig config_;
  bool sound_;
  CanStatistics statistics_;
  CanEncoder height_, cable_;
  std::uint32_t home_count_ = 0, cable_home_count_ = 0;
  float home_height_m_ = kNotHomed;
  DriveReading drive_;
  DriveWatch watch_;
  LastHeard drive_heard_, own_ids_heard_, supply_heard_;
  bus::Stream supply_stream_;
  float supply_v_ = 0.0f;
  std::array<float, kCommandsKept> commanded_{};  ///< N m, of the last ticks: the drive lags by one or two
  std::uint32_t next_commanded_ = 0, entered_ = 0, awaited_ = 0, disobeys_since_us_ = 0;
  std::uint32_t troubles_before_ = 0, trouble_tenths_ = 0;
  bool disobeys_ = false, on_bench_ = false;
  BusWatch bus_watch_;
  HostStream host_;
  CanRegisters registers_;
};

}  // namespace furcula::firmware
