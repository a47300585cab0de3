// A planar leg on its boom, simulated: plant, ground whose level changes, encoders in whole counts, a switch under the
// toe that is late, what breaks; for a controller that plays a gait (control/gait_player.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "furcula/control/gait_player.hpp"
#include "furcula/dynamics/planar_leg_plant.hpp"
#include "host/core/random.hpp"

namespace furcula::sim_host {

enum class LegFault : std::uint8_t {
  none,
  switch_stuck_open,
  switch_stuck_closed,
  height_stuck,    ///< the boom's counter stands still
  height_nan,      ///< its reference is lost
  height_jumps,    ///< by 5 cm
  knee_stuck,      ///< the knee's angle and rate stand still
  sample_stale,    ///< the same old sample, whose age grows
  sample_missing,  ///< no answer
  knee_drive_off,  ///< gives no torque
};

struct LegRigConfig {
  dynamics::PlanarLegParameters<double> leg;
  dynamics::LegSpring spring = dynamics::LegSpring::switched;
  dynamics::LegLiftOff lift_off = dynamics::LegLiftOff::force;
  double ground_m = 0.0;       ///< each landing's ground is drawn evenly within this of level
  double switch_late_s = 0.0;  ///< of each change that it reports, whole ticks, 31 at most
  bool quantisation =
      true;  ///< 0.1 mm of the boom; angles in 16 bits over 25 rad, rates in 12 over 100 rad/s
  std::uint64_t seed = 1;
  LegFault fault = LegFault::none;
  double fault_s = 0.0;  ///< when it begins; for good
};

class LegRig {
 public:
  using Plant = dynamics::PlanarLeg<double>;
  static constexpr double kTick_s = 1e-3;

  explicit LegRig(const LegRigConfig& config)
      : c_(config), plant_(config.leg, config.spring, config.lift_off), ground_(config.seed, 1) {}

  /// In flight, at rest but for the speed forward.
  void drop(double height_m, double speed_mps, const dynamics::Joints2<double>& angle) {
    plant_.set_ground(next_ground());
    plant_.reset({0.0, height_m}, {speed_mps, 0.0}, angle, {});
    was_closed_ = {};
    strides_ = 0;
  }

  control::GaitInputs sense() {
    control::GaitInputs in;
    in.tick_interval_us = 1000;
    in.sample_valid = !broken(LegFault::sample_missing);
    if (broken(LegFault::sample_stale)) {
      stale_.age_us += 1000;
      in.sample = stale_;
      return in;
    }
    control::GaitSample& s = in.sample;
    const auto a = plant_.angle_rad(), r = plant_.rate_radps();
    s.height_m = counted(plant_.hip_m().y, 1e-4);
    s.angle_rad = {counted(a.hip, 25.0 / 65536.0), counted(a.knee, 25.0 / 65536.0)};
    s.rate_radps = {counted(r.hip, 100.0 / 4096.0), counted(r.knee, 100.0 / 4096.0)};
    s.contact = switch_closed() ? 1 : 0;
    if (broken(LegFault::switch_stuck_open)) s.contact = 0;
    if (broken(LegFault::switch_stuck_closed)) s.contact = 1;
    if (broken(LegFault::height_stuck)) s.height_m = stale_.height_m;
    if (broken(LegFault::height_nan)) s.height_m = std::numeric_limits<float>::quiet_NaN();
    if (broken(LegFault::height_jumps)) s.height_m += 0.05f;
    if (broken(LegFault::knee_stuck)) {
      s.angle_rad.knee = stale_.angle_rad.knee;
      s.rate_radps.knee = stale_.rate_radps.knee;
    }
    if (time_s_ < c_.fault_s || c_.fault == LegFault::none) stale_ = s;
    return in;
  }

  /// A tick under these torques.
  void advance(const control::JointPair& torque) {
    dynamics::Joints2<double> u{torque.hip, torque.knee};
    if (broken(LegFault::knee_drive_off)) u.knee = 0.0;
    plant_.advance(u, kTick_s);
    for (const auto& e : plant_.events()) {
      if (e.kind != Plant::Event::Kind::apex) continue;
      plant_.set_ground(next_ground());
      ++strides_;
    }
    time_s_ += kTick_s;
    for (std::size_t i = was_closed_.size(); i-- > 1;) was_closed_[i] = was_closed_[i - 1];
    was_closed_[0] = plant_.mode() == Plant::Mode::stance;
  }

  const Plant& plant() const { return plant_; }
  double time_s() const { return time_s_; }
  unsigned strides() const { return strides_; }  ///< apexes since the drop

 private:
  bool switch_closed() const {
    const double ticks = std::round(c_.switch_late_s / kTick_s);
    return was_closed_[std::min(static_cast<std::size_t>(ticks), was_closed_.size() - 1)];
  }
  bool broken(LegFault fault) const { return c_.fault == fault && time_s_ >= c_.fault_s; }
  double next_ground() { return c_.ground_m > 0.0 ? ground_.uniform(-c_.ground_m, c_.ground_m) : 0.0; }
  float counted(double x, double count) const {
    return static_cast<float>(c_.quantisation ? count * std::round(x / count) : x);
  }

  LegRigConfig c_;
  Plant plant_;
  core::Random ground_;
  control::GaitSample stale_;
  double time_s_ = 0.0;
  std::array<bool, 32> was_closed_{};  ///< at the last ticks, the newest first
  unsigned strides_ = 0;
};

}  // namespace furcula::sim_host
