// Evidence and its threshold, cross-validation and standing out against tables, closed forms and refitting by hand.
#include "host/diagnose/hypothesis.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using diagnose::Hypothesis;
using dynamics::Effect;
using identify::Channel;

namespace {

/// Of one channel: so many squares on so many independent rows.
identify::Fit left(Channel channel, double squares, double rows) {
  identify::Fit fit;
  identify::WindowShare share;
  share.channels[static_cast<std::size_t>(channel)] = {squares, rows, rows};
  fit.shares.push_back(share);
  return fit;
}

/// An axis with an effect, its parameters at these values with this covariance.
Hypothesis with_effect(Effect e, const std::vector<double>& values, const Eigen::MatrixXd& covariance) {
  Hypothesis h;
  h.effects = {e};
  h.unknowns = identify::effect_unknowns(e, dynamics::Kind::motor_axis);
  h.fit.values = values;
  h.fit.at_bound.assign(values.size(), false);
  h.fit.covariance = covariance;
  return h;
}

/// Least squares of a line through points, each a window of its own, and its recording.
struct Line {
  std::vector<double> x, y;
  std::vector<identify::Window> windows;

  std::array<double, 2> without(const std::vector<bool>& excluded) const {
    double n = 0.0, sx = 0.0, sxx = 0.0, sy = 0.0, sxy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (excluded[i]) continue;
      n += 1.0, sx += x[i], sxx += x[i] * x[i], sy += y[i], sxy += x[i] * y[i];
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    return {(sy - slope * sx) / n, slope};
  }
  identify::Fit fit() const {
    identify::Fit f;
    const auto [offset, slope] = without(std::vector<bool>(x.size(), false));
    f.values = {offset, slope};
    f.at_bound = {false, false};
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Eigen::Vector2d row(1.0, x[i]);
      const double residual = offset + slope * x[i] - y[i];
      identify::WindowShare s;
      s.squares = residual * residual;
      s.gradient = row * residual;
      s.information = row * row.transpose();
      f.squares += s.squares;
      f.shares.push_back(s);
    }
    return f;
  }
};

Line scattered_line(std::size_t count, std::size_t recordings) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  Line line;
  for (std::size_t i = 0; i < count; ++i) {
    line.x.push_back(std::sqrt(static_cast<double>(i)));
    line.y.push_back(1.0 + 2.0 * line.x.back() + noise(random));
    identify::Window w;
    w.recording = i % recordings;
    line.windows.push_back(w);
  }
  return line;
}

}  // namespace

TEST_CASE("The evidence threshold is the chi-square's at a two-hundredth over the number of tries") {
  // Tables: 7.879 (1 degree), 10.597 (2), 12.838 (3), 25.188 (10) at 0.005; 12.116 at 0.0005.
  CHECK(diagnose::chi_square_point(1.0, 1.0) == Approx(7.8794).epsilon(1e-5));
  CHECK(diagnose::chi_square_point(1.0, 2.0) == Approx(10.5966).epsilon(1e-5));
  CHECK(diagnose::chi_square_point(1.0, 3.0) == Approx(12.8382).epsilon(1e-5));
  CHECK(diagnose::chi_square_point(1.0, 10.0) == Approx(25.1882).epsilon(1e-5));
  CHECK(diagnose::chi_square_point(10.0, 1.0) == Approx(12.1157).epsilon(1e-5));
  CHECK(diagnose::chi_square_point(50.0, 3.0) == Approx(21.1075).epsilon(1e-5));
  CHECK(diagnose::chi_square_point(0.0, 0.0) == diagnose::chi_square_point(1.0, 1.0));
}

TEST_CASE("Chance passes the evidence threshold about once in two hundred, not more and not much less") {
  // A mean that is not there: n log(S0/S1) of white noise, n = 400.
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise;
  constexpr int kRuns = 20000, kRows = 400;
  int passed = 0;
  for (int run = 0; run < kRuns; ++run) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kRows; ++i) {
      const double v = noise(random);
      sum += v;
      squares += v * v;
    }
    const double evidence = diagnose::evidence_of(
        left(Channel::motion, squares, kRows), left(Channel::motion, squares - sum * sum / kRows, kRows),
        left(Channel::motion, squares - sum * sum / kRows, kRows), 1);
    passed += evidence > diagnose::chi_square_point(1.0, 1.0) ? 1 : 0;
  }
  CHECK(passed > 70);  // 100 expected, three deviations of a binomial
  CHECK(passed < 130);
}

TEST_CASE(
    "Evidence is rows times the logarithm of the squares, channel by channel, rows in layers counted once") {
  const auto smaller = left(Channel::motion, 200.0, 50.0), larger = left(Channel::motion, 100.0, 40.0);
  CHECK(diagnose::evidence_of(smaller, larger, larger, 1) == Approx(40.0 * std::log(2.0)).epsilon(1e-12));
  CHECK(diagnose::evidence_of(smaller, larger, larger, 4) == Approx(10.0 * std::log(2.0)).epsilon(1e-12));
  // What the drive's errors are below its resolution, they are by chance: its rows are added to both.
  const auto one = left(Channel::drive, 60.0, 30.0), other = left(Channel::drive, 30.0, 30.0);
  CHECK(diagnose::evidence_of(one, other, other, 1) == Approx(30.0 * std::log(90.0 / 60.0)).epsilon(1e-12));
  const auto few = left(Channel::motion, 1.0, 1.5);  // fewer than two rows say nothing
  CHECK(diagnose::evidence_of(smaller, few, few, 1) == 0.0);
}

TEST_CASE("Cross-validation predicts each fold with the fit that has not seen it") {
  for (const std::size_t recordings : {1, 7}) {
    const Line line = scattered_line(23, recordings);
    double squares = 0.0;
    for (std::size_t fold = 0; fold < 5; ++fold) {
      std::vector<bool> out(23);
      for (std::size_t i = 0; i < 23; ++i)
        out[i] = (recordings == 1 ? i * 5 / 23 : line.windows[i].recording % 5) == fold;
      const auto [offset, slope] = line.without(out);
      for (std::size_t i = 0; i < 23; ++i)
        if (out[i]) squares += std::pow(offset + slope * line.x[i] - line.y[i], 2);
    }
    CAPTURE(recordings);
    CHECK(diagnose::cross_validate(line.fit(), line.windows, recordings) == Approx(squares).epsilon(1e-9));
  }
  // One point a fold: the sum of (residual / (1 - leverage))^2.
  const Line five = scattered_line(5, 1);
  double mean = 0.0, about = 0.0, press = 0.0;
  for (double x : five.x) mean += x / 5.0;
  for (double x : five.x) about += (x - mean) * (x - mean);
  const auto fit = five.fit();
  for (std::size_t i = 0; i < 5; ++i) {
    const double leverage = 0.2 + (five.x[i] - mean) * (five.x[i] - mean) / about;
    press += fit.shares[i].squares / ((1.0 - leverage) * (1.0 - leverage));
  }
  CHECK(diagnose::cross_validate(fit, five.windows, 1) == Approx(press).epsilon(1e-9));
  auto held = fit;
  held.at_bound = {true, true};
  CHECK(diagnose::cross_validate(held, five.windows, 1) == Approx(fit.squares).epsilon(1e-12));
}

TEST_CASE("Pulls that scatter as independent residuals would are not overdispersed, repeated ones are") {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise;
  // A mean of `rows` residuals in each of 400 units, each residual said so often.
  const auto ratio = [&](int rows, int said, double of_another = 0.0) {
    identify::Fit fit;
    fit.values = {0.0};
    fit.at_bound = {false};
    std::vector<std::vector<std::size_t>> units;
    for (std::size_t u = 0; u < 400; ++u) {
      identify::WindowShare s;
      s.gradient = Eigen::VectorXd::Zero(1);
      s.information = Eigen::MatrixXd::Constant(1, 1, rows * said);
      double squares = 0.0;
      for (int i = 0; i < rows; ++i) {
        const double r = noise(random);
        s.gradient(0) += said * r;
        squares += said * r * r;
      }
      const double count = rows * said;
      s.channels[0] = {squares, count, count};
      if (of_another > 0.0) {  // of which the parameter knows nothing
        s.channels[1] = {of_another, 1000.0, 1000.0};
        s.information_of = {s.information, Eigen::MatrixXd::Zero(1, 1), Eigen::MatrixXd::Zero(1, 1),
                            Eigen::MatrixXd::Zero(1, 1)};
      }
      fit.shares.push_back(s);
      units.push_back({u});
    }
    return diagnose::overdispersion(fit, units);
  };
  CHECK(ratio(20, 1) == Approx(1.0).margin(0.25));  // of 400 units: a deviation of sqrt(2 / 400)
  CHECK(ratio(20, 5) == Approx(5.0).margin(1.3));
  // Another channel changes nothing: neither white noise of a thousand rows nor what is wrong there for good.
  CHECK(ratio(20, 1, 0.1) == Approx(1.0).margin(0.25));
  CHECK(ratio(20, 5, 1e9) == Approx(5.0).margin(1.3));
}

TEST_CASE("An effect stands out from where its size is further from none than chance and the tries allow") {
  const auto model = test::axis_model(95.0, 200.0);
  // One parameter, 0.01 N of scatter: with ten tries from sqrt(12.1157) = 3.4808 deviations on.
  REQUIRE(dynamics::info(Effect::coulomb_friction).search.shapes == 1.0);
  const auto one = [&](double deviations) {
    const auto h =
        with_effect(Effect::coulomb_friction, {0.01 * deviations}, Eigen::MatrixXd::Constant(1, 1, 1e-4));
    return diagnose::stands_out(h, model, Effect::coulomb_friction, 10.0);
  };
  CHECK_FALSE(one(3.47));
  CHECK(one(3.49));
  CHECK(one(-3.49));
  // Two that are correlated by 0.8: (a^2 - 1.6 a b + b^2) / 0.36 deviations, against 15.2018 with ten tries. Apart from each other they
  // are further from none than together.
  REQUIRE(dynamics::info(Effect::asymmetric_friction).search.shapes == 1.0);
  Eigen::Matrix2d covariance;
  covariance << 1e-4, 1.6e-4, 1.6e-4, 4e-4;
  const auto two = [&](double a, double b) {
    const auto h = with_effect(Effect::asymmetric_friction, {0.01 * a, 0.02 * b}, covariance);
    return diagnose::stands_out(h, model, Effect::asymmetric_friction, 10.0);
  };
  CHECK_FALSE(two(3.6, 3.6));   // 14.4
  CHECK(two(3.8, 3.8));         // 16.0
  CHECK_FALSE(two(1.2, -1.2));  // 14.4
  CHECK(two(1.25, -1.25));      // 15.6
}

TEST_CASE(
    "There may be none of an effect where its interval says so, of one with two sizes where both together do") {
  const auto model = test::axis_model(95.0, 200.0);
  // 400 windows that tell each value alike: Student's t is 1.966.
  const auto may_be_none = [&](Effect e, const std::vector<double>& values,
                               const Eigen::MatrixXd& covariance) {
    Hypothesis h = with_effect(e, values, covariance);
    const auto n = static_cast<Eigen::Index>(values.size());
    identify::WindowShare share;
    share.gradient = Eigen::VectorXd::Zero(n);
    share.information = Eigen::MatrixXd::Identity(n, n);
    h.fit.shares.assign(400, share);
    return diagnose::may_be_none(h, model, e);
  };
  const auto one = [&](double deviations) {
    return may_be_none(Effect::coulomb_friction, {0.01 * deviations}, Eigen::MatrixXd::Constant(1, 1, 1e-4));
  };
  CHECK(one(1.95));
  CHECK_FALSE(one(1.98));
  // Correlated by 0.8, each 1.5 deviations from none: together 2.5 where they are so the same way, 22.5 the other; 5.99 is the point.
  Eigen::Matrix2d covariance;
  covariance << 1e-4, 1.6e-4, 1.6e-4, 4e-4;
  const auto two = [&](double a, double b) {
    return may_be_none(Effect::asymmetric_friction, {0.01 * a, 0.02 * b}, covariance);
  };
  CHECK(two(1.5, 1.5));
  CHECK_FALSE(two(1.5, -1.5));
  CHECK_FALSE(two(2.2, 1.5));
}

TEST_CASE("A drive that lags and clocks that are apart by as much the other way are neither of them meant") {
  // To first order in both, what is left of the input's shift is their sum.
  const auto meant = [](double lag_s, double skew_s) {
    Hypothesis h;
    h.effects = {Effect::actuator_lag, Effect::time_skew};
    h.fitted = test::axis_model(95.0, 200.0);
    h.fitted.effects[Effect::actuator_lag] = {lag_s};
    h.fitted.effects[Effect::time_skew] = {skew_s};
    return diagnose::within_limits(h);
  };
  CHECK_FALSE(meant(0.0345, -0.0343));
  CHECK_FALSE(meant(0.0135, -0.0145));
  CHECK(meant(0.012, -0.002));
  CHECK(meant(0.002, -0.012));
  CHECK(meant(0.01, 0.01));
}

TEST_CASE("Folds of windows that overlap share no rows with what their estimate has seen") {
  // The mean of ten numbers, in windows of twenty rows that begin ten rows apart; of five folds the first is the first two.
  identify::Fit fit;
  fit.values = {0.0};
  fit.at_bound = {false};
  std::vector<identify::Window> windows;
  const std::vector<double> y{1.0, -2.0, 0.5, 3.0, -1.0, 2.0, -0.5, 0.0, 1.5, -4.5};
  for (std::size_t i = 0; i < y.size(); ++i) {
    identify::WindowShare s;
    s.squares = y[i] * y[i];
    s.gradient = Eigen::VectorXd::Constant(1, -y[i]);
    s.information = Eigen::MatrixXd::Constant(1, 1, 1.0);
    fit.shares.push_back(s);
    identify::Window w;
    w.first = 10 * i;
    w.last = 10 * i + 20;
    windows.push_back(w);
  }
  const auto crossing = diagnose::crossing_of(fit, windows, 1);
  // The third window shares rows 20 to 30 with the second: the mean of the other seven.
  CHECK(crossing.step[0](0) == Approx((3.0 - 1.0 + 2.0 - 0.5 + 0.0 + 1.5 - 4.5) / 7.0));
  // In the middle one more on either side.
  CHECK(crossing.step[2](0) == Approx((1.0 - 2.0 + 0.5 + 0.0 + 1.5 - 4.5) / 6.0));
}

TEST_CASE("A set leaves more where it does in one channel, whatever the others leave") {
  const auto with = [](double motion, double drive) {
    Hypothesis h;
    identify::WindowShare share;
    share.channels[static_cast<std::size_t>(Channel::motion)] = {motion, 100.0, 100.0};
    share.channels[static_cast<std::size_t>(Channel::drive)] = {drive, 100.0, 100.0};
    h.fit.shares.push_back(share);
    h.cross_validated_squares = motion + drive;
    return h;
  };
  // A drive whose current sensor is wrong hides nothing of the motion.
  CHECK(diagnose::squares_of_body(with(300.0, 7000.0)) == Approx(300.0));
  CHECK(diagnose::leaves_more(with(110.0, 7000.0), with(100.0, 7000.0), 0.04));
  CHECK_FALSE(diagnose::leaves_more(with(102.0, 7000.0), with(100.0, 7000.0), 0.04));
  CHECK(diagnose::leaves_more(with(100.0, 7400.0), with(100.0, 7000.0), 0.04));
  // Below a step of the drive's loop a part is by chance.
  CHECK_FALSE(diagnose::leaves_more(with(100.0, 3.0), with(100.0, 1.0), 0.04));
}
