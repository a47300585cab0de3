// See drive.hpp.
#include "tests/hidden/drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/hidden/random.hpp"

namespace furcula::hidden {

Drive::Drive(const std::vector<Planted>& planted, double start_s, std::uint64_t draw)
    : limit_(std::numeric_limits<double>::infinity()), since_s_(start_s) {
  if (const auto* v = find(planted, "actuator_delay")) delay_s_ = (*v)[0];
  if (const auto* v = find(planted, "actuator_lag")) time_constant_s_ = (*v)[0];
  if (const auto* v = find(planted, "torque_saturation")) limit_ = (*v)[0];
  if (const auto* v = find(planted, "drive_deadband")) dead_band_ = (*v)[0];
  if (const auto* v = find(planted, "torque_gain_error")) gain_ = (*v)[0];
  if (const auto* v = find(planted, "torque_offset")) offset_ = (*v)[0];
  if (const auto* v = find(planted, "thermal_derating")) {
    final_gain_ = (*v)[0];
    derating_s_ = (*v)[1];
  }
  if (const auto* v = find(planted, "torque_ripple")) {
    ripple_ = (*v)[0];
    ripple_cycles_ = (*v)[1];
    ripple_phase_rad_ = (*v)[2];
  }
  if (const auto* v = find(planted, "drive_dropout")) {
    constexpr double kLongest_s = 60.0;
    Random random(draw * 0x9E3779B97F4A7C15u + 17);
    for (double t = start_s; t < start_s + kLongest_s;) {
      t -= std::log(1.0 - random.unit()) / (*v)[1];
      dropouts_s_.push_back(t);
      dropouts_s_.push_back(t += (*v)[0]);
    }
  }
}

void Drive::command(double time_s, double value) {
  pending_.push_back({time_s + delay_s_, value});
  settle(time_s);
}

double Drive::next_change_s() const {
  double next = pending_.empty() ? std::numeric_limits<double>::infinity() : pending_.front().time_s;
  if (dropout_ < dropouts_s_.size()) next = std::min(next, dropouts_s_[dropout_]);
  return next;
}

void Drive::settle(double time_s) {
  for (double next = next_change_s(); next <= time_s; next = next_change_s()) {
    lag_from_ = reported(next);
    if (value_ != 0) commanded_s_ += next - since_s_;
    since_s_ = next;
    if (!pending_.empty() && pending_.front().time_s <= next) {
      value_ = pending_.front().value;
      pending_.pop_front();
    } else {
      ++dropout_;
    }
  }
}

double Drive::target() const {
  if (dropout_ % 2 == 1 || std::abs(value_) < dead_band_) return 0.0;
  return std::clamp(value_, -limit_, limit_);
}

double Drive::reported(double time_s) const {
  if (time_constant_s_ <= 0) return target();
  return target() + (lag_from_ - target()) * std::exp(-(time_s - since_s_) / time_constant_s_);
}

double Drive::delivered(double time_s, double angle_rad) const {
  const double warm_s = commanded_s_ + (value_ != 0 ? time_s - since_s_ : 0.0);
  const double derating = final_gain_ + (1 - final_gain_) * std::exp(-warm_s / derating_s_);
  const double ripple =
      ripple_ == 0 ? 0.0 : ripple_ * std::sin(ripple_cycles_ * angle_rad + ripple_phase_rad_);
  return gain_ * derating * reported(time_s) + offset_ + ripple;
}

}  // namespace furcula::hidden
