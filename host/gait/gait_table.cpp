#include "host/gait/gait_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/core/error.hpp"

namespace furcula::gait {

control::GaitConfig controller_config(const Gait& gait, const StanceGains& gains) {
  constexpr std::size_t kIntervals = control::GaitPath::kIntervals;
  StrideOptions options;
  options.lift_off = gait.task.lift_off;
  options.longest_step_s = 1e-3;
  options.energies = false;
  const StrideEnd<double> first = stride_of(gait, options);
  if (!first.whole) throw core::DataError("the gait makes no stride: " + std::string(first.why));
  const std::array<double, 3> durations{first.stance, first.rise, first.fall};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 1; i < kIntervals; ++i)
      options.samples[k].push_back(durations[k] * static_cast<double>(i) / static_cast<double>(kIntervals));

  control::GaitConfig out;
  const std::array<control::GaitPath*, 3> paths{&out.stance, &out.rise, &out.fall};
  std::array<double, 3> begin{};
  std::array<bool, 3> begun{};
  const auto pair = [](const Joints2<double>& v) {
    return control::JointPair{static_cast<float>(v.hip), static_cast<float>(v.knee)};
  };
  // The stride stops at each of these times; the phase's last moment is its end.
  options.moment = [&](const Moment& m) {
    const auto k = static_cast<std::size_t>(m.phase);
    if (!begun[k]) begin[k] = m.time_s;
    begun[k] = true;
    const double at = (m.time_s - begin[k]) / durations[k] * static_cast<double>(kIntervals);
    const double knot = std::round(at);
    if (std::abs(at - knot) > 1e-6 || knot > static_cast<double>(kIntervals)) return;
    paths[k]->knots[static_cast<std::size_t>(knot)] = {pair(m.angle), pair(m.rate), pair(m.torque)};
  };
  stride_of(gait, options);
  for (std::size_t k = 0; k < 3; ++k) paths[k]->duration_s = static_cast<float>(durations[k]);

  const FlightGains flight;
  out.flight_kp_nmprad = static_cast<float>(flight.kp_nmprad);
  out.flight_kd_nmsprad = static_cast<float>(flight.kd_nmsprad);
  out.stance_kp_nmprad = static_cast<float>(gains.kp_nmprad.hip);
  out.stance_kd_nmsprad = static_cast<float>(gains.kd_nmsprad.hip);
  out.feedback_most_nm = static_cast<float>(gains.most_nm);
  out.stance_ramp_s = static_cast<float>(gains.ramp_s);
  const auto& leg = gait.machine.leg;
  out.thigh_length_m = static_cast<float>(leg.thigh_length_m);
  out.shank_length_m = static_cast<float>(leg.shank_length_m);
  out.gravity_mps2 = static_cast<float>(leg.gravity_mps2);
  constexpr float kPlay = 0.1f;  // beyond the joints' ranges, rad
  out.least_rad = pair(gait.machine.least);
  out.most_rad = pair(gait.machine.most);
  out.least_rad = {out.least_rad.hip - kPlay, out.least_rad.knee - kPlay};
  out.most_rad = {out.most_rad.hip + kPlay, out.most_rad.knee + kPlay};
  return out;
}

}  // namespace furcula::gait
