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

#include "furcula/dynamics/leg_joints.hpp"
#include "host/gait/machine.hpp"
#include "host/gait/runge_kutta.hpp"
#include "host/optimise/spline.hpp"

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
  /// In stance; 0: as in flight. Where no feedback works a step may be three times as long for the same error.
  double stance_step_s = 0.0;
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

/// What a stride's phases have in common. `Law` has motors(phase, time, middle, angle, rate), and breaks(phase), the
/// times at which its torques are not smooth: `middle` lies inside the step, and tells the side of a break.
///
/// In all phases the state is that of the joints. In flight the mass falls as a whole, which needs no integrator.
template <class T, class Law, class PlainLaw, bool kEnergies>
class StrideRun {
 public:
  StrideRun(const Machine& machine, const Law& law, const PlainLaw& plain_law, const StrideOptions& options)
      : m_(machine), law_(law), plain_(plain_law), o_(options), leg_(machine.leg), joints_(machine.leg) {}

  StrideEnd<T> run(const Apex<T>& start) {
    r_.least_force_n = std::numeric_limits<double>::infinity();
    r_.lowest_toe = std::numeric_limits<double>::infinity();
    r_.highest_toe = T(-1.0);
    State<T> s{start.angle.hip, start.angle.knee, start.rate.hip, start.rate.knee};
    let_go({T(0.0), start.height}, {start.speed, T(0.0)}, s);
    T flown = run_phase<false>(LegPhase::fall, s);
    r_.fall = flown;
    if (!r_.why[0]) land_and_leave(s);
    if (!r_.why[0]) r_.rise = flown = run_phase<false>(LegPhase::rise, s);
    r_.whole = !r_.why[0];
    const auto pose = joints_.pose(angle_of(s));
    const Hip<T> hip = hip_of(flown, pose, rate_of(s));
    r_.apex = {hip.place.y, hip.velocity.x, angle_of(s), rate_of(s)};
    r_.distance = hip.place.x;
    if constexpr (kEnergies) {
      r_.electric = s[4];
      r_.motor = s[5];
      r_.joint = s[6];
    }
    return r_;
  }

 private:
  static constexpr std::size_t kState = kEnergies ? 7 : 4;
  template <class S>
  using State = std::array<S, kState>;  ///< hip, knee, their rates, three energies
  template <class S>
  using Pose = typename dynamics::LegJoints<double>::template Pose<S>;
  template <class S>
  struct Hip {
    Vec2<S> place, velocity;
  };

  static constexpr double kLongestPhase = 2.0, kNotCaught = 100.0;

  template <class S>
  const auto& law() const {
    if constexpr (std::is_same_v<S, double>)
      return plain_;
    else
      return law_;
  }
  template <class S>
  static Joints2<S> angle_of(const State<S>& s) {
    return {s[0], s[1]};
  }
  template <class S>
  static Joints2<S> rate_of(const State<S>& s) {
    return {s[2], s[3]};
  }

  /// The spring's torque on the knee for the angle at which it begins, N m.
  template <class S>
  S stretched(const S& knee, const S& rest) const {
    const S stretch = knee - rest;
    return plain(stretch) > 0.0 ? S(-m_.leg.stiffness_nmprad * stretch) : S(0.0);
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
    if (m_.spring == LegSpring::parallel) return stretched<S>(knee, S(m_.leg.rest_angle_rad));
    if (m_.spring == LegSpring::switched && stance) {
      if constexpr (std::is_same_v<S, double>)
        return stretched<S>(knee, plain(rest_));
      else
        return stretched<S>(knee, rest_);
    }
    return S(0.0);
  }

  /// From here on all mass falls as a whole.
  void let_go(const Vec2<T>& hip, const Vec2<T>& velocity, const State<T>& s) {
    const auto pose = joints_.pose(angle_of(s));
    const Vec2<T> place = joints_.hip(pose), turn = joints_.hip_velocity(pose, rate_of(s));
    place_ = {hip.x - place.x, hip.y - place.y};
    velocity_ = {velocity.x - turn.x, velocity.y - turn.y};
    plain_place_ = {plain(place_.x), plain(place_.y)};
    plain_velocity_ = {plain(velocity_.x), plain(velocity_.y)};
  }
  /// Where the centre of all mass is, and how fast, this long after.
  template <class S>
  Hip<S> centre(const S& time) const {
    Hip<S> c;
    if constexpr (std::is_same_v<S, double>)
      c = {plain_place_, plain_velocity_};
    else
      c = {place_, velocity_};
    const S fallen = m_.leg.gravity_mps2 * time;
    c.place.x = c.place.x + c.velocity.x * time;
    c.place.y = c.place.y + (c.velocity.y - 0.5 * fallen) * time;
    c.velocity.y = c.velocity.y - fallen;
    return c;
  }
  template <class S>
  Hip<S> hip_of(const S& time, const Pose<S>& pose, const Joints2<S>& rate) const {
    Hip<S> h = centre(time);
    const Vec2<S> place = joints_.hip(pose), turn = joints_.hip_velocity(pose, rate);
    h.place = {h.place.x + place.x, h.place.y + place.y};
    h.velocity = {h.velocity.x + turn.x, h.velocity.y + turn.y};
    return h;
  }
  template <class S>
  S toe_height(const S& time, const Pose<S>& pose) const {
    return centre(time).place.y + joints_.toe(pose).y - o_.ground_m;
  }

  /// Everything at a moment, both for the rates and for what is watched.
  template <class S>
  struct Look {
    Joints2<S> u, rate, acceleration;
    S spring;
    Pose<S> pose;
  };
  template <bool kStands, class S>
  Look<S> look(LegPhase phase, const S& time, const State<S>& s) const {
    const Joints2<S> angle = angle_of(s);
    Look<S> k;
    k.rate = rate_of(s);
    k.u = law<S>().motors(phase, time, middle_, angle, k.rate);
    k.spring = spring<S>(kStands, angle.knee);
    k.pose = joints_.pose(angle);
    k.acceleration =
        joints_.template acceleration<kStands>(k.pose, k.rate, Joints2<S>{k.u.hip, S(k.u.knee + k.spring)});
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
  State<S> rates(const Look<S>& k) const {
    State<S> out;
    out[0] = k.rate.hip;
    out[1] = k.rate.knee;
    out[2] = k.acceleration.hip;
    out[3] = k.acceleration.knee;
    if constexpr (kEnergies) {
      const auto p = powers<S>(k);
      const S none(0.0);
      out[4] = (counts_[0] ? p[0] : none) + (counts_[1] ? p[1] : none);
      out[5] = counts_[2] ? p[2] : none;
      out[6] = counts_[3] ? p[3] : none;
    }
    return out;
  }

  /// What may change its sign: the events first, then kinks.
  static constexpr std::size_t kWatched = 3;
  template <bool kStands, class S>
  std::array<S, kWatched> watched(LegPhase phase, const S& t, const State<S>& s, const Look<S>& k) const {
    std::array<S, kWatched> out;
    if constexpr (kStands) {
      S kink(1.0);
      if (m_.spring == LegSpring::parallel) kink = s[1] - m_.leg.rest_angle_rad;
      if (m_.spring == LegSpring::switched || o_.lift_off == LegLiftOff::knee) {
        if constexpr (std::is_same_v<S, double>)
          kink = s[1] - plain(rest_);
        else
          kink = s[1] - rest_;
      }
      out[0] = joints_.ground_force(k.pose, k.rate, k.acceleration).y;
      out[1] = S(1.0);
      out[2] = kink;
    } else {
      const Hip<S> c = centre(t);
      out[0] = phase == LegPhase::rise ? S(c.velocity.y + joints_.hip_velocity(k.pose, k.rate).y)
                                       : S(c.place.y + joints_.toe(k.pose).y - o_.ground_m);
      out[1] = c.velocity.y + joints_.toe_velocity(k.pose, k.rate).y;
      out[2] = m_.spring == LegSpring::parallel ? S(s[1] - m_.leg.rest_angle_rad) : S(1.0);
    }
    return out;
  }
  template <bool kStands, class S>
  std::array<S, kWatched> watched(LegPhase phase, const S& t, const State<S>& s) const {
    return watched<kStands, S>(phase, t, s, look<kStands, S>(phase, t, s));
  }

  static State<double> plain_state(const State<T>& s) {
    State<double> out;
    for (std::size_t i = 0; i < kState; ++i) out[i] = plain(s[i]);
    return out;
  }

  template <bool kStands, class S>
  State<S> after(LegPhase phase, double t, const State<S>& s, const State<S>& first, const S& h) const {
    return runge_kutta_8<S, kState>(S(t), s, first, h, [&](const S& at, const State<S>& x) {
      return rates<S>(look<kStands, S>(phase, at, x));
    });
  }
  template <bool kStands, class S>
  State<S> after(LegPhase phase, double t, const State<S>& s, const S& h) const {
    return after<kStands, S>(phase, t, s, rates<S>(look<kStands, S>(phase, S(t), s)), h);
  }

  template <class S>
  struct StepOf {
    S h{};
    State<S> from, from_rate, to;
    Look<S> here, there;
  };
  using Step = StepOf<double>;
  /// Angles and rates after a share of the step: Hermite's polynomial of degree 5 through angles, rates and
  /// accelerations at its ends.
  template <class S>
  State<S> between(const StepOf<S>& x, double s) const {
    const double r = 1.0 - s, s2 = s * s, s3 = s2 * s, r2 = r * r, r3 = r2 * r;
    const double a = r3 * (1.0 + s * (3.0 + 6.0 * s)), b = r3 * s * (1.0 + 3.0 * s), c = 0.5 * r3 * s2;
    const double d = s3 * (1.0 + r * (3.0 + 6.0 * r)), e = -s3 * r * (1.0 + 3.0 * r), f = 0.5 * s3 * r2;
    const double da = -30.0 * s2 * r2, db = r2 * (1.0 + s * (2.0 - 15.0 * s)),
                 dc = 0.5 * r2 * s * (2.0 - 5.0 * s), de = s2 * (1.0 + r * (2.0 - 15.0 * r)),
                 df = -0.5 * s2 * r * (2.0 - 5.0 * r);
    const S per = 1.0 / x.h;
    State<S> out{};
    const std::array<S, 2> last{x.there.acceleration.hip, x.there.acceleration.knee};
    for (std::size_t i = 0; i < 2; ++i) {
      const S &v0 = x.from[2 + i], &a0 = x.from_rate[2 + i], &v1 = x.to[2 + i];
      out[i] = a * x.from[i] + d * x.to[i] + x.h * (b * v0 + e * v1 + x.h * (c * a0 + f * last[i]));
      out[2 + i] = da * (per * (x.from[i] - x.to[i])) + db * v0 + de * v1 + x.h * (dc * a0 + df * last[i]);
    }
    return out;
  }
  template <bool kStands>
  void move(LegPhase phase, double t, Step& x, double h) const {
    x.h = h;
    x.to = after<kStands, double>(phase, t, x.from, x.from_rate, h);
    x.there = look<kStands, double>(phase, t + h, x.to);
  }

  /// Shortens the step to where a watched value falls through zero.
  template <bool kStands>
  void cut(LegPhase phase, double t, Step& x, std::size_t which, double sign) const {
    const Step whole = x;
    const double until = whole.h;
    const auto rough = [&](double by) {
      return sign * watched<kStands, double>(phase, t + by, between(whole, by / whole.h))[which];
    };
    const double at_until = rough(until);
    if (at_until < 0.0) {
      // Between the polynomial's zero and that of the step lies next to nothing: Newton's method.
      constexpr double kProbe = 1e-6, kNear = 1e-8;
      double by = crossing(until, at_until, 1e-9, rough);
      const double slope = (rough(by + kProbe) - rough(by - kProbe)) / (2.0 * kProbe);
      for (int round = 0; round < 6 && by >= 0.0 && by <= until; ++round) {
        move<kStands>(phase, t, x, by);
        const double missed = -sign * watched<kStands, double>(phase, t + by, x.to, x.there)[which] / slope;
        if (std::abs(missed) <= 1e-13) return;
        if (std::abs(missed) <= kNear && by + missed > 0.0) {
          const State<double> rate = rates<double>(x.there);
          for (std::size_t i = 0; i < kState; ++i) x.to[i] += missed * rate[i];
          for (std::size_t i = 0; i < 2; ++i) x.to[i] += 0.5 * missed * missed * rate[2 + i];
          x.h = by + missed;
          x.there = look<kStands, double>(phase, t + x.h, x.to);
          return;
        }
        by += missed;
      }
    }
    const auto exact = [&](double by) {
      return sign * watched<kStands, double>(
                        phase, t + by, after<kStands, double>(phase, t, x.from, x.from_rate, by))[which];
    };
    const double last = exact(until);
    move<kStands>(phase, t, x, last < 0.0 ? crossing(until, last, 1e-14, exact) : until);
  }

  /// Which powers count in the step that begins so, and so have no kink in it.
  void choose(const Look<double>& k) {
    if constexpr (kEnergies) {
      const auto p = powers<double>(k);
      for (std::size_t i = 0; i < p.size(); ++i) counts_[i] = p[i] > 0.0;
    }
  }
  /// Adds what a step has of powers that change their sign within it: less what counts and is below zero, and what is
  /// above and does not. `plain` has the same step in plain numbers, `last` the powers at its end.
  template <bool kStands, class S>
  void mend(LegPhase phase, double t, const Step& step, const StepOf<S>& x, State<S>& to) const {
    // An event may lie where the step begins.
    if (step.h < 1e-12) return;
    const auto sign = [&](std::size_t i) { return counts_[i] ? 1.0 : -1.0; };
    const auto at = [&](double s) {
      return powers<double>(look<kStands, double>(phase, t + s * step.h, between(step, s)));
    };
    // At the ends of the quarters, too: a power may change its sign twice.
    constexpr std::size_t kParts = 4;
    constexpr double kPart = 1.0 / kParts;
    std::array<std::array<double, 4>, kParts + 1> p;
    p.front() = powers<double>(step.here);
    for (std::size_t k = 1; k < kParts; ++k) p[k] = at(kPart * static_cast<double>(k));
    p.back() = powers<double>(step.there);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < kParts; ++k) {
        double low = kPart * static_cast<double>(k), high = low + kPart;
        const double first = sign(i) * p[k][i], second = sign(i) * p[k + 1][i];
        if (first >= 0.0 && second >= 0.0) continue;
        const double begin = low;
        if (first > 0.0)
          low += crossing(kPart, second, 1e-6, [&](double by) { return sign(i) * at(begin + by)[i]; });
        else if (second > 0.0)
          high -=
              crossing(kPart, first, 1e-6, [&](double by) { return sign(i) * at(begin + kPart - by)[i]; });
        for (const optimise::GaussPoint& g : optimise::kGauss) {
          const double s = low + g.at * (high - low);
          const S power = powers<S>(look<kStands, S>(phase, S(S(t) + s * x.h), between(x, s)))[i];
          S& sum = to[i < 2 ? 4 : 3 + i];
          sum = sum - (sign(i) * g.weight * (high - low)) * (x.h * power);
        }
      }
  }

  /// Runs a phase to its end; returns its duration.
  template <bool kStands>
  T run_phase(LegPhase phase, State<T>& state) {
    std::vector<double> breaks = plain_.breaks(phase);
    const std::vector<double>& samples = o_.samples[static_cast<std::size_t>(phase)];
    std::size_t sampled = 0;
    breaks.insert(breaks.end(), samples.begin(), samples.end());
    const double caught_s = kStands && m_.spring == LegSpring::switched ? m_.catching.delay_s : 0.0;
    if (caught_s > 0.0) breaks.push_back(caught_s);
    std::sort(breaks.begin(), breaks.end());
    const double longest = kStands && o_.stance_step_s > 0.0 ? o_.stance_step_s : o_.longest_step_s;
    std::size_t next = 0;
    double t = 0.0;
    std::array<int, kWatched> side{};
    middle_ = 0.5 * (breaks.empty() ? longest : breaks.front());
    Step x;
    x.to = plain_state(state);
    x.there = look<kStands, double>(phase, t, x.to);
    note<kStands>(phase, t, x.to, x.there, side, kWatched);
    while (t < kLongestPhase) {
      bool other_side = false;
      for (; next < breaks.size() && breaks[next] <= t + 1e-12; ++next) other_side = true;
      x.h = longest;
      // Steps of the same length up to the next break.
      if (next < breaks.size() && breaks[next] < t + 64.0 * x.h)
        x.h = (breaks[next] - t) / std::max(1.0, std::ceil((breaks[next] - t) / x.h - 1e-6));
      middle_ = t + 0.5 * x.h;
      x.from = x.to;
      if (other_side) x.there = look<kStands, double>(phase, t, x.from);
      x.here = x.there;
      choose(x.here);
      x.from_rate = rates<double>(x.here);
      move<kStands>(phase, t, x, x.h);
      auto values = watched<kStands, double>(phase, t + x.h, x.to, x.there);
      std::size_t which = kWatched;
      for (std::size_t w = 0; w < kWatched; ++w) {
        if (w == which || side[w] == 0 || !(values[w] * side[w] < 0.0)) continue;
        cut<kStands>(phase, t, x, w, side[w]);
        which = w;
        values = watched<kStands, double>(phase, t + x.h, x.to, x.there);
      }
      const double h = x.h;
      const bool ends = which == 0 || (which == 2 && kStands && o_.lift_off == LegLiftOff::knee);
      T length(h);
      if constexpr (std::is_same_v<T, double>) {
        state = x.to;
        if constexpr (kEnergies) mend<kStands, T>(phase, t, x, x, state);
      } else {
        const State<T> before = state;
        pulls_ = side[2] != 0 ? side[2] : values[2] > 0.0 ? 1 : -1;
        state = after<kStands, T>(phase, t, before, length);
        if (ends) {
          // The event's time by the implicit function theorem; then the step once more, of that length.
          const T margin = watched<kStands, T>(phase, T(t + h), state)[which];
          constexpr double kProbe = 1e-5;
          const auto value = [&](double by) {
            return watched<kStands, double>(phase, t + by,
                                            after<kStands, double>(phase, t, x.from, x.from_rate, by))[which];
          };
          const double rate = (value(h + kProbe) - value(h - kProbe)) / (2.0 * kProbe);
          length = T(h) - (margin - plain(margin)) / rate;
          state = after<kStands, T>(phase, t, before, length);
        }
        if constexpr (kEnergies) {
          StepOf<T> step;
          step.h = length;
          step.from = before;
          step.here = look<kStands, T>(phase, T(t), before);
          step.from_rate = rates<T>(step.here);
          step.to = state;
          step.there = look<kStands, T>(phase, T(T(t) + length), state);
          mend<kStands, T>(phase, t, x, step, state);
        }
      }
      x.to = plain_state(state);
      if (which < kWatched) side[which] = -side[which];
      const T now = T(t) + length;
      if constexpr (!kStands)
        if (which == 1 && side[1] < 0) {
          const T toe = toe_height<T>(now, joints_.pose(angle_of(state)));
          if (plain(toe) > plain(r_.highest_toe)) r_.highest_toe = toe;
        }
      t += h;
      if constexpr (kStands)
        if (caught_s > 0.0 && std::abs(t - caught_s) < 1e-12 && plain(rest_) == kNotCaught)
          rest_ = state[1] + m_.catching.lost_rad;
      for (; sampled < samples.size() && samples[sampled] <= t + 1e-12; ++sampled) {
        Sample<T> sample;
        sample.angle = angle_of(state);
        if constexpr (!kStands) sample.toe_height = toe_height<T>(now, joints_.pose(sample.angle));
        r_.samples[static_cast<std::size_t>(phase)].push_back(sample);
      }
      note<kStands>(phase, t, x.to, x.there, side, which);
      if (ends) return now;
      if constexpr (!kStands)
        if (phase == LegPhase::rise && t > 1e-3 && toe_height<double>(t, x.there.pose) < -1e-7) {
          r_.why = "the toe comes down before the apex";
          return T(t);
        }
    }
    r_.why = kStands ? "the stance does not end" : "the flight does not end";
    return T(t);
  }

  void land_and_leave(State<T>& s) {
    const auto pose = leg_.pose(angle_of(s));
    const Hip<T> hip = hip_of(r_.fall, joints_.pose(angle_of(s)), rate_of(s));
    r_.touchdown_speed_mps = -plain(hip.velocity.y + leg_.toe_velocity(pose, rate_of(s)).y);
    if (r_.touchdown_speed_mps < 0.0) r_.why = "the toe goes up through the ground";
    const auto impact = leg_.impact(pose, hip.velocity, rate_of(s));
    r_.impulse_ns = plain(impact.impulse.y);
    r_.impact_friction = std::abs(plain(impact.impulse.x) / r_.impulse_ns);
    if (!(r_.impulse_ns > 0.0)) r_.why = "the impact would have to pull";
    r_.touchdown_knee = s[1];
    // Until it is caught a spring rests wherever the knee is.
    rest_ = m_.catching.delay_s > 0.0 ? T(kNotCaught) : T(s[1] + m_.catching.lost_rad);
    const auto toe = leg_.toe(pose);
    toe_at_ = {hip.place.x + toe.x, hip.place.y + toe.y};
    if (r_.why[0]) return;
    s[2] = impact.rate.hip;
    s[3] = impact.rate.knee;
    r_.stance = run_phase<true>(LegPhase::stance, s);
    const auto after_pose = leg_.pose(angle_of(s));
    const auto off = leg_.toe(after_pose);
    let_go({toe_at_.x - off.x, toe_at_.y - off.y}, leg_.pinned_hip_velocity(after_pose, rate_of(s)), s);
    // Where the knee ends the stance the toe leaves the ground only by what the motors do next.
    const auto k = look<false, double>(LegPhase::rise, 0.0, plain_state(s));
    // Against the toe the mass would accelerate so with the ground's force; without it the toe goes the other way.
    r_.toe_acceleration_mps2 = -joints_.ground_force(k.pose, k.rate, k.acceleration).y / m_.leg.mass_kg;
  }

  /// Keeps the sides on which the watched values are, and the extremes that are asked for.
  template <bool kStands>
  void note(LegPhase phase, double t, const State<double>& s, const Look<double>& k,
            std::array<int, kWatched>& side, std::size_t crossed) {
    const auto values = watched<kStands, double>(phase, t, s, k);
    for (std::size_t w = 0; w < kWatched; ++w)
      if (w != crossed && std::abs(values[w]) > 1e-9) side[w] = values[w] > 0.0 ? 1 : -1;
    // The end of a phase is its margin's way down; what begins below has to rise first.
    if (side[0] < 0) side[0] = 0;
    Vec2<double> force{};
    if constexpr (kStands) {
      force = joints_.ground_force(k.pose, k.rate, k.acceleration);
      r_.least_force_n = std::min(r_.least_force_n, force.y);
      if (force.y > 20.0) r_.friction = std::max(r_.friction, std::abs(force.x / force.y));
    } else {
      r_.lowest_toe = std::min(r_.lowest_toe, toe_height<double>(t, k.pose));
    }
    for (const auto& [a, low, high] :
         {std::array{s[0], m_.least.hip, m_.most.hip}, std::array{s[1], m_.least.knee, m_.most.knee}})
      r_.joint_excess_rad = std::max({r_.joint_excess_rad, low - a, a - high});
    const Motors& motors = m_.motors;
    for (const auto& [gear, per_torque, u, w] :
         {std::array{motors.hip_gear, current_.hip, k.u.hip, k.rate.hip},
          std::array{motors.knee_gear, current_.knee, k.u.knee, k.rate.knee}}) {
      const double current = u * per_torque;
      r_.current_a = std::max(r_.current_a, std::abs(current));
      r_.motor_speed_radps = std::max(r_.motor_speed_radps, std::abs(gear * w));
      r_.voltage_v = std::max(
          r_.voltage_v, std::abs(gear * w * motors.torque_constant_nmpa + motors.resistance_ohm * current));
    }
    if (!o_.moment) return;
    const double before = phase == LegPhase::fall     ? 0.0
                          : phase == LegPhase::stance ? plain(r_.fall)
                                                      : plain(r_.fall) + plain(r_.stance);
    const auto pose = plain_leg().pose(angle_of(s));
    const Vec2<double> toe = plain_leg().toe(pose);
    Hip<double> hip{{plain(toe_at_.x) - toe.x, plain(toe_at_.y) - toe.y},
                    plain_leg().pinned_hip_velocity(pose, k.rate)};
    if constexpr (!kStands) hip = hip_of<double>(t, k.pose, k.rate);
    o_.moment({before + t,
               phase,
               hip.place,
               hip.velocity,
               angle_of(s),
               k.rate,
               k.u,
               k.spring,
               {hip.place.x + toe.x, hip.place.y + toe.y},
               force});
  }
  dynamics::LegEquations<double, double> plain_leg() const {
    return dynamics::LegEquations<double, double>(m_.leg);
  }

  const Machine& m_;
  const Law& law_;
  const PlainLaw& plain_;
  const StrideOptions& o_;
  dynamics::LegEquations<T, double> leg_;
  dynamics::LegJoints<double> joints_;
  Joints2<double> heat_ = m_.motors.heat();
  /// A for each N m of the joint.
  Joints2<double> current_{1.0 / (m_.motors.hip_gear * m_.motors.torque_constant_nmpa),
                           1.0 / (m_.motors.knee_gear * m_.motors.torque_constant_nmpa)};
  T rest_{};
  double middle_ = 0.0;
  std::array<bool, 4> counts_{};             ///< of the step: the powers that are above zero
  int pulls_ = 0;                            ///< of the step: the spring pulls (1), or not (-1)
  Vec2<T> toe_at_{}, place_{}, velocity_{};  ///< the last two: of all mass where the flight began
  Vec2<double> plain_place_{}, plain_velocity_{};
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
