// What stabilises a gait: in stance a PD law about the gait's own path, as its flight has one. It vanishes on the gait, so
// that the gait's cost stays what it is.
#pragma once

#include <cmath>
#include <vector>

#include "host/gait/free_law.hpp"
#include "host/gait/path_pieces.hpp"
#include "host/gait/stride.hpp"

namespace furcula::gait {

/// Of hip and knee; zero is no feedback.
struct StanceGains {
  Joints2<double> kp_nmprad, kd_nmsprad;
  double most_nm = 40.0;  ///< of the feedback, of each joint: what a spring of the knee gives at most
  /// The gains grow from zero in this time after touch-down, as the ground's force does: where it carries little yet, a
  /// torque against a deviation would lift the toe; s.
  double ramp_s = 0.08;

  bool none() const {
    return kp_nmprad.hip == 0.0 && kp_nmprad.knee == 0.0 && kd_nmsprad.hip == 0.0 && kd_nmsprad.knee == 0.0;
  }
};

/// A law of torques with the feedback in stance. `Law` as run_stride() wants it; it has to live as long.
template <class Law>
class HeldLaw {
 public:
  HeldLaw(const Law& law, const PathPieces& stance, const StanceGains& gains)
      : law_(law), stance_(stance), gains_(gains) {}

  template <class T>
  Joints2<T> motors(LegPhase phase, const T& time, double middle, const Joints2<T>& angle,
                    const Joints2<T>& rate) const {
    Joints2<T> u = law_.motors(phase, time, middle, angle, rate);
    if (phase != LegPhase::stance || gains_.none()) return u;
    const PathState<T> path = stance_.at(time, middle);
    const T share = middle < gains_.ramp_s ? T(time / gains_.ramp_s) : T(1.0);
    u.hip = u.hip + limited(T(share * (gains_.kp_nmprad.hip * (path[0].hip - angle.hip) +
                                       gains_.kd_nmsprad.hip * (path[1].hip - rate.hip))));
    u.knee = u.knee + limited(T(share * (gains_.kp_nmprad.knee * (path[0].knee - angle.knee) +
                                         gains_.kd_nmsprad.knee * (path[1].knee - rate.knee))));
    return u;
  }
  std::vector<double> breaks(LegPhase phase) const {
    std::vector<double> out(law_.breaks(phase));
    if (phase == LegPhase::stance && !gains_.none()) {
      for (const double t : stance_.breaks()) out.push_back(t);
      out.push_back(gains_.ramp_s);
    }
    return out;
  }

 private:
  template <class T>
  T limited(const T& torque) const {
    const double value = dynamics::value_of(torque);
    return std::abs(value) <= gains_.most_nm ? torque : T(std::copysign(gains_.most_nm, value));
  }

  const Law& law_;
  const PathPieces& stance_;
  StanceGains gains_;
};

}  // namespace furcula::gait
