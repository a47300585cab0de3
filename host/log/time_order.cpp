// Rows whose time does not increase, see time_order.hpp.
#include "host/log/time_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/message.hpp"

namespace furcula::log {
namespace {

constexpr std::size_t kLook = 8;      // rows that show whether time goes on from an odd one
constexpr std::size_t kNotes = 3;     // steps that are named
constexpr double kFarAhead = 2.0;     // times the longest interval so far: the next row must confirm it
constexpr double kClockSet_s = 1e6;   // twelve days: no recording pauses so long
constexpr double kFarFromPace = 1e3;  // times the interval to the next row
constexpr double kMargin = 0.1;       // about the intervals of the last rows

double between(const TimeOrder::Row& from, const TimeOrder::Row& to) {
  return from.large() && to.large() ? to.stamp.since(from.stamp) : to.raw_s - from.raw_s;
}

/// Counters of time that wrap.
struct TimeCounter {
  double span_s;
  const char* what;
};
constexpr TimeCounter kTimeCounters[]{{65.536, "a counter of 16 bits of milliseconds"},
                                      {0.065536, "a counter of 16 bits of microseconds"},
                                      {4294967.296, "a counter of 32 bits of milliseconds"},
                                      {4294.967296, "a counter of 32 bits of microseconds"},
                                      {4.294967296, "a counter of 32 bits of nanoseconds"}};
/// The same of the file's numbers, whatever their unit.
constexpr TimeCounter kRawCounters[]{{65536.0, "a counter of 16 bits"},
                                     {16777216.0, "a counter of 24 bits"},
                                     {4294967296.0, "a counter of 32 bits"},
                                     {1e6, "a count of microseconds of the second"},
                                     {1e9, "a count of nanoseconds of the second"}};

}  // namespace

TimeOrder::TimeOrder(std::string name, double raw_unit_s, Pass pass, Refuse refuse)
    : name_(std::move(name)),
      raw_unit_s_(std::abs(raw_unit_s)),
      pass_(std::move(pass)),
      refuse_(std::move(refuse)) {}

double TimeOrder::time_of(const Row& row) const {
  return on_epoch_ ? start_s_ + row.stamp.since(start_) : row.raw_s + shift_s_;
}

double TimeOrder::after_last(const Row& row) const { return time_of(row) - last_s_; }

bool TimeOrder::repeats(const Row& row) const {
  const auto count = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(rows_, recent_s_.size()));
  return std::find(recent_s_.begin(), recent_s_.begin() + count, time_of(row)) != recent_s_.begin() + count;
}

/// As long as intervals between the last rows.
bool TimeOrder::usual(double interval_s) const {
  const std::size_t count = std::min<std::uint64_t>(rows_, recent_s_.size());
  if (count < 2) return true;
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (std::size_t k = 1; k < count; ++k) {
    const double d =
        recent_s_[(rows_ - k) % recent_s_.size()] - recent_s_[(rows_ - k - 1) % recent_s_.size()];
    low = std::min(low, d);
    high = std::max(high, d);
  }
  return interval_s >= (1.0 - kMargin) * low && interval_s <= (1.0 + kMargin) * high;
}

void TimeOrder::add(std::span<double> values, std::uint64_t line, double raw_s, const Stamp& stamp) {
  waiting_.push_back({{values.begin(), values.end()}, line, raw_s, stamp});
  if (rows_ == 0) {
    Row& first = waiting_.front();
    on_epoch_ = first.large();
    if (on_epoch_) {
      start_ = first.stamp;
      notes_.push_back(name_ + ": time_s counts from the first row, " + core::rounded(raw_s, 12) +
                       " s: seconds since the epoch with their fraction do not fit a number.");
    }
    first_s_ = time_of(first);
    pass_front(0.0);
    return;
  }
  resolve(false);
}

void TimeOrder::finish() { resolve(true); }

void TimeOrder::pass_front(double interval_s) {
  Row row = std::move(waiting_.front());
  waiting_.pop_front();
  const double time_s = time_of(row);
  count(time_s, row.raw_s, interval_s);
  pass_(row.values, row.line, time_s);
}

void TimeOrder::refuse_front(const std::string& why) {
  refuse_(waiting_.front(), why);
  waiting_.pop_front();
}

void TimeOrder::step_to_front(double step_s) {
  const Row& row = waiting_.front();
  ++steps_;
  if (notes_.size() < kNotes) {
    notes_.push_back(
        name_ + " line " + std::to_string(row.line) + ": time steps " + (step_s < 0.0 ? "back" : "forward") +
        " by " + core::rounded(std::abs(step_s), 7) +
        " s and goes on from there, as where the clock is set or another recording begins: the interval was left out.");
  }
  on_epoch_ = row.large();
  if (on_epoch_) {
    start_ = row.stamp;
    start_s_ = last_s_ + kUnknownInterval_s;
  } else {
    shift_s_ = last_s_ + kUnknownInterval_s - row.raw_s;
  }
  pass_front(0.0);
}

/// Where a counter wrapped before the row, time goes on over it.
bool TimeOrder::wraps(const Row& row) {
  constexpr double kLongest = 5.0;  // times the longest interval so far
  if (on_epoch_) return false;
  const double interval_s = after_last(row);
  const auto fits = [&](double span_s) {
    return interval_s < -0.5 * span_s && interval_s + span_s > 0.0 &&
           interval_s + span_s <= kLongest * longest_s_;
  };
  const auto go_on = [&](double span_s, const char* what) {
    shift_s_ += span_s;
    ++wraps_;
    if (notes_.size() < kNotes)
      notes_.push_back(name_ + " line " + std::to_string(row.line) + ": time goes back by " +
                       core::rounded(-interval_s, 7) + " s, as " + what +
                       " does that wraps: taken to go on.");
    return true;
  };
  for (const TimeCounter& c : kTimeCounters)
    if (fits(c.span_s)) return go_on(c.span_s, c.what);
  for (const TimeCounter& c : kRawCounters)
    if (fits(c.span_s * raw_unit_s_)) return go_on(c.span_s * raw_unit_s_, c.what);
  return false;
}

void TimeOrder::resolve(bool end) {
  while (!waiting_.empty()) {
    const Row& row = waiting_.front();
    const double interval_s = after_last(row);
    if (interval_s > 0.0 && interval_s <= kFarAhead * longest_s_) {
      pass_front(interval_s);
      continue;
    }
    if (interval_s > 0.0) {
      if (waiting_.size() < 2 && !end) return;
      if (waiting_.size() > 1 && after_last(waiting_[1]) > 0.0 && between(row, waiting_[1]) <= 0.0 &&
          rows_ > 1) {
        refuse_front(core::rounded(interval_s, 7) +
                     " s after the row before, and the next row goes back; expected time to increase");
        continue;
      }
      // Not where all rows are so far apart: nanoseconds called seconds.
      const bool alone =
          waiting_.size() < 2 || interval_s > kFarFromPace * std::abs(between(row, waiting_[1]));
      if (interval_s > kClockSet_s && alone && can_step())
        step_to_front(interval_s);
      else
        pass_front(interval_s);
      continue;
    }
    if (!resolve_back(end)) return;
  }
}

/// The first row that waits does not come after the last one. False: more rows must be seen.
bool TimeOrder::resolve_back(bool end) {
  const Row& row = waiting_.front();
  const double interval_s = after_last(row);
  if (wraps(row)) return true;
  const auto refuse = [&] {
    const double time_s = row.raw_s, before_s = last_raw_s_;
    refuse_front(core::shortest(time_s) + " s after " + core::shortest(before_s) +
                 " s in the row before; expected time to increase");
    return true;
  };
  std::size_t ahead = 1;  // the first that comes after the last row again
  while (ahead < waiting_.size() && !(after_last(waiting_[ahead]) > 0.0)) ++ahead;
  if (ahead < waiting_.size()) {
    bool at_pace = !repeats(row) && can_step();
    for (std::size_t k = 1; k <= ahead; ++k)
      at_pace = at_pace && usual(between(waiting_[k - 1], waiting_[k]));
    if (!at_pace) return refuse();
    step_to_front(interval_s);
    return true;
  }
  if (waiting_.size() < kLook && !end) return false;
  std::size_t increasing = 0;
  for (std::size_t k = 1; k < waiting_.size(); ++k)
    if (between(waiting_[k - 1], waiting_[k]) > 0.0) ++increasing;
  if (waiting_.size() < 3 || 2 * increasing < waiting_.size() || !can_step()) return refuse();
  step_to_front(interval_s);
  return true;
}

std::vector<std::string> TimeOrder::notes() const {
  std::vector<std::string> all = notes_;
  const std::size_t told = steps_ + wraps_ + (start_s_ == 0.0 && on_epoch_ ? 1 : 0);
  if (told > notes_.size())
    all.push_back(name_ + ": time steps or wraps at " + std::to_string(told - notes_.size()) + " more rows.");
  return all;
}

}  // namespace furcula::log
