// Paths of the joints' angles as polynomials of time, for laws that follow them: a spline's piece by piece.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host/gait/free_gait.hpp"

namespace furcula::gait {

/// Angle, rate and acceleration of both joints; rad, rad/s, rad/s^2.
template <class T>
using PathState = std::array<Joints2<T>, 3>;

class PathPieces {
 public:
  /// Adds a path that begins at the time `from`, s; what of it lies before zero is left out.
  void add(const JointPath& path, double from);
  double end_s() const { return pieces_.empty() ? 0.0 : pieces_.back().end_s; }

  /// How long after its end the path's last polynomial goes on, s: no kink lies on the gait itself. Then the angles go on
  /// at their rate, and stand still at last.
  static constexpr double kGoesOn = 3e-3, kDrifts = 0.05;
  /// Times at which the path is not smooth, after its end.
  std::array<double, 2> breaks() const { return {end_s() + kGoesOn, end_s() + kGoesOn + kDrifts}; }

  /// At `time`, on the side of a break on which `middle` lies.
  template <class T>
  PathState<T> at(const T& time, double middle) const {
    const auto [last, stands] = breaks();
    if (middle < last) return polynomial(time, middle);
    const PathState<double> p = polynomial(last, last);
    if (middle >= stands)
      return {Joints2<T>{T(p[0].hip + kDrifts * p[1].hip), T(p[0].knee + kDrifts * p[1].knee)}, {}, {}};
    const T past(time - last);
    return {Joints2<T>{p[0].hip + p[1].hip * past, p[0].knee + p[1].knee * past},
            Joints2<T>{T(p[1].hip), T(p[1].knee)},
            {}};
  }

 private:
  template <class T>
  PathState<T> polynomial(const T& time, double middle) const {
    std::size_t i = 0;
    while (i + 1 < pieces_.size() && middle >= pieces_[i].end_s) ++i;
    const Piece& p = pieces_[i];
    const T t(time - p.begin_s);
    PathState<T> out{Joints2<T>{T(p.power[Spline::kDegree].hip), T(p.power[Spline::kDegree].knee)}, {}, {}};
    for (std::size_t k = Spline::kDegree; k-- > 0;) {
      out[2] = {out[2].hip * t + out[1].hip, out[2].knee * t + out[1].knee};
      out[1] = {out[1].hip * t + out[0].hip, out[1].knee * t + out[0].knee};
      out[0] = {out[0].hip * t + p.power[k].hip, out[0].knee * t + p.power[k].knee};
    }
    out[2] = {2.0 * out[2].hip, 2.0 * out[2].knee};
    return out;
  }

  struct Piece {
    double begin_s = 0.0, end_s = 0.0;
    std::array<Joints2<double>, Spline::kOrder> power{};
  };
  std::vector<Piece> pieces_;
};

}  // namespace furcula::gait
