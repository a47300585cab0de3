// sim_host: a hopper's rig as a board. Simulated time, the plant in double, sensors with their errors,
// faults.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "boards/sim_host/contact_switch.hpp"
#include "boards/sim_host/faults.hpp"
#include "boards/sim_host/live_commands.hpp"
#include "boards/sim_host/plant.hpp"
#include "boards/sim_host/sensors.hpp"
#include "firmware/app/app.hpp"
#include "firmware/app/start_fault.hpp"
#include "furcula/bus/motors.hpp"
#include "furcula/core/count.hpp"
#include "furcula/dynamics/stages.hpp"
#include "host/core/random.hpp"

namespace furcula::sim_host {

/// From then on the coil of a clutch of two delays is on, or off.
struct CoilSwitch {
  double time_s;
  bool on;
};

struct RigConfig {
  Plant plant;  ///< anywhere: the board puts it to the start
  dynamics::Effects<double> effects{};
  double start_height_m = 0.0;
  double start_velocity_mps = 0.0;
  double duration_s = 0.0;
  SensorErrors sensors{};
  std::vector<PlannedFault> faults{};
  double coil_supply_v = 10.0;
  std::vector<CoilSwitch> coil_switches{};  ///< in the order of time
  double cable_count_m = 0.0;               ///< of the clutch's encoder, along the leg; 0 without a clutch
  double cable_loose_m = 0.0;   ///< that its cable hangs loose, along the leg: so much more is paid out
  double ground_steps_m = 0.0;  ///< in each flight the ground moves to a height within this, either way
  std::uint64_t seed = 0;
  /// Of faults that have a size: encoder_drifting, torque_offset and torque_offset_hidden, and
  /// drive_of_other_motor.
  double drift_mps = -kDriftMps;
  double torque_offset_nm = kTorqueOffsetNm;
  bus::Motor other_motor = bus::Motor::ak80_6;
};

/// Metres a count that the controller must be configured with.
constexpr double metres_per_count(const SensorErrors& errors) {
  return errors.quantisation ? kHeightCountM : kFineCountM;
}

/// A tick samples the sensors at its instant; the command that it answers with acts from that instant until
/// the next tick's.
class SimBoard {
 public:
  static constexpr double kPeriodS = 0.001;
  static constexpr double kWatchdogS = 0.005;

  explicit SimBoard(const RigConfig& config)
      : config_(config),
        stages_(config.plant, config.effects),
        encoder_(config.sensors, kHeightCountM, config.seed),
        switch_(config.sensors, stages_.sensing().contact_delay_s(), config.seed),
        ground_(config.seed, 4),
        ticks_(static_cast<std::uint32_t>(std::lround(config.duration_s / kPeriodS))) {
    stages_.plant().reset(config.start_height_m, config.start_velocity_mps);
    note_faults();
    home_ =
        std::llround(stages_.sensing().measured(config.start_height_m) / metres_per_count(config.sensors));
  }

  // The board's seam.

  bool wait_for_tick() {
    if (started_) {
      pass_millisecond();
      for (const PlannedFault& fault : config_.faults)
        if (delays_tick(fault.kind) && starts_now(fault)) {
          const bool brown_out = fault.kind == RigFault::brown_out;
          // A coil's driver without its logic's supply is off; the motor's drive has a supply of its own.
          if (brown_out) command_.coil_duty = 0.0f;
          for (double late_s = 0.0; late_s < fault.duration_s - 1e-9; late_s += kPeriodS) pass_millisecond();
          if (brown_out) restarted_ = homeless_ = true;
        }
    }
    started_ = true;
    if (tick_ >= ticks_) return false;
    measure();
    return true;
  }

  // Both counters start close to where they wrap, so that every run crosses it.
  std::uint32_t now_us() const { return 0xffff0000u + tick_ * 1000u; }

  Result<control::Sample> sense() const {
    if (active(RigFault::peer_lost)) return Status::disconnected;
    if (start_fault_ == control::Fault::none || tick_ >= firmware::kStartFaultTicks) return sample_;
    control::Sample sample = sample_;
    sample.reported_fault = static_cast<std::uint32_t>(start_fault_);
    return sample;
  }

  Status actuate(const control::Command& command) {
    command_ = command;
    return Status::ok;
  }

  void kick_watchdog() { kicked_s_ = time_s(); }

  bool take_reset_request() {
    const bool requested = reset_requested_;
    reset_requested_ = false;
    return requested;
  }

  void report(const firmware::Telemetry& telemetry) { telemetry_ = telemetry; }

  // What a simulation sees.

  double time_s() const { return static_cast<double>(tick_) * kPeriodS; }
  const Plant& plant() const { return stages_.plant(); }
  const RigConfig& config() const { return config_; }
  /// Of a clutch of two delays, at this tick.
  bool coil_switched_on() const {
    bool on = false;
    for (const CoilSwitch& s : config_.coil_switches)
      if (s.time_s <= time_s() + 1e-9) on = s.on;
    return on;
  }
  const control::Command& command() const { return command_; }
  const control::Sample& sample() const { return sample_; }
  const firmware::Telemetry& telemetry() const { return telemetry_; }
  /// As the sample has them, to the double; the height is NaN where the encoder is not homed.
  double measured_height_m() const { return height_m_; }
  /// As the encoder's counts have it.
  double measured_cable_travel_m() const {
    return config_.cable_count_m * count_difference(sample_.cable_count, sample_.cable_home_count);
  }
  double measured_leg_angle_rad() const { return leg_angle_rad_; }
  /// As the rig derives it from counts; with ideal sensors the plant's own.
  double measured_velocity_mps() const {
    const bool ideal = !config_.sensors.quantisation && !config_.sensors.noise;
    return ideal ? stages_.velocity() : static_cast<double>(telemetry_.outputs.height.velocity_mps);
  }
  /// What the drive's current says of its torque, once the command of this tick has arrived.
  double measured_torque_nm() {
    return commands_.shown(stages_.actuation(), static_cast<double>(command_.torque_nm), kPeriodS);
  }
  void request_reset() { reset_requested_ = true; }
  /// Before the first tick: what the start found.
  void report_start_fault(control::Fault fault) { start_fault_ = fault; }
  /// Whether the board has started anew since the last call: its program is to begin with nothing known. The
  /// counters' reference is lost.
  bool take_restart() {
    const bool restarted = restarted_;
    restarted_ = false;
    return restarted;
  }
  /// One more, from the next tick on or later.
  void plant(const PlannedFault& fault) {
    config_.faults.push_back(fault);
    jump_phase_ = (tick_ + 1) / 10 % 2;
  }
  /// Whether such a fault is planted at this tick.
  bool active(RigFault kind) const { return (active_ >> static_cast<unsigned>(kind) & 1u) != 0; }

 private:
  void pass_millisecond() {
    if (time_s() - kicked_s_ > kWatchdogS) command_ = {};
    if (stages_.plant().clutched() != nullptr) stages_.plant().set_voltage(coil_volts());
    if (!config_.coil_switches.empty()) stages_.plant().energise(coil_switched_on());
    if (config_.ground_steps_m > 0.0) move_ground();
    stages_.plant().advance(motor_torque_nm(), kPeriodS);
    switch_.follow(stages_.plant(), time_s());
    ++tick_;
    note_faults();
  }

  /// What acts on the leg: of a motor that is off, nothing.
  double motor_torque_nm() {
    const double torque_nm =
        commands_.torque(stages_.actuation(), static_cast<double>(command_.torque_nm), kPeriodS);
    if (config_.faults.empty() || command_.torque_nm == 0.0f) return torque_nm;
    return (active(RigFault::drive_reversed) ? -torque_nm : torque_nm) +
           (active(RigFault::torque_offset_hidden) ? config_.torque_offset_nm : 0.0);
  }

  void note_faults() {
    active_ = 0;
    for (const PlannedFault& fault : config_.faults)
      if (time_s() >= fault.time_s - 1e-9 && time_s() < fault.time_s + fault.duration_s - 1e-9)
        active_ |= std::uint64_t{1} << static_cast<unsigned>(fault.kind);
  }

  double coil_volts() const {
    const double supply_v = config_.coil_supply_v * (active(RigFault::supply_sag) ? 0.8 : 1.0);
    if (config_.faults.empty()) return supply_v * static_cast<double>(command_.coil_duty);
    // A key that sticks is one that the coil does not pull, or one that the coil holds.
    if (active(RigFault::coil_open) || active(RigFault::coil_shorted)) return 0.0;
    const bool caught = stages_.plant().clutched() == nullptr || stages_.plant().clutched()->caught();
    if (active(RigFault::key_stuck_caught) && caught) return 0.0;
    const bool held = active(RigFault::key_stuck_released) && !caught;
    return supply_v *
           (held || active(RigFault::coil_stuck_on) ? 1.0 : static_cast<double>(command_.coil_duty));
  }

  /// At the apex, under the toe.
  void move_ground() {
    const bool falls = stages_.plant().velocity_mps() < 0.0 && !stages_.plant().in_stance();
    if (falls && !fell_)
      stages_.plant().set_ground(ground_.uniform(-config_.ground_steps_m, config_.ground_steps_m));
    fell_ = falls;
  }

  bool starts_now(const PlannedFault& fault) const {
    return fault.time_s <= time_s() + 1e-9 && fault.time_s > time_s() - kPeriodS + 1e-9;
  }

  void measure() {
    const bool faults = !config_.faults.empty();
    const bool reading = switch_.read(stages_.plant(), static_cast<double>(command_.torque_nm), time_s());
    double height_m = encoder_.measure(stages_.position());
    if (faults) height_m += miscounted_m(height_m);
    if (faults && active(RigFault::encoder_frozen)) {
      sample_.age_us += 1000;
      return;
    }
    if (!(faults && active(RigFault::encoder_stuck))) {
      height_m_ = height_m;
      const std::int64_t count = std::llround(height_m / metres_per_count(config_.sensors)) - home_;
      sample_.height_count = kHomeCount + static_cast<std::uint32_t>(count);
    }
    leg_angle_rad_ = stages_.plant().leg_angle_rad();
    sample_.home_count = kHomeCount;
    sample_.home_height_m =
        static_cast<float>(static_cast<double>(home_) * metres_per_count(config_.sensors));
    sample_.leg_angle_rad = static_cast<float>(leg_angle_rad_);
    sample_.age_us = 0;
    sample_.contact = reading ? 1 : 0;
    if (config_.cable_count_m > 0.0) {
      sample_.cable_home_count = kHomeCount;
      const double paid_out_m = stages_.plant().cable_travel_m() + config_.cable_loose_m;
      sample_.cable_count =
          kHomeCount + static_cast<std::uint32_t>(std::llround(paid_out_m / config_.cable_count_m));
    }
    if (!faults) return;
    if (active(RigFault::height_nan) || homeless_) {
      sample_.home_height_m = std::numeric_limits<float>::quiet_NaN();
      height_m_ = std::numeric_limits<double>::quiet_NaN();
    }
    if (active(RigFault::switch_stuck_open)) sample_.contact = 0;
    if (active(RigFault::switch_stuck_closed)) sample_.contact = 1;
    if (active(RigFault::switch_chattering)) sample_.contact = tick_ % 2;
    if (active(RigFault::switch_vibrating) && flies_released() && tick_ % 10 < 3) sample_.contact = 1;
  }

  bool flies_released() const {
    return stages_.plant().clutched() != nullptr && !stages_.plant().clutched()->caught() &&
           !stages_.plant().in_stance();
  }

  /// What the encoder's faults have added to its count so far; it stays when they have gone.
  double miscounted_m(double height_m) {
    const double moved_m = std::isfinite(counted_m_) ? height_m - counted_m_ : 0.0;
    counted_m_ = height_m;
    const bool backwards = active(RigFault::encoder_backwards) && moved_m > 0.0;
    if (active(RigFault::encoder_reversed) || backwards) miscount_m_ -= 2.0 * moved_m;
    if (active(RigFault::encoder_drifting)) miscount_m_ += config_.drift_mps * kPeriodS;
    const bool jumped = active(RigFault::encoder_jumping) && tick_ / 10 % 2 == jump_phase_;
    if (!active(RigFault::encoder_jumping)) jump_phase_ = (tick_ + 1) / 10 % 2;
    return miscount_m_ + (jumped ? kJumpM : 0.0);
  }

  static constexpr double kJumpM = 0.05;
  static constexpr std::uint32_t kHomeCount = 0xfffffff0u;

  RigConfig config_;
  dynamics::Stages<Plant, double> stages_;
  LiveCommands commands_;
  Encoder encoder_;
  ContactSwitch switch_;
  core::Random ground_;
  bool fell_ = true;
  std::uint32_t ticks_;
  std::int64_t home_ = 0;

  bool started_ = false;
  std::uint32_t tick_ = 0;    ///< milliseconds passed
  std::uint64_t active_ = 0;  ///< a bit for each RigFault
  control::Command command_;
  control::Sample sample_;
  firmware::Telemetry telemetry_;
  double height_m_ = 0.0, leg_angle_rad_ = 0.0;
  double counted_m_ = std::numeric_limits<double>::quiet_NaN(), miscount_m_ = 0.0;
  std::uint32_t jump_phase_ = 0;
  double kicked_s_ = 0.0;
  bool reset_requested_ = false;
  control::Fault start_fault_ = control::Fault::none;
  bool restarted_ = false, homeless_ = false;
};

static_assert(firmware::Board<SimBoard>);

}  // namespace furcula::sim_host
