// One stride of a leg under a law of torques, from apex to apex, by an integrator that owes nothing to how the law
// was found. Events, kinks of the spring and changes of sign of the powers are located; the scalar may carry
// derivatives, which pass through every event (docs/decisions/0005-derivatives-through-events.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

#include "host/gait/machine.hpp"
#include "host/gait/runge_kutta.hpp"

namespace furcula::gait {

enum class LegPhase : std::uint8_t { stance, rise, fall };

/// Where a stride begins: the hip's highest point, its place left out.
template <class T>
struct Apex {
  T height{}, speed{};  ///< of the hip, m and m/s
  Joints2<T> angle, rate;

  std::array<T, 6> values() const { return {height, angle.hip, angle.knee, speed, rate.hip, rate.knee}; }
  static Apex of(const std::array<T, 6>& v) { return {v[0], v[3], {v[1], v[2]}, {v[4], v[5]}}; }
};

/// One moment of a stride, for pictures and logs.
struct Moment {
  double time_s = 0.0;
  LegPhase phase = LegPhase::fall;
  Vec2<double> hip, hip_velocity;
  Joints2<double> angle, rate, torque;
  double spring_nm = 0.0;
  Vec2<double> toe, force_n;
};

template <class T>
struct Sample {
  T toe_height{};
  Joints2<T> angle;
};

template <class T>
struct StrideEnd {
  bool whole = false;
  const char* why = "";  ///< where it is not: what happened
  Apex<T> apex;
  T distance{};                ///< of the hip, m
  T fall{}, stance{}, rise{};  ///< durations, s
  T electric{}, motor{},
      joint{};         ///< positive parts of the powers, J: electric, of the motors, of motors and spring
  T highest_toe{};     ///< between lift-off and touch-down, m
  T touchdown_knee{};  ///< rad
  std::array<std::vector<Sample<T>>, 3> samples;
  double lowest_toe = 0.0;  ///< in flight, m; below zero where the toe went through the ground
  double least_force_n = 0.0, friction = 0.0, impact_friction = 0.0, impulse_ns = 0.0;
  double toe_acceleration_mps2 = 0.0;                                ///< upward, just after lift-off
  double touchdown_speed_mps = 0.0;                                  ///< of the toe, downward
  double joint_excess_rad = 0.0;                                     ///< beyond the joints' ranges
  double voltage_v = 0.0, current_a = 0.0, motor_speed_radps = 0.0;  ///< the most of either motor
};

struct StrideOptions {
  LegLiftOff lift_off = LegLiftOff::force;
  double longest_step_s = 4e-3;
  std::function<void(const Moment&)> moment;  ///< after every step
  double ground_m = 0.0;                      ///< height of what the toe lands on
  bool energies = true;  ///< else they are left at zero, and a stride takes a third of the time
  /// Times of each phase at which the toe's height and the joints' angles are kept.
  std::array<std::vector<double>, 3> samples;
};

namespace detail {

template <class T>
double plain(const T& x) {
  return dynamics::value_of(x);
}

/// Where f falls through zero in [0, to], f(to) = `last` < 0: false position in Illinois' way, to `tolerance`.
template <class F>
double crossing(double to, double last, double tolerance, const F& f) {
  double low = 0.0, high = to, at_low = f(0.0), at_high = last;
  if (!(at_low > 0.0)) return 0.0;
  int kept = 0;
  for (int round = 0; round < 60 && high - low > tolerance; ++round) {
    double next = high - at_high * (high - low) / (at_high - at_low);
    if (!(next > low && next < high)) next = low + 0.5 * (high - low);
    const double value = f(next);
    if (value == 0.0) return next;
    if (value > 0.0) {
      if (kept == 1) at_high *= 0.5;
      if (next - low <= tolerance && round > 0) return next;
      low = next;
      at_low = value;
      kept = 1;
    } else {
      if (kept == -1) at_low *= 0.5;
      if (high - next <= tolerance && round > 0) return next;
      high = next;
      at_high = value;
      kept = -1;
    }
  }
  return high;
}

/// The same to `tolerance` with fewer calls of `f`: from the zero of `rough`, which is nearly f, by secants.
template <class F, class R>
double crossing(double to, double last, double tolerance, const F& f, const R& rough) {
  constexpr double kProbe = 1e-6;
  double before = crossing(to, last, 1e-9, rough);
  double at_before = f(before);
  const double rate = (rough(before + kProbe) - rough(before - kProbe)) / (2.0 * kProbe);
  double next = before - at_before / rate;
  for (int round = 0; round < 5 && next >= 0.0 && next <= to; ++round) {
    // A secant's error is about the product of the last two.
    if (std::abs(next - before) <= std::max(tolerance, 1e-9)) return next;
    const double at_next = f(next);
    const double secant = (at_next - at_before) / (next - before);
    before = next;
    at_before = at_next;
    next = before - at_before / secant;
  }
  return crossing(to, last, tolerance, f);
}

/// Between two states `h` apart with their rates, `by` after the first: Hermite's cubic.
template <std::size_t N>
std::array<double, N> between(const std::array<double, N>& from, const std::array<double, N>& from_rate,
                              const std::array<double, N>& to, const std::array<double, N>& to_rate, double h,
                              double by) {
  const double s = by / h, r = 1.0 - s;
  const double a = r * r * (1.0 + 2.0 * s), b = r * r * by, c = s * s * (1.0 + 2.0 * r), d = -s * r * by;
  std::array<double, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = a * from[i] + b * from_rate[i] + c * to[i] + d * to_rate[i];
  return out;
}

/// What a stride's phases have in common. `Law` has motors(phase, time, middle, angle, rate), and breaks(phase), the
/// times at which its torques are not smooth: `middle` lies inside the step, and tells the side of a break.
template <class T, class Law, class PlainLaw, bool kEnergies>
class StrideRun {
 public:
  StrideRun(const Machine& machine, const Law& law, const PlainLaw& plain_law, const StrideOptions& options)
      : m_(machine), law_(law), plain_(plain_law), o_(options), leg_(machine.leg), plain_leg_(machine.leg) {}

  StrideEnd<T> run(const Apex<T>& start) {
    r_.least_force_n = std::numeric_limits<double>::infinity();
    r_.lowest_toe = std::numeric_limits<double>::infinity();
    r_.highest_toe = T(-1.0);
    Flight<T> s{T(0.0),      start.height, start.angle.hip, start.angle.knee,
                start.speed, T(0.0),       start.rate.hip,  start.rate.knee};
    r_.fall = fly(LegPhase::fall, s);
    if (!r_.why[0]) land_and_leave(s);
    if (!r_.why[0]) r_.rise = fly(LegPhase::rise, s);
    r_.whole = !r_.why[0];
    r_.apex = {s[1], s[4], {s[2], s[3]}, {s[6], s[7]}};
    r_.distance = s[0];
    if constexpr (kEnergies) {
      r_.electric = s[8];
      r_.motor = s[9];
      r_.joint = s[10];
    }
    return r_;
  }

 private:
  static constexpr std::size_t kFlight = kEnergies ? 11 : 8, kStance = kEnergies ? 7 : 4;
  template <class S>
  using Flight = std::array<S, kFlight>;  ///< x, y, hip, knee, their rates, three energies
  template <class S>
  using Stance = std::array<S, kStance>;  ///< hip, knee, their rates, three energies

  static constexpr double kLongestPhase = 2.0, kNotCaught = 100.0;

  template <class S>
  const auto& law() const {
    if constexpr (std::is_same_v<S, double>)
      return plain_;
    else
      return law_;
  }
  template <class S>
  const auto& leg() const {
    if constexpr (std::is_same_v<S, double>)
      return plain_leg_;
    else
      return leg_;
  }

  template <class S>
  S spring(bool stance, const S& knee) const {
    // A step begins or ends where the spring begins to pull: there the sign says nothing of the derivatives.
    if constexpr (!std::is_same_v<S, double>)
      if (pulls_ != 0 && (stance || m_.spring == LegSpring::parallel) && m_.spring != LegSpring::none) {
        if (pulls_ < 0) return S(0.0);
        const S rest = m_.spring == LegSpring::parallel ? S(m_.leg.rest_angle_rad) : S(rest_);
        return S(-m_.leg.stiffness_nmprad * (knee - rest));
      }
    if (m_.spring == LegSpring::parallel) return leg<S>().spring_torque(knee, S(m_.leg.rest_angle_rad));
    if (m_.spring == LegSpring::switched && stance) {
      if constexpr (std::is_same_v<S, double>)
        return leg<S>().spring_torque(knee, plain(rest_));
      else
        return leg<S>().spring_torque(knee, rest_);
    }
    return S(0.0);
  }

  /// Everything at a moment, both for the rates and for what is watched.
  template <class S>
  struct Look {
    Joints2<S> u, rate;
    S spring;
    typename dynamics::LegEquations<S, double>::Motion motion;
    typename dynamics::LegEquations<S, double>::Pose pose;
  };
  template <class S, std::size_t N>
  Look<S> look(LegPhase phase, const S& time, const std::array<S, N>& s) const {
    constexpr bool kStands = N == kStance;
    constexpr std::size_t kAngle = kStands ? 0 : 2, kRate = kStands ? 2 : 6;
    const Joints2<S> angle{s[kAngle], s[kAngle + 1]};
    Look<S> k;
    k.rate = {s[kRate], s[kRate + 1]};
    k.u = law<S>().motors(phase, time, middle_, angle, k.rate);
    k.spring = spring<S>(kStands, angle.knee);
    const Joints2<S> torque{k.u.hip, k.u.knee + k.spring};
    k.pose = leg<S>().pose(angle);
    k.motion =
        kStands ? leg<S>().in_stance(k.pose, k.rate, torque) : leg<S>().in_flight(k.pose, k.rate, torque);
    return k;
  }
  /// Electric of hip and knee, of the motors, of motors and spring, W.
  template <class S>
  std::array<S, 4> powers(const Look<S>& k) const {
    const S motor = k.u.hip * k.rate.hip + k.u.knee * k.rate.knee;
    return {electric_power(heat_.hip, k.u.hip, k.rate.hip), electric_power(heat_.knee, k.u.knee, k.rate.knee),
            motor, motor + k.spring * k.rate.knee};
  }
  template <class S>
  static S positive(const S& x) {
    return plain(x) > 0.0 ? x : S(0.0);
  }

  template <class S, std::size_t N>
  std::array<S, N> rates(LegPhase phase, const S& t, const std::array<S, N>& s) const {
    const Look<S> k = look<S>(phase, t, s);
    std::array<S, N> out;
    constexpr std::size_t kMoves = N == kStance ? 4 : 8;
    if constexpr (N == kStance)
      std::ranges::copy(std::array<S, 4>{s[2], s[3], k.motion.acceleration.hip, k.motion.acceleration.knee},
                        out.begin());
    else
      std::ranges::copy(
          std::array<S, 8>{s[4], s[5], s[6], s[7], k.motion.hip_acceleration.x, k.motion.hip_acceleration.y,
                           k.motion.acceleration.hip, k.motion.acceleration.knee},
          out.begin());
    if constexpr (kEnergies) {
      const auto p = powers<S>(k);
      out[kMoves] = positive<S>(p[0]) + positive<S>(p[1]);
      out[kMoves + 1] = positive<S>(p[2]);
      out[kMoves + 2] = positive<S>(p[3]);
    }
    return out;
  }

  /// What may change its sign: the events first, then kinks.
  static constexpr std::size_t kWatched = kEnergies ? 7 : 3;
  template <class S, std::size_t N>
  std::array<S, kWatched> watched(LegPhase phase, const std::array<S, N>& s, const Look<S>& k) const {
    std::array<S, kWatched> out;
    if constexpr (N == kStance) {
      S kink(1.0);
      if (m_.spring == LegSpring::parallel) kink = s[1] - m_.leg.rest_angle_rad;
      if (m_.spring == LegSpring::switched || o_.lift_off == LegLiftOff::knee) {
        if constexpr (std::is_same_v<S, double>)
          kink = s[1] - plain(rest_);
        else
          kink = s[1] - rest_;
      }
      out[0] = k.motion.ground_force.y;
      out[1] = S(1.0);
      out[2] = kink;
    } else {
      out[0] = phase == LegPhase::rise ? s[5] : S(s[1] + leg<S>().toe(k.pose).y - o_.ground_m);
      out[1] = s[5] + leg<S>().toe_velocity(k.pose, k.rate).y;
      out[2] = m_.spring == LegSpring::parallel ? S(s[3] - m_.leg.rest_angle_rad) : S(1.0);
    }
    if constexpr (kEnergies) std::ranges::copy(powers<S>(k), out.begin() + 3);
    return out;
  }
  template <class S, std::size_t N>
  std::array<S, kWatched> watched(LegPhase phase, const S& t, const std::array<S, N>& s) const {
    return watched<S>(phase, s, look<S>(phase, t, s));
  }

  template <std::size_t N>
  static std::array<double, N> plain_state(const std::array<T, N>& s) {
    std::array<double, N> out;
    for (std::size_t i = 0; i < N; ++i) out[i] = plain(s[i]);
    return out;
  }

  template <class S, std::size_t N>
  std::array<S, N> after(LegPhase phase, double t, const std::array<S, N>& s, const S& h) const {
    return runge_kutta_8<S, N>(
        S(t), s, h, [&](const S& at, const std::array<S, N>& x) { return rates<S>(phase, at, x); });
  }

  /// Runs a phase to its end; returns its duration.
  template <std::size_t N>
  T run_phase(LegPhase phase, std::array<T, N>& state) {
    constexpr bool kStands = N == kStance;
    std::vector<double> breaks = plain_.breaks(phase);
    const std::vector<double>& samples = o_.samples[static_cast<std::size_t>(phase)];
    std::size_t sampled = 0;
    breaks.insert(breaks.end(), samples.begin(), samples.end());
    const double caught_s = kStands && m_.spring == LegSpring::switched ? m_.catching.delay_s : 0.0;
    if (caught_s > 0.0) breaks.push_back(caught_s);
    std::sort(breaks.begin(), breaks.end());
    std::size_t next = 0;
    double t = 0.0;
    std::array<int, kWatched> side{};
    middle_ = 0.5 * (breaks.empty() ? o_.longest_step_s : breaks.front());
    const std::array<double, N> begin = plain_state(state);
    note(phase, t, begin, look<double>(phase, t, begin), side, kWatched);
    while (t < kLongestPhase) {
      while (next < breaks.size() && breaks[next] <= t + 1e-12) ++next;
      double h = o_.longest_step_s;
      if (next < breaks.size()) h = std::min(h, breaks[next] - t);
      middle_ = t + 0.5 * h;
      const std::array<double, N> from = plain_state(state);
      std::array<double, N> to = after<double>(phase, t, from, h);
      Look<double> there = look<double>(phase, t + h, to);
      auto values = watched<double>(phase, to, there);
      std::size_t which = kWatched;
      for (std::size_t w = 0; w < kWatched; ++w) {
        if (side[w] == 0 || !(values[w] * side[w] < 0.0)) continue;
        const double sign = side[w];
        const auto from_rate = rates<double>(phase, t, from), to_rate = rates<double>(phase, t + h, to);
        const auto rough = [&](double by) {
          return sign * watched<double>(phase, t + by, between(from, from_rate, to, to_rate, h, by))[w];
        };
        // A kink that is a little off costs its square; an event is where it is.
        h = crossing(
            h, sign * values[w], w < 3 ? 1e-14 : 1e-8,
            [&](double by) {
              return sign * watched<double>(phase, t + by, after<double>(phase, t, from, by))[w];
            },
            rough);
        which = w;
        to = after<double>(phase, t, from, h);
        there = look<double>(phase, t + h, to);
        values = watched<double>(phase, to, there);
      }
      const bool ends = which == 0 || (which == 2 && kStands && o_.lift_off == LegLiftOff::knee);
      T length(h);
      if constexpr (std::is_same_v<T, double>) {
        state = to;
      } else {
        const std::array<T, N> before = state;
        pulls_ = side[2] != 0 ? side[2] : values[2] > 0.0 ? 1 : -1;
        state = after<T>(phase, t, before, length);
        if (ends) {
          // The event's time by the implicit function theorem; then the step once more, of that length.
          const T margin = watched<T>(phase, T(t + h), state)[which];
          constexpr double kProbe = 1e-5;
          const auto value = [&](double by) {
            return watched<double>(phase, t + by, after<double>(phase, t, from, by))[which];
          };
          const double rate = (value(h + kProbe) - value(h - kProbe)) / (2.0 * kProbe);
          length = T(h) - (margin - plain(margin)) / rate;
          state = after<T>(phase, t, before, length);
        }
      }
      if (which < kWatched) side[which] = -side[which];
      if constexpr (!kStands)
        if (which == 1 && side[1] < 0) {
          const T toe = toe_height<T>(state);
          if (plain(toe) > plain(r_.highest_toe)) r_.highest_toe = toe;
        }
      t += h;
      if constexpr (kStands)
        if (caught_s > 0.0 && std::abs(t - caught_s) < 1e-12 && plain(rest_) == kNotCaught)
          rest_ = state[1] + m_.catching.lost_rad;
      for (; sampled < samples.size() && samples[sampled] <= t + 1e-12; ++sampled) {
        Sample<T> sample;
        if constexpr (kStands)
          sample.angle = {state[0], state[1]};
        else
          sample = {toe_height<T>(state), {state[2], state[3]}};
        r_.samples[static_cast<std::size_t>(phase)].push_back(sample);
      }
      note(phase, t, to, there, side, which);
      if (ends) return T(t - h) + length;
      if constexpr (!kStands)
        if (phase == LegPhase::rise && t > 1e-3 && toe_height<double>(to) < -1e-7) {
          r_.why = "the toe comes down before the apex";
          return T(t);
        }
    }
    r_.why = kStands ? "the stance does not end" : "the flight does not end";
    return T(t);
  }

  template <class S>
  S toe_height(const Flight<S>& s) const {
    return s[1] + leg<S>().toe(leg<S>().pose({s[2], s[3]})).y - o_.ground_m;
  }

  T fly(LegPhase phase, Flight<T>& s) { return run_phase<kFlight>(phase, s); }

  void land_and_leave(Flight<T>& s) {
    const Joints2<T> angle{s[2], s[3]}, rate{s[6], s[7]};
    const auto pose = leg_.pose(angle);
    r_.touchdown_speed_mps = -plain(s[5] + leg_.toe_velocity(pose, rate).y);
    if (r_.touchdown_speed_mps < 0.0) r_.why = "the toe goes up through the ground";
    const auto impact = leg_.impact(pose, {s[4], s[5]}, rate);
    r_.impulse_ns = plain(impact.impulse.y);
    r_.impact_friction = std::abs(plain(impact.impulse.x) / r_.impulse_ns);
    if (!(r_.impulse_ns > 0.0)) r_.why = "the impact would have to pull";
    r_.touchdown_knee = angle.knee;
    // Until it is caught a spring rests wherever the knee is.
    rest_ = m_.catching.delay_s > 0.0 ? T(kNotCaught) : T(angle.knee + m_.catching.lost_rad);
    const auto toe = leg_.toe(pose);
    toe_at_ = {s[0] + toe.x, s[1] + toe.y};
    Stance<T> p{angle.hip, angle.knee, impact.rate.hip, impact.rate.knee};
    std::copy(s.begin() + 8, s.end(), p.begin() + 4);
    if (r_.why[0]) return;
    r_.stance = run_phase<kStance>(LegPhase::stance, p);
    const auto after_pose = leg_.pose({p[0], p[1]});
    const auto off = leg_.toe(after_pose);
    const auto velocity = leg_.pinned_hip_velocity(after_pose, {p[2], p[3]});
    std::ranges::copy(std::array<T, 8>{toe_at_.x - off.x, toe_at_.y - off.y, p[0], p[1], velocity.x,
                                       velocity.y, p[2], p[3]},
                      s.begin());
    std::copy(p.begin() + 4, p.end(), s.begin() + 8);
    // Where the knee ends the stance the toe leaves the ground only by what the motors do next.
    const auto k = look<double>(LegPhase::rise, 0.0, plain_state(s));
    const double shank = plain(s[6]) + plain(s[7]);
    r_.toe_acceleration_mps2 = k.motion.hip_acceleration.y +
                               dynamics::LegEquations<double>::dot(k.pose.toe_y, k.motion.acceleration) +
                               m_.leg.thigh_length_m * k.pose.cos_hip * plain(s[6]) * plain(s[6]) +
                               m_.leg.shank_length_m * k.pose.cos_shank * shank * shank;
  }

  /// Keeps the sides on which the watched values are, and the extremes that are asked for.
  template <std::size_t N>
  void note(LegPhase phase, double t, const std::array<double, N>& s, const Look<double>& k,
            std::array<int, kWatched>& side, std::size_t crossed) {
    const auto values = watched<double>(phase, s, k);
    for (std::size_t w = 0; w < kWatched; ++w)
      if (w != crossed && std::abs(values[w]) > 1e-9) side[w] = values[w] > 0.0 ? 1 : -1;
    // The end of a phase is its margin's way down; what begins below has to rise first.
    if (side[0] < 0) side[0] = 0;
    constexpr bool kStands = N == kStance;
    const Joints2<double> angle = kStands ? Joints2<double>{s[0], s[1]} : Joints2<double>{s[2], s[3]};
    const Joints2<double>& rate = k.rate;
    const Vec2<double> toe = plain_leg_.toe(k.pose), force = k.motion.ground_force;
    Vec2<double> hip{plain(toe_at_.x) - toe.x, plain(toe_at_.y) - toe.y};
    Vec2<double> velocity = plain_leg_.pinned_hip_velocity(k.pose, rate);
    if constexpr (kStands) {
      r_.least_force_n = std::min(r_.least_force_n, force.y);
      if (force.y > 20.0) r_.friction = std::max(r_.friction, std::abs(force.x / force.y));
    } else {
      hip = {s[0], s[1]};
      velocity = {s[4], s[5]};
      r_.lowest_toe = std::min(r_.lowest_toe, toe_height<double>(s));
    }
    for (const auto& [a, low, high] : {std::array{angle.hip, m_.least.hip, m_.most.hip},
                                       std::array{angle.knee, m_.least.knee, m_.most.knee}})
      r_.joint_excess_rad = std::max({r_.joint_excess_rad, low - a, a - high});
    const Motors& motors = m_.motors;
    for (const auto& [gear, u, w] : {std::array{motors.hip_gear, k.u.hip, rate.hip},
                                     std::array{motors.knee_gear, k.u.knee, rate.knee}}) {
      const double current = u / (gear * motors.torque_constant_nmpa);
      r_.current_a = std::max(r_.current_a, std::abs(current));
      r_.motor_speed_radps = std::max(r_.motor_speed_radps, std::abs(gear * w));
      r_.voltage_v = std::max(
          r_.voltage_v, std::abs(gear * w * motors.torque_constant_nmpa + motors.resistance_ohm * current));
    }
    if (o_.moment) {
      const double before = phase == LegPhase::fall     ? 0.0
                            : phase == LegPhase::stance ? plain(r_.fall)
                                                        : plain(r_.fall) + plain(r_.stance);
      o_.moment({before + t,
                 phase,
                 hip,
                 velocity,
                 angle,
                 rate,
                 k.u,
                 k.spring,
                 {hip.x + toe.x, hip.y + toe.y},
                 force});
    }
  }

  const Machine& m_;
  const Law& law_;
  const PlainLaw& plain_;
  const StrideOptions& o_;
  dynamics::LegEquations<T, double> leg_;
  dynamics::LegEquations<double, double> plain_leg_;
  Joints2<double> heat_ = m_.motors.heat();
  T rest_{};
  double middle_ = 0.0;
  int pulls_ = 0;  ///< of the step: the spring pulls (1), or not (-1)
  Vec2<T> toe_at_{};
  StrideEnd<T> r_;
};

}  // namespace detail

/// One stride from an apex. `plain` is the law without derivatives.
template <class T, class Law, class PlainLaw>
StrideEnd<T> run_stride(const Machine& machine, const Law& law, const PlainLaw& plain, const Apex<T>& start,
                        const StrideOptions& options) {
  if (options.energies)
    return detail::StrideRun<T, Law, PlainLaw, true>(machine, law, plain, options).run(start);
  return detail::StrideRun<T, Law, PlainLaw, false>(machine, law, plain, options).run(start);
}

}  // namespace furcula::gait
