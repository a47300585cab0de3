// The biped on its feet, simulated, for the controller that a board has (control/walk/walker.hpp): plant, drives whose loops are closed on
// encoders that err, IMU, feet, pins, and what breaks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "furcula/control/walk/walker.hpp"
#include "furcula/dynamics/biped/step.hpp"
#include "host/walk/rollout.hpp"
#include "host/walk/sensors.hpp"

namespace furcula::walk {

enum class WalkerFault : std::uint8_t {
  none,
  encoder_stuck,     ///< angle and rate of a joint stand still, the drive's loop is on them
  encoder_jumping,   ///< the angle jumps by 0.1 rad, and back after 10 ms; the loop is on it
  encoder_slipping,  ///< the angle drifts by 0.5 rad/s, the rate does not show it; the loop is on it
  encoder_lost,      ///< the angle is no number; the drive gives no torque
  drive_silent,      ///< no answer, no torque
  drive_error,       ///< reports an error, gives no torque
  drive_off,         ///< answers, reports no error, gives no torque
  imu_silent,        ///< no answer
  imu_frozen,        ///< the same numbers for ever, fresh by their age
  imu_no_number,     ///< its numbers are none
  gyro_offset,       ///< 1 rad/s about y
  acc_dead,          ///< the accelerometer reads 0
  foot_stuck_on,     ///< the left foot reads 300 N
  foot_stuck_off,    ///< the left foot reads 0 N
  feet_silent,       ///< no answer
  pin_stays_out,     ///< the pin of the left knee does not enter
  pin_comes_out,     ///< it leaves its place: the motor is no longer the knee's
  pushed,            ///< its pelvis gets 1.2 m/s sideways
  late_tick,         ///< one tick, by 5 ms
};

struct WalkerRigConfig {
  dynamics::biped::Description robot;
  WalkMode mode = WalkMode::active;
  Parameters walk;
  std::optional<std::uint64_t>
      seed{};  ///< of what the sensors get wrong (sensors.hpp); without it they do not err
  double foot_threshold_n = 30.0;
  /// A bus a leg at 500 Hz (bus/walker_nodes.hpp): each drive is told and answers in every second tick. Else in each.
  bool two_buses = false;
  WalkerFault fault = WalkerFault::none;
  double fault_s = 0.0;                        ///< when it begins, from the first tick; for good
  std::size_t joint = dynamics::biped::kKnee;  ///< of the encoder or drive that breaks
};

/// The board's configuration for this walk of this robot.
control::WalkerConfig walker_config(const WalkerRigConfig& rig, double walk_until_s);

class WalkerRig {
 public:
  static constexpr double kTick_s = 1e-3;

  explicit WalkerRig(const WalkerRigConfig& config);

  /// What the devices give in this tick. The robot hangs on its stand until the board walks: in its posture, or moving its legs in an exercise.
  control::WalkerInputs sense();
  /// A tick under these commands.
  void advance(const control::WalkerOutputs& told);

  double time_s() const { return time_s_; }
  const dynamics::biped::State<double>& state() const { return s_; }
  double largest_torque_nm() const { return largest_nm_; }       ///< of a joined motor, in the last tick
  double largest_speed_radps() const { return largest_radps_; }  ///< of a joint
  double positive_work_j() const { return positive_j_; }         ///< of the joined motors, since the start
  bool broken() const { return broken(c_.fault); }

 private:
  bool broken(WalkerFault fault) const {
    return c_.fault == fault && fault != WalkerFault::none && time_s_ >= c_.fault_s - 0.5 * kTick_s;
  }
  bool broken_drive(std::size_t i) const;
  /// What the loop of joint `i`'s drive takes its angle to be, less what it is.
  double loop_error_rad(std::size_t i) const;

  WalkerRigConfig c_;
  dynamics::biped::Parameters<double> plant_;
  dynamics::biped::State<double> s_;
  dynamics::biped::JointLaws<double> laws_;
  dynamics::biped::StepReport<double> report_{};
  std::optional<Sensors> sensors_;
  std::array<double, 2> normal_n_{};
  std::array<double, control::kWalkerPins> pins_{};
  dynamics::tree::Vec3<double> acc_mps2_{};
  std::array<control::JointCommand, control::kWalkerJoints> told_{};  ///< what the drives hold
  std::uint32_t tick_ = 0;
  control::WalkerSample before_;  ///< what broke, as it was
  double stuck_rad_ = 0.0;        ///< true angle where the encoder stands still
  double time_s_ = 0.0, largest_nm_ = 0.0, largest_radps_ = 0.0, positive_j_ = 0.0;
  bool on_stand_ = true, exercises_ = false, was_pushed_ = false;
};

}  // namespace furcula::walk
