// Measured rows less residuals.
#include "host/floating/predicted.hpp"

#include <algorithm>
#include <cmath>

#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::floating {

double noise_sd(std::size_t channel) {
  static const Variances kVariances = first_variances();
  return std::sqrt(kVariances.noise[noise_of(channel)]);
}

std::string channel_name(std::size_t channel) {
  static constexpr const char* kOthers[] = {"roll", "pitch", "yaw", "gyro x", "gyro y", "gyro z"};
  if (channel >= kJoints) return kOthers[channel - kJoints];
  std::string name = link_name(channel);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

const char* channel_unit(std::size_t channel) { return channel < kJoints + 3 ? "rad" : "rad/s"; }

std::vector<Row> predicted_rows(const Recording& recording, const Predicted& predicted) {
  std::vector<Row> out;
  for (std::size_t k = 1; k < predicted.window.count; ++k) {
    Row row = recording.rows[predicted.window.first + k];
    const double* r = predicted.residual.data() + (k - 1) * kRowSize;
    for (std::size_t i = 0; i < kJoints; ++i) row.angle_rad[i] -= r[i];
    const auto turn =
        rate(row.attitude, dynamics::tree::Vec3<double>{-r[kJoints], -r[kJoints + 1], -r[kJoints + 2]});
    row.attitude = normalised(dynamics::biped::Quaternion<double>{
        row.attitude.w + turn.w, row.attitude.x + turn.x, row.attitude.y + turn.y, row.attitude.z + turn.z});
    row.gyro_radps =
        row.gyro_radps - dynamics::tree::Vec3<double>{r[kJoints + 3], r[kJoints + 4], r[kJoints + 5]};
    out.push_back(row);
  }
  return out;
}

double value_of(const Row& row, std::size_t channel) {
  if (channel < kJoints) return row.angle_rad[channel];
  const walk::RollPitchYaw attitude = walk::roll_pitch_yaw(row.attitude);
  const double values[] = {attitude.roll_rad, attitude.pitch_rad, attitude.yaw_rad,
                           row.gyro_radps.x,  row.gyro_radps.y,   row.gyro_radps.z};
  return values[channel - kJoints];
}

}  // namespace furcula::floating
