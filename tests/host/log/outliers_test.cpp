// Which rows are no part of a motion, and which motions have none such.
#include "host/log/outliers.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

using namespace furcula;
using Rows = std::vector<std::size_t>;

namespace {

struct Series {
  std::vector<double> time_s, values;
};

/// `at(t)` every millisecond for `seconds`, with white noise.
template <class At>
Series sampled(double seconds, double noise, const At& at, double jitter = 0.0) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> white(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Series s;
  for (int i = 0; i < static_cast<int>(1000.0 * seconds); ++i) {
    const double t = 1e-3 * i;
    s.time_s.push_back(t);
    s.values.push_back(at(t + 1e-3 * jitter * uniform(random)) + noise * white(random));
  }
  return s;
}

/// Falls from 1 m and bounces with half its speed: a kink at each impact.
double ball(double t) {
  double v = 0.0, z = 1.0, lands = std::sqrt(2.0 / 9.81);
  while (t > lands && std::abs(v) < 10.0) {
    t -= lands;
    z = 0.0;
    v = 0.5 * (v == 0.0 ? std::sqrt(2.0 * 9.81) : v);
    lands = 2.0 * v / 9.81;
    if (v < 0.1) return 0.0;
  }
  return z + v * t - 0.5 * 9.81 * t * t;
}

}  // namespace

TEST_CASE("A wrong row, a burst of five and wrong rows at the ends are found, and no other") {
  Series s = sampled(1.0, 1e-4, [](double t) { return 0.3 * std::sin(6.0 * t); });
  s.values[0] += 0.2;
  s.values[417] = 9.99;
  for (std::size_t i = 600; i < 605; ++i) s.values[i] = i % 2 == 0 ? -3.0 : 0.0;
  s.values[602] = 4.0;
  s.values[998] += 0.5;
  s.values[999] -= 0.5;
  CHECK(log::steps_out_and_back(s.time_s, s.values) == Rows{0, 417, 600, 601, 602, 603, 604, 998, 999});
}

TEST_CASE("One row of a hundred at random is found, but for those that are within the motion") {
  Series s = sampled(14.0, 1e-4, [](double t) { return 0.3 * std::sin(6.0 * t); });
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  Rows wrong;
  for (std::size_t i = 50; i < s.values.size(); i += 50 + random() % 100) {
    const double before = s.values[i];
    s.values[i] = anywhere(random);
    // 1.8 m/s and 2 ms: what is nearer than twice that may be a clock's error.
    if (std::abs(s.values[i] - before) > 0.02) wrong.push_back(i);
  }
  const Rows found = log::steps_out_and_back(s.time_s, s.values);
  for (const std::size_t i : wrong) CHECK(std::find(found.begin(), found.end(), i) != found.end());
  CHECK(found.size() < wrong.size() + 10);
}

TEST_CASE("Bounces, stops, reversals, steps that stay, counts and a jittering clock are no wrong rows") {
  const auto none = [](const Series& s) { return log::steps_out_and_back(s.time_s, s.values).empty(); };
  CHECK(none(sampled(3.0, 0.0, ball)));
  CHECK(none(sampled(3.0, 1e-4, ball)));
  CHECK(none(sampled(3.0, 1e-5, ball, 0.4)));
  CHECK(none(sampled(1.0, 1e-5, [](double t) { return t < 0.5 ? 2.0 * t : 1.0; })));
  CHECK(none(sampled(1.0, 1e-5, [](double t) { return 0.2 * std::abs(t - 0.5); })));
  CHECK(none(sampled(1.0, 1e-5, [](double t) { return t < 0.5 ? 0.1 * t : 0.1 * t + 0.3; })));
  CHECK(none(sampled(2.0, 0.0, [](double t) { return 1e-3 * std::floor(40.0 * std::sin(3.0 * t)); })));
  // A sensor that rings at 200 Hz after an impact.
  CHECK(none(sampled(1.0, 1e-5, [](double t) {
    const double after = t - 0.5;
    return after < 0.0 ? -2.0 * after
                       : 1e-3 * std::exp(-after / 0.02) * std::sin(2.0 * std::numbers::pi * 200.0 * after);
  })));
  // A clock that is late by most of an interval, once.
  Series late = sampled(1.0, 1e-5, [](double t) { return 2.0 * t; });
  late.time_s[300] += 9e-4;
  CHECK(none(late));
}

TEST_CASE("Rows at an end that the rows beside them do not predict are found, and no knock is") {
  const auto swing = [](double t) { return 0.7 * std::sin(2.0 * t + 0.3) + 0.3 * std::cos(9.0 * t); };
  Series s = sampled(4.0, 1e-4, swing);
  CHECK(log::off_at_ends(s.time_s, s.values).empty());
  // The first three rows come from before a delay; the last two are a sensor's.
  for (std::size_t i = 0; i < 3; ++i) s.values[i] += 0.012;
  for (std::size_t i = 3998; i < 4000; ++i) s.values[i] -= 0.008;
  CHECK(log::off_at_ends(s.time_s, s.values) == Rows{0, 1, 2, 3998, 3999});
  // Less than twelve times the noise is not seen.
  Series little = sampled(4.0, 1e-4, swing);
  for (std::size_t i = 0; i < 3; ++i) little.values[i] += 8e-4;
  CHECK(log::off_at_ends(little.time_s, little.values).empty());
  // It lands in its fourth row, and in its fourth but last.
  const double lands_s = std::sqrt(2.0 / 9.81);
  const Series knock = sampled(3.0, 1e-5, [&](double t) { return ball(t + lands_s - 3.4e-3); });
  CHECK(log::off_at_ends(knock.time_s, knock.values).empty());
  const Series sets_off =
      sampled(3.0, 1e-5, [&](double t) { return t < 0.4e-3 ? 0.0 : std::sin(6.0 * (t - 0.4e-3)); });
  CHECK(log::off_at_ends(sets_off.time_s, sets_off.values).empty());
  Series back = sampled(0.4554, 1e-5, ball);
  CHECK(log::off_at_ends(back.time_s, back.values).empty());
}

TEST_CASE(
    "An encoder that stands still while the body goes on is found, a body that stands still, and a slip there, are not") {
  const double count = 2.0 * std::numbers::pi / 16384.0;
  const auto counted = [count](double x) { return count * std::round(x / count); };
  Series s = sampled(3.0, 0.0, [&](double t) { return counted(1.2 * std::sin(4.0 * t)); });
  CHECK(log::stuck(s.time_s, s.values).empty());
  for (std::size_t i = 1000; i < 1150; ++i) s.values[i] = s.values[999];
  Rows rows;
  for (std::size_t i = 1000; i < 1150; ++i) rows.push_back(i);
  CHECK(log::stuck(s.time_s, s.values) == rows);
  // It sticks between two moves, goes on slowly, and slips at rest.
  const auto rests = [&](double t) {
    return counted(t < 1.0   ? std::sin(2.0 * t)
                   : t < 2.0 ? std::sin(2.0)
                             : std::sin(2.0) + 0.5 * (t - 2.0) * (t - 2.0));
  };
  Series rest = sampled(3.0, 0.0, rests);
  CHECK(log::stuck(rest.time_s, rest.values).empty());
  for (std::size_t i = 1500; i < rest.values.size(); ++i) rest.values[i] += 0.05;
  CHECK(log::stuck(rest.time_s, rest.values).empty());
}

TEST_CASE("What may jump is refused where it is beyond all others, and for a few rows") {
  std::vector<double> torque(1000);
  for (std::size_t i = 0; i < torque.size(); ++i) torque[i] = (i / 100) % 2 == 0 ? 1.5 : -1.5;
  CHECK(log::far_beyond_others(torque).empty());
  torque[250] = 1e6;
  torque[700] = torque[701] = -800.0;
  CHECK(log::far_beyond_others(torque) == Rows{250, 700, 701});
  // A push for ten rows is a command; so is the only one that is not zero.
  for (std::size_t i = 400; i < 410; ++i) torque[i] = 90.0;
  torque[250] = torque[700] = torque[701] = 1.5;
  CHECK(log::far_beyond_others(torque).empty());
  std::vector<double> pulse(1000, 0.0);
  pulse[500] = 20.0;
  CHECK(log::far_beyond_others(pulse).empty());
}

TEST_CASE("An angle that wraps at a turn goes on, and so does a counter that wraps twice by the same") {
  const double turn = 2.0 * std::numbers::pi;
  const Series s = sampled(2.0, 1e-4, [](double t) { return 12.0 * std::sin(2.0 * t); });
  Series wrapped = s;
  for (double& x : wrapped.values) x -= turn * std::floor((x + std::numbers::pi) / turn);
  CHECK(log::wrap_span(wrapped.time_s, wrapped.values, turn) == turn);
  const auto back = log::unwrapped(wrapped.values, turn);
  for (std::size_t i = 0; i < back.size(); ++i) CHECK(back[i] == Approx(s.values[i]).margin(1e-9));

  Series counter = s;
  for (double& x : counter.values) x -= 0.4096 * std::floor(x / 0.4096);
  const double span = log::wrap_span(counter.time_s, counter.values, 0.0);
  CHECK(span == Approx(0.4096).epsilon(0.01));
}

TEST_CASE("A single step that is no turn, and a motion that does not jump, are no wraps") {
  const double turn = 2.0 * std::numbers::pi;
  const Series slip = sampled(1.0, 1e-4, [](double t) { return t < 0.5 ? 0.1 * t : 0.1 * t - 0.3; });
  CHECK(log::wrap_span(slip.time_s, slip.values, turn) == 0.0);
  const Series swing = sampled(1.0, 1e-4, [](double t) { return 3.1 * std::sin(9.0 * t); });
  CHECK(log::wrap_span(swing.time_s, swing.values, turn) == 0.0);
}
