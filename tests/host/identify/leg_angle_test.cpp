// The leg angle as a channel: when it is believed, what a prediction says of it, and its derivatives.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/identify/prediction.hpp"
#include "host/identify/simulation_fit.hpp"
#include "host/machines/hopper.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Effect;
using identify::Channel;
using identify::Recording;
using identify::Window;

namespace {

constexpr std::size_t kRows = 600;

/// z = 2 L cos(theta) in stance, the stop in flight; L = 0.15 m, 20 degrees.
double angle_at(double height) {
  const double stop = 20.0 * std::numbers::pi / 180.0;
  return height < 0.3 * std::cos(stop) ? std::acos(height / 0.3) : stop;
}

/// A stride that the model itself runs, driven with 1.5 N m over the stance; its leg angle by geometry, as an
/// encoder on the leg would tell it.
Recording stride(const model::Model& model) {
  Recording r;
  r.name = "stride.csv";
  r.kind = model.kind;
  for (std::size_t i = 0; i < kRows; ++i) {
    r.time_s.push_back(1e-3 * static_cast<double>(i));
    r.input.push_back(i > 100 && i < 350
                          ? 1.5 * std::sin(2.0 * std::numbers::pi * static_cast<double>(i - 100) / 300.0)
                          : 0.0);
    r.impulse.push_back(i == 0 ? 0.0 : r.impulse.back() + 1e-3 * r.input[i - 1]);
    r.driven_s.push_back(0.0);
  }
  r.position =
      identify::predict(model, r, {0, 0, kRows - 1, identify::WindowKind::stride}, {0.34, 0.0}).position;
  for (double z : r.position) r.leg_angle.push_back(angle_at(z));
  r.velocity = r.velocity_smoothed = std::vector<double>(kRows, 0.0);
  r.position_noise = 4e-5;
  r.leg_angle_noise = 2e-3;
  return r;
}

const Window kStride{0, 0, kRows - 1, identify::WindowKind::stride};

identify::ChannelErrors errors_of(const model::Model& model, const Recording& r, double start_height) {
  const auto errors = identify::leg_angle_errors(model, {r}, {kStride}, {{start_height, 0.0}});
  REQUIRE(errors.has_value());
  return *errors;
}

/// Hops of the simulator, with a backlash.
std::vector<Recording> hops() {
  auto model = test::hopper_model();
  model.effects[Effect::backlash] = {0.05};
  sim::Scenario scenario = sim::default_scenario(model);
  scenario.duration_s = 2.5;
  auto log = sim::simulate(model, scenario, 3);
  log.path = "hops.csv";
  auto all = identify::make_recordings({log}, model.kind);
  all[0].position_noise = 1e-3;  // so that the leg's angle has a say
  return all;
}

}  // namespace

TEST_CASE("A leg angle's errors are those about the window's mean, in closed form") {
  const auto model = test::hopper_model();
  Recording r = stride(model);
  double mean = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < kRows; ++i) r.leg_angle[i] += 0.2 + (i % 3 == 0 ? 0.02 : -0.01);
  for (double a : r.leg_angle) mean += a / kRows;
  for (double a : r.leg_angle) spread += (a - mean) * (a - mean);
  const auto e = errors_of(model, r, 0.34);
  CHECK(e.mae == Approx((0.02 + 2 * 0.01) / 3));
  CHECK(e.rmse == Approx(std::sqrt((4e-4 + 2 * 1e-4) / 3)));
  CHECK(e.nmse == Approx(kRows * 2e-4 / spread));
}

TEST_CASE("Without the column there are no errors of the leg angle") {
  Recording r = stride(test::hopper_model());
  r.leg_angle.clear();
  CHECK_FALSE(identify::leg_angle_errors(test::hopper_model(), {r}, {kStride}, {{0.34, 0.0}}).has_value());
}

TEST_CASE("What is wrong with the height alone leaves the leg angle as it is") {
  const auto model = test::hopper_model();
  const double top = machines::touchdown_height_m(model);
  const Recording truth = stride(model);
  for (const auto& [effect, value] : {std::pair{Effect::height_scale_error, 1.04},
                                      {Effect::encoder_offset, 0.004},
                                      {Effect::time_skew, 0.007}}) {
    Recording r = truth;
    // What the height's encoder makes of it; seven rows late with the skew, so that it begins in free fall.
    for (std::size_t i = 0; i < kRows; ++i)
      r.position[i] = effect == Effect::height_scale_error ? top + 1.04 * (truth.position[i] - top)
                      : effect == Effect::encoder_offset   ? truth.position[i] + 0.004
                      : i < 7                              ? truth.position[0]
                                                           : truth.position[i - 7];
    auto extended = model;
    extended.effects[effect] = {value};
    const Window w{0, 7, kRows - 1, identify::WindowKind::stride};
    const double before = truth.position[effect == Effect::time_skew ? 0 : 7];
    const double start = effect == Effect::time_skew ? before : r.position[7];
    const double scale = effect == Effect::height_scale_error ? 1.04 : 1.0;
    const double speed = effect == Effect::time_skew ? 0.0 : -9.81 * 0.007 * scale;  // drag: below 1e-4 of it
    CAPTURE(dynamics::info(effect).name);
    const auto with = identify::leg_angle_errors(extended, {r}, {w}, {{start, speed}});
    const auto without = identify::leg_angle_errors(model, {r}, {w}, {{start, speed}});
    REQUIRE((with && without));
    CHECK(with->rmse < 5e-4);
    CHECK(without->rmse > 5e-3);
  }
}

TEST_CASE(
    "A leg angle that does not follow the height is left out, one with a backlash or another zero is not") {
  const auto model = test::hopper_model();
  const auto believed = [&](const auto& reading) {
    std::vector<Recording> all{stride(model)};
    for (std::size_t i = 0; i < kRows; ++i) all[0].leg_angle[i] = reading(all[0].leg_angle[i], i);
    identify::keep_plausible_leg_angles(all, model);
    return !all[0].leg_angle.empty();
  };
  CHECK(believed([](double a, std::size_t) { return a; }));
  CHECK(believed([](double a, std::size_t) { return a + 0.1; }));
  CHECK(believed([](double a, std::size_t i) { return a + (i < 220 ? 0.05 : -0.05); }));
  CHECK(believed([](double a, std::size_t) { return std::round(a / 3.8e-4) * 3.8e-4; }));
  CHECK_FALSE(believed([](double, std::size_t) { return 0.0; }));
  CHECK_FALSE(believed([](double a, std::size_t) { return -a; }));
  CHECK_FALSE(believed([](double a, std::size_t) { return a * 180.0 / std::numbers::pi; }));
  CHECK_FALSE(believed([](double a, std::size_t) { return std::min(a, 0.5); }));
  CHECK_FALSE(believed([](double a, std::size_t) { return std::max(a, 0.5); }));
  CHECK_FALSE(
      believed([](double, std::size_t i) { return 0.4 + 0.1 * std::sin(0.9 * static_cast<double>(i)); }));
}

TEST_CASE("A column that does not move is no leg angle") {
  auto log = sim::simulate(test::hopper_model(), sim::default_scenario(test::hopper_model()), 1);
  log.path = "hops.csv";
  CHECK(identify::make_recording(log, dynamics::Kind::hopper_linear).leg_angle == log.at("leg_angle_rad"));
  for (double stuck : {0.0, 0.349}) {
    for (double& a : log.columns["leg_angle_rad"]) a = stuck;
    CHECK(identify::make_recording(log, dynamics::Kind::hopper_linear).leg_angle.empty());
  }
}

TEST_CASE("The squares of a fit with leg angles have the gradient that finite differences give") {
  const auto recordings = hops();
  const auto model = test::hopper_model();
  const auto windows = identify::prediction_windows(recordings, model, 0.5);
  REQUIRE(windows.size() >= 3);
  struct Case {
    Effect effect;
    double at, width;
  };
  for (const Case& c :
       {Case{Effect::backlash, 0.043, 1e-5}, Case{Effect::stiffness_error, 612.0, 1e-2},
        Case{Effect::height_scale_error, 1.01, 1e-5}, Case{Effect::time_skew, 0.0013, 1e-6}}) {
    CAPTURE(dynamics::info(c.effect).name);
    const auto unknowns = identify::effect_unknowns(c.effect, model.kind);
    const auto look = [&](double value, bool leg) {
      auto seen = recordings;
      if (!leg) seen[0].leg_angle.clear();
      return identify::fit_by_simulation(with_values(model, unknowns, {value}), {}, {}, seen, windows);
    };
    const auto at = identify::look_by_simulation(model, unknowns, {c.at}, recordings, windows);
    double gradient = 0.0, leg = 0.0;
    for (const auto& share : at.shares) {
      gradient += share.gradient(0);
      leg += share[Channel::leg].squares;
    }
    CHECK(leg > 1.0);
    // Half the derivative of the squares with each start at its best.
    const double difference =
        (look(c.at + c.width, true).squares - look(c.at - c.width, true).squares) / (4.0 * c.width);
    CHECK(gradient == Approx(difference).epsilon(0.01));
    // And without the leg angles it is another one.
    const double other =
        (look(c.at + c.width, false).squares - look(c.at - c.width, false).squares) / (4.0 * c.width);
    CHECK(gradient != Approx(other).epsilon(0.01));
  }
}

TEST_CASE("By a linear step the start states come to where running the windows again brings them") {
  const auto recordings = hops();
  const auto model = test::hopper_model();
  const auto windows = identify::prediction_windows(recordings, model, 0.5);
  const auto unknowns = identify::effect_unknowns(Effect::stiffness_error, model.kind);
  const auto look = [&](identify::Starting starting) {
    return identify::look_by_simulation(model, unknowns, {612.0}, recordings, windows, starting);
  };
  const auto best = look(identify::Starting::at_optimum), linear = look(identify::Starting::linear);
  REQUIRE(best.shares.size() == linear.shares.size());
  for (std::size_t i = 0; i < best.shares.size(); ++i) {
    CHECK(linear.shares[i].squares == Approx(best.shares[i].squares).epsilon(0.02));
    CHECK(linear.shares[i].gradient(0) == Approx(best.shares[i].gradient(0)).epsilon(0.05));
  }
}
