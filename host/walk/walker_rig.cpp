#include "host/walk/walker_rig.hpp"

#include <algorithm>
#include <cmath>

#include "furcula/bus/walker_nodes.hpp"
#include "host/walk/posture.hpp"
#include "host/walk/walker_config.hpp"

namespace furcula::walk {
namespace {

using namespace dynamics::biped;
using control::kWalkerPins;

constexpr int kStepsATick = 2;
constexpr double kPinStroke_s = 0.04;
constexpr std::size_t kBrokenPin = kKneeClutch;  // of the left leg

double of(const Joints<double>& all, std::size_t i) { return joint<double>(all, i); }

dynamics::tree::Vec3<float> rounded(const Vec3<double>& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

control::WalkerConfig walker_config(const WalkerRigConfig& rig, double walk_until_s) {
  return walker_config(rig.robot, {"", rig.mode, walk_until_s, rig.walk}, rig.foot_threshold_n,
                       rig.two_buses ? DriveTurns::every_second_tick : DriveTurns::each_tick);
}

WalkerRig::WalkerRig(const WalkerRigConfig& config)
    : c_(config),
      plant_(config.robot),
      s_(posture(config.robot, plant_, config.mode, config.walk)),
      laws_(active_laws(plant_)) {
  if (c_.seed) sensors_.emplace(SensorErrors{}, *c_.seed);
  Kinematics<double> k;
  kinematics<DesignTopology>(plant_, s_, k);
  for (const std::size_t side : {kLeft, kRight}) {
    for (std::size_t i = 0; i < kVertices; ++i) {
      const auto& at = c_.robot.vertices_m[side][i];
      s_.anchors_m[0][i][0].set(side, k.legs[0].foot_position_m.x[side] + at.x);
      s_.anchors_m[0][i][1].set(side, k.legs[0].foot_position_m.y[side] + at.y);
    }
    for (std::size_t p = 0; p < kClutches; ++p)
      s_.rotors_rad[0][p].set(side, of(s_.q_rad, side * kLegJoints + kClutchJoints[p]));
    if (c_.mode == WalkMode::semi_passive) set_mode(plant_, side, kHipClutch, Mode::passive, laws_, s_);
  }
  normal_n_.fill(0.5 * c_.robot.mass_kg() * c_.robot.gravity_mps2);
  acc_mps2_ = -transposed_times(rotation(s_.attitude), plant_.gravity_mps2);
}

bool WalkerRig::broken_drive(std::size_t i) const {
  return i == c_.joint && (broken(WalkerFault::encoder_lost) || broken(WalkerFault::drive_silent) ||
                           broken(WalkerFault::drive_error) || broken(WalkerFault::drive_off));
}

double WalkerRig::loop_error_rad(std::size_t i) const {
  double error = sensors_ ? sensors_->offset_rad(i) : 0.0;
  if (i != c_.joint) return error;
  const double since_s = time_s_ - c_.fault_s;
  if (broken(WalkerFault::encoder_stuck)) error += stuck_rad_ - of(s_.q_rad, i);
  if (broken(WalkerFault::encoder_jumping) && since_s < 0.01 - 0.5 * kTick_s) error += 0.1;
  if (broken(WalkerFault::encoder_slipping)) error += 0.5 * since_s;
  return error;
}

control::WalkerInputs WalkerRig::sense() {
  control::WalkSample<double> sample{};
  sample.q_rad = s_.q_rad;
  sample.qd_radps = s_.qd_radps;
  control::Imu<double> imu{s_.w_radps, acc_mps2_};
  if (sensors_) (*sensors_)(sample, imu);

  control::WalkerInputs in;
  in.run = true;
  in.tick_interval_us = broken(WalkerFault::late_tick) ? 6000 : 1000;
  control::WalkerSample& out = in.sample;
  out.answered = control::kAllDevices;
  if (!broken(WalkerFault::encoder_stuck)) stuck_rad_ = of(s_.q_rad, c_.joint);
  for (std::size_t i = 0; i < kJoints; ++i) {
    // Sensors have added the offset already.
    const double offset_rad = sensors_ ? sensors_->offset_rad(i) : 0.0;
    out.joints[i] = {static_cast<float>(of(sample.q_rad, i) + loop_error_rad(i) - offset_rad),
                     static_cast<float>(of(sample.qd_radps, i)),
                     static_cast<float>(of(report_.torque.motor_nm, i))};
    if (broken_drive(i)) out.joints[i].torque_nm = 0.0f;
  }
  out.gyro_radps = rounded(imu.gyro_radps);
  out.acc_mps2 = rounded(imu.acc_mps2);
  for (std::size_t side = 0; side < 2; ++side) out.foot_n[side] = static_cast<float>(normal_n_[side]);
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin) out.pins[pin] = static_cast<float>(pins_[pin]);

  for (std::size_t i = 0; i < kJoints; ++i)
    if (c_.two_buses && !bus::has_turn(i, tick_)) out.answered &= ~(1u << i);

  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  control::JointReading& reading = out.joints[c_.joint];
  if (broken(WalkerFault::encoder_stuck)) {
    reading.angle_rad = before_.joints[c_.joint].angle_rad;
    reading.rate_radps = 0.0f;
  }
  if (broken(WalkerFault::encoder_lost)) reading.angle_rad = kNone;
  if (broken(WalkerFault::drive_silent)) out.answered &= ~(1u << c_.joint);
  if (broken(WalkerFault::drive_error)) {
    out.reported_fault = static_cast<std::uint32_t>(control::Fault::drive_fault);
    out.reported_by = static_cast<std::uint32_t>(c_.joint);
  }
  if (broken(WalkerFault::imu_silent)) out.answered &= ~(1u << control::kImuDevice);
  if (broken(WalkerFault::imu_frozen)) out.gyro_radps = before_.gyro_radps, out.acc_mps2 = before_.acc_mps2;
  if (broken(WalkerFault::imu_no_number)) out.gyro_radps.x = kNone;
  if (broken(WalkerFault::gyro_offset)) out.gyro_radps.y += 1.0f;
  if (broken(WalkerFault::acc_dead)) out.acc_mps2 = {0.0f, 0.0f, 0.0f};
  if (broken(WalkerFault::foot_stuck_on)) out.foot_n[kLeft] = 300.0f;
  if (broken(WalkerFault::foot_stuck_off)) out.foot_n[kLeft] = 0.0f;
  if (broken(WalkerFault::feet_silent)) out.answered &= ~(1u << control::kFeetDevice);
  if (!broken()) before_ = out;
  return in;
}

void WalkerRig::advance(const control::WalkerOutputs& told) {
  for (std::size_t i = 0; i < kJoints; ++i)
    if (!c_.two_buses || bus::has_turn(i, tick_)) told_[i] = told.joints[i];
  ++tick_;
  for (std::size_t pin = 0; pin < kWalkerPins; ++pin) {
    double target = static_cast<double>(told.pin_targets[pin]);
    if (pin == kBrokenPin && (broken(WalkerFault::pin_stays_out) || broken(WalkerFault::pin_comes_out)))
      target = 0.0;
    const double stroke = kTick_s / kPinStroke_s;
    pins_[pin] += std::clamp(target - pins_[pin], -stroke, stroke);
  }
  if (told.stage == control::WalkerStage::walking) on_stand_ = false;
  if (told.stage == control::WalkerStage::exercising && !exercises_) {
    constexpr double kAboveGround_m = 1.0;
    exercises_ = true;
    s_.position_m.z += kAboveGround_m;
  }
  time_s_ += kTick_s;
  largest_nm_ = largest_radps_ = 0.0;
  if (on_stand_ && !exercises_) {
    for (std::size_t i = 0; i < kJoints; ++i)
      set_joint<double>(report_.torque.motor_nm, i,
                        static_cast<double>(told_[i].stiffness_nmprad) *
                            (static_cast<double>(told_[i].target_rad) - of(s_.q_rad, i) - loop_error_rad(i)));
    return;
  }
  if (broken(WalkerFault::pushed) && !was_pushed_) {
    was_pushed_ = true;
    s_.v_mps.y += 1.2;
  }
  if (broken(WalkerFault::pin_comes_out) && laws_[0][kKnee].joined[kLeft] && pins_[kBrokenPin] < 0.5)
    set_mode(plant_, kLeft, kKneeClutch, Mode::released, laws_, s_);
  for (int k = 0; k < kStepsATick; ++k) {
    Commands<double> command;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t side = i / kLegJoints;
      auto& law = laws_[0][i % kLegJoints];
      if (!law.joined[side]) continue;
      const bool dead = broken_drive(i);
      const bool blind = i == c_.joint && broken(WalkerFault::encoder_stuck);
      law.kp_nmprad.set(side, dead ? 0.0 : static_cast<double>(told_[i].stiffness_nmprad));
      law.kd_nmsprad.set(side, dead || blind ? 0.0 : static_cast<double>(told_[i].damping_nmsprad));
      set_joint<double>(command.target_rad, i, static_cast<double>(told_[i].target_rad) - loop_error_rad(i));
    }
    const Joints<double> speeds = s_.qd_radps;
    if (on_stand_)
      step<true, DesignTopology, true>(plant_, laws_, command, kTick_s / kStepsATick, s_, report_);
    else
      step<true>(plant_, laws_, command, kTick_s / kStepsATick, s_, report_);
    for (std::size_t i = 0; i < kJoints; ++i) {
      largest_radps_ = std::max(largest_radps_, std::abs(of(speeds, i)));
      if (!laws_[0][i % kLegJoints].joined[i / kLegJoints]) continue;
      const double nm = of(report_.torque.motor_nm, i);
      largest_nm_ = std::max(largest_nm_, std::abs(nm));
      positive_j_ += std::max(nm * of(speeds, i), 0.0) * kTick_s / kStepsATick;
    }
  }
  acc_mps2_ = report_.acceleration.vd_mps2 + cross(s_.w_radps, s_.v_mps) -
              transposed_times(rotation(s_.attitude), plant_.gravity_mps2);
  for (const std::size_t side : {kLeft, kRight}) normal_n_[side] = report_.contact.normal_n[0][side];
}

}  // namespace furcula::walk
