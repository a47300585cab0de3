// Both estimators against closed forms with known noise.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/identify/equation_fit.hpp"
#include "host/identify/simulation_fit.hpp"
#include "host/identify/verdicts.hpp"
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
  const auto windows = identify::prediction_windows(recordings, model, 0.5);
  const auto unknowns = identify::free_unknowns(model);
  const auto start = identify::values_in(model, unknowns);
  Fitted f;
  f.fit = by_equation ? identify::fit_by_equation(model, unknowns, start, recordings, windows)
                      : identify::fit_by_simulation(model, unknowns, start, recordings, windows);
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

TEST_CASE("Intervals of 95 % hold the true values in about 95 % of repeated recordings") {
  const auto model = test::axis_model(60.0, 90.0);
  int held = 0;
  constexpr int kRuns = 60;
  for (unsigned run = 0; run < kRuns; ++run) {
    const auto f = fitted({test::axis_log(95.0, 203.5, 2e-4, 100 + run)}, model, false);
    for (std::size_t i = 0; i < 2; ++i) {
      const double truth = i == 0 ? 95.0 : 203.5;
      held += f.verdicts[i].lower <= truth && truth <= f.verdicts[i].upper ? 1 : 0;
      CHECK(f.verdicts[i].verdict == "identified");
    }
  }
  // A binomial of 120 at 0.95 lies in 0.88 to 1 with odds of a thousand to one.
  INFO(held << " of " << 2 * kRuns);
  CHECK(held >= 106);
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

TEST_CASE("Student's t has its tabulated 95 % points") {
  CHECK(identify::student_t95(1) == Approx(12.706));
  CHECK(identify::student_t95(2) == Approx(4.303));
  CHECK(identify::student_t95(3) == Approx(3.182).epsilon(0.01));
  CHECK(identify::student_t95(5) == Approx(2.571).epsilon(2e-3));
  CHECK(identify::student_t95(10) == Approx(2.228).epsilon(1e-3));
  CHECK(identify::student_t95(100) == Approx(1.984).epsilon(1e-3));
}
