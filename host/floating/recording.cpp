#include "host/floating/recording.hpp"

#include <algorithm>
#include <cmath>

#include "host/biped/machine.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::floating {
namespace {

constexpr double kMostRoll_rad = 0.35, kMostPitch_rad = 0.5, kBeforeFall_s = 0.15, kAfterLanding_s = 0.06;
constexpr double kStill_radps = 0.1;  // as a board on its stand (control::WalkerConfig::rest_radps)

}  // namespace

Recording recording_of(const log::Log& log) {
  std::vector<std::string> missing;
  static const std::vector<double> kNone;
  const auto column = [&](const std::string& name) -> const std::vector<double>& {
    if (log.has(name)) return log.at(name);
    missing.push_back(name);
    return kNone;
  };
  const auto& time = column("time_s");
  std::array<const std::vector<double>*, kJoints> angle{}, rate{}, target{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    angle[i] = &column("angle_" + link_name(i) + "_rad");
    rate[i] = &column("velocity_" + link_name(i) + "_radps");
    target[i] = &column("angle_cmd_" + link_name(i) + "_rad");
  }
  const auto &gx = column("gyro_x_radps"), &gy = column("gyro_y_radps"), &gz = column("gyro_z_radps");
  const auto &roll = column("roll_rad"), &pitch = column("pitch_rad"), &yaw = column("yaw_rad");
  const auto &left = column("contact_left_foot"), &right = column("contact_right_foot");
  if (!missing.empty())
    throw core::DataError(
        log.path + ": no column " + core::quoted(missing.front()) +
        (missing.size() > 1 ? " and " + std::to_string(missing.size() - 1) + " others" : "") +
        "; expected angles, rates and targets of 12 joints, gyro, roll, pitch, yaw and two foot "
        "switches, as `furcula walk sim` writes them");
  Recording out;
  out.file = log.path;
  std::size_t rows = log.rows();
  for (std::size_t k = 0; k < rows; ++k)
    if (std::abs(roll[k]) > kMostRoll_rad || std::abs(pitch[k]) > kMostPitch_rad) {
      std::size_t until = k;
      while (until > 0 && time[k] - time[until] < kBeforeFall_s - 1e-9) --until;
      out.fall_s = time[k] - time[0];
      out.notes.push_back(log.path + ": the robot falls " + core::rounded(*out.fall_s, 3) +
                          " s after the first row; the rows before " +
                          core::rounded(time[until] - time[0], 3) + " s are used");
      rows = until;
    }
  out.rows.reserve(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    Row r;
    r.time_s = time[k];
    for (std::size_t i = 0; i < kJoints; ++i)
      r.angle_rad[i] = (*angle[i])[k], r.rate_radps[i] = (*rate[i])[k], r.target_rad[i] = (*target[i])[k];
    r.attitude = walk::attitude_of({roll[k], pitch[k], yaw[k]});
    r.gyro_radps = {gx[k], gy[k], gz[k]};
    r.contact = {left[k] > 0.5, right[k] > 0.5};
    out.rows.push_back(r);
  }
  double turning = 0.0;
  for (const Row& r : out.rows) turning += dot(r.gyro_radps, r.gyro_radps);
  out.held = turning < 3.0 * kStill_radps * kStill_radps * static_cast<double>(out.rows.size()) &&
             std::none_of(out.rows.begin(), out.rows.end(),
                          [](const Row& r) { return r.contact[0] || r.contact[1]; });
  if (out.held) out.notes.push_back(log.path + ": no foot is ever loaded: a robot on its stand");
  return out;
}

std::vector<Window> windows_of(const Recording& recording, std::size_t index, double length_s,
                               Unused* unused) {
  Unused excluded;
  const auto& rows = recording.rows;
  std::vector<Window> out;
  const auto lands = [&](std::size_t k) {
    return (rows[k].contact[0] && !rows[k - 1].contact[0]) || (rows[k].contact[1] && !rows[k - 1].contact[1]);
  };
  std::size_t phase = 0;
  std::size_t first = 1;  // a row before the first: its target is held until then
  while (first + 1 < rows.size()) {
    std::size_t end = first + 1;  // one behind the last row
    while (end < rows.size() && !lands(end) && rows[end].time_s - rows[first].time_s < length_s + 1e-9) ++end;
    Window w{index, first, end - first, {true, true}, 0, phase};
    for (std::size_t k = first; k < end; ++k)
      for (std::size_t side = 0; side < 2; ++side) w.stance[side] = w.stance[side] && rows[k].contact[side];
    const auto carries_since = [&](std::size_t side) {
      std::size_t k = first;
      while (k > 0 && rows[k - 1].contact[side]) --k;
      return k;
    };
    w.foot = w.stance[1] && (!w.stance[0] || carries_since(1) < carries_since(0)) ? 1 : 0;
    const bool landing = end < rows.size() && lands(end);
    phase = landing ? 0 : phase + 1;
    const double duration_s = rows[end - 1].time_s - rows[first].time_s;
    if (!w.stance[0] && !w.stance[1] && !recording.held)
      excluded.no_stance_s += duration_s;
    else if (duration_s > 0.5 * length_s)
      out.push_back(w);
    else
      excluded.short_s += duration_s;
    first = end - (landing ? 0 : 1);
    if (landing)
      for (std::size_t landed = end;
           first + 1 < rows.size() && rows[first].time_s - rows[landed].time_s < kAfterLanding_s - 1e-9;)
        if (lands(++first)) landed = first;
    if (!landing && first == w.first) ++first;
    excluded.landings_s += rows[std::min(first, rows.size() - 1)].time_s - rows[end - 1].time_s;
  }
  if (unused != nullptr) *unused = excluded;
  return out;
}

}  // namespace furcula::floating
