// Both estimators against closed forms with known noise.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/identify/equation_fit.hpp"
#include "host/identify/simulation_fit.hpp"
#include "host/identify/verdicts.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;

namespace {

struct Fitted {
  identify::Fit fit;
  std::vector<identify::ParameterVerdict> verdicts;
};

Fitted fitted(const std::vector<log::Log>& logs, const model::Model& model, bool by_equation) {
  std::vector<identify::Recording> recordings;
  for (const auto& log : logs) recordings.push_back(identify::make_recording(log, model.kind));
  const auto training = identify::training_windows(recordings, model, 0.5);
  const auto& windows = training.windows;
  const std::size_t layers = training.layers;
  const auto unknowns = identify::free_unknowns(model);
  const auto start = identify::values_in(model, unknowns);
  Fitted f;
  f.fit = by_equation ? identify::fit_by_equation(model, unknowns, start, recordings, windows, layers)
                      : identify::fit_by_simulation(model, unknowns, start, recordings, windows,
                                                    identify::Weighting::noise, layers);
  f.verdicts = identify::parameter_verdicts(f.fit, unknowns);
  return f;
}

}  // namespace

TEST_CASE("Without noise both estimators give the mass and damping of the closed form") {
  const auto model = test::axis_model(60.0, 90.0);
  const std::vector<log::Log> logs{test::axis_log(95.0, 203.5, 0.0, 1), test::axis_log(95.0, 203.5, 0.0, 2)};
  const auto simulation = fitted(logs, model, false);
  CHECK(simulation.fit.values[0] == Approx(95.0).epsilon(1e-6));
  CHECK(simulation.fit.values[1] == Approx(203.5).epsilon(1e-6));
  // One step's velocity comes from a local parabola, which rounds the corners where the force switches.
  const auto equation = fitted(logs, model, true);
  CHECK(equation.fit.values[0] == Approx(95.0).epsilon(0.05));
  CHECK(equation.fit.values[1] == Approx(203.5).epsilon(0.1));
}

TEST_CASE(
    "Intervals of 95 % hold the true values in about 95 % of repeated recordings, overlapping windows or not") {
  // Noise so large that what the numerics are worth does not widen them. 12 s are 24 windows side by side, 6 s 12 in each of 2 layers.
  const auto model = test::axis_model(60.0, 90.0);
  constexpr int kRuns = 100;
  for (const double seconds : {12.0, 6.0}) {
    int held = 0;
    for (unsigned run = 0; run < kRuns; ++run) {
      const auto f = fitted({test::axis_log(95.0, 203.5, 6e-3, 100 + run, seconds)}, model, false);
      CHECK(f.fit.layers == (seconds > 10.0 ? 1 : 2));
      for (std::size_t i = 0; i < 2; ++i) {
        const double truth = i == 0 ? 95.0 : 203.5;
        held += f.verdicts[i].lower <= truth && truth <= f.verdicts[i].upper ? 1 : 0;
        CHECK(f.verdicts[i].verdict == "identified");
      }
    }
    CAPTURE(seconds, held, 2 * kRuns);
    CHECK(held >= 0.90 * 2 * kRuns);
    CHECK(held <= 0.98 * 2 * kRuns);
  }
}

TEST_CASE("Under a bounded loss windows that are far off weigh no more than others") {
  // Five recordings of one machine, with noise; in the last one the place jumps by half a metre within three of the windows.
  const auto model = test::axis_model(60.0, 90.0);
  std::vector<identify::Recording> recordings;
  for (unsigned i = 1; i <= 5; ++i) {
    log::Log log = test::axis_log(95.0, 203.5, 1e-4, i);
    if (i == 5)
      for (std::size_t row = 0; row < log.rows(); ++row)
        log.columns["position_m"][row] += row < 1130 ? 0.0 : row < 1430 ? 0.5 : row < 1680 ? 1.0 : 1.5;
    recordings.push_back(identify::make_recording(log, model.kind));
  }
  const auto training = identify::training_windows(recordings, model, 0.5);
  const auto unknowns = identify::free_unknowns(model);
  const auto fitted_with = [&](double most_squares) {
    identify::Effort effort;
    effort.most_squares = most_squares;
    return identify::fit_by_simulation(model, unknowns, identify::values_in(model, unknowns), recordings,
                                       training.windows, identify::Weighting::noise, training.layers, effort);
  };
  const identify::Fit all = fitted_with(std::numeric_limits<double>::infinity());
  double most = 0.0;
  identify::Fit bounded = all;
  for (int round = 0; round < 4; ++round) {
    most = identify::most_squares_of(bounded.shares);
    bounded = fitted_with(most);
  }
  CAPTURE(all.values, bounded.values, most);
  CHECK(std::abs(all.values[0] - 95.0) > 1.0);
  CHECK(bounded.values[0] == Approx(95.0).epsilon(1e-3));
  CHECK(bounded.values[1] == Approx(203.5).epsilon(1e-3));
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < bounded.shares.size(); ++i) {
    const identify::WindowShare& s = bounded.shares[i];
    CHECK(s.squares <= s.all_squares * (1.0 + 1e-12));
    CHECK(s.squares <= most / 3.0 * (1.0 + 1e-12));
    if (s.all_squares < most) continue;
    ++beyond;
    CHECK(training.windows[i].recording == 4);
    CHECK(s.squares == Approx(most / 3.0));
    CHECK(s.gradient.norm() == 0.0);
    CHECK(s.information.norm() == 0.0);
  }
  CHECK(beyond >= 2);
}

TEST_CASE("The bound of that loss is Tukey's for a normal number, by the windows' upper quartile") {
  std::vector<identify::WindowShare> shares(101);
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i].all_squares = static_cast<double>(i);
  // A normal number's square has its upper quartile at 1.3233 variances.
  CHECK(identify::most_squares_of(shares) == Approx(4.685 * 4.685 * 75.0 / 1.3233).epsilon(1e-3));
  CHECK(std::isinf(identify::most_squares_of({})));
  CHECK(std::isinf(identify::most_squares_of(std::vector<identify::WindowShare>(4))));
}

TEST_CASE("However quiet a recording is, no interval is narrower than what the numerics are worth") {
  const auto f = fitted({test::axis_log(95.0, 203.5, 1e-7, 1, 24.0)}, test::axis_model(60.0, 90.0), false);
  // 48 windows less two unknowns: t = 2.0129; 0.15 % of the value.
  for (const auto& v : f.verdicts)
    CHECK(v.upper - v.lower == Approx(2.0 * 2.0129 * 1.5e-3 * v.value).epsilon(0.03));
}

TEST_CASE("A parameter that nothing excites is not called identified") {
  auto log = test::axis_log(95.0, 203.5, 1e-4, 1);
  for (double& u : log.columns["force_n"]) u = 0.0;
  for (std::size_t i = 0; i < log.rows(); ++i)
    log.columns["position_m"][i] = 1e-4 * std::sin(12345.0 * static_cast<double>(i));
  const auto f = fitted({log}, test::axis_model(60.0, 90.0), false);
  for (const auto& v : f.verdicts) CHECK(v.verdict != "identified");
}

TEST_CASE("A value at its bound is told as such, with the bound") {
  auto model = test::axis_model(60.0, 90.0);
  model.free[0] = {50.0, 70.0};
  const auto f = fitted({test::axis_log(95.0, 203.5, 1e-5, 1)}, model, false);
  CHECK(f.verdicts[0].verdict == "at_bound");
  CHECK(f.verdicts[0].with == "upper");
}

TEST_CASE("A phase is told within half a turn of zero, from wherever its fit began") {
  // The encoder's wheel is eccentric: 2 mm, once in 0.12 m.
  constexpr double kPhase = 1.9;
  std::vector<identify::Recording> recordings;
  for (unsigned i = 0; i < 3; ++i) {
    log::Log log = test::flight_log({.height = 0.0, .velocity = 2.0 + i}, 9e-5, i);
    for (double& z : log.columns["height_m"])
      z += 2e-3 * std::sin(2.0 * std::numbers::pi * z / 0.12 + kPhase);
    recordings.push_back(identify::make_recording(log, dynamics::Kind::rail_carriage));
  }
  const auto model = test::carriage_model();
  const auto training = identify::training_windows(recordings, model, 0.5);
  const auto unknowns =
      identify::effect_unknowns(dynamics::Effect::height_eccentricity, dynamics::Kind::rail_carriage);
  for (const double turns : {-1.0, 0.0, 1.0}) {
    const auto fit = identify::fit_by_simulation(
        model, unknowns, {2e-3, 0.12, kPhase + 2.0 * std::numbers::pi * turns}, recordings, training.windows,
        identify::Weighting::noise, training.layers);
    CAPTURE(turns);
    CHECK(fit.values[2] == Approx(kPhase).margin(0.05));
  }
}

TEST_CASE("No delay of a drive is known better than when within a row its command came") {
  constexpr double kRow_s = 0.002, kDelay_s = 0.012, kRowSd_s = 0.5 * kRow_s / 1.7320508;
  std::vector<identify::Recording> recordings;
  for (unsigned i = 0; i < 3; ++i) {
    log::Log log = test::axis_log(95.0, 203.5, 1e-6, i);
    // Told of commands before they acted.
    std::vector<double>& force = log.columns["force_n"];
    force.erase(force.begin(), force.begin() + std::lround(kDelay_s / kRow_s));
    force.resize(log.columns["time_s"].size(), force.back());
    recordings.push_back(identify::make_recording(log, dynamics::Kind::motor_axis));
  }
  const auto model = test::axis_model(95.0, 203.5);
  const auto training = identify::training_windows(recordings, model, 0.5);
  auto unknowns = identify::free_unknowns(model);
  for (const auto& u :
       identify::effect_unknowns(dynamics::Effect::actuator_delay, dynamics::Kind::motor_axis))
    unknowns.push_back(u);
  const auto fit = identify::fit_by_simulation(model, unknowns, {95.0, 203.5, 0.01}, recordings,
                                               training.windows, identify::Weighting::noise, training.layers);
  const auto delay = identify::parameter_verdicts(fit, unknowns).back();
  CAPTURE(delay.value, delay.lower, delay.upper);
  CHECK(delay.value == Approx(kDelay_s).margin(0.5 * kRow_s));
  CHECK(0.5 * (delay.upper - delay.lower) == Approx(1.96 * kRowSd_s).epsilon(0.1));
}

TEST_CASE("A free swing tells gravity torque over inertia, not each") {
  // Small free swings of a pendulum, in closed form: theta = A cos(sqrt(G/I) t); no torque, so only G/I
  // matters.
  log::Log log;
  log.path = "swing.csv";
  for (int n = 0; n < 3000; ++n) {
    const double t = 0.004 * n;
    log.columns["time_s"].push_back(t);
    log.columns["angle_rad"].push_back(0.02 * std::cos(std::sqrt(3.7 / 0.2) * t) + 1e-6 * std::sin(1e4 * t));
    log.columns["torque_nm"].push_back(0.0);
  }
  model::Model model;
  model.kind = dynamics::Kind::rotary_joint;
  model.parameters = {0.15, 2.5, 0.0};
  model.free = {{0, {0.05, 0.6}}, {1, {0.5, 9.0}}};
  const auto f = fitted({log}, model, false);
  CHECK(f.verdicts[0].verdict == "correlated");
  CHECK(f.verdicts[0].with == "gravity_torque_nm");
  CHECK(f.verdicts[1].verdict == "correlated");
  CHECK(f.fit.values[1] / f.fit.values[0] == Approx(3.7 / 0.2).epsilon(1e-3));
}

namespace {

/// Fitted by equation error, one row of the result an unknown.
std::vector<double> by_equation(const std::vector<log::Log>& logs, const model::Model& model) {
  return fitted(logs, model, true).fit.values;
}

/// A free swing of a pendulum, 0.4 rad wide, gravity torque over inertia 18.5: classic Runge-Kutta steps of 0.1 ms.
log::Log swing() {
  log::Log log;
  log.path = "swing.csv";
  double angle = 0.4, speed = 0.0;
  for (int n = 0; n < 2000; ++n) {
    log.columns["time_s"].push_back(0.004 * n);
    log.columns["angle_rad"].push_back(angle);
    log.columns["torque_nm"].push_back(0.0);
    constexpr double h = 1e-4;
    const auto pull = [](double at) { return -18.5 * std::sin(at); };
    for (int k = 0; k < 40; ++k) {
      const double v1 = speed, a1 = pull(angle), v2 = speed + 0.5 * h * a1, a2 = pull(angle + 0.5 * h * v1);
      const double v3 = speed + 0.5 * h * a2, a3 = pull(angle + 0.5 * h * v2), v4 = speed + h * a3,
                   a4 = pull(angle + h * v3);
      angle += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
      speed += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }
  return log;
}

}  // namespace

TEST_CASE("Equation error takes a drive that is late in the model for what it is") {
  // The same motion, told of commands that were sent 20 ms, ten rows, before they acted.
  auto model = test::axis_model(60.0, 90.0);
  const auto on_time = test::axis_log(95.0, 203.5, 0.0, 1);
  auto late = on_time;
  const auto& force = on_time.at("force_n");
  for (std::size_t i = 0; i + 10 < late.rows(); ++i) late.columns["force_n"][i] = force[i + 10];
  const auto expected = by_equation({on_time}, model);
  CHECK(std::abs(by_equation({late}, model)[0] / expected[0] - 1.0) > 0.03);  // without the delay it is wrong
  model.effects[dynamics::Effect::actuator_delay] = {0.02};
  const auto found = by_equation({late}, model);
  CHECK(found[0] == Approx(expected[0]).epsilon(1e-6));
  CHECK(found[1] == Approx(expected[1]).epsilon(1e-6));
}

TEST_CASE("Equation error takes an encoder whose zero is off in the model for what it is") {
  model::Model model;
  model.kind = dynamics::Kind::rotary_joint;
  model.parameters = {0.2, 2.5, 0.0};
  model.free = {{1, {0.5, 9.0}}};
  auto off = swing();
  for (double& angle : off.columns["angle_rad"]) angle += 0.3;
  CHECK(by_equation({swing()}, model)[0] == Approx(18.5 * 0.2).epsilon(0.01));
  CHECK(by_equation({off}, model)[0] < 0.95 * 18.5 * 0.2);  // a swing about another place
  model.effects[dynamics::Effect::encoder_offset] = {0.3};
  CHECK(by_equation({off}, model)[0] == Approx(18.5 * 0.2).epsilon(0.01));
}

TEST_CASE(
    "Equation error moves all parameters of the non-linear hopper at once, each as it would with a few") {
  // Hops of the robot of document 002; all 13 held within a billionth, so that every fit looks at the same place.
  model::Model model = test::hopper_model();
  model.kind = dynamics::Kind::hopper_nonlinear;
  model.parameters.insert(model.parameters.end(), {42e-4, 75e-4, 38e-3});
  auto scenario = sim::default_scenario(model);
  scenario.duration_s = 1.5;
  const identify::Recording r = identify::make_recording(sim::simulate(model, scenario, 1), model.kind);
  const auto windows = identify::stances(r, 0, model);
  REQUIRE(windows.size() >= 2);
  const auto fit_of = [&](const std::vector<std::size_t>& free) {
    model.free.clear();
    for (const std::size_t i : free) {
      const double value = 0.98 * model.parameters[i];
      model.free[i] = {value, value * (1.0 + 1e-9)};
    }
    const auto unknowns = identify::free_unknowns(model);
    std::vector<double> start;
    for (const auto& u : unknowns) start.push_back(u.lower);
    // What is not free stands where it is held elsewhere.
    auto at = model;
    for (double& p : at.parameters) p *= 0.98;
    return identify::fit_by_equation(at, unknowns, start, {r}, windows);
  };
  std::vector<std::size_t> all(13);
  for (std::size_t i = 0; i < 13; ++i) all[i] = i;
  const auto whole = fit_of(all);
  REQUIRE(whole.values.size() == 13);
  for (const auto& [i, k] : {std::pair<std::size_t, std::size_t>{0, 12}, {1, 10}, {11, 12}, {3, 5}}) {
    const auto pair = fit_of({i, k});
    CAPTURE(i, k);
    const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(k);
    const auto& of_all = whole.shares[1];
    const auto& of_two = pair.shares[1];
    CHECK(of_all.gradient(row) == Approx(of_two.gradient(0)).epsilon(1e-5));
    CHECK(of_all.gradient(column) == Approx(of_two.gradient(1)).epsilon(1e-5));
    CHECK(of_all.information(row, column) == Approx(of_two.information(0, 1)).epsilon(1e-5));
    CHECK(of_all.information(column, column) == Approx(of_two.information(1, 1)).epsilon(1e-5));
  }
}

TEST_CASE("More unknowns than a fit has room for are refused with both numbers") {
  auto model = test::axis_model(60.0, 90.0);
  std::vector<identify::Recording> recordings{
      identify::make_recording(test::axis_log(95.0, 203.5, 0.0, 1), model.kind)};
  const auto windows = identify::prediction_windows(recordings, model, 0.5);
  const auto unknowns = identify::free_unknowns(model);
  std::vector<identify::Unknown> many(31, unknowns[0]);
  CHECK_THROWS_WITH(
      identify::fit_by_simulation(model, many, std::vector<double>(31, 60.0), recordings, windows),
      Catch::Contains("31") && Catch::Contains("30"));
}
