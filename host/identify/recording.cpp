#include "host/identify/recording.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/log/error.hpp"

namespace furcula::identify {
namespace {

constexpr std::size_t kFewestRows = 20;
constexpr double kSlopeHalfWidth_s = 0.006;

/// Slope of the position by a local parabola over +-6 ms (at least two rows on either side): no delay. Where
/// there is a contact flag, over the rows alone that have the same one: an impact has no slope.
std::vector<double> smoothed_slope(const std::vector<double>& time_s, const std::vector<double>& position,
                                   const std::vector<double>& contact) {
  const std::size_t n = time_s.size();
  std::vector<double> slope(n);
  std::size_t first = 0, last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    while (time_s[first] < time_s[i] - kSlopeHalfWidth_s) ++first;
    while (last + 1 < n && time_s[last + 1] <= time_s[i] + kSlopeHalfWidth_s) ++last;
    std::size_t from = std::min(first, i >= 2 ? i - 2 : 0);
    std::size_t to = std::min(n - 1, std::max(last, i + 2));
    if (!contact.empty()) {
      const auto same = [&](std::size_t k) { return contact[k] == contact[i]; };
      std::size_t low = i, high = i;
      while (low > from && same(low - 1)) --low;
      while (high < to && same(high + 1)) ++high;
      from = low;
      to = high;
    }
    if (to - from < 2) continue;
    slope[i] = local_polynomial(time_s, position, from, to, time_s[i], 2).slope;
  }
  return slope;
}

/// Standard deviation of what neighbouring samples do not share: the scatter about a cubic through eight rows
/// in a row, the median over the log (so that impacts and standstill do not decide). A channel that is
/// quantised and hardly moves gives the mean instead. Rows with `contact` (which may be empty) are left out.
double sample_noise(const std::vector<double>& time_s, const std::vector<double>& values,
                    const std::vector<double>& contact = {}) {
  constexpr std::size_t kRows = 8;
  std::vector<double> variances;
  const std::size_t stride = std::max<std::size_t>(kRows / 2, time_s.size() / 4000);
  for (std::size_t first = 0; first + kRows <= time_s.size(); first += stride) {
    const std::size_t last = first + kRows - 1;
    if (!contact.empty() && (contact[first] != 0.0 || contact[last] != 0.0)) continue;
    variances.push_back(
        local_polynomial(time_s, values, first, last, time_s[first + kRows / 2], 3).residual_variance);
  }
  if (variances.empty()) return 0.0;
  double mean = 0.0;
  for (double v : variances) mean += v / static_cast<double>(variances.size());
  auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  constexpr double kMedianOfChiSquare4 =
      3.3567 / 4.0;  // median of a chi-square with 4 degrees of freedom, over 4
  const double by_median = *middle / kMedianOfChiSquare4;
  return std::sqrt(by_median > 0.0 ? by_median : mean);
}

/// The first closing of a switch that was open for a while: after it, it bounces.
std::vector<double> first_closings(const std::vector<double>& time_s, const std::vector<double>& contact) {
  constexpr double kOpenFor_s = 0.03;
  std::vector<double> found;
  double open_since = contact.front() == 0.0 ? time_s.front() - kOpenFor_s : time_s.front();
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (contact[i] != 0.0 && contact[i - 1] == 0.0 && time_s[i] - open_since >= kOpenFor_s)
      found.push_back(0.5 * (time_s[i - 1] + time_s[i]));
    if (contact[i] != 0.0) open_since = time_s[i];
  }
  return found;
}

}  // namespace

LocalPolynomial local_polynomial(const std::vector<double>& time_s, const std::vector<double>& values,
                                 std::size_t first, std::size_t last, double at_s, int order) {
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 5, 5>;
  const int terms = order + 1;
  const double scale = std::max(1e-9, std::max(time_s[last] - at_s, at_s - time_s[first]));
  Matrix normal = Matrix::Zero(terms, terms);
  Vector right = Vector::Zero(terms);
  Vector row(terms);
  const double origin = values[first];
  for (std::size_t i = first; i <= last; ++i) {
    const double s = (time_s[i] - at_s) / scale;
    row(0) = 1.0;
    for (int k = 1; k < terms; ++k) row(k) = row(k - 1) * s;
    normal.noalias() += row * row.transpose();
    right += row * (values[i] - origin);
  }
  const Eigen::LDLT<Matrix> factors(normal);
  const Vector c = factors.solve(right);
  double squares = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    const double s = (time_s[i] - at_s) / scale;
    double fitted = c(terms - 1);
    for (int k = terms - 2; k >= 0; --k) fitted = fitted * s + c(k);
    squares += (values[i] - origin - fitted) * (values[i] - origin - fitted);
  }
  const Matrix inverse = factors.solve(Matrix::Identity(terms, terms));
  LocalPolynomial p;
  p.value = c(0) + origin;
  p.slope = order >= 1 ? c(1) / scale : 0.0;
  p.curvature = order >= 2 ? 2.0 * c(2) / (scale * scale) : 0.0;
  const auto freedom = static_cast<double>(last - first + 1) - terms;
  p.residual_variance = freedom > 0.0 ? squares / freedom : 0.0;
  p.value_variance = inverse(0, 0);
  if (order >= 1) {
    p.slope_variance = inverse(1, 1) / (scale * scale);
    p.covariance = inverse(0, 1) / scale;
  }
  return p;
}

ChannelNames channel_names(dynamics::Kind kind) {
  switch (kind) {
    case dynamics::Kind::hopper_linear:
    case dynamics::Kind::rail_carriage:
      return {"height", "m", "mps"};
    case dynamics::Kind::motor_axis:
      return {"position", "m", "mps"};
    case dynamics::Kind::rotary_joint:
      return {"angle", "rad", "radps"};
  }
  return {};
}

Recording make_recording(const log::Log& log, dynamics::Kind kind) {
  if (log.rows() < kFewestRows)
    throw log::DataError(log.path + ": " + std::to_string(log.rows()) +
                         " rows are too few to learn anything from; expected at least " +
                         std::to_string(kFewestRows));
  Recording r;
  r.name = log.path;
  r.kind = kind;
  r.time_s = log.time_s();
  const char* velocity_column = "velocity_mps";
  switch (kind) {
    case dynamics::Kind::hopper_linear:
      r.position = log.at("height_m");
      r.input = log.at("torque_cmd_nm");
      break;
    case dynamics::Kind::motor_axis:
      r.position = log.at("position_m");
      r.input = log.at("force_n");
      break;
    case dynamics::Kind::rotary_joint:
      r.position = log.at("angle_rad");
      r.input = log.at("torque_nm");
      velocity_column = "velocity_radps";
      break;
    case dynamics::Kind::rail_carriage:  // nothing drives it: its force_n is the stop's
      r.position = log.at("height_m");
      r.input.assign(r.rows(), 0.0);
      if (log.has("contact")) r.contact = log.at("contact");
      break;
  }
  r.impulse.assign(r.rows(), 0.0);
  r.driven_s.assign(r.rows(), 0.0);
  for (std::size_t i = 1; i < r.rows(); ++i) {
    const double interval_s = r.time_s[i] - r.time_s[i - 1];
    r.impulse[i] = r.impulse[i - 1] + r.input[i - 1] * interval_s;
    r.driven_s[i] = r.driven_s[i - 1] + (r.input[i - 1] != 0.0 ? interval_s : 0.0);
  }
  if (kind == dynamics::Kind::hopper_linear) {
    if (log.has("contact")) r.touchdown_reports_s = first_closings(r.time_s, log.at("contact"));
    if (log.has("torque_nm") && log.at("torque_nm") != r.input) {
      r.drive = log.at("torque_nm");
      // A current sensor tells a hundredth of what is usual at best; and whether a row's torque is that
      // before or after its command is the rig's affair.
      double squares = 0.0, steps = 0.0;
      for (std::size_t i = 1; i < r.rows(); ++i) {
        squares += r.input[i] * r.input[i];
        steps += (r.input[i] - r.input[i - 1]) * (r.input[i] - r.input[i - 1]);
      }
      const auto rows = static_cast<double>(r.rows());
      r.drive_noise = std::hypot(sample_noise(r.time_s, r.drive), std::sqrt(1e-4 * squares / rows),
                                 std::sqrt(steps / rows));
      if (!(r.drive_noise > 0.0)) r.drive.clear();
    }
  }
  r.velocity_smoothed = smoothed_slope(r.time_s, r.position, r.contact);
  r.velocity_recorded = log.has(velocity_column);
  r.velocity = r.velocity_recorded ? log.at(velocity_column) : r.velocity_smoothed;
  r.position_noise = sample_noise(r.time_s, r.position, r.contact);
  r.velocity_noise = sample_noise(r.time_s, r.velocity, r.contact);
  return r;
}

std::vector<Recording> make_recordings(const std::vector<log::Log>& logs, dynamics::Kind kind) {
  constexpr double kShare = 0.3;
  constexpr double kMotionOverNoise = 10.0;
  std::vector<Recording> all;
  for (const auto& log : logs) all.push_back(make_recording(log, kind));
  double noise = 0.0;
  bool moves = all.empty();
  for (const Recording& r : all) {
    noise = std::max(noise, r.position_noise);
    const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
    moves = moves || *high - *low > kMotionOverNoise * r.position_noise;
  }
  if (!moves)
    throw log::DataError(all.front().name + ": the " + channel_names(kind).position +
                         " never moves by more than its noise, in any recording; expected motion");
  for (Recording& r : all) r.position_noise = std::max(r.position_noise, kShare * noise);
  return all;
}

}  // namespace furcula::identify
