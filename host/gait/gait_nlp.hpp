// The programme of a gait: splines over the phases of a stride, of which each candidate obeys the equations of
// motion, with the events, the ground and the cost (free_gait.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/gait/free_gait.hpp"
#include "host/optimise/nlp.hpp"

namespace furcula::gait {

using dynamics::LegEquations;
using optimise::GaussPoint;
using optimise::kCostRow;
using optimise::kGauss;
using optimise::kNoBound;
using optimise::Nlp;
using optimise::Second;
using optimise::Solution;
using optimise::SolveOptions;
using optimise::Sum;

/// What parts two phases of a flight: the toe's highest point, the hip's.
enum class Turn { top, apex };

/// max(d, 0), rounded over a width of some e.
template <class T>
T rounded_positive(const T& d, double e) {
  using std::sqrt;
  return 0.5 * (d + sqrt(T(d * d + e * e)));
}

/// The first phase is the stance, the others the flight. Angles are in rad by the phase's own time from 0 to 1.
class GaitNlp {
 public:
  GaitNlp(const Machine& machine, const Task& task, const std::vector<JointPath>& start,
          const std::vector<Turn>& turns, double rounding, double margin = 0.0)
      : m_(machine),
        task_(task),
        rounding_(rounding),
        margin_(margin),
        turns_(turns),
        phases_(start.size()),
        catch_share_(std::min(machine.catching.delay_s / start.front().duration_s, 1.0)) {
    for (const JointPath& path : start) add_phase(path);
    const LegEquations<double> eq(machine.leg);
    const auto end = start.front().at(start.front().duration_s);
    const auto pose = eq.pose(end.angle);
    const Vec2<double> hip = eq.pinned_hip_velocity(pose, end.rate),
                       turn = eq.centre_velocity(pose, end.rate);
    const Vec2<double> centre = eq.centre(pose), toe = eq.toe(pose);
    vx_ = p_.variable(-10.0, 10.0, hip.x + turn.x);
    vy_ = p_.variable(-10.0, 10.0, hip.y + turn.y);
    height_ = p_.variable(-2.0, 2.0, centre.y - toe.y);
    place_ = p_.variable(-2.0, 2.0, centre.x - toe.x);
    energy_ = p_.variable(0.0, kNoBound, 5.0);
    total_ = p_.row(kCostRow, 0.0, 0.0);
    p_.linear(total_, {{energy_, -1.0}});
    add_points();
    add_lift_off();
    for (std::size_t k = 1; k + 1 < phases_; ++k) add_turn(k);
    add_touch_down();
    add_cost();
  }

  Nlp& nlp() { return p_; }

  std::vector<JointPath> paths(const std::vector<double>& x) const {
    std::vector<JointPath> out(phases_);
    for (std::size_t k = 0; k < phases_; ++k) {
      JointPath& path = out[k];
      path.duration_s = x[static_cast<std::size_t>(duration_[k])];
      for (const int v : coefficient_[k][0]) path.hip.push_back(x[static_cast<std::size_t>(v)]);
      for (const int v : coefficient_[k][1]) path.knee.push_back(x[static_cast<std::size_t>(v)]);
    }
    return out;
  }

 protected:
  /// Phases share the coefficients at their ends: angles are continuous over the whole stride.
  void add_phase(const JointPath& path) {
    const std::size_t k = spline_.size();
    spline_.push_back(path.spline());
    duration_.push_back(p_.variable(k == 0 ? 0.05 : 0.002, k == 0 ? 2.0 : 1.0, path.duration_s));
    coefficient_.emplace_back();
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const std::vector<double>& c = joint == 0 ? path.hip : path.knee;
      auto& own = coefficient_[k][joint];
      for (std::size_t i = 0; i < c.size(); ++i) {
        if (i == 0 && k > 0)
          own.push_back(coefficient_[k - 1][joint].back());
        else if (i + 1 == c.size() && k + 1 == phases_)
          own.push_back(coefficient_[0][joint].front());
        else
          own.push_back(p_.variable(-4.0, 4.0, c[i]));
      }
    }
  }

  /// A joint's angle or its derivative by the phase's own time.
  Sum path(std::size_t phase, std::size_t joint, std::size_t derivative, double s,
           std::size_t interval) const {
    const Spline::Basis b = spline_[phase].basis(s, interval);
    Sum out;
    for (std::size_t i = 0; i < Spline::kOrder; ++i)
      if (b.share[derivative][i] != 0.0)
        out.emplace_back(coefficient_[phase][joint][b.first + i], b.share[derivative][i]);
    return out;
  }
  Sum start(std::size_t phase, std::size_t joint, std::size_t derivative) const {
    return path(phase, joint, derivative, 0.0, 0);
  }
  Sum end(std::size_t phase, std::size_t joint, std::size_t derivative) const {
    return path(phase, joint, derivative, 1.0, spline_[phase].intervals() - 1);
  }
  Sum touchdown_knee() const { return {{coefficient_[0][1].front(), 1.0}}; }
  /// Where a switched spring catches; what a tooth loses is left out. The share of the stance at which it does is that
  /// of the start: find_free_gait() solves until it stays.
  Sum caught_knee() const { return path(0, 1, 0, catch_share_, spline_[0].interval_at(catch_share_)); }
  static Sum of(int variable) { return {{variable, 1.0}}; }

  /// The motors' torques: what the motion needs, less the spring's. `rest` counts in stance alone.
  template <class T>
  Joints2<T> motors(const Joints2<T>& needed, const T& knee, const T& rest, bool stance) const {
    Joints2<T> u = needed;
    if (m_.spring == LegSpring::switched && stance) {
      // Where the knee stays flexed beyond its angle of touch-down there is no kink.
      const T d = knee - rest - m_.catching.lost_rad;
      const bool kink = task_.lift_off == LegLiftOff::unguarded || !m_.catching.ideal();
      u.knee = u.knee + m_.leg.stiffness_nmprad * (kink ? rounded_positive(d, rounding_) : d);
    } else if (m_.spring == LegSpring::parallel) {
      u.knee =
          u.knee + m_.leg.stiffness_nmprad * rounded_positive(T(knee - m_.leg.rest_angle_rad), rounding_);
    }
    return u;
  }

  void add_points() {
    for (std::size_t k = 0; k < phases_; ++k) {
      const std::size_t n = spline_[k].intervals();
      for (std::size_t i = 0; i < n; ++i)
        for (const GaussPoint& g : kGauss)
          add_point(k, i, (static_cast<double>(i) + g.at) / static_cast<double>(n),
                    g.weight / static_cast<double>(n));
    }
  }

  void add_point(std::size_t k, std::size_t interval, double s, double weight) {
    std::array<int, 2> slack{}, work{};
    for (std::size_t joint = 0; joint < 2; ++joint) {
      slack[joint] = p_.variable(0.0, kNoBound, 0.02);
      work[joint] = p_.row(kCostRow, 0.0, kNoBound);
      p_.linear(work[joint], {{slack[joint], 1.0}});
      p_.linear(total_, {{slack[joint], 1.0}});
      const double low = joint == 0 ? m_.least.hip : m_.least.knee;
      const double high = joint == 0 ? m_.most.hip : m_.most.knee;
      p_.linear(p_.row(joint == 0 ? "the hip's range" : "the knee's range", low, high),
                path(k, joint, 0, s, interval));
    }
    const std::array<Sum, 8> inputs{path(k, 0, 0, s, interval), path(k, 1, 0, s, interval),
                                    path(k, 0, 1, s, interval), path(k, 1, 1, s, interval),
                                    path(k, 0, 2, s, interval), path(k, 1, 2, s, interval),
                                    of(duration_[k]),           caught_knee()};
    const Joints2<double> heat = m_.motors.heat();
    if (m_.motors.current_a > 0.0 || m_.motors.supply_v > 0.0) add_motor_limits(k, inputs);
    if (k == 0) {
      const int force = p_.row("the ground that does not pull", 0.01 * margin_, kNoBound);
      if (task_.lift_off != LegLiftOff::unguarded) {
        Sum beyond = path(0, 1, 0, s, interval);
        for (const auto& [v, f] : touchdown_knee()) beyond.emplace_back(v, -f);
        p_.linear(p_.row("the knee's angle of touch-down", 0.0, kNoBound), beyond);
      }
      if (task_.friction) {
        const double mu = *task_.friction;
        const std::array<int, 2> cone{p_.row("the ground's friction", 0.0, kNoBound),
                                      p_.row("the ground's friction", 0.0, kNoBound)};
        p_.element(inputs, cone, [this, mu](const auto& z) {
          using T = std::decay_t<decltype(z[0])>;
          const auto n = needed(z, true);
          return std::array<T, 2>{0.01 * (mu * n.ground_force.y - n.ground_force.x),
                                  0.01 * (mu * n.ground_force.y + n.ground_force.x)};
        });
      }
      p_.element(inputs, std::array<int, 3>{work[0], work[1], force}, [this, heat, weight](const auto& z) {
        using T = std::decay_t<decltype(z[0])>;
        const auto n = needed(z, true);
        const Joints2<T> u = motors<T>(n.torque, z[1], z[7], true);
        const T w = T(-weight) * z[6], r = 1.0 / z[6];
        return std::array<T, 3>{w * electric_power(heat.hip, u.hip, T(z[2] * r)),
                                w * electric_power(heat.knee, u.knee, T(z[3] * r)), 0.01 * n.ground_force.y};
      });
      return;
    }
    p_.element(inputs, work, [this, heat, weight](const auto& z) {
      using T = std::decay_t<decltype(z[0])>;
      const auto n = needed(z, false);
      const Joints2<T> u = motors<T>(n.torque, z[1], z[7], false);
      const T w = T(-weight) * z[6], r = 1.0 / z[6];
      return std::array<T, 2>{w * electric_power(heat.hip, u.hip, T(z[2] * r)),
                              w * electric_power(heat.knee, u.knee, T(z[3] * r))};
    });
    // The toe leaves and comes from zero: a margin of its height grows from there.
    const double away = (k == 1 ? s : 1.0) * (k + 1 == phases_ ? 1.0 - s : 1.0);
    const int toe = p_.row("the toe's height in flight", 1e-4 * margin_ * away, kNoBound);
    p_.element(std::array<Sum, 5>{path(k, 0, 0, s, interval), path(k, 1, 0, s, interval), since(k, s),
                                  of(vy_), of(height_)},
               std::array<int, 1>{toe}, [this](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 return std::array<T, 1>{toe_height<T>({z[0], z[1]}, z[2], z[3], z[4])};
               });
  }

  void add_motor_limits(std::size_t k, const std::array<Sum, 8>& inputs) {
    // A little less where more came out between these points.
    const auto limit = [this](double most) { return most > 0.0 ? most * (1.0 - 0.01 * margin_) : kNoBound; };
    const double amperes = limit(m_.motors.current_a), volts = limit(m_.motors.supply_v);
    const std::array<int, 4> rows{
        p_.row("the motors' current", -amperes, amperes), p_.row("the motors' current", -amperes, amperes),
        p_.row("the motors' voltage", -volts, volts), p_.row("the motors' voltage", -volts, volts)};
    p_.element(inputs, rows, [this, stance = k == 0](const auto& z) {
      using T = std::decay_t<decltype(z[0])>;
      const Joints2<T> u = motors<T>(needed(z, stance).torque, z[1], z[7], stance);
      const T r = 1.0 / z[6];
      const Motors& m = m_.motors;
      const double hip = m.hip_gear * m.torque_constant_nmpa, knee = m.knee_gear * m.torque_constant_nmpa;
      const T hip_a = (1.0 / hip) * u.hip, knee_a = (1.0 / knee) * u.knee;
      return std::array<T, 4>{hip_a, knee_a, hip * (z[2] * r) + m.resistance_ohm * hip_a,
                              knee * (z[3] * r) + m.resistance_ohm * knee_a};
    });
  }

  /// Time since lift-off.
  Sum since(std::size_t k, double s) const {
    Sum out;
    for (std::size_t i = 1; i < k; ++i) out.emplace_back(duration_[i], 1.0);
    out.emplace_back(duration_[k], s);
    return out;
  }

  template <class Z>
  auto needed(const Z& z, bool stance) const {
    using T = std::decay_t<decltype(z[0])>;
    const LegEquations<T, double> leg(m_.leg);
    const T r = 1.0 / z[6];
    const Joints2<T> rate{z[2] * r, z[3] * r}, acceleration{z[4] * r * r, z[5] * r * r};
    const auto pose = leg.pose({z[0], z[1]});
    return stance ? leg.needed_in_stance(pose, rate, acceleration)
                  : leg.needed_in_flight(pose, rate, acceleration);
  }

  /// In flight, from the fall of the centre of mass.
  template <class T>
  T toe_height(const Joints2<T>& angle, const T& time, const T& vy, const T& height) const {
    const LegEquations<T, double> leg(m_.leg);
    const auto pose = leg.pose(angle);
    return height + vy * time - 0.5 * m_.leg.gravity_mps2 * time * time + leg.toe(pose).y -
           leg.centre(pose).y;
  }

  void add_lift_off() {
    const bool by_knee = task_.lift_off == LegLiftOff::knee;
    const std::array<int, 5> rows{
        p_.row("the ground's force at lift-off", 0.0, by_knee ? kNoBound : 0.0),
        p_.row("speed at lift-off", 0.0, 0.0), p_.row("speed at lift-off", 0.0, 0.0),
        p_.row("place at lift-off", 0.0, 0.0), p_.row("place at lift-off", 0.0, 0.0)};
    p_.linear(rows[1], {{vx_, -1.0}});
    p_.linear(rows[2], {{vy_, -1.0}});
    p_.linear(rows[3], {{place_, -1.0}});
    p_.linear(rows[4], {{height_, -1.0}});
    p_.element(std::array<Sum, 7>{end(0, 0, 0), end(0, 1, 0), end(0, 0, 1), end(0, 1, 1), end(0, 0, 2),
                                  end(0, 1, 2), of(duration_[0])},
               rows, [this](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 const LegEquations<T, double> leg(m_.leg);
                 const auto n = needed(z, true);
                 const auto pose = leg.pose({z[0], z[1]});
                 const T r = 1.0 / z[6];
                 const Joints2<T> rate{z[2] * r, z[3] * r};
                 const auto hip = leg.pinned_hip_velocity(pose, rate);
                 const auto turn = leg.centre_velocity(pose, rate);
                 const auto toe = leg.toe(pose), centre = leg.centre(pose);
                 return std::array<T, 5>{0.01 * n.ground_force.y, hip.x + turn.x, hip.y + turn.y,
                                         centre.x - toe.x, centre.y - toe.y};
               });
    if (task_.lift_off == LegLiftOff::force) {
      Sum beyond = end(0, 1, 0);
      for (const auto& [v, f] : touchdown_knee()) beyond.emplace_back(v, -f);
      p_.linear(p_.row("the knee's angle of touch-down", 0.0, kNoBound), beyond);
    }
    // The ground's force just after touch-down.
    p_.element(std::array<Sum, 7>{start(0, 0, 0), start(0, 1, 0), start(0, 0, 1), start(0, 1, 1),
                                  start(0, 0, 2), start(0, 1, 2), of(duration_[0])},
               std::array<int, 1>{p_.row("the ground that does not pull", 0.0, kNoBound)},
               [this](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 return std::array<T, 1>{0.01 * needed(z, true).ground_force.y};
               });
    if (by_knee) {
      Sum back = end(0, 1, 0);
      for (const auto& [v, f] : touchdown_knee()) back.emplace_back(v, -f);
      p_.linear(p_.row("the knee's angle of touch-down at lift-off", 0.0, 0.0), back);
      // The toe has to leave the ground by what the motors do next.
      p_.element(std::array<Sum, 7>{start(1, 0, 0), start(1, 1, 0), start(1, 0, 1), start(1, 1, 1),
                                    start(1, 0, 2), start(1, 1, 2), of(duration_[1])},
                 std::array<int, 1>{p_.row("the toe that has to leave the ground", 0.0, kNoBound)},
                 [this](const auto& z) {
                   using T = std::decay_t<decltype(z[0])>;
                   const LegEquations<T, double> leg(m_.leg);
                   const T r = 1.0 / z[6];
                   const auto pose = leg.pose({z[0], z[1]});
                   const auto n = needed(z, false);
                   const Joints2<T> w{z[2] * r, z[3] * r};
                   const T shank = w.hip + w.knee;
                   return std::array<T, 1>{
                       0.1 * (n.hip_acceleration.y +
                              LegEquations<T, double>::dot(pose.toe_y, {z[4] * r * r, z[5] * r * r}) +
                              m_.leg.thigh_length_m * pose.cos_hip * w.hip * w.hip +
                              m_.leg.shank_length_m * pose.cos_shank * shank * shank)};
                 });
    }
    add_same_rates(0, 1);
  }

  /// Torques are bounded: rates do not jump between phases that no impact parts.
  void add_same_rates(std::size_t before, std::size_t after) {
    const std::array<int, 2> rows{p_.row("rates between phases", 0.0, 0.0),
                                  p_.row("rates between phases", 0.0, 0.0)};
    p_.element(std::array<Sum, 6>{end(before, 0, 1), end(before, 1, 1), start(after, 0, 1),
                                  start(after, 1, 1), of(duration_[before]), of(duration_[after])},
               rows, [](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 const T b = 1.0 / z[4], a = 1.0 / z[5];
                 return std::array<T, 2>{z[0] * b - z[2] * a, z[1] * b - z[3] * a};
               });
  }

  /// What parts two phases of the flight.
  void add_turn(std::size_t k) {
    add_same_rates(k, k + 1);
    const bool top = turns_[k - 1] == Turn::top;
    const double height = task_.clearance_m.value_or(0.0);
    const std::array<int, 2> rows{p_.row("the toe's clearance", top ? height : 0.0, top ? height : kNoBound),
                                  p_.row(top ? "the toe's highest point" : "the apex", 0.0, 0.0)};
    p_.element(std::array<Sum, 8>{end(k, 0, 0), end(k, 1, 0), end(k, 0, 1), end(k, 1, 1), of(duration_[k]),
                                  of(vy_), of(height_), since(k, 1.0)},
               rows, [this, top](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 const LegEquations<T, double> leg(m_.leg);
                 const T r = 1.0 / z[4];
                 const auto pose = leg.pose({z[0], z[1]});
                 const Joints2<T> rate{z[2] * r, z[3] * r};
                 const T hip = z[5] - m_.leg.gravity_mps2 * z[7] - leg.centre_velocity(pose, rate).y;
                 return std::array<T, 2>{toe_height<T>({z[0], z[1]}, z[7], z[5], z[6]),
                                         top ? T(hip + leg.toe_velocity(pose, rate).y) : hip};
               });
  }

  void add_touch_down() {
    const std::size_t last = phases_ - 1;
    const double mu = task_.friction.value_or(0.0), cone = task_.friction ? 0.0 : -kNoBound;
    const std::array<int, 8> rows{p_.row("the toe's height at touch-down", 0.0, 0.0),
                                  p_.row("the impact", 0.0, 0.0),
                                  p_.row("the impact", 0.0, 0.0),
                                  p_.row("the toe that comes down", -kNoBound, -task_.landing_speed_mps),
                                  p_.row("the impact that does not pull", 0.0, kNoBound),
                                  p_.row("the way of a stride", 0.0, 0.0),
                                  p_.row("the ground's friction at touch-down", cone, kNoBound),
                                  p_.row("the ground's friction at touch-down", cone, kNoBound)};
    if (task_.speed_mps)
      for (const int d : duration_) p_.linear(rows[5], {{d, -*task_.speed_mps}});
    p_.element(std::array<Sum, 13>{end(last, 0, 0), end(last, 1, 0), end(last, 0, 1), end(last, 1, 1),
                                   start(0, 0, 1), start(0, 1, 1), of(duration_[last]), since(last, 1.0),
                                   of(duration_[0]), of(vx_), of(vy_), of(height_), of(place_)},
               rows, [this, mu](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 const LegEquations<T, double> leg(m_.leg);
                 const auto pose = leg.pose({z[0], z[1]});
                 const T r = 1.0 / z[6], q = 1.0 / z[8], time = z[7];
                 const Joints2<T> before{z[2] * r, z[3] * r}, after{z[4] * q, z[5] * q};
                 const auto turn = leg.centre_velocity(pose, before);
                 const Vec2<T> hip{z[9] - turn.x, z[10] - m_.leg.gravity_mps2 * time - turn.y};
                 const auto kept = leg.pinned_momentum(pose, hip, before);
                 const auto inertia = leg.standing_inertia(pose);
                 const auto hip_after = leg.pinned_hip_velocity(pose, after);
                 const T impulse = m_.leg.mass_kg * (hip_after.y - hip.y) +
                                   LegEquations<T, double>::dot(
                                       pose.along_y, {after.hip - before.hip, after.knee - before.knee});
                 const T along = m_.leg.mass_kg * (hip_after.x - hip.x) +
                                 LegEquations<T, double>::dot(
                                     pose.along_x, {after.hip - before.hip, after.knee - before.knee});
                 return std::array<T, 8>{toe_height<T>({z[0], z[1]}, time, z[10], z[11]),
                                         inertia.hip * after.hip + inertia.both * after.knee - kept.hip,
                                         inertia.both * after.hip + inertia.knee * after.knee - kept.knee,
                                         hip.y + leg.toe_velocity(pose, before).y,
                                         impulse,
                                         z[12] + z[9] * time + leg.toe(pose).x - leg.centre(pose).x,
                                         mu * impulse - along,
                                         mu * impulse + along};
               });
    if (task_.touchdown_knee_rad)
      p_.linear(
          p_.row("the knee's angle at touch-down", *task_.touchdown_knee_rad, *task_.touchdown_knee_rad),
          touchdown_knee());
  }

  void add_cost() {
    if (!task_.speed_mps) {
      p_.linear(0, {{energy_, 1.0}});
      return;
    }
    const double weight = m_.leg.mass_kg * m_.leg.gravity_mps2 * std::abs(*task_.speed_mps);
    Sum whole;
    for (const int d : duration_) whole.emplace_back(d, 1.0);
    p_.element(std::array<Sum, 2>{of(energy_), whole}, std::array<int, 1>{0}, [weight](const auto& z) {
      using T = std::decay_t<decltype(z[0])>;
      return std::array<T, 1>{z[0] / (weight * z[1])};
    });
  }

  const Machine& m_;
  const Task& task_;
  double rounding_, margin_;
  std::vector<Turn> turns_;
  std::size_t phases_;
  double catch_share_;
  Nlp p_;
  std::vector<Spline> spline_;
  std::vector<int> duration_;
  std::vector<std::array<std::vector<int>, 2>> coefficient_;  ///< of hip and knee
  int vx_ = 0, vy_ = 0, height_ = 0, place_ = 0, energy_ = 0, total_ = 0;
};

}  // namespace furcula::gait
