// What many replies of a drive tell together: one drive or two, its own motor or another's, an offset of its torque.
#pragma once

#include <cstdint>

#include "furcula/bus/motor_frames.hpp"

namespace furcula::firmware {

/// What the drive's replies say over many of them: whose they are, and whether its torque and its velocity
/// are what its commands and its position make of them.
class DriveWatch {
 public:
  /// One reply, `told_nm` before it. `answers`: to a command that was not answered yet.
  void hear(const bus::MotorReply& reply, float off_nm, bool answers, std::uint32_t since_last_us);
  /// Whether it is another drive's: a second answer from another place.
  bool is_stranger(float position_rad) const {
    const float away_rad = position_rad - position_rad_;
    return away_rad > kOtherShaftRad || away_rad < -kOtherShaftRad;
  }
  void note_stranger() { strangers_ += kTicksPerStranger; }
  /// One tick.
  void tick() {
    if (strangers_ > 0) --strangers_;
    if (ratio_ticks_ > 0 && --ratio_ticks_ == 0) ratio_ = 1.0f;
  }
  bool doubled() const { return strangers_ > 2 * kTicksPerStranger; }
  float mean_off_nm() const { return mean_off_nm_; }
  /// From 1 - tolerance to 1 + tolerance, over the last turns that were counted.
  bool is_other_motor(float tolerance) const {
    return ratio_ < 1.0f - tolerance || ratio_ > 1.0f + tolerance;
  }

 private:
  /// A shaft turns by no more between two replies to one command.
  static constexpr float kOtherShaftRad = 0.1f;
  static constexpr std::uint32_t kTicksPerStranger = 10;
  static constexpr float kMeanReplies = 512.0f;
  /// Position counts are 0.4 mrad: slower than 5 rad/s they say little in 1 ms.
  static constexpr float kLeastTurnRad = 0.005f;
  static constexpr float kTurnsRad = 2.0f;
  /// What was found stands so long, for the supervisor to latch it; then a reset may clear it.
  static constexpr std::uint32_t kRatioTicks = 500;

  float position_rad_ = 0.0f, mean_off_nm_ = 0.0f;
  float turned_rad_ = 0.0f, reported_rad_ = 0.0f, ratio_ = 1.0f, velocity_radps_ = 0.0f;
  std::uint32_t strangers_ = 0, ratio_ticks_ = 0;
};

inline void DriveWatch::hear(const bus::MotorReply& reply, float off_nm, bool answers,
                             std::uint32_t since_last_us) {
  const auto size = [](float x) { return x < 0.0f ? -x : x; };
  const float turned_rad = size(reply.position_rad - position_rad_);
  const float mean_radps = size(0.5f * (reply.velocity_radps + velocity_radps_));
  position_rad_ = reply.position_rad;
  velocity_radps_ = reply.velocity_radps;
  mean_off_nm_ += (off_nm - mean_off_nm_) * (1.0f / kMeanReplies);
  // Of two replies that came together the time between says nothing.
  if (!answers || since_last_us < 500 || since_last_us > 1500 || turned_rad < kLeastTurnRad) return;
  turned_rad_ += turned_rad;
  reported_rad_ += mean_radps * static_cast<float>(since_last_us) * 1e-6f;
  if (turned_rad_ < kTurnsRad) return;
  ratio_ = reported_rad_ / turned_rad_;
  ratio_ticks_ = kRatioTicks;
  turned_rad_ = reported_rad_ = 0.0f;
}

}  // namespace furcula::firmware
