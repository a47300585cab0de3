// Drive and motor against closed forms, and their derivatives against finite differences.
#include "furcula/dynamics/actuation.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;
using Jet = ceres::Jet<double, 3>;

namespace {

/// Commands at uneven instants, as a recording has them.
struct Recorded {
  std::vector<double> time_s, command, impulse, driven_s;
  void add(double interval_s, double value) {
    if (time_s.empty()) {
      time_s.push_back(0.0);
      impulse.push_back(0.0);
      driven_s.push_back(0.0);
    } else {
      impulse.push_back(impulse.back() + command.back() * interval_s);
      driven_s.push_back(driven_s.back() + (command.back() != 0.0 ? interval_s : 0.0));
      time_s.push_back(time_s.back() + interval_s);
    }
    command.push_back(value);
  }
  Commands<double> view() const { return {time_s, command, impulse, driven_s}; }
  std::size_t rows() const { return command.size(); }
  double interval(std::size_t row) const { return time_s[row + 1] - time_s[row]; }
};

Recorded swings() {
  Recorded out;
  for (int n = 0; n < 400; ++n) out.add(1e-3 * (1.0 + 0.2 * std::sin(0.7 * n)), 2.0 * std::sin(0.031 * n));
  return out;
}

Recorded step_of(double value, int before, int after) {
  Recorded out;
  for (int n = 0; n < before; ++n) out.add(1e-3, 0.0);
  for (int n = 0; n <= after; ++n) out.add(1e-3, value);
  return out;
}

/// Torque at the leg, row by row; and its integral with the time as weight, a number that all of them move.
template <class T>
std::vector<T> delivered(const Recorded& r, const Effects<T>& effects) {
  Actuation<T> actuation{Drive<T>(effects), Motor<T>(effects)};
  const auto commands = r.view();
  actuation.drive.start(commands, 0);
  std::vector<T> out;
  for (std::size_t i = 0; i + 1 < r.rows(); ++i) out.push_back(actuation.torque(commands, i, r.interval(i)));
  return out;
}

/// The sum of f(command at a time) over an interval in fine steps: what a delay must give.
double mean_delayed(const Recorded& r, double from, double to, const std::function<double(double)>& f) {
  const int steps = 20000;
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double t = from + (k + 0.5) * (to - from) / steps;
    std::size_t i = 0;
    while (i + 1 < r.rows() && r.time_s[i + 1] <= t) ++i;
    sum += f(r.command[i]);
  }
  return sum / steps;
}

}  // namespace

TEST_CASE("The row of an instant is the last one that is not after it, however uneven the rows are") {
  Recorded r = swings();
  r.add(0.5, 1.0);  // a gap, and many rows close together behind it
  for (int n = 0; n < 50; ++n) r.add(1e-5, 0.1 * n);
  r.add(2.0, -1.0);
  const auto commands = r.view();
  const auto expected = [&](double at) {
    std::size_t row = 0;
    while (row + 1 < r.rows() && r.time_s[row + 1] <= at) ++row;
    return row;
  };
  for (std::size_t i = 0; i < r.rows(); ++i)
    for (const double off : {-1e-7, 0.0, 1e-7, 3e-4})
      CHECK(commands.row_at(r.time_s[i] + off) == expected(r.time_s[i] + off));
  for (const double at : {-1.0, 0.3, 0.7, 1.5, 99.0}) CHECK(commands.row_at(at) == expected(at));
  const Recorded one = step_of(3.0, 0, 0);
  CHECK(one.view().row_at(-1.0) == 0);
  CHECK(one.view().row_at(1.0) == 0);
}

TEST_CASE("A delay shifts the impulse, by any part of a step") {
  const Recorded r = swings();
  for (const double delay : {0.0, 0.4e-3, 3e-3, 12.34e-3}) {
    Effects<double> effects;
    effects.set(Effect::actuator_delay, 0, delay);
    const auto torque = delivered(r, effects);
    CAPTURE(delay);
    for (const std::size_t i : {std::size_t{3}, std::size_t{150}, std::size_t{301}}) {
      const double from = r.time_s[i] - delay, to = r.time_s[i + 1] - delay;
      // The fine sum is off by a jump over 1/20000 of the step.
      CHECK(torque[i] == Approx(mean_delayed(r, from, to, [](double c) { return c; })).margin(1e-5));
    }
    double impulse = 0.0;
    for (std::size_t i = 0; i < torque.size(); ++i) impulse += torque[i] * r.interval(i);
    // All that was commanded up to the delay before the end; before the first row the first command holds.
    CHECK(impulse == Approx(r.view().impulse_until(r.time_s.back() - delay) + r.command[0] * delay));
  }
}

TEST_CASE("A lag answers a step as one less an exponential, exactly in the mean of each row") {
  const Recorded r = step_of(3.0, 5, 100);
  const double tau = 7e-3;
  Effects<double> effects;
  effects.set(Effect::actuator_lag, 0, tau);
  const auto torque = delivered(r, effects);
  CHECK(torque[4] == 0.0);
  for (const int n : {0, 1, 10, 90}) {
    const double from = n * 1e-3, to = from + 1e-3;
    const double mean = 3.0 * (1.0 - (std::exp(-from / tau) - std::exp(-to / tau)) * tau / 1e-3);
    CHECK(torque[5 + n] == Approx(mean).epsilon(1e-12));
  }
  Drive<double> drive(effects);
  drive.start(r.view(), 0);
  for (std::size_t i = 0; i < 25; ++i) drive.torque(r.view(), i, 1e-3);
  CHECK(drive.shown(r.view(), 25, 1e-3) == Approx(3.0 * -std::expm1(-20e-3 / tau)).epsilon(1e-12));
  CHECK(std::exp(-drive.memory_s() / tau) < 1e-3);
}

TEST_CASE("A lag without a time constant is none, and its derivative there is that of a very small one") {
  const Recorded r = swings();
  const auto at = [&](auto tau) {
    using T = decltype(tau);
    Effects<T> effects;
    effects.set(Effect::actuator_lag, 0, tau);
    return delivered(r, effects)[200];
  };
  CHECK(at(0.0) == r.command[200]);
  CHECK(at(Jet(0.0, 0)).v[0] == Approx((at(1e-5) - at(0.0)) / 1e-5).epsilon(1e-6));
}

TEST_CASE("A limit cuts both signs, before the lag and after the delay") {
  const Recorded r = swings();
  Effects<double> effects;
  effects.set(Effect::torque_saturation, 0, 1.2);
  for (std::size_t i = 0; const double torque : delivered(r, effects)) {
    CHECK(torque == std::max(-1.2, std::min(1.2, r.command[i])));
    ++i;
  }
  // Delayed by part of a step: the mean of what is limited, not the limit of the mean.
  effects.set(Effect::actuator_delay, 0, 0.3e-3);
  const Recorded step = step_of(5.0, 5, 10);
  CHECK(delivered(step, effects)[5] == Approx(1.2 * 0.7).epsilon(1e-12));
  CHECK(delivered(step, effects)[6] == Approx(1.2).epsilon(1e-12));
  effects.set(Effect::actuator_delay, 0, 2.7e-3);
  const auto torque = delivered(r, effects);
  for (const std::size_t i : {std::size_t{30}, std::size_t{77}, std::size_t{300}})
    CHECK(torque[i] == Approx(mean_delayed(r, r.time_s[i] - 2.7e-3, r.time_s[i + 1] - 2.7e-3, [](double c) {
                         return std::max(-1.2, std::min(1.2, c));
                       })).margin(1e-5));
  effects.clear(Effect::actuator_delay);
  effects.set(Effect::actuator_lag, 0, 0.05);
  const auto lagging = delivered(step_of(5.0, 5, 300), effects);
  CHECK(lagging.back() < 1.2);
  CHECK(lagging[5 + 50] == Approx(1.2 * (1 - std::exp(-50.5e-3 / 0.05))).epsilon(1e-4));
}

TEST_CASE("Gain, heat and offset change what the motor makes, in that order, and not what the drive shows") {
  Recorded r;
  for (int n = 0; n < 1000; ++n) r.add(1e-3, n % 10 < 4 ? 2.0 : 0.0);  // driven two fifths of the time
  Effects<double> effects;
  effects.set(Effect::torque_gain_error, 0, 0.9);
  effects.set(Effect::thermal_derating, {0.6, 0.25, 0.0});
  effects.set(Effect::torque_offset, 0, -0.1);
  const Drive<double> drive(effects);
  CHECK(drive.ideal());
  const auto torque = delivered(r, effects);
  CHECK(torque[0] == Approx(0.9 * 2.0 - 0.1));
  CHECK(torque[5] == Approx(-0.1));
  CHECK(torque[500] == Approx(0.9 * 2.0 * (0.6 + 0.4 * std::exp(-0.2 / 0.25)) - 0.1).epsilon(1e-9));
  CHECK(drive.shown(r.view(), 500, 1e-3) == 2.0);
}

TEST_CASE("What the drive and the motor make has the derivatives that finite differences give") {
  const Recorded r = swings();
  const auto weighed = [&](const auto& effects) {
    const auto torque = delivered(r, effects);
    auto sum = torque[0] * 0.0;
    for (std::size_t i = 0; i < torque.size(); ++i)
      sum += torque[i] * (r.interval(i) * (r.time_s.back() - r.time_s[i]));
    return sum;
  };
  struct Case {
    std::vector<Effect> effects;
    std::vector<std::vector<double>> at;
  };
  const std::vector<Case> cases{
      {{Effect::actuator_delay}, {{4.37e-3}}},
      {{Effect::actuator_lag}, {{9e-3}}},
      {{Effect::torque_saturation}, {{1.3}}},
      {{Effect::torque_gain_error}, {{1.1}}},
      {{Effect::torque_offset}, {{0.2}}},
      {{Effect::thermal_derating}, {{0.7, 0.3}}},
      {{Effect::actuator_delay, Effect::torque_saturation, Effect::actuator_lag}, {{4.37e-3}, {1.3}, {6e-3}}},
  };
  for (const Case& c : cases) {
    CAPTURE(std::string(info(c.effects[0]).name), c.effects.size());
    Effects<Jet> jets;
    Effects<double> values;
    struct Unknown {
      Effect effect;
      std::size_t parameter;
      double at;
    };
    std::vector<Unknown> unknowns;
    for (std::size_t k = 0; k < c.effects.size(); ++k)
      for (std::size_t i = 0; i < c.at[k].size(); ++i) {
        jets.set(c.effects[k], i, Jet(c.at[k][i], static_cast<int>(unknowns.size())));
        values.set(c.effects[k], i, c.at[k][i]);
        unknowns.push_back({c.effects[k], i, c.at[k][i]});
      }
    const Jet out = weighed(jets);
    CHECK(out.a == Approx(weighed(values)).epsilon(1e-14));
    for (std::size_t u = 0; u < unknowns.size(); ++u) {
      const auto [effect, i, at] = unknowns[u];
      const double step = 1e-6 * std::abs(at);
      Effects<double> up = values, down = values;
      up.set(effect, i, at + step);
      down.set(effect, i, at - step);
      CHECK(out.v[static_cast<int>(u)] ==
            Approx((weighed(up) - weighed(down)) / (2 * step)).epsilon(1e-6).margin(3e-8));
    }
  }
}
