// Plays a gait of free torques: in stance its torques over time, in flight the same with a feedback that holds the
// leg to its angles.
#pragma once

#include <array>
#include <vector>

#include "host/gait/free_gait.hpp"
#include "host/gait/path_pieces.hpp"
#include "host/gait/stride.hpp"

namespace furcula::gait {

/// Of hip and knee alike; vanishes on the gait itself.
struct FlightGains {
  double kp_nmprad = 200.0, kd_nmsprad = 5.0;
};

class FreeLaw {
 public:
  FreeLaw(const Machine& machine, const FreeGait& gait, const FlightGains& gains = {});

  /// The hip's highest point, as the gait has it. @throws core::DataError: the hip has none in flight
  const Apex<double>& apex() const { return apex_; }
  double stride_s() const;
  double rise_s() const { return apex_s_; }  ///< from lift-off to the apex

  template <class T>
  Joints2<T> motors(LegPhase phase, const T& time, double middle, const Joints2<T>& angle,
                    const Joints2<T>& rate) const {
    const bool stance = phase == LegPhase::stance;
    const PathState<T> path = pieces_[static_cast<std::size_t>(phase)].at(time, middle);
    const auto pose = joints_.pose(path[0]);
    Joints2<T> u =
        stance ? joints_.torque<true>(pose, path[1], path[2]) : joints_.torque<false>(pose, path[1], path[2]);
    if (m_.spring == LegSpring::parallel || (m_.spring == LegSpring::switched && stance)) {
      const T stretch =
          path[0].knee - (m_.spring == LegSpring::parallel ? m_.leg.rest_angle_rad : spring_rest_rad_);
      if (dynamics::value_of(stretch) > 0.0) u.knee = u.knee + m_.leg.stiffness_nmprad * stretch;
    }
    if (stance) return u;
    u.hip =
        u.hip + gains_.kp_nmprad * (path[0].hip - angle.hip) + gains_.kd_nmsprad * (path[1].hip - rate.hip);
    u.knee = u.knee + gains_.kp_nmprad * (path[0].knee - angle.knee) +
             gains_.kd_nmsprad * (path[1].knee - rate.knee);
    return u;
  }
  const std::vector<double>& breaks(LegPhase phase) const { return breaks_[static_cast<std::size_t>(phase)]; }

 private:
  void find_apex();
  void find_breaks();

  const Machine& m_;
  dynamics::LegJoints<double> joints_;
  FreeGait gait_;
  FlightGains gains_;
  double spring_rest_rad_;
  double apex_s_ = 0.0;  ///< since lift-off
  Apex<double> apex_;
  std::array<PathPieces, 3> pieces_;
  std::array<std::vector<double>, 3> breaks_;
};

}  // namespace furcula::gait
