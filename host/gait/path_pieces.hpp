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
    const T t(time - p.begin_s), t2 = t * t;
    // In halves of two terms each, which do not wait for one another.
    const auto sum = [&](const std::array<double, Spline::kOrder>& c) {
      return T((c[0] + c[1] * t) + t2 * ((c[2] + c[3] * t) + t2 * (c[4] + c[5] * t)));
    };
    PathState<T> out;
    for (std::size_t d = 0; d < out.size(); ++d) out[d] = {sum(p.hip[d]), sum(p.knee[d])};
    return out;
  }

  /// Factors of 1, t, t^2, ... of the angle, its rate and its acceleration.
  using Powers = std::array<std::array<double, Spline::kOrder>, 3>;
  struct Piece {
    double begin_s = 0.0, end_s = 0.0;
    Powers hip{}, knee{};
  };
  std::vector<Piece> pieces_;
};

}  // namespace furcula::gait
