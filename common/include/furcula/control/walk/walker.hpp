// A walking robot's controller on the board, a pure step from its devices' samples to its drives' commands: the attitude
// filter, the walk, the supervisor, and the reaction to a fault or fall. No clock, no I/O, no globals, no heap.
//
//   idle     drives off
//   joining  after the request to walk: on a stand the drives hold the posture, the pins go in, the vertical is measured
//   walking  the walk, until it stands, and standing
//   exercising  in place of a walk, on the stand: the legs move (exercise.hpp)
//   damped   a fault: each drive brakes its joint with a limited torque, and so takes energy out only; the drive of the
//            joint with the fault is off. Ends with a reset; to walk needs a new request
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "furcula/control/walk/attitude_filter.hpp"
#include "furcula/control/walk/exercise.hpp"
#include "furcula/control/walk/walk.hpp"
#include "furcula/control/walk/walk_supervisor.hpp"
#include "furcula/control/walk/walker_sample.hpp"
#include "furcula/core/status.hpp"

namespace furcula::control {

/// Configuration of the controller. check() says whether it makes sense.
struct WalkerConfig {
  WalkConfig<float> walk;           ///< the walk, and the robot's model with the gains of its drives
  AttitudeGains<float> attitude;    ///< of the attitude filter
  WalkSupervisorConfig supervisor;  ///< limits
  /// A bit for each pin that is to be in the spring's rotator: both hips' of a semi-passive walk.
  std::uint32_t passive_pins = 0;
  float exercise_s = 0.0f;         ///< above 0: the legs move on the stand for so long, in place of a walk
  float foot_threshold_n = 30.0f;  ///< load from which on a foot is on the ground (FootSwitch)
  float sole_m = 0.09f;            ///< depth of the sole below the ankle
  std::uint32_t rest_ticks = 100;  ///< over which the vertical is measured
  float rest_radps = 0.1f;         ///< largest magnitude of each gyro component while the robot hangs still
  float damping_nmsprad = 50.0f;   ///< of each joint after a fault
  float damped_most_nm = 80.0f;    ///< largest torque of this damping: document 000's limit of a motor
};

/// Inputs of one tick.
struct WalkerInputs {
  WalkerSample sample;                 ///< of the devices that answered since the last tick
  bool reset = false;                  ///< a person asks for the latched fault to be cleared
  bool run = false;                    ///< the request to walk; false: drives off
  std::uint32_t tick_interval_us = 0;  ///< measured, since the last tick
};

/// Stage of the controller.
enum class WalkerStage : std::uint8_t {
  idle,       ///< drives off
  joining,    ///< on the stand: the drives hold the posture, the pins go in, the vertical is measured
  walking,    ///< the walk, until it stands, and standing
  damped,     ///< after a fault: the drives brake
  exercising  ///< on the stand: the legs move, then hold the posture
};

/// Made by begin_walker(); one that was not is in the fault bad_configuration.
struct WalkerState {
  Status configuration = Status::invalid;  ///< result of check()
  WalkerStage stage = WalkerStage::idle;   ///< current stage
  bool let_go = true;                      ///< the request to walk has been off since the last fault
  WalkerSample last;               ///< last readings; a joint that does not answer goes on at its rate
  WalkSupervisorState supervisor;  ///< has the latched fault
  AttitudeFilter<float> filter{{1.0f, 0.0f, 0.0f, 0.0f}, {}};  ///< of the pelvis
  WalkState<float> walk;                                       ///< made when `joining` begins
  ExerciseState exercise;                                      ///< of `exercising`
  std::array<FootSwitch<float>, 2> feet{};                     ///< left and right
  dynamics::tree::Vec3<float> acc_sum{};  ///< sum of the accelerometer over the ticks at rest
  std::uint32_t rests = 0;                ///< ticks at rest in a row, in `joining`
};

/// Result of one tick.
struct WalkerOutputs {
  std::array<JointCommand, kWalkerJoints> joints;  ///< as WalkerSample::joints; zero gains: no torque
  std::array<float, kWalkerPins> pin_targets{};    ///< of their servos: 1 motor, -1 spring
  Fault fault = Fault::none;                       ///< latched
  std::uint32_t suspect = kNoJoint;                ///< joint of the fault, or kNoJoint
  WalkerStage stage = WalkerStage::idle;           ///< stage after this tick
  WalkPhase phase = WalkPhase::start;              ///< of the walk
  bool on_left = true;                             ///< the stance foot is the left one
  float upright = 1.0f,                            ///< cosine of the pelvis' tilt; 1 unless it walks
      height_m = 0.0f;  ///< of the pelvis frame's origin above the lower sole; meaningless unless it walks
};

/// Whether the numbers make sense. `invalid`: a parameter of the walk is not finite, a number is not positive where it
/// must be, or torque_lag_ticks is above kTorqueLagMost.
inline Status check(const WalkerConfig& c) {
  const auto values = c.walk.walk.values();
  for (const float x : values)
    if (!is_finite(x)) return Status::invalid;
  const WalkParameters<float>& w = c.walk.walk;
  for (const float x :
       {w.start_s, w.up_blend_s, w.down_blend_s, w.stop_blend_s, c.walk.inverse_mass_1pkg, c.foot_threshold_n,
        c.damped_most_nm, c.supervisor.slip_fades_s, c.supervisor.torque_fades_s, c.supervisor.weight_fades_s,
        c.supervisor.turn_fades_s, c.supervisor.vertical_fades_s})
    if (!is_finite(x) || !(x > 0.0f)) return Status::invalid;
  for (const auto& leg : c.walk.body.drives)
    for (const auto& drive : leg)
      if (!(drive.kp_nmprad > 0.0f) || !(drive.kd_nmsprad >= 0.0f)) return Status::invalid;
  return c.damping_nmsprad >= 0.0f && is_finite(c.exercise_s) && c.exercise_s >= 0.0f && c.rest_ticks > 0 &&
                 c.supervisor.torque_lag_ticks <= kTorqueLagMost
             ? Status::ok
             : Status::invalid;
}

/// State before the first tick.
inline WalkerState begin_walker(const WalkerConfig& config) {
  WalkerState state;
  state.configuration = check(config);
  return state;
}

namespace detail {

/// Takes the readings of the devices that answered; a joint whose drive did not goes on at its rate.
inline void take_sample(const WalkerSample& in, float dt_s, WalkerState& s) {
  const auto answers = [&](std::uint32_t device) {
    const bool yes = (in.answered >> device & 1u) != 0;
    std::uint8_t& missed = s.supervisor.missed[device];
    if (yes) s.supervisor.heard |= 1u << device;
    missed = yes ? 0 : missed == 255 ? 255 : static_cast<std::uint8_t>(missed + 1);
    return yes;
  };
  for (std::uint32_t i = 0; i < kWalkerJoints; ++i) {
    if (answers(i))
      s.last.joints[i] = in.joints[i];
    else
      s.last.joints[i].angle_rad += dt_s * s.last.joints[i].rate_radps;
  }
  if (answers(kImuDevice)) s.last.gyro_radps = in.gyro_radps, s.last.acc_mps2 = in.acc_mps2;
  if (answers(kFeetDevice)) s.last.foot_n = in.foot_n;
  if (answers(kPinsDevice)) s.last.pins = in.pins;
  s.last.answered = in.answered;
  s.last.reported_fault = in.reported_fault;
  s.last.reported_by = in.reported_by;
}

/// On its stand. @returns whether the vertical is known.
inline bool measure_vertical(const WalkerConfig& c, WalkerState& s) {
  const auto& g = s.last.gyro_radps;
  const bool still =
      magnitude(g.x) < c.rest_radps && magnitude(g.y) < c.rest_radps && magnitude(g.z) < c.rest_radps;
  if (!still || s.rests == 0) s.acc_sum = {0.0f, 0.0f, 0.0f};
  s.rests = still ? s.rests + 1 : 0;
  if (still) s.acc_sum += s.last.acc_mps2;
  return s.rests >= c.rest_ticks;
}

inline void hold(const WalkerConfig& c, std::size_t i, float target_rad, WalkerOutputs& out) {
  using namespace dynamics::biped;
  const auto& drive = c.walk.body.drives[i / kLegJoints][i % kLegJoints];
  const std::size_t pin = pin_of_joint(i);
  const bool joined = pin == kWalkerPins || (c.passive_pins >> pin & 1u) == 0;
  // A motor that its pin does not join follows its link by its drive's own control (pin_clutch_sequencer.hpp).
  out.joints[i] = joined ? JointCommand{target_rad, drive.kp_nmprad, drive.kd_nmsprad}
                         : JointCommand{target_rad, 0.0f, 0.0f};
}

/// Each drive brakes its joint.
inline void damp(const WalkerConfig& c, const WalkerState& s, WalkerOutputs& out) {
  for (std::size_t i = 0; i < kWalkerJoints; ++i) {
    const float rate = magnitude(s.last.joints[i].rate_radps);
    const float most = c.damped_most_nm, wanted = c.damping_nmsprad;
    const bool off = i == s.supervisor.suspect || !is_finite(rate);
    out.joints[i] = {0.0f, 0.0f, off ? 0.0f : wanted * rate > most ? most / rate : wanted};
  }
}

}  // namespace detail

/// One tick, `dt_s` after the last (the nominal period: that a tick was late is an input). Does not block; what fails is
/// `WalkerOutputs::fault`, which stays until a reset.
inline WalkerOutputs step_walker(const WalkerConfig& c, WalkerState& s, const WalkerInputs& in, float dt_s) {
  using namespace dynamics::biped;
  WalkerOutputs out;
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin)
    out.pin_targets[pin] = (c.passive_pins >> pin & 1u) != 0 ? -1.0f : 1.0f;
  if (s.configuration != Status::ok) {
    out.fault = Fault::bad_configuration;
    out.stage = WalkerStage::damped;
    return out;
  }
  detail::take_sample(in.sample, dt_s, s);
  if (in.reset && s.supervisor.fault != Fault::none) s.stage = WalkerStage::idle;
  s.let_go = s.let_go || !in.run;
  if (s.stage == WalkerStage::idle && in.run && s.let_go) {
    s.stage = WalkerStage::joining;
    s.walk = begin_walk(c.walk);
    s.rests = 0;
  }
  if (!in.run && s.stage != WalkerStage::damped) s.stage = WalkerStage::idle;

  WalkObservation seen{s.last};
  seen.tick_interval_us = in.tick_interval_us;
  seen.passive_pins = c.passive_pins;
  seen.on_stand = s.stage != WalkerStage::walking;
  seen.driven = s.stage != WalkerStage::idle && s.stage != WalkerStage::damped;
  seen.exercises = s.stage == WalkerStage::exercising;
  if (s.stage == WalkerStage::walking || seen.exercises)
    for (std::size_t side = 0; side < 2; ++side) {
      s.feet[side].step(s.last.foot_n[side], c.foot_threshold_n, dt_s);
      seen.carries[side] = s.feet[side].carries > 0.5f;
    }
  WalkOutputs<float> walked;
  if (s.stage == WalkerStage::walking) {
    WalkSample<float> sample;
    for (std::size_t i = 0; i < kWalkerJoints; ++i) {
      set_joint<float>(sample.q_rad, i, s.last.joints[i].angle_rad);
      set_joint<float>(sample.qd_radps, i, s.last.joints[i].rate_radps);
    }
    sample.gyro_radps = s.last.gyro_radps;
    // The filter's state from all samples before is the current attitude; this sample is for the next tick.
    sample.attitude = s.filter.attitude;
    sample.left_carries = s.feet[0].carries;
    sample.right_carries = s.feet[1].carries;
    const auto up = up_of(sample.attitude);
    step_attitude(c.attitude, {s.last.gyro_radps, s.last.acc_mps2}, dt_s, s.filter);
    step_walk(c.walk, sample, dt_s, s.walk, walked);
    const float left_m = -dot(up, walked.left_ankle_m), right_m = left_m + dot(up, walked.apart_m);
    seen.up = up;
    seen.height_m = (left_m > right_m ? left_m : right_m) + c.sole_m;
  }
  if (seen.exercises) step_attitude(c.attitude, {s.last.gyro_radps, s.last.acc_mps2}, dt_s, s.filter);
  const auto& w = c.walk.walk;
  seen.stride_s = 2.5f * (w.up_s + w.down_s);  // of two steps, with a margin
  seen.phase = s.walk.phase[0];
  seen.on_left = s.walk.on_left[0];
  supervise_walk(c.supervisor, s.supervisor, seen, in.reset, dt_s);

  if (s.supervisor.fault != Fault::none) {
    if (s.stage != WalkerStage::damped) s.let_go = false;
    s.stage = WalkerStage::damped;
    detail::damp(c, s, out);
  } else if (s.stage == WalkerStage::walking) {
    for (std::size_t i = 0; i < kWalkerJoints; ++i)
      detail::hold(c, i, joint<float>(walked.target_rad, i), out);
  } else if (s.stage == WalkerStage::exercising) {
    JointAngles posture_rad;
    for (std::size_t i = 0; i < kWalkerJoints; ++i) posture_rad[i] = joint<float>(s.walk.from_rad, i);
    const JointAngles targets_rad = step_exercise(posture_rad, c.exercise_s, dt_s, s.exercise);
    for (std::size_t i = 0; i < kWalkerJoints; ++i) detail::hold(c, i, targets_rad[i], out);
  } else if (s.stage == WalkerStage::joining) {
    for (std::size_t i = 0; i < kWalkerJoints; ++i) detail::hold(c, i, joint<float>(s.walk.from_rad, i), out);
    const bool vertical = detail::measure_vertical(c, s);
    const bool heard = s.supervisor.heard == kAllDevices;
    if (vertical && heard && detail::pin_out_of_place(c.supervisor, seen) == kNoJoint) {
      s.filter = attitude_at_rest(s.acc_sum);
      const bool walks = !(c.exercise_s > 0.0f);
      for (auto& foot : s.feet) foot = {walks ? 1.0f : 0.0f, 0.0f};
      s.exercise = {};
      s.stage = walks ? WalkerStage::walking : WalkerStage::exercising;
    }
  }
  note_told(c.supervisor, s.supervisor, out.joints);
  out.fault = s.supervisor.fault;
  out.suspect = s.supervisor.suspect;
  out.stage = s.stage;
  out.phase = seen.phase;
  out.on_left = seen.on_left;
  out.upright = seen.up.z;
  out.height_m = seen.height_m;
  return out;
}

}  // namespace furcula::control
