// What time stamps imply, see time_stamps.hpp.
#include "host/log/time_stamps.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/time_order.hpp"

namespace furcula::log {
namespace {

constexpr std::size_t kFewest = 20;  // intervals, of which a distribution is judged
/// Machines that this is for are sampled at 10 Hz to 10 kHz: their modes lie between 1 and 100 Hz, drives close their loops at up to some
/// 10 kHz, and below ten rows a second a swing of a leg (0.3 s) has three rows.
constexpr double kShortest_s = 1e-4, kLongest_s = 0.1;
constexpr double kRounding = 1.05;  // a log at 10 Hz whose clock is a little slow
constexpr double kFlight_s = 0.03;  // the shortest piece of a log that anything is learnt from
constexpr double kEven = 1.5;      // longest over shortest interval of a block of which nothing is to be said
constexpr std::size_t kNamed = 3;  // intervals that are named

std::string ms(double s) {
  return s < 100.0 ? core::rounded(1e3 * s, 4) + " ms" : core::rounded(s, 4) + " s";
}

struct Unit {
  double seconds;
  const char* name;
  const char* scale;
};
constexpr Unit kUnits[]{{1e-3, "ms", "0.001"}, {1e-6, "us", "1e-6"}, {1e-9, "ns", "1e-9"}};
constexpr Unit kTooSmall[]{{1e3, "ks", "1000"}, {1e6, "Ms", "1e6"}};

/// Deviation of what neighbouring rows of a column do not share: third differences (a smooth motion has hardly any); at least that of its
/// smallest step.
double noise_of(std::span<const double> x) {
  std::vector<double> third;
  double step = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double d = std::abs(x[i] - x[i - 1]);
    if (d > 0.0 && (step == 0.0 || d < step)) step = d;
    if (i >= 3) third.push_back(std::abs(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]));
  }
  if (third.empty()) return 0.0;
  // Median of |normal| is 0.6745 of its deviation; third differences of white noise have sqrt(20) of it.
  return std::max(core::median(std::move(third)) / 0.6745 / std::sqrt(20.0), step / std::sqrt(12.0));
}

}  // namespace

/// Intervals of a block: interval i lies before row i.
struct StampJudge::Block {
  std::vector<double> interval_s;  ///< [0] is none
  double median_s = 0.0, mean_s = 0.0, low_s = 0.0,
         high_s = 0.0;  ///< low and high: all but a twentieth at either end
  std::size_t rows() const { return interval_s.size(); }
};

StampJudge::StampJudge(std::string name, std::size_t positions, const ColumnMap* map)
    : name_(std::move(name)), map_(map), x_(positions) {}

void StampJudge::grow() {
  const std::size_t size = std::min(kBlock, std::max<std::size_t>(256, 4 * time_s_.size()));
  time_s_.resize(size);
  lines_.resize(size);
  for (auto& x : x_) x.resize(size);
}

void StampJudge::end_block() {
  const std::size_t n = rows_;
  if (n < 2) return;
  if (intervals_ == 0) first_s_ = time_s_.front();
  last_s_ = time_s_[n - 1];
  double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    const double d = time_s_[i] - time_s_[i - 1];
    shortest = std::min(shortest, d);
    longest = std::max(longest, d);
  }
  intervals_ += n - 1;
  const double mean = (time_s_[n - 1] - time_s_.front()) / static_cast<double>(n - 1);
  const bool even = longest < kEven * shortest, whole = lines_[n - 1] - lines_.front() == n - 1;
  Block b;
  if (!even || !whole) {
    b.interval_s.resize(n);
    for (std::size_t i = 1; i < n; ++i) b.interval_s[i] = time_s_[i] - time_s_[i - 1];
  }
  if (even) {
    medians_.emplace_back(mean, n - 1);
    b.median_s = b.mean_s = mean;
    b.low_s = shortest;
    b.high_s = longest;
    if (!whole && n > kFewest) look_for_steps(b);
  } else {
    // A thousand tell the distribution; a prime step meets no period.
    constexpr std::size_t kSample = 1024, kStep = 7919;
    std::vector<double> sorted(b.interval_s.begin() + 1, b.interval_s.end());
    if (sorted.size() > 2 * kSample) {
      for (std::size_t k = 0; k < kSample; ++k) sorted[k] = b.interval_s[1 + k * kStep % (n - 1)];
      sorted.resize(kSample);
    }
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
      return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    };
    b.median_s = at(0.5);
    b.low_s = at(0.05);
    b.high_s = at(0.95);
    b.mean_s = mean;
    medians_.emplace_back(b.median_s, n - 1);
    if (sorted.size() >= kFewest) {
      ++uneven_blocks_;
      look_for_bursts(b);
      look_for_steps(b);
      look_for_missing(b);
      // Takes longest: on fewer and fewer blocks.
      if (std::has_single_bit(uneven_blocks_)) look_for_receipt(b);
    }
  }
  // The last row begins the next block.
  before_ += n - 1;
  time_s_.front() = time_s_[n - 1];
  lines_.front() = lines_[n - 1];
  for (auto& x : x_) x.front() = x[n - 1];
  rows_ = 1;
}

/// Rows that leave a buffer together bear stamps that lie close together, and a pause follows until the next are read. Such stamps are wrong
/// where the body goes as far over the pause as over any other interval: of all its way the pauses then have their share of the rows, and
/// if the stamps were right, their share of the time. Between the two the geometric mean decides.
void StampJudge::look_for_bursts(const Block& b) {
  constexpr std::size_t kFewestPauses = 10;  // and bursts in which a body moves
  constexpr double kShort = 0.25, kShareOfTime = 0.8, kInBursts = 0.5;
  if (b.low_s > kShort * b.mean_s) return;
  std::vector<std::size_t> pauses;  // rows after one
  double pause_s = 0.0, within_s = 0.0;
  std::size_t within = 0;
  for (std::size_t i = 1; i < b.rows(); ++i) {
    if (b.interval_s[i] > b.mean_s) {
      pauses.push_back(i);
      pause_s += b.interval_s[i];
    } else if (b.interval_s[i] < kShort * b.mean_s) {
      within_s += b.interval_s[i];
      ++within;
    }
  }
  const auto intervals = static_cast<double>(b.rows() - 1);
  const double share_of_time = pause_s / (b.mean_s * intervals),
               share_of_rows = static_cast<double>(pauses.size()) / intervals;
  if (pauses.size() < kFewestPauses || share_of_time < kShareOfTime ||
      share_of_rows > 0.5 + 1.0 / intervals ||
      static_cast<double>(within + pauses.size()) < kInBursts * intervals)
    return;
  std::size_t moving = 0, as_rows = 0;  // positions
  for (const std::vector<double>& x : x_) {
    double over_pauses = 0.0, over_rows = 0.0, over_bursts = 0.0, squares = 0.0;
    for (std::size_t i = pauses.front(); i < pauses.back(); ++i) over_rows += std::abs(x[i + 1] - x[i]);
    for (std::size_t k = 1; k < pauses.size(); ++k) {
      over_pauses += std::abs(x[pauses[k]] - x[pauses[k] - 1]);
      const double way = std::abs(x[pauses[k]] - x[pauses[k - 1]]);
      over_bursts += way;
      squares += way * way;
    }
    // Noise goes to and fro from row to row, and nowhere from burst to burst; and a few steps of a body that else is still fall anywhere.
    if (!(over_bursts > 0.5 * over_rows) ||
        over_bursts * over_bursts < static_cast<double>(kFewestPauses) * squares)
      continue;
    ++moving;
    if (over_pauses < std::sqrt(share_of_rows * share_of_time) * over_rows) ++as_rows;
  }
  if (moving > 0 && 2 * as_rows < moving) return;
  ++bursts_.blocks;
  if (as_rows > 0) ++bursts_.by_motion;
  const std::size_t rows = pauses.back() - pauses.front();  // of whole bursts
  bursts_.rows += rows;
  bursts_.bursts += pauses.size() - 1;
  bursts_.within_s +=
      within_s * static_cast<double>(rows) / static_cast<double>(std::max<std::size_t>(within, 1));
  bursts_.period_s += time_s_[pauses.back()] - time_s_[pauses.front()];
}

/// Rows are missing where nearly all intervals are alike, and the others whole multiples of them.
void StampJudge::look_for_missing(const Block& b) {
  constexpr double kAlike = 0.1, kWhole = 0.15, kMost = 0.9, kPause = 100.0;
  if (b.low_s < (1.0 - 2.0 * kAlike) * b.median_s) return;
  const auto is_gap = [&](std::size_t row) { return std::binary_search(gaps_.begin(), gaps_.end(), row); };
  std::size_t alike = 0, long_ones = 0, whole = 0, missing = 0;
  for (std::size_t i = 1; i < b.rows(); ++i) {
    const double ratio = b.interval_s[i] / b.median_s;
    if (std::abs(ratio - 1.0) < kAlike) ++alike;
    if (ratio < 1.5 || ratio > kPause || is_gap(before_ + i) || lines_[i] != lines_[i - 1] + 1) continue;
    ++long_ones;
    if (std::abs(ratio - std::round(ratio)) >= kWhole) continue;
    ++whole;
    missing += static_cast<std::size_t>(std::round(ratio)) - 1;
  }
  // Of intervals of any length three in ten would be so near to a multiple.
  if (long_ones == 0 || static_cast<double>(whole) < kMost * static_cast<double>(long_ones) ||
      static_cast<double>(alike + long_ones) < kMost * static_cast<double>(b.rows() - 1))
    return;
  missing_ += missing;
  missing_places_ += whole;
}

/// An interval that is far longer or shorter than the others, or over which rows were left out, while the body goes as far as its rows at the
/// usual pace at the velocity that it has before and after: the clock was set there.
void StampJudge::look_for_steps(const Block& b) {
  constexpr std::size_t kRows = 5;   // on either side
  constexpr double kFar = 2.0;       // times what all but a twentieth have
  constexpr double kMostOdd = 0.05;  // more of them are the distribution itself
  constexpr double kSure = 5.0;      // standard deviations
  const auto usual = [&](std::size_t i) {
    return b.interval_s[i] <= kFar * b.high_s && b.interval_s[i] >= b.low_s / kFar;
  };
  // Where the clock was known to be set, time_order.hpp has told it.
  const auto told = [&](std::size_t i) { return std::abs(b.interval_s[i] - kUnknownInterval_s) < 1e-9; };
  std::vector<std::size_t> odd;
  for (std::size_t i = 1; i < b.rows(); ++i)
    if ((!usual(i) || lines_[i] != lines_[i - 1] + 1) && !told(i)) odd.push_back(i);
  if (odd.empty() || static_cast<double>(odd.size()) > kMostOdd * static_cast<double>(b.rows())) return;
  std::vector<double> noise;
  for (const std::vector<double>& x : x_) noise.push_back(noise_of(std::span(x).first(b.rows())));
  for (const std::size_t i : odd) {
    if (i < kRows + 1 || i + kRows >= b.rows()) continue;
    bool alone = true;
    for (std::size_t k = i - kRows; k <= i + kRows; ++k) alone = alone && (k == i || usual(k));
    if (!alone) continue;
    const double pace_s = b.median_s * static_cast<double>(lines_[i] - lines_[i - 1]);
    bool contradicts = false, agrees = false;
    for (std::size_t j = 0; j < x_.size(); ++j) {
      const std::vector<double>& x = x_[j];
      const double before = (x[i - 1] - x[i - 1 - kRows]) / (time_s_[i - 1] - time_s_[i - 1 - kRows]);
      const double after = (x[i + kRows] - x[i]) / (time_s_[i + kRows] - time_s_[i]);
      const double velocity = 0.5 * (before + after), step = x[i] - x[i - 1];
      const double off_stamp = std::abs(step - velocity * b.interval_s[i]),
                   off_usual = std::abs(step - velocity * pace_s);
      // Over `s` seconds: noise in the step and in both velocities, and the velocity that changes meanwhile.
      const auto tolerance = [&](double s) {
        return kSure * noise[j] * (std::sqrt(2.0) + s / (static_cast<double>(kRows) * b.median_s)) +
               std::abs(after - before) * s;
      };
      const bool as_stamped = off_stamp <= tolerance(b.interval_s[i]),
                 as_usual = off_usual <= tolerance(pace_s);
      if (!as_stamped && as_usual) contradicts = true;
      if (as_stamped && !as_usual) agrees = true;
    }
    if (!contradicts || agrees) continue;
    ++steps_;
    gaps_.push_back(before_ + i);
    if (step_words_.size() < kNamed)
      step_words_.push_back(name_ + " line " + std::to_string(lines_[i]) + ": " + ms(b.interval_s[i]) +
                            " after the row before, and the motion is that of " + ms(pace_s) +
                            ": the clock was set there, the interval was left out.");
  }
}

/// Stamps that are given when a row arrives are late by varying times. Then rows that are taken as even fit the motion better than the
/// stamps do: each row is compared with the cubic through two rows on either side.
void StampJudge::look_for_receipt(const Block& b) {
  constexpr double kUneven = 0.2;  // of the mean interval
  constexpr double kBetter = 0.7;  // of the residuals by the stamps
  constexpr std::size_t kFewestRows = 200;
  if (b.high_s - b.low_s < kUneven * b.mean_s) return;
  // Where a body is still, or goes evenly within its noise, every clock fits.
  ++receipt_looked_;
  const auto residual = [](const std::array<double, 5>& t, std::span<const double> x, std::size_t i) {
    double value = 0.0;
    for (const std::size_t k : {0U, 1U, 3U, 4U}) {
      double weight = 1.0;
      for (const std::size_t m : {0U, 1U, 3U, 4U})
        if (m != k) weight *= (t[2] - t[m]) / (t[k] - t[m]);
      value += weight * x[i + k - 2];
    }
    return std::abs(x[i] - value);
  };
  for (const std::vector<double>& x : x_) {
    std::vector<double> by_stamp, even;
    const double noise = noise_of(std::span(x).first(b.rows()));
    for (std::size_t i = 2; i + 2 < b.rows(); ++i) {
      bool together = true;
      for (std::size_t k = i - 1; k <= i + 2; ++k) together = together && b.interval_s[k] < 3.0 * b.high_s;
      if (!together || std::abs(x[i + 2] - x[i - 2]) < 4.0 * noise) continue;
      std::array<double, 5> t{};
      for (std::size_t k = 0; k < 5; ++k) t[k] = (time_s_[i + k - 2] - time_s_[i]) / b.mean_s;
      by_stamp.push_back(residual(t, x, i));
      even.push_back(residual({-2.0, -1.0, 0.0, 1.0, 2.0}, x, i));
    }
    if (by_stamp.size() < kFewestRows) continue;
    if (core::median(std::move(even)) < kBetter * core::median(std::move(by_stamp))) {
      ++receipt_blocks_;
      receipt_low_s_ = b.low_s;
      receipt_high_s_ = b.high_s;
      receipt_mean_s_ = b.mean_s;
      return;
    }
  }
}

std::string StampJudge::burst_words() const {
  const double rows = static_cast<double>(bursts_.rows), each = rows / static_cast<double>(bursts_.bursts);
  const double mean_s = bursts_.period_s / rows, within_s = bursts_.within_s / rows;
  return name_ + ": time stamps come in bursts: about " +
         core::rounded(std::abs(each - std::round(each)) < 0.02 * each ? std::round(each) : each, 3) +
         " rows " + ms(within_s) + " apart, then nothing until " + ms(each * mean_s) +
         " after the first of them (mean interval " + ms(mean_s) + ", " +
         core::rounded(mean_s / within_s, 2) + " times that within a burst)";
}

/// Of the blocks' medians.
double StampJudge::median_s() const {
  auto sorted = medians_;
  const auto at = std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return sorted[static_cast<std::size_t>(at)].first;
}

std::string StampJudge::unit_words() const {
  const double median_s = this->median_s(), duration_s = last_s_ - first_s_;
  const auto words = [&](std::span<const Unit> units, const std::string& why) -> std::string {
    const Unit* best = nullptr;
    const auto off = [&](const Unit& u) {
      return std::abs(std::log(median_s * u.seconds / std::sqrt(kShortest_s * kLongest_s)));
    };
    for (const Unit& u : units)
      if (median_s * u.seconds >= kShortest_s / kRounding && median_s * u.seconds <= kLongest_s * kRounding &&
          (best == nullptr || off(u) < off(*best)))
        best = &u;
    if (best == nullptr) return {};
    std::string column = "time_s", scale = best->scale;
    if (map_ != nullptr)
      if (const auto mapped = map_->columns.find("time_s");
          mapped != map_->columns.end() && mapped->second.parts.size() == 1) {
        column = mapped->second.parts.front().column;
        scale = core::rounded(mapped->second.parts.front().scale * best->seconds, 12);
      }
    return name_ + ": " + why + "; is time_s in " + best->name +
           "? Then a --map file with the line time_s = { column = \"" + core::printable(column) +
           "\", scale = " + scale + " } reads it, with rows " + ms(median_s * best->seconds) + " apart";
  };
  if (median_s > kRounding * kLongest_s)
    return words(kUnits,
                 "rows are " + ms(median_s) + " apart, so that each interval is a gap that ends a window");
  if (duration_s < kFlight_s && intervals_ > 5 * kFewest && median_s < kShortest_s)
    return words(kTooSmall, "rows are " + core::rounded(1e6 * median_s, 4) +
                                " us apart, and all of them take " + ms(duration_s));
  return {};
}

TimeStamps StampJudge::finish() {
  end_block();
  TimeStamps s;
  if (intervals_ == 0) return s;
  s.median_s = median_s();
  s.mean_s = (last_s_ - first_s_) / static_cast<double>(intervals_);
  if (intervals_ < kFewest) return s;
  s.unit = unit_words();
  if (2 * bursts_.by_motion > uneven_blocks_)
    s.bursts =
        burst_words() +
        ", while the motion goes on evenly from row to row: rows were stamped when a buffer was read, not when they were "
        "measured. Expected the device's own clock in time_s, or rows spread evenly over each burst";
  else if (2 * bursts_.blocks > uneven_blocks_)
    s.notes.push_back(
        burst_words() +
        ". If a buffer was read so, they say nothing of when a row was measured; the motion is too small to tell.");
  // Then an interval that does not fit is no step of the clock.
  const bool on_receipt = s.bursts.empty() && 2 * receipt_blocks_ > receipt_looked_;
  if (on_receipt)
    s.notes.push_back(
        name_ + ": intervals of " + ms(receipt_low_s_) + " to " + ms(receipt_high_s_) +
        " do not fit the motion, rows " + ms(receipt_mean_s_) +
        " apart do: it seems that stamps were rounded, or given when rows arrived. Record the device's own clock, with "
        "all its digits.");
  if (s.bursts.empty() && !on_receipt) {
    s.notes.insert(s.notes.end(), step_words_.begin(), step_words_.end());
    if (steps_ > step_words_.size())
      s.notes.push_back(name_ + ": " + std::to_string(steps_ - step_words_.size()) +
                        " more intervals were left out for the same reason.");
    s.gaps = gaps_;
  }
  if (missing_ != 0 && s.bursts.empty() && !on_receipt)
    s.remarks.push_back(name_ + ": " + std::to_string(missing_) +
                        (missing_ == 1 ? " row seems" : " rows seem") + " to be missing in " +
                        std::to_string(missing_places_) + (missing_places_ == 1 ? " place" : " places") +
                        " (intervals that are whole multiples of " + ms(medians_.front().first) + ").");
  return s;
}

std::vector<std::string> position_columns(const std::string& rig, std::span<const std::string> columns) {
  constexpr std::string_view kPositions[]{"height_m", "position_m", "angle_rad", "pulley_angle_rad",
                                          "leg_angle_rad"};
  std::vector<std::string> found;
  const MachineType* info = machine_type_named(rig);
  if (info == nullptr) return found;
  for (const std::string& column : columns) {
    bool is = std::find(std::begin(kPositions), std::end(kPositions), column) != std::end(kPositions);
    for (const ColumnPattern& p : info->patterns)
      if (!p.joint_in(column).empty()) {
        is = p.prefix == "angle_" || p.prefix == "position_";
        break;
      }
    if (is) found.push_back(column);
  }
  return found;
}

TimeStamps judge(const Log& log, const ColumnMap* map) {
  std::vector<std::string> names;
  for (const auto& [name, values] : log.columns) names.push_back(name);
  std::vector<const std::vector<double>*> positions;
  for (const std::string& name : position_columns(log.rig, names)) positions.push_back(&log.at(name));
  StampJudge judge(log.path, positions.size(), map);
  for (std::size_t i = 0; i < log.rows(); ++i)
    judge.add(log.time_s()[i], log.lines.empty() ? i + 1 : log.lines[i],
              [&](std::size_t j) { return (*positions[j])[i]; });
  return judge.finish();
}

void open_gaps(Log& log, const std::vector<std::size_t>& gaps) {
  std::vector<double>& t = log.columns.at("time_s");
  double shift_s = 0.0;
  std::size_t next = 0;
  double before_s = t.empty() ? 0.0 : t.front();
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double interval_s = t[i] - before_s;
    before_s = t[i];
    if (next < gaps.size() && gaps[next] == i) {
      ++next;
      shift_s += std::max(0.0, kUnknownInterval_s - interval_s);
    }
    t[i] += shift_s;
  }
}

}  // namespace furcula::log
