#include "host/gait/free_law.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"

namespace furcula::gait {

using dynamics::LegEquations;

FreeLaw::FreeLaw(const Machine& machine, const FreeGait& gait, const FlightGains& gains)
    : m_(machine),
      joints_(machine.leg),
      gait_(gait),
      gains_(gains),
      spring_rest_rad_(gait.spring_rest_rad(machine.catching)) {
  find_apex();
  find_breaks();
}

double FreeLaw::stride_s() const {
  double sum = 0.0;
  for (const JointPath& p : gait_.phases) sum += p.duration_s;
  return sum;
}

void FreeLaw::find_apex() {
  const LegEquations<double> leg(m_.leg);
  const JointPath& stance = gait_.stance();
  const JointPath::At off = stance.at(stance.duration_s);
  const auto pose = leg.pose(off.angle);
  const Vec2<double> hip = leg.pinned_hip_velocity(pose, off.rate),
                     turn = leg.centre_velocity(pose, off.rate);
  const Vec2<double> velocity{hip.x + turn.x, hip.y + turn.y};
  const double height = leg.centre(pose).y - leg.toe(pose).y;
  const auto hip_at = [&](double t) {
    const double first = gait_.phases[1].duration_s;
    const JointPath::At at = t < first ? gait_.phases[1].at(t) : gait_.phases[2].at(t - first);
    const auto o = leg.pose(at.angle);
    const Vec2<double> w = leg.centre_velocity(o, at.rate);
    Apex<double> a;
    a.height = height + velocity.y * t - 0.5 * m_.leg.gravity_mps2 * t * t - leg.centre(o).y;
    a.speed = velocity.x - w.x;
    a.angle = at.angle;
    a.rate = at.rate;
    return std::pair{a, velocity.y - m_.leg.gravity_mps2 * t - w.y};
  };
  const double whole = gait_.phases[1].duration_s + gait_.phases[2].duration_s;
  constexpr int kParts = 200;
  for (int i = 0; i < kParts; ++i) {
    double low = whole * i / kParts, high = whole * (i + 1) / kParts;
    if (!(hip_at(low).second > 0.0 && hip_at(high).second <= 0.0)) continue;
    for (int round = 0; round < 60; ++round) {
      const double middle = 0.5 * (low + high);
      (hip_at(middle).second > 0.0 ? low : high) = middle;
    }
    apex_s_ = low;
    apex_ = hip_at(low).first;
    return;
  }
  throw core::DataError("the gait has no apex: the hip does not rise and fall in flight");
}

void FreeLaw::find_breaks() {
  const auto add = [&](LegPhase phase, const JointPath& path, double from) {
    pieces_[static_cast<std::size_t>(phase)].add(path, from);
    auto& out = breaks_[static_cast<std::size_t>(phase)];
    const std::size_t n = path.spline().intervals();
    const auto time = [&](double s) { return from + s * path.duration_s; };
    for (std::size_t i = 0; i <= n; ++i) out.push_back(time(static_cast<double>(i) / static_cast<double>(n)));
    const bool stance = phase == LegPhase::stance;
    double rest = m_.leg.rest_angle_rad;
    if (m_.spring == LegSpring::switched) rest = spring_rest_rad_;
    if (m_.spring == LegSpring::none || (m_.spring == LegSpring::switched && !stance)) return;
    // Where the path's spring begins and ends to pull the torque has a kink.
    const auto stretch = [&](double s) { return path.at(s * path.duration_s).angle.knee - rest; };
    const std::size_t parts = 20 * n;
    for (std::size_t i = 0; i < parts; ++i) {
      double low = static_cast<double>(i) / static_cast<double>(parts),
             high = static_cast<double>(i + 1) / static_cast<double>(parts);
      const bool up = stretch(low) < 0.0;
      if (up == (stretch(high) < 0.0)) continue;
      for (int round = 0; round < 60; ++round) {
        const double middle = 0.5 * (low + high);
        ((stretch(middle) < 0.0) == up ? low : high) = middle;
      }
      out.push_back(time(low));
    }
  };
  add(LegPhase::stance, gait_.stance(), 0.0);
  for (const LegPhase phase : {LegPhase::rise, LegPhase::fall}) {
    const double from = phase == LegPhase::rise ? 0.0 : -apex_s_;
    add(phase, gait_.phases[1], from);
    add(phase, gait_.phases[2], from + gait_.phases[1].duration_s);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    auto& b = breaks_[k];
    for (const double t : pieces_[k].breaks()) b.push_back(t);
    std::sort(b.begin(), b.end());
    b.erase(std::remove_if(b.begin(), b.end(), [](double t) { return t <= 0.0; }), b.end());
  }
}

}  // namespace furcula::gait
