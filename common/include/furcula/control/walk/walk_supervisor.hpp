// Fault detection of a walking robot, a pure step: its devices, its joints' encoders and drives, its IMU, its feet, the
// pins of its clutches, and a fall. docs/safety.md has the table of faults and detection times. The limits here have a
// margin above the largest values in simulated walks with sensor errors (docs/studies.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "furcula/control/fault.hpp"
#include "furcula/control/walk/walk.hpp"
#include "furcula/control/walk/walker_sample.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// The most by which a drive's torque may lag its command, ticks: buses' two, and drives that are late by up to 18 ms.
inline constexpr std::uint32_t kTorqueLagMost = 20;

/// Limits of the supervisor; beyond each is a fault. Each low-pass has a time constant of its own.
struct WalkSupervisorConfig {
  std::uint32_t tick_interval_max_us = 3000;  ///< between two ticks; more is late_tick
  std::uint32_t missed_max = 1;               ///< answers that a device may miss in a row

  // A joint's encoder.
  float rate_max_radps = 20.0f;  ///< no joint turns faster, not even in a fall
  float jump_rad = 5e-3f;        ///< by which a reading may be beyond that
  float range_rad = 1.57f;       ///< largest magnitude of a joint's angle (000)
  float stuck_rad = 0.015f;      ///< change of the target while the same angle is read: 45 N m of the drive
  /// For which it is read at least: quantised readings repeat by chance too. A joint that 45 N m pull moves 1.7 mrad in it.
  float stuck_s = 0.01f;
  float slip_rad = 0.01f;     ///< between the angle and the integral of its rate, high-pass
  float slip_fades_s = 0.1f;  ///< time constant of this high-pass

  // Its drive.
  float astray_rad = 0.2f;        ///< of the angle from its target
  float astray_s = 0.02f;         ///< for which it may be further from it
  float torque_off_nm = 15.0f;    ///< low-pass of the reported torque's deviation from the command
  float torque_fades_s = 0.02f;   ///< time constant of this low-pass
  float torque_most_nm = 220.0f;  ///< largest magnitude of a drive's torque
  /// Ticks by which the target of the torque that a drive reports is older than its last command; at most kTorqueLagMost.
  std::uint32_t torque_lag_ticks = 0;

  // The IMU.
  float gyro_max_radps = 15.0f,  ///< magnitude of each component; near the end of a range of 1000 degrees/s
      acc_max_mps2 = 150.0f;     ///< magnitude of each component; near the end of a range of 16 g
  /// Ticks in a row with the same six numbers: the last bits of a working IMU change.
  std::uint32_t imu_same_max = 20;
  float weight_least = 0.5f,    ///< low-pass of the accelerometer's magnitude, in g, lower limit
      weight_most = 1.6f;       ///< low-pass of the accelerometer's magnitude, in g, upper limit
  float weight_fades_s = 0.1f;  ///< time constant of this low-pass
  /// Low-pass of the stance sole's angular velocity in roll and in pitch, from gyro and joints: a sole does not turn.
  float turn_off_radps = 0.9f;
  float turn_fades_s = 0.25f;  ///< time constant of this low-pass
  /// Low-pass of the cross product of the accelerometer's direction and the filter's vertical, magnitude; sine of the
  /// angle between them.
  float vertical_off = 0.35f;
  float vertical_fades_s = 0.2f;  ///< time constant of this low-pass

  // The feet.
  float neither_s = 0.03f;  ///< without load on either foot: the walk has no flight
  float unloaded_s = 1.0f;  ///< without load on one foot in the phases `start` and `stop`

  // The pins.
  float pin_in_place = 0.95f;  ///< share of the stroke from which on a pin is in place
  float pins_max_s = 0.75f;    ///< from the command until all are in place: three tries of 0.25 s
  float pin_out_s = 0.01f;     ///< for which one may be out of place in a walk

  // A fall.
  float upright_least = 0.8f;    ///< cosine of the pelvis' tilt
  float height_least_m = 0.88f;  ///< of the pelvis frame's origin above the lower sole; 000 has 0.80 m
  float gravity_mps2 = 9.81f;    ///< acceleration of gravity, for weight_least and weight_most
};

/// State of supervise_walk() between two ticks. Arrays of joints are in the order of WalkerSample::joints, those of feet
/// left, right.
struct WalkSupervisorState {
  Fault fault = Fault::none;                          ///< latched: the first since the last reset
  std::uint32_t suspect = kNoJoint;                   ///< joint of the latched fault, or kNoJoint
  bool begun = false;                                 ///< there was a tick before this one
  std::uint32_t heard = 0,                            ///< a bit for each device that has ever answered
      known = 0;                                      ///< a bit for each joint with a reading before
  std::array<std::uint8_t, kWalkerDevices> missed{};  ///< answers missed in a row
  std::array<float, kWalkerJoints> before_rad{},      ///< angles on the last tick
      followed_rad{},                                 ///< targets when the angle last changed
      slip_rad{},                                     ///< angle less the integral of its rate, high-pass
      wanted_nm{},                                    ///< torques of the commands at the last readings
      torque_off_nm{},                                ///< deviation of the reported torque, low-pass
      astray_s{},                                     ///< how long the angle has been far from its target
      still_s{};                                      ///< how long the same angle has been read
  std::array<bool, kWalkerJoints> held{};             ///< the drive held a target on the last tick
  std::array<JointCommand, kWalkerJoints> told{};     ///< commands of the last tick
  /// Targets of the ticks before `told`, in a ring; not kept with torque_lag_ticks 0.
  std::array<std::array<float, kWalkerJoints>, kTorqueLagMost> told_before_rad{};
  std::uint32_t told_next = 0;                ///< of the ring, the place that is written next
  dynamics::tree::Vec3<float> gyro_before{},  ///< gyro on the last tick, rad/s
      acc_before{};                           ///< accelerometer on the last tick, m/s^2
  std::uint32_t imu_same = 0;                 ///< ticks in a row with the same numbers
  float weight_mps2 = 0.0f;                   ///< magnitude of the accelerometer, low-pass
  /// Cross product of the accelerometer's direction and the filter's vertical, low-pass.
  dynamics::tree::Vec3<float> vertical_off{};
  float turn_roll_radps = 0.0f,       ///< angular velocity of the stance sole about x, low-pass
      turn_pitch_radps = 0.0f;        ///< angular velocity of the stance sole about y, low-pass
  float neither_s = 0.0f,             ///< how long neither foot has had load
      pin_out_s = 0.0f,               ///< how long a pin has been out of place in a walk
      pins_s = 0.0f;                  ///< how long a pin has been out of place on the stand
  std::array<float, 2> unloaded_s{};  ///< how long each foot has had no load in `start` and `stop`
  std::array<bool, 2> carried{};      ///< whether each foot had load on the last tick
  std::array<float, 2> same_s{};      ///< how long this has not changed in `up` and `down`
};

/// Inputs of one tick of the supervisor.
struct WalkObservation {
  const WalkerSample& now;  ///< with the last reading of a device that did not answer
  bool on_stand = false;    ///< does not walk: falls are not monitored, nor are feet unless it exercises
  bool exercises = false;   ///< moves its legs on the stand: no foot may have load
  bool driven = false;      ///< the drives hold their targets
  WalkPhase phase = WalkPhase::start;  ///< of the walk
  bool on_left = true;                 ///< the stance foot is the left one
  float stride_s = 1e9f;               ///< for which a foot may stay on or off the ground in `up` and `down`
  std::array<bool, 2> carries{};       ///< whether each foot has load, left and right
  std::uint32_t passive_pins = 0;      ///< a bit for each pin that is to be in the spring's rotator
  dynamics::tree::Vec3<float> up{0.0f, 0.0f, 1.0f};  ///< upward unit vector in the pelvis' axes
  float height_m = 1.0f;                             ///< of the pelvis frame's origin above the lower sole
  std::uint32_t tick_interval_us = 0;                ///< measured, since the last tick
};

namespace detail {

inline float magnitude(float x) { return x < 0.0f ? -x : x; }

inline float within_size(float x, float most) { return x > most ? most : x < -most ? -most : x; }

/// Counts while something holds.
inline float lasting_s(float& time_s, bool holds, float dt_s) {
  time_s = holds ? time_s + dt_s : 0.0f;
  return time_s;
}

/// The pin that a joint has, or kWalkerPins.
constexpr std::size_t pin_of_joint(std::size_t joint) {
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin)
    if (joint_of_pin(pin) == joint) return pin;
  return kWalkerPins;
}

inline Fault find_device_fault(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                               const WalkObservation& seen) {
  if (seen.tick_interval_us > c.tick_interval_max_us) return Fault::late_tick;
  if (seen.now.reported_fault != 0) {
    s.suspect = seen.now.reported_by;
    return seen.now.reported_fault < kFaultCount ? static_cast<Fault>(seen.now.reported_fault)
                                                 : Fault::drive_fault;
  }
  for (const float x : seen.now.foot_n)
    if (!is_finite(x)) return Fault::non_finite_input;
  for (std::size_t i = 0; i < kWalkerDevices; ++i) {
    if (s.missed[i] <= c.missed_max) continue;
    if (i >= kWalkerJoints) return Fault::peer_lost;
    s.suspect = static_cast<std::uint32_t>(i);
    return Fault::drive_silent;
  }
  return Fault::none;
}

/// Of the joint `i`: its readings against each other, and against the commands to its drive.
inline Fault find_joint_fault(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                              const WalkObservation& seen, std::size_t i, float dt_s) {
  if ((s.heard >> i & 1u) == 0) return Fault::none;
  const JointReading& r = seen.now.joints[i];
  if (!is_finite(r.angle_rad) || !is_finite(r.rate_radps) || !is_finite(r.torque_nm))
    return Fault::non_finite_input;
  const JointCommand& told = s.told[i];
  const bool held = seen.driven && told.stiffness_nmprad > 0.0f;
  const float turned = (s.known >> i & 1u) != 0 ? r.angle_rad - s.before_rad[i] : 0.0f;
  s.before_rad[i] = r.angle_rad;
  s.known |= 1u << i;
  // The last bits of a joint that moves change.
  if (turned != 0.0f || !held || !s.held[i]) s.followed_rad[i] = told.target_rad;
  if (lasting_s(s.still_s[i], turned == 0.0f, dt_s) > c.stuck_s &&
      magnitude(told.target_rad - s.followed_rad[i]) > c.stuck_rad)
    return Fault::encoder_implausible;
  if (magnitude(turned) > c.rate_max_radps * dt_s + c.jump_rad) return Fault::encoder_jump;
  if (magnitude(r.angle_rad) > c.range_rad) return Fault::leg_angle_out_of_range;
  s.slip_rad[i] += turned - dt_s * r.rate_radps - dt_s / c.slip_fades_s * s.slip_rad[i];
  if (magnitude(s.slip_rad[i]) > c.slip_rad) return Fault::encoder_implausible;

  const float off_rad = told.target_rad - r.angle_rad;
  const float behind_rad =
      c.torque_lag_ticks == 0
          ? off_rad
          : s.told_before_rad[(s.told_next + kTorqueLagMost - c.torque_lag_ticks) % kTorqueLagMost][i] -
                r.angle_rad;
  // Its torque is of some time within the last tick: between what the readings at both ends ask for.
  const float now_nm =
      within_size(told.stiffness_nmprad * behind_rad - told.damping_nmsprad * r.rate_radps, c.torque_most_nm);
  const float then_nm = s.held[i] ? s.wanted_nm[i] : now_nm;
  const float least = now_nm < then_nm ? now_nm : then_nm, most = now_nm < then_nm ? then_nm : now_nm;
  const float beyond_nm = r.torque_nm < least  ? r.torque_nm - least
                          : r.torque_nm > most ? r.torque_nm - most
                                               : 0.0f;
  s.wanted_nm[i] = now_nm;
  s.held[i] = held;
  s.torque_off_nm[i] += dt_s / c.torque_fades_s * ((held ? beyond_nm : 0.0f) - s.torque_off_nm[i]);
  if (magnitude(s.torque_off_nm[i]) > c.torque_off_nm) return Fault::drive_disobeys;
  if (lasting_s(s.astray_s[i], held && magnitude(off_rad) > c.astray_rad, dt_s) > c.astray_s)
    return Fault::leg_astray;
  return Fault::none;
}

inline Fault find_imu_fault(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                            const WalkObservation& seen, float dt_s) {
  const auto &g = seen.now.gyro_radps, &a = seen.now.acc_mps2;
  for (const float x : {g.x, g.y, g.z, a.x, a.y, a.z})
    if (!is_finite(x)) return Fault::non_finite_input;
  for (const float x : {g.x, g.y, g.z})
    if (magnitude(x) > c.gyro_max_radps) return Fault::imu_implausible;
  for (const float x : {a.x, a.y, a.z})
    if (magnitude(x) > c.acc_max_mps2) return Fault::imu_implausible;
  const auto &gb = s.gyro_before, &ab = s.acc_before;
  const bool same = g.x == gb.x && g.y == gb.y && g.z == gb.z && a.x == ab.x && a.y == ab.y && a.z == ab.z;
  s.imu_same = same && s.begun ? s.imu_same + 1 : 0;
  s.gyro_before = g;
  s.acc_before = a;
  if (s.imu_same >= c.imu_same_max) return Fault::imu_implausible;
  const float weight = dynamics::square_root(dot(a, a));
  if (!s.begun) s.weight_mps2 = weight;
  s.weight_mps2 += dt_s / c.weight_fades_s * (weight - s.weight_mps2);
  if (s.weight_mps2 < c.weight_least * c.gravity_mps2 || s.weight_mps2 > c.weight_most * c.gravity_mps2)
    return Fault::imu_implausible;

  const auto off = cross(a, seen.up) * (seen.on_stand || !(weight > 1.0f) ? 0.0f : 1.0f / weight);
  s.vertical_off += (off - s.vertical_off) * (dt_s / c.vertical_fades_s);
  if (dot(s.vertical_off, s.vertical_off) > c.vertical_off * c.vertical_off) return Fault::imu_implausible;

  // The stance sole does not turn: the rates of its leg's joints cancel the gyro's.
  const std::size_t side = seen.on_left ? 0 : 1, leg = side * dynamics::biped::kLegJoints;
  const bool stands = !seen.on_stand && seen.carries[side];
  using namespace dynamics::biped;
  const auto rate = [&](std::size_t j) { return seen.now.joints[leg + j].rate_radps; };
  const float roll = g.x + rate(kHipRoll) + rate(kAnkleRoll);
  const float pitch = g.y + rate(kHipPitch) + rate(kKnee) + rate(kAnklePitch);
  const float share = dt_s / c.turn_fades_s;
  s.turn_roll_radps += share * ((stands ? roll : 0.0f) - s.turn_roll_radps);
  s.turn_pitch_radps += share * ((stands ? pitch : 0.0f) - s.turn_pitch_radps);
  if (magnitude(s.turn_roll_radps) > c.turn_off_radps || magnitude(s.turn_pitch_radps) > c.turn_off_radps)
    return Fault::imu_implausible;
  return Fault::none;
}

/// Loads of the feet in a walk.
inline Fault find_foot_fault(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                             const WalkObservation& seen, float dt_s) {
  const bool neither = !seen.carries[0] && !seen.carries[1];
  if (lasting_s(s.neither_s, neither, dt_s) > c.neither_s) return Fault::contact_implausible;
  const bool steps = seen.phase == WalkPhase::up || seen.phase == WalkPhase::down;
  for (std::size_t side = 0; side < 2; ++side)
    if (lasting_s(s.unloaded_s[side], !steps && !seen.carries[side], dt_s) > c.unloaded_s)
      return Fault::contact_implausible;
  // Within a stride each foot leaves the ground and comes back to it.
  for (std::size_t side = 0; side < 2; ++side) {
    const bool changes = !steps || seen.carries[side] != s.carried[side];
    if (lasting_s(s.same_s[side], !changes, dt_s) > seen.stride_s) return Fault::contact_implausible;
  }
  s.carried = seen.carries;
  return Fault::none;
}

/// The joint whose pin is not where it is to be, or kNoJoint.
inline std::uint32_t pin_out_of_place(const WalkSupervisorConfig& c, const WalkObservation& seen) {
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin) {
    const bool passive = (seen.passive_pins >> pin & 1u) != 0;
    const float there = passive ? -seen.now.pins[pin] : seen.now.pins[pin];
    if (!(there >= c.pin_in_place)) return static_cast<std::uint32_t>(joint_of_pin(pin));
  }
  return kNoJoint;
}

inline Fault find_walk_fault(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                             const WalkObservation& seen, float dt_s) {
  Fault found = find_device_fault(c, s, seen);
  // Every joint is checked in every tick: its state does not depend on the others.
  for (std::size_t i = 0; i < kWalkerJoints; ++i) {
    const Fault of_joint = find_joint_fault(c, s, seen, i, dt_s);
    if (found == Fault::none && of_joint != Fault::none) {
      found = of_joint;
      s.suspect = static_cast<std::uint32_t>(i);
    }
  }
  const Fault of_imu = find_imu_fault(c, s, seen, dt_s);
  if (found == Fault::none) found = of_imu;
  s.begun = true;
  if (found != Fault::none) return found;

  const std::uint32_t pin = pin_out_of_place(c, seen);
  const bool out = seen.driven && pin != kNoJoint;
  s.suspect = pin;
  const bool waits = seen.on_stand && !seen.exercises;
  if (lasting_s(s.pins_s, out && waits, dt_s) > c.pins_max_s) return Fault::clutch_not_engaged;
  if (lasting_s(s.pin_out_s, out && !waits, dt_s) > c.pin_out_s) return Fault::clutch_not_engaged;
  s.suspect = kNoJoint;
  if (seen.exercises && (seen.carries[0] || seen.carries[1])) return Fault::contact_implausible;
  if (seen.on_stand) return Fault::none;
  if (!(seen.up.z > c.upright_least) || !(seen.height_m > c.height_least_m)) return Fault::falling;
  return find_foot_fault(c, s, seen, dt_s);
}

}  // namespace detail

/// Keeps the commands of this tick for the next one. Where a drive held no target before, all earlier targets are set to
/// this one.
inline void note_told(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                      const std::array<JointCommand, kWalkerJoints>& told) {
  if (c.torque_lag_ticks != 0) {
    for (std::size_t i = 0; i < kWalkerJoints; ++i) {
      if (s.told[i].stiffness_nmprad > 0.0f)
        s.told_before_rad[s.told_next][i] = s.told[i].target_rad;
      else  // a drive that held nothing begins at its first target
        for (auto& before : s.told_before_rad) before[i] = told[i].target_rad;
    }
    s.told_next = (s.told_next + 1) % kTorqueLagMost;
  }
  s.told = told;
}

/// One tick, `dt_s` after the last; call note_told() after it. `reset` clears a latched fault; one that is still there
/// latches again at once. @returns the latched fault.
inline Fault supervise_walk(const WalkSupervisorConfig& c, WalkSupervisorState& s,
                            const WalkObservation& seen, bool reset, float dt_s) {
  if (reset) {
    const auto missed = s.missed;
    const std::uint32_t heard = s.heard;
    s = {};
    s.missed = missed;
    s.heard = heard;
  }
  const std::uint32_t suspect = s.suspect;
  const Fault found = detail::find_walk_fault(c, s, seen, dt_s);
  if (s.fault == Fault::none)
    s.fault = found;
  else
    s.suspect = suspect;
  return s.fault;
}

}  // namespace furcula::control
