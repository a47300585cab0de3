#include "host/identify/recording.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

constexpr std::size_t kFewestRowsOfLog = 20;
constexpr double kSlopeHalfWidth_s = 0.006;
constexpr double kLegMovesOverNoise = 10.0;

/// Slope of the position by a local parabola over +-6 ms (at least two rows on either side): no delay. Not over a pause. Where
/// there is a contact flag, over the rows alone that have the same one: an impact has no slope.
std::vector<double> smoothed_slope(const std::vector<double>& time_s, const std::vector<double>& position,
                                   const std::vector<double>& contact) {
  const std::size_t n = time_s.size();
  std::vector<double> slope(n);
  const double pause_s = longest_pause_s(time_s);
  std::size_t first = 0, last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    while (time_s[first] < time_s[i] - kSlopeHalfWidth_s) ++first;
    while (last + 1 < n && time_s[last + 1] <= time_s[i] + kSlopeHalfWidth_s) ++last;
    std::size_t from = std::min(first, i >= 2 ? i - 2 : 0);
    std::size_t to = std::min(n - 1, std::max(last, i + 2));
    const auto same = [&](std::size_t k) { return contact.empty() || contact[k] == contact[i]; };
    std::size_t low = i, high = i;
    while (low > from && same(low - 1) && time_s[low] - time_s[low - 1] <= pause_s) --low;
    while (high < to && same(high + 1) && time_s[high + 1] - time_s[high] <= pause_s) ++high;
    from = low;
    to = high;
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

/// Of an encoder on a belt that stands still most of the time, where a count does not flicker and a stop is a
/// kink: what a count is worth, and the scatter in the rows in which the coil is off and has been for long.
double standstill_noise(const Recording& r) {
  constexpr double kStands_s = 0.3;
  double count = 0.0, squares = 0.0, freedom = 0.0;
  for (std::size_t i = 1; i < r.rows(); ++i) {
    const double step = std::abs(r.position[i] - r.position[i - 1]);
    if (step > 0.0 && (count == 0.0 || step < count)) count = step;
  }
  double on_until_s = r.time_s.front() - kStands_s;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.input[i] != 0.0) on_until_s = r.time_s[i];
    if (i == 0 || r.time_s[i - 1] - on_until_s < kStands_s) continue;
    const double step = r.position[i] - r.position[i - 1];
    squares += 0.5 * step * step;
    freedom += 1.0;
  }
  const double scatter = freedom > 0.0 ? squares / freedom : 0.0;
  return std::sqrt(scatter + count * count / 12.0);
}

/// A current sensor tells a hundredth of what is usual at best; and whether a row's torque is that before or
/// after its command is the rig's affair.
double drive_noise(const std::vector<double>& time_s, std::span<const double> command,
                   const std::vector<double>& drive) {
  double squares = 0.0, steps = 0.0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    squares += command[i] * command[i];
    steps += (command[i] - command[i - 1]) * (command[i] - command[i - 1]);
  }
  const auto rows = static_cast<double>(time_s.size());
  return std::hypot(sample_noise(time_s, drive, {}), std::sqrt(1e-4 * squares / rows),
                    std::sqrt(steps / rows));
}

/// Neighbouring samples do not tell what links and joints give under load: some milliradians.
double leg_angle_noise(const std::vector<double>& time_s, const std::vector<double>& angle) {
  constexpr double kLegGives_rad = 2e-3;
  return std::hypot(sample_noise(time_s, angle), kLegGives_rad);
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

/// Steps between two neighbouring rows that stand far out of those of the rows around, and stay: neither an
/// impact, which changes the slope for good, nor a single wrong row, which steps back.
std::vector<Slip> find_slips(const std::vector<double>& time_s, const std::vector<double>& position,
                             double noise) {
  constexpr std::size_t kAround = 6;
  constexpr double kFarOut = 10.0;     // of the scatter of the steps around
  constexpr double kLongestGap = 4.0;  // of the usual interval: over a pause the axis may have gone anywhere
  std::vector<Slip> found;
  if (time_s.size() < 4 * kAround) return found;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time_s.size(); ++i) intervals.push_back(time_s[i] - time_s[i - 1]);
  const double usual_s = core::median(intervals);
  const auto slope = [&](std::size_t i) {
    return (position[i] - position[i - 1]) / (time_s[i] - time_s[i - 1]);
  };
  for (std::size_t i = kAround + 1; i + kAround + 1 < time_s.size(); ++i) {
    const double interval_s = time_s[i] - time_s[i - 1];
    if (interval_s > kLongestGap * usual_s) continue;
    // Cheap first: most rows are nowhere near.
    const double before = slope(i - 1), after = slope(i + 1);
    if (std::abs(slope(i) - 0.5 * (before + after)) * interval_s < kFarOut * noise) continue;
    std::vector<double> left, right, scatter;
    for (std::size_t k = 1; k <= kAround; ++k) {
      left.push_back(slope(i - k));
      right.push_back(slope(i + k));
    }
    const double from = core::median(left), to = core::median(right);
    for (double v : left) scatter.push_back(std::abs(v - from) * interval_s);
    for (double v : right) scatter.push_back(std::abs(v - to) * interval_s);
    const double around = std::max(1.4826 * core::median(scatter), 1.5 * noise);
    // Between the two slopes the axis may have gone at either.
    const double rest_from = (slope(i) - from) * interval_s, rest_to = (slope(i) - to) * interval_s;
    if (rest_from * rest_to <= 0.0 || std::min(std::abs(rest_from), std::abs(rest_to)) < kFarOut * around)
      continue;
    const double step = 0.5 * (rest_from + rest_to);
    const auto steps_back = [&](std::size_t k) {
      return (slope(k) - (k < i ? from : to)) * (time_s[k] - time_s[k - 1]) * step < -0.5 * step * step;
    };
    if (steps_back(i - 1) || steps_back(i + 1) || steps_back(i + 2)) continue;
    // The step between lines through the rows on either side.
    const auto one = local_polynomial(time_s, position, i - kAround, i - 1, time_s[i], 2);
    const auto other = local_polynomial(time_s, position, i, i + kAround - 1, time_s[i], 2);
    const double refined = other.value - one.value;
    const double deviation = noise * std::sqrt(one.value_variance + other.value_variance);
    const bool agree = std::abs(refined - step) < 0.3 * std::abs(step);
    found.push_back({i, agree ? refined : step, agree ? deviation : around});
    i += kAround;
  }
  return found;
}

void sum_inputs(Recording& r) {
  r.impulse.assign(r.rows(), 0.0);
  r.driven_s.assign(r.rows(), 0.0);
  for (std::size_t i = 1; i < r.rows(); ++i) {
    const double interval_s = r.time_s[i] - r.time_s[i - 1];
    r.impulse[i] = r.impulse[i - 1] + r.input[i - 1] * interval_s;
    r.driven_s[i] = r.driven_s[i - 1] + (r.input[i - 1] != 0.0 ? interval_s : 0.0);
  }
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

double longest_pause_s(const std::vector<double>& time_s) {
  constexpr double kPause_s = 0.05, kRows = 5.0;
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < time_s.size(); ++i) intervals_s.push_back(time_s[i] - time_s[i - 1]);
  return std::max(kPause_s, kRows * core::quantile(std::move(intervals_s), 0.5));
}

ChannelNames channel_names(dynamics::Kind kind) {
  const bool rotary = dynamics::info(kind).rotary;
  return {std::string(machines::rules(kind).channel), rotary ? "rad" : "m", rotary ? "radps" : "mps"};
}

Recording make_recording(const log::Log& raw, dynamics::Kind kind, const std::vector<log::Refuted>& refuted) {
  const machines::Rules& rules = machines::rules(kind);
  const machines::Columns& columns = rules.columns;
  std::vector<log::Watched> watched;
  for (const std::string_view column : {columns.position, columns.leg_angle}) {
    const bool leg = column == columns.leg_angle, angle = leg || dynamics::info(kind).rotary;
    watched.push_back({std::string(column), true, angle ? 2.0 * std::numbers::pi : 0.0, leg});
  }
  for (const std::string_view column : {columns.velocity, columns.input, columns.command, columns.report})
    watched.push_back({std::string(column), false});
  std::erase_if(watched, [](const log::Watched& w) { return w.column.empty(); });
  log::Clean clean = log::clean(raw, watched, refuted);
  const log::Log& log = clean.log;
  if (log.rows() < kFewestRowsOfLog)
    throw core::DataError(log.path + ": " + std::to_string(log.rows()) +
                          " rows are too few to learn anything from; expected at least " +
                          std::to_string(kFewestRowsOfLog));
  Recording r;
  r.name = log.path;
  r.kind = kind;
  r.time_s = log.time_s();
  r.refused = log.refused;
  r.notes = log.notes;
  r.mapped = log.mapped;
  r.log_row = std::move(clean.row);
  const auto given = [&](std::string_view column) {
    return !column.empty() && log.has(std::string(column)) ? log.at(std::string(column))
                                                           : std::vector<double>{};
  };
  r.position = log.at(std::string(columns.position));
  if (columns.input.empty())
    r.input.assign(r.rows(), 0.0);
  else
    r.input = log.at(std::string(columns.input));
  r.drive_command = given(columns.command);
  r.contact = given(columns.stop);
  sum_inputs(r);
  r.solenoid = given(columns.coil);
  if (std::all_of(r.solenoid.begin(), r.solenoid.end(), [](double on) { return on == 0.0; }))
    r.solenoid.clear();
  const std::vector<double> touchdown = given(columns.touchdown);
  if (!touchdown.empty()) r.touchdown_reports_s = first_closings(r.time_s, touchdown);
  r.on_ground = touchdown;
  if (!r.solenoid.empty()) r.cable = given(columns.cable);
  if (!r.cable.empty() &&
      std::all_of(r.cable.begin(), r.cable.end(), [&](double x) { return x == r.cable[0]; }))
    r.cable.clear();
  r.drive = given(columns.report);
  if (r.drive == r.input) r.drive.clear();
  r.leg_angle = given(columns.leg_angle);
  if (!r.leg_angle.empty()) {
    r.leg_angle_noise = leg_angle_noise(r.time_s, r.leg_angle);
    const auto [low, high] = std::minmax_element(r.leg_angle.begin(), r.leg_angle.end());
    if (*high - *low < kLegMovesOverNoise * r.leg_angle_noise) r.leg_angle.clear();
  }
  if (!r.drive_command.empty()) {
    r.drive = r.input;
    r.drive_impulse.assign(r.rows(), 0.0);
    for (std::size_t i = 1; i < r.rows(); ++i)
      r.drive_impulse[i] = r.drive_impulse[i - 1] + r.drive_command[i - 1] * (r.time_s[i] - r.time_s[i - 1]);
    if (r.drive == r.drive_command) {
      r.drive.clear();
      r.drive_command.clear();
    }
  }
  if (!r.drive.empty()) {
    r.drive_noise = drive_noise(r.time_s, r.drive_commands().command, r.drive);
    if (!(r.drive_noise > 0.0)) {
      r.drive.clear();
      r.drive_command.clear();
    }
  }
  r.velocity_smoothed = smoothed_slope(r.time_s, r.position, r.contact);
  r.velocity = given(columns.velocity);
  r.velocity_recorded = !r.velocity.empty();
  if (!r.velocity_recorded) r.velocity = r.velocity_smoothed;
  r.position_noise = rules.held ? standstill_noise(r) : sample_noise(r.time_s, r.position, r.contact);
  r.velocity_noise = sample_noise(r.time_s, r.velocity, r.contact);
  r.slips = find_slips(r.time_s, r.position, r.position_noise);
  if (!r.slips.empty()) {
    r.slip_offset.assign(r.rows(), 0.0);
    for (const Slip& slip : r.slips)
      for (std::size_t i = slip.row; i < r.rows(); ++i) r.slip_offset[i] += slip.step;
  }
  return r;
}

std::vector<Recording> make_recordings(const std::vector<log::Log>& logs, dynamics::Kind kind,
                                       const std::vector<std::vector<log::Refuted>>& refuted) {
  constexpr double kShare = 0.3;
  constexpr double kMotionOverNoise = 10.0;
  std::vector<Recording> all;
  for (std::size_t i = 0; i < logs.size(); ++i)
    all.push_back(make_recording(logs[i], kind, refuted.empty() ? std::vector<log::Refuted>{} : refuted[i]));
  double noise = 0.0;
  bool moves = all.empty();
  for (const Recording& r : all) {
    noise = std::max(noise, r.position_noise);
    const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
    moves = moves || *high - *low > kMotionOverNoise * r.position_noise;
  }
  if (!moves)
    throw core::DataError(all.front().name + ": the " + channel_names(kind).position +
                          " never moves by more than its noise, in any recording; expected motion");
  for (Recording& r : all) r.position_noise = std::max(r.position_noise, kShare * noise);
  return all;
}

double row_s(const Recording& r) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < r.rows(); ++i) steps.push_back(r.time_s[i] - r.time_s[i - 1]);
  return core::quantile(steps, 0.5);
}

void take_earlier(std::vector<Recording>& recordings, double rows) {
  for (Recording& r : recordings) {
    for (std::size_t i = 0; i + 1 < r.rows(); ++i) r.input[i] += rows * (r.input[i + 1] - r.input[i]);
    sum_inputs(r);
  }
}

const Recording* goes_on_from(const Recording& r, const std::vector<Recording>& earlier) {
  for (const Recording& e : earlier)
    if (e.name == r.name && e.time_s.back() < r.time_s.front()) return &e;
  return nullptr;
}

void keep_warm(std::vector<Recording>& recordings, const std::vector<Recording>& earlier) {
  for (Recording& r : recordings) {
    const Recording* before = goes_on_from(r, earlier);
    if (before == nullptr) continue;
    const double between_s = before->input.back() != 0.0 ? r.time_s.front() - before->time_s.back() : 0.0;
    for (double& driven_s : r.driven_s) driven_s += before->driven_s.back() + between_s;
  }
}

}  // namespace furcula::identify
