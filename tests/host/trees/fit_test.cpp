// Fits of a tree by simulation, and the torque that a model lacks.
#include "host/trees/fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "host/trees/friction_at_rest.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/missing_torque.hpp"
#include "host/trees/score_test.hpp"
#include "host/trees/simulate.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;
using trees::Effect;

namespace {

std::vector<trees::Recording> recordings(const trees::TreeModel& m, const std::vector<log::Log>& logs) {
  std::vector<trees::Recording> out;
  for (const log::Log& log : logs) out.push_back(trees::recording_of(m, log));
  return out;
}

}  // namespace

TEST_CASE("Steadiness is large where recordings agree, small where they do not") {
  const std::vector<double> even(6, 1.0);
  CHECK(trees::steadiness(std::vector{0.30, 0.31, 0.29, 0.30, 0.32, 0.28}, even) > 3.0);
  CHECK(trees::steadiness(std::vector{0.3, -0.3, 0.2, -0.2, 0.25, -0.25}, even) < 0.1);
  // It does not depend on the unit, nor on the sign.
  const std::vector<double> some{0.3, 0.1, 0.25, 0.05, 0.2, 0.15};
  std::vector<double> scaled;
  for (const double x : some) scaled.push_back(-1e3 * x);
  CHECK(trees::steadiness(some, even) == Approx(trees::steadiness(scaled, even)));
  CHECK(trees::steadiness(some, even) == Approx(trees::steadiness(some, std::vector<double>(6, 50.0))));
  // A recording without information has no say.
  CHECK(trees::steadiness(std::vector{0.3, 0.1, 0.25, 0.05, 0.2, 0.15, -99.0},
                          std::vector{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1e-12}) ==
        Approx(trees::steadiness(some, even)).epsilon(1e-3));
  // None at all says nothing, one alone cannot be contradicted.
  CHECK(trees::steadiness({}, {}) == 0.0);
  CHECK(trees::steadiness(std::vector{0.3, 0.2}, std::vector{0.0, 0.0}) == 0.0);
  CHECK(trees::steadiness(std::vector{0.3}, std::vector{5.0}) > 1.0);
}

TEST_CASE("Steadiness finds agreement in pure noise hardly ever") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const std::size_t count : {3u, 5u, 10u}) {
    int found = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      std::vector<double> x;
      for (std::size_t k = 0; k < count; ++k) x.push_back(normal(random));
      found += trees::steadiness(x, std::vector<double>(count, 1.0)) > 1.0 ? 1 : 0;
    }
    INFO(count);
    CHECK(found < 80);  // 4 %
  }
}

TEST_CASE("Windows lie side by side, none over a gap") {
  const trees::TreeModel m = test::wheel();
  std::vector<trees::Recording> r{test::inputs(m, 3.0, 0.004, [](std::size_t, double) { return 0.0; })};
  const auto whole = trees::windows_of(m, r, 0.3);
  CHECK(whole.size() == 10);
  for (std::size_t i = 1; i < whole.size(); ++i) CHECK(whole[i].first == whole[i - 1].last);
  for (const trees::Window& w : whole)
    CHECK(r[0].time_s[w.last] - r[0].time_s[w.first] == Approx(0.3).epsilon(0.02));
  CHECK(trees::windows_of(m, r, 0.3, 4).size() == 4);
  // A second is missing after 1 s.
  for (std::size_t k = 0; k < r[0].rows(); ++k)
    if (r[0].time_s[k] > 1.0) r[0].time_s[k] += 1.0;
  for (const trees::Window& w : trees::windows_of(m, r, 0.3))
    CHECK(r[0].time_s[w.last] - r[0].time_s[w.first] < 0.31);
  CHECK(trees::windows_of(m, r, 10.0).empty());
  const std::vector<trees::Recording> none;
  CHECK_THAT(test::error_message([&] { trees::Problem(m, none, {}, 1); }),
             Contains("long enough for a window"));
}

TEST_CASE("Starts that are hardly known spoil no fit, though the motion is no linear function of them") {
  const trees::TreeModel truth = test::double_pendulum("[drive.elbow]\ndamping_nmspr = 0.08\n");
  const trees::TreeModel model = test::double_pendulum("[free]\n\"damping_nmspr.elbow\" = [0.0, 1.0]\n");
  const auto all = recordings(model, test::logs(truth, 3, 6.0, 10));
  std::vector<trees::Window> windows = trees::windows_of(model, all, 0.3, 60);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  constexpr double kOff_radps = 6.0;
  for (trees::Window& w : windows)
    for (std::size_t j = 0; j < 2; ++j) {
      w.velocity_radps[j] += kOff_radps * normal(random);
      w.start_precision(static_cast<Eigen::Index>(2 + j)) = 1.0 / (kOff_radps * kOff_radps);
    }
  const auto fitted = [&](const std::vector<trees::Window>& of) {
    trees::Problem problem(model, all, of, 2);
    problem.weigh({model.drives, {}});
    trees::Fit fit = problem.fit({model.drives, {}}, 6);
    problem.weigh(fit.at);
    return problem.fit(fit.at, 6);
  };
  const trees::Fit good = fitted(trees::windows_of(model, all, 0.3, 60)), spoilt = fitted(windows);
  const double sd = std::sqrt(good.covariance(0, 0)), off = std::sqrt(spoilt.covariance(0, 0));
  INFO(good.at.drives[1].damping_nmspr << " +- " << sd << ", " << spoilt.at.drives[1].damping_nmspr << " +- "
                                       << off);
  CHECK(off < 1.5 * sd);
  CHECK(std::abs(spoilt.at.drives[1].damping_nmspr - good.at.drives[1].damping_nmspr) < 2.0 * sd);
  CHECK(std::abs(spoilt.at.drives[1].damping_nmspr - 0.08) < 3.0 * off);
}

TEST_CASE("A ripple's phase is told within half a turn of zero, from wherever its fit began") {
  constexpr double kPhase_rad = 1.9;
  const trees::TreeModel model = test::pendulum();
  trees::TreeModel truth = model;
  truth.causes.push_back({Effect::torque_ripple, {0}, {0.05, 6.0, kPhase_rad, 0}});
  const auto all = recordings(model, test::logs(truth, 3, 6.0, 11));
  trees::Problem problem(model, all, trees::windows_of(model, all, 0.3), 2);
  for (const double turns : {-1.0, 0.0, 1.0}) {
    CAPTURE(turns);
    const trees::Hypothesis from{
        model.drives,
        {{Effect::torque_ripple, {0}, {0.04, 6.0, kPhase_rad + turns * 2.0 * std::numbers::pi - 0.2, 0}}}};
    problem.weigh(from);
    const trees::Fit fit = problem.fit(from, 8);
    CHECK(fit.at.causes[0].values[0] == Approx(0.05).epsilon(0.1));
    CHECK(fit.at.causes[0].values[2] == Approx(kPhase_rad).margin(0.1));
  }
}

TEST_CASE("No delay of one drive is known better than the row in which it takes its commands") {
  const trees::TreeModel model = test::double_pendulum();
  trees::TreeModel truth = model;
  truth.causes.push_back({Effect::actuator_delay, {1}, {0.02, 0, 0, 0}});
  const auto all = recordings(model, test::logs(truth, 3, 6.0, 12));
  trees::Problem problem(model, all, trees::windows_of(model, all, 0.3), 2);
  const trees::Hypothesis from{model.drives, {{Effect::actuator_delay, {1}, {0.018, 0, 0, 0}}}};
  problem.weigh(from);
  const trees::Fit fit = problem.fit(from, 8);
  const auto found = std::find_if(fit.unknowns.begin(), fit.unknowns.end(),
                                  [](const trees::Unknown& u) { return u.of_cause; });
  const auto k = static_cast<std::size_t>(found - fit.unknowns.begin());
  const trees::Interval within = trees::interval_of(fit, k);
  CAPTURE(fit.at.causes[0].values[0], within.lower, within.upper, problem.interval_s());
  CHECK(within.lower < 0.02);
  CHECK(within.upper > 0.02);
  // Half a row to either side, each as likely.
  const double of_row = 1.96 * 0.5 * problem.interval_s() / std::sqrt(3.0);
  CHECK(0.5 * (within.upper - within.lower) > of_row);
  CHECK(0.5 * (within.upper - within.lower) < 1.3 * of_row);
  // That it is late at all the windows know as well as before.
  CHECK(std::sqrt(trees::variance_of(fit, k)) < 0.5 * of_row);
}

TEST_CASE(
    "Dry friction swallows what a drive answers to a push on a joint that it holds, in motion it gains nothing") {
  const trees::TreeModel model = test::arm3("[free]\n\"damping_nmspr.elbow\" = [0.0, 1.0]\n");
  trees::TreeModel rough = model;
  rough.causes.push_back({Effect::coulomb_friction, {2}, {0.2, 0, 0, 0}});
  trees::Scenario still = trees::default_scenario(model);
  still.duration_s = 5.0;
  for (trees::Path& path : still.paths) path = {trees::Path::Profile::hold, 0.3, 0.0, 1.0, 0.0};
  // Whether friction is better than none at all, and in motion.
  const auto gains = [&](const trees::TreeModel& truth) {
    std::vector<log::Log> logs = test::logs(truth, 3, 5.0, 5);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (unsigned seed : {31u, 32u}) {
      logs.push_back(trees::simulate(model, still, seed));
      // What pushes the elbow is met by the drive: neither moves it, the log has the drive's part alone.
      double pushed_nm = 0.0;
      for (double& torque_nm : logs.back().columns.at("torque_elbow_nm")) {
        pushed_nm += -0.02 * pushed_nm + 0.02 * normal(random);  // 0.1 N m, for 0.2 s
        torque_nm += pushed_nm;
      }
    }
    const auto all = recordings(model, logs);
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3), 2);
    const trees::Cause friction{Effect::coulomb_friction, {2}, {0.1, 0, 0, 0}};
    const trees::Hypothesis bare{model.drives, {}}, dry{model.drives, {friction}};
    problem.weigh(bare);
    problem.weigh(problem.fit(bare, 6).at);
    const trees::Fit without = problem.fit(bare, 6), with = problem.fit(dry, 8);
    const std::vector<bool> moves = trees::windows_in_motion(problem, friction);
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (problem.windows()[i].recording >= 3) CHECK_FALSE(moves[i]);
    CHECK(std::count(moves.begin(), moves.end(), true) > 10);
    return std::pair(with.loss < 0.8 * without.loss, trees::gains_in_motion(with, without, moves));
  };
  CHECK(gains(model) == std::pair(true, false));
  CHECK(gains(rough) == std::pair(true, true));
}

TEST_CASE("A fit finds where between rows inputs act") {
  const trees::TreeModel model = test::arm3("[drive]\ncontrol_mode = \"torque\"\n");
  const auto torque_nm = [](std::size_t j, double t) {
    return 0.8 * std::sin((5.0 + 2.0 * static_cast<double>(j)) * t) +
           0.3 * std::sin((31.0 - 4.0 * static_cast<double>(j)) * t);
  };
  // Rows of 10 ms of a motion with steps of 1 ms. The torque of a row's time is that of a continuous one; a command is held, and comes
  // 4 ms after its row.
  constexpr std::size_t kEvery = 10, kLate = 4;
  const auto late_rows = [&](bool held) {
    trees::Recording fine = test::inputs(model, 3.0, 1e-3, torque_nm), rows = fine;
    for (std::size_t j = 0; j < model.joints(); ++j)
      for (std::size_t k = 0; k < fine.rows(); ++k) {
        const std::size_t rows_told = (k + kEvery - kLate) / kEvery;
        fine.input[j][k] =
            torque_nm(j, held ? 0.01 * (static_cast<double>(rows_told) - 1.0) : fine.time_s[k] + 0.5e-3);
      }
    const std::vector<double> still(model.joints());
    std::vector<double> out(fine.rows() * model.joints());
    trees::run(trees::SetupMaker(model).make({model.drives, {}}), fine, 0, fine.rows() - 1, still, still,
               out);
    rows.time_s.clear();
    for (std::size_t j = 0; j < model.joints(); ++j) rows.angle_rad[j].clear(), rows.input[j].clear();
    for (std::size_t k = 0; k < fine.rows(); k += kEvery) {
      rows.time_s.push_back(fine.time_s[k]);
      for (std::size_t j = 0; j < model.joints(); ++j) {
        rows.angle_rad[j].push_back(out[k * model.joints() + j]);
        rows.input[j].push_back(torque_nm(j, fine.time_s[k]));
      }
    }
    rows.interval_s = 0.01;
    const std::vector<trees::Recording> all{rows};
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3), 1);
    trees::Fit fit;
    fit.at.drives = model.drives;
    for (int round = 0; round < 3; ++round) {
      problem.weigh(fit.at);
      fit = problem.fit(fit.at, 8);
    }
    return fit.at.inputs_late_rows;
  };
  CHECK(late_rows(false) == Approx(-0.5).margin(0.02));
  CHECK(late_rows(true) == Approx(0.4).margin(0.02));
}

TEST_CASE("A skew is known no better than when in a row inputs act, beside causes that the model has, too") {
  for (const bool given : {false, true}) {
    trees::TreeModel model = test::double_pendulum("[drive]\ncontrol_mode = \"torque\"\n");
    if (given) model.causes = {{Effect::coulomb_friction, {1}, {0.02, 0, 0, 0}}};
    const auto all = recordings(model, test::logs(model, 2, 3.0, 4));
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3), 2);
    trees::Hypothesis h{model.drives, model.causes};
    h.causes.push_back({Effect::time_skew, {0}, {1e-3, 0, 0, 0}});
    problem.weigh(h);
    const trees::Fit fit = problem.fit(h, 4);
    REQUIRE(fit.unknowns.size() == 1);
    CHECK(std::sqrt(fit.covariance(0, 0)) > problem.interval_s() / std::sqrt(12.0));
  }
}

TEST_CASE("A fit finds the damping that logs were made with, within its interval") {
  trees::TreeModel truth = test::double_pendulum("[drive.elbow]\ndamping_nmspr = 0.08\n");
  const trees::TreeModel model = test::double_pendulum(
      "[free]\n\"damping_nmspr.elbow\" = [0.0, 1.0]\n\"damping_nmspr.shoulder\" = [0.0, 1.0]\n");
  for (const unsigned seed : {10u, 20u, 30u}) {
    const auto all = recordings(model, test::logs(truth, 3, 6.0, seed));
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3, 60), 2);
    const trees::Hypothesis given{model.drives, {}};
    problem.weigh(given);
    trees::Fit fit = problem.fit(given, 6);
    problem.weigh(fit.at);
    fit = problem.fit(fit.at, 6);
    REQUIRE(fit.unknowns.size() == 3);
    CHECK(fit.unknowns[0].of_inputs);
    CHECK(std::abs(fit.at.inputs_late_rows) < 3.0 * std::sqrt(fit.covariance(0, 0)));
    for (std::size_t k = 1; k < 3; ++k) {
      const double right = truth.drives[fit.unknowns[k].joint].damping_nmspr,
                   found = trees::value_of(fit.at, fit.unknowns[k]);
      const double sd = std::sqrt(fit.covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
      INFO(seed << " " << model.robot.joints[fit.unknowns[k].joint].name << " " << found << " +- " << sd);
      CHECK(std::abs(found - right) < 3.0 * sd + 1e-4);
      CHECK(sd < 0.01);
      CHECK(fit.fold_value[k].size() == 3);
    }
    // A right model leaves what chance leaves: about one per residual.
    const double residuals = static_cast<double>(problem.windows().size()) *
                             static_cast<double>(problem.windows().front().measured.size());
    CHECK(fit.loss < 2.0 * residuals);
    CHECK(fit.loss > 0.5 * residuals);
  }
}

TEST_CASE("A cause that is there is far from none, one that is not is near") {
  trees::TreeModel truth = test::double_pendulum();
  const trees::TreeModel model = truth;
  truth.causes = {{Effect::coulomb_friction, {1}, {0.05, 0, 0, 0}}};
  for (const unsigned seed : {10u, 20u, 30u}) {
    const auto all = recordings(model, test::logs(truth, 3, 6.0, seed));
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3, 60), 2);
    const trees::Hypothesis both{model.drives,
                                 {{Effect::coulomb_friction, {1}, {0.04, 0, 0, 0}},
                                  {Effect::base_tilt, {0}, {0.001, 0.001, 0, 0}},
                                  {Effect::torque_saturation, {0}, {100.0, 0, 0, 0}}}};
    problem.weigh(both);
    trees::Fit fit = problem.fit(both, 6);
    problem.weigh(fit.at);
    fit = problem.fit(fit.at, 6);
    const trees::Away there = trees::away_from_none(model, fit, 0),
                      not_there = trees::away_from_none(model, fit, 1);
    INFO(seed << ": " << there.squares << ", " << not_there.squares);
    CHECK(there.parameters == 1);
    CHECK(there.squares > 100.0);
    CHECK(there.by_windows >= there.squares);
    // Of two numbers that are none chance makes more than 14 once in a thousand.
    CHECK(not_there.parameters == 2);
    CHECK(not_there.squares < 14.0);
    // A limit that is never reached has no value with which it would not be there.
    CHECK(trees::away_from_none(model, fit, 2).parameters == 0);
  }
}

TEST_CASE("An interval holds what the recordings do not tell") {
  const std::string free = "[free]\n\"damping_nmspr.elbow\" = [0.0, 1.0]\n";
  const auto fitted = [](const trees::TreeModel& model, const trees::TreeModel& truth,
                         const std::vector<trees::Cause>& causes) {
    const auto all = recordings(model, test::logs(truth, 3, 6.0, 7));
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3, 60), 2);
    const trees::Hypothesis given{model.drives, causes};
    problem.weigh(given);
    const trees::Fit fit = problem.fit(given, 6);
    problem.weigh(fit.at);
    return problem.fit(fit.at, 6);
  };
  SECTION("the centre of mass along a planar robot's axes: all that is possible") {
    const trees::TreeModel model = test::double_pendulum();
    std::size_t link = 0;  // the first that the last joint moves
    while (model.robot.links[link].joint != 1) ++link;
    const trees::Fit fit =
        fitted(model, model, {trees::Cause{Effect::com_error, {link}, {0.0, 0.0, 0.0, 0}}});
    REQUIRE(fit.unknowns.size() == 4);
    std::size_t all_of_it = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      const auto [lower, upper] = trees::interval_of(fit, k);
      all_of_it += lower == fit.unknowns[k].lower && upper == fit.unknowns[k].upper ? 1 : 0;
      CHECK(lower - (upper - lower) <= 0.0);
      CHECK(upper + (upper - lower) >= 0.0);
    }
    CHECK(all_of_it == 1);
  }
  SECTION("a value at its bound: what lies inside of it") {
    const trees::TreeModel model = test::double_pendulum(free);
    trees::TreeModel truth = model;
    truth.drives[1].damping_nmspr = 0.0;
    truth.causes = {{Effect::force_offset, {1}, {0.05, 0, 0, 0}}};
    const trees::Fit fit = fitted(model, truth, {{Effect::coulomb_friction, {1}, {0.0, 0, 0, 0}}});
    for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
      if (fit.unknowns[k].of_inputs) continue;
      const auto [lower, upper] = trees::interval_of(fit, k);
      INFO(k << ": " << trees::value_of(fit.at, fit.unknowns[k]) << " in " << lower << " to " << upper);
      CHECK(lower <= 0.0);
      CHECK(upper > trees::value_of(fit.at, fit.unknowns[k]));
      CHECK(upper < 0.2);
    }
  }
  SECTION("a drive's damping beside the joint's: each from none to all of both") {
    const std::string drive =
        "[drive.elbow]\ncontrol_mode = \"position\"\nkp_nmprad = 8.0\nkd_nmsprad = 0.30\ndamping_nmspr = 0.10\n";
    const trees::TreeModel model = test::double_pendulum(drive + free);
    trees::TreeModel truth = model;
    truth.drives[1].kd_nmsprad = 0.36;
    const trees::Fit fit = fitted(model, truth, {{Effect::position_gain_error, {1}, {8.0, 0.3, 0, 0}}});
    REQUIRE(fit.unknowns.size() == 4);
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const trees::Unknown& u = fit.unknowns[k];
      if (u.of_inputs) continue;
      const auto [lower, upper] = trees::interval_of(fit, k);
      const bool stiffness = u.of_cause && u.parameter == 0;
      const double right = stiffness ? 8.0 : u.of_cause ? 0.36 : 0.1;
      INFO(k << ": " << trees::value_of(fit.at, u) << " in " << lower << " to " << upper);
      CHECK(lower <= right);
      CHECK(upper >= right);
      if (stiffness) {
        CHECK(upper - lower < 1.0);
        continue;
      }
      sum += trees::value_of(fit.at, u);
      CHECK(lower == Approx(0.0).margin(0.02));
      CHECK(upper == Approx(0.46).margin(0.03));
    }
    CHECK(sum == Approx(0.46).margin(0.01));
  }
}

TEST_CASE("A fit is the same on one thread and on two") {
  const trees::TreeModel model = test::double_pendulum("[free]\n\"damping_nmspr.elbow\" = [0.0, 1.0]\n");
  const auto all = recordings(model, test::logs(model, 2, 3.0, 1));
  std::vector<double> loss, value;
  for (const unsigned threads : {1u, 2u}) {
    trees::Problem problem(model, all, trees::windows_of(model, all, 0.3), threads);
    const trees::Hypothesis given{model.drives, {{Effect::coulomb_friction, {1}, {0.01, 0, 0, 0}}}};
    problem.weigh(given);
    const trees::Fit fit = problem.fit(given, 4);
    loss.push_back(fit.loss);
    value.push_back(fit.at.causes[0].values[0]);
  }
  CHECK(loss[0] == loss[1]);
  CHECK(value[0] == value[1]);
}

TEST_CASE("What the model lacks of a constant torque is that torque") {
  trees::TreeModel truth = test::double_pendulum();
  truth.causes = {{Effect::force_offset, {1}, {0.12, 0, 0, 0}}};
  const trees::TreeModel model = test::double_pendulum();
  const auto all = recordings(model, test::logs(truth, 3, 6.0, 5));
  trees::Problem problem(model, all, trees::windows_of(model, all, 0.3, 60), 2);
  const auto mean = [](const std::vector<double>& x) {
    double sum = 0.0;
    for (const double v : x) sum += v / static_cast<double>(x.size());
    return sum;
  };
  const auto lacking = trees::missing_torque(problem, all, {model.drives, {}}, 0.3);
  REQUIRE(lacking.size() == 2);
  REQUIRE(lacking[1].missing_nm.size() > 300);
  CHECK(mean(lacking[1].missing_nm) == Approx(0.12).margin(0.012));
  CHECK(std::abs(mean(lacking[0].missing_nm)) < 0.03);
  // A constant alone predicts its own square's share of the mean square; the rest is noise.
  double square = 0.0;
  for (const double x : lacking[1].missing_nm)
    square += x * x / static_cast<double>(lacking[1].missing_nm.size());
  CHECK(trees::predictable_share(lacking[1], 1, all.size()) == Approx(0.12 * 0.12 / square).epsilon(0.15));
  const auto with = trees::missing_torque(problem, all, {model.drives, truth.causes}, 0.3);
  CHECK(std::abs(mean(with[1].missing_nm)) < 0.012);
  CHECK(trees::predictable_share(with[1], 1, all.size()) < 0.1);
}

TEST_CASE("A torque that goes with the velocity is named so") {
  trees::TreeModel truth = test::double_pendulum();
  truth.causes = {{Effect::damping_error, {1}, {0.2, 0, 0, 0}}};
  const trees::TreeModel model = test::double_pendulum();
  const auto all = recordings(model, test::logs(truth, 3, 6.0, 8));
  trees::Problem problem(model, all, trees::windows_of(model, all, 0.3, 60), 2);
  const auto lacking = trees::missing_torque(problem, all, {model.drives, {}}, 0.3);
  CHECK_THAT(trees::correlated_with(lacking[1], 1, all.size(), model), Contains("velocity of elbow"));
}

TEST_CASE("What lasts of a missing torque is told from its noise") {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  // A sine and white noise, some 20 s; the noise of one sample is not in those 40 ms on and later.
  const auto lasting = [&](double sine_nm, double noise_nm, double hz = 0.5) {
    trees::TorqueSamples s;
    s.half_s = 0.02;
    for (int k = 0; k < 2500; ++k) {
      s.recording.push_back(0);
      s.time_s.push_back(0.008 * k);
      s.missing_nm.push_back(sine_nm * std::sin(2.0 * M_PI * hz * s.time_s.back()) +
                             noise_nm * normal(random));
    }
    return trees::persistent_nm(s);
  };
  const double rms_nm = 0.3 / std::sqrt(2.0) * std::sqrt(std::cos(M_PI * 0.05));
  CHECK(lasting(0.3, 0.0) == Approx(rms_nm).epsilon(0.15));
  CHECK(lasting(0.3, 0.3) == Approx(rms_nm).epsilon(0.2));
  // 50 ms on, one of 5 Hz is a quarter of a period further: it is seen by what it does later.
  CHECK(lasting(0.3, 0.0, 5.0) == Approx(0.3 / std::sqrt(2.0)).epsilon(0.05));
  CHECK(lasting(0.3, 0.3, 5.0) == Approx(0.3 / std::sqrt(2.0)).epsilon(0.2));
  CHECK(lasting(0.0, 1.0) < 0.1);
  CHECK(lasting(0.0, 0.0) == 0.0);
}

TEST_CASE("What moves a robot as a cause does stands in its place") {
  // Of one joint, the rotor's inertia and the link's about the axis are one law; friction is another.
  const trees::TreeModel model = test::pendulum("[drive]\nrotor_inertia_kgm2 = 0.01\n");
  const std::vector<trees::Recording> all = recordings(model, test::logs(model, 2, 5.0, 60));
  trees::Problem problem(model, all, trees::windows_of(model, all, 0.3, 40), 2);
  const trees::Hypothesis none{model.drives, {}},
      rotor{model.drives, {{Effect::rotor_inertia_error, {0}, {0.015, 0, 0, 0}}}};
  problem.weigh(rotor);
  const trees::ScoreTest test(problem, rotor, {}, trees::candidates(problem, rotor, {}), {none});
  double link = 0.0, friction = 0.0;
  for (const trees::ScoreTest::Score& s : test.in_place_of(0, {}, 0.0)) {
    const Effect e = test.candidates()[s.candidate].effect;
    if (e == Effect::inertia_error) link = std::max(link, s.gain);
    if (e == Effect::coulomb_friction) friction = std::max(friction, s.gain);
  }
  CHECK(link > 0.999);
  CHECK(friction < 0.5);
}
