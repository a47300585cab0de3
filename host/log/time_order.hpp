// Time that increases: what becomes of rows whose stamps do not.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/log/interval_median.hpp"
#include "host/log/stamp.hpp"

namespace furcula::log {

/// Between two rows of which it is not known how far they are apart. It is longer than any pause that a window may hold
/// (host/identify/recording.hpp, longest_pause_s: 50 ms or five rows).
inline constexpr double kUnknownInterval_s = 1.0;

/// Rows pass through in order. One whose time does not increase is refused where the rows about it say that it alone is wrong: repeated,
/// late, or far ahead. Where the rows after it go on from its time, the clock was set (or a counter wrapped, or a second recording begins):
/// time goes on kUnknownInterval_s later, after a wrap as if nothing had been.
class TimeOrder {
 public:
  struct Row {
    std::vector<double> values;
    std::uint64_t line;
    double raw_s;  ///< as the file says
    Stamp stamp;   ///< the same, where needs_stamp() asked for it
    bool large() const { return is_large_time(raw_s); }
  };
  /// A row in its turn, with its time.
  using Pass = std::function<void(std::span<double> values, std::uint64_t line, double time_s)>;
  /// One that is left out, and why.
  using Refuse = std::function<void(const Row& row, const std::string& why)>;

  /// `raw_unit_s`: what one of the time column's numbers is worth, for counters that wrap.
  TimeOrder(std::string name, double raw_unit_s, Pass pass, Refuse refuse);

  /// Whether the stamp of a row of this time is needed, beside the number.
  bool needs_stamp(double raw_s) const { return on_epoch_ || is_large_time(raw_s); }

  /// A row that simply follows the last one, as nearly all do: true, and `time_s` is its time. Else it must be added.
  bool follows(double raw_s, const Stamp& stamp, double& time_s) {
    if (!waiting_.empty() || rows_ < 2) return false;
    time_s = on_epoch_ ? start_s_ + stamp.since(start_) : raw_s + shift_s_;
    const double interval_s = time_s - last_s_;
    if (!(interval_s > 0.0 && interval_s <= 2.0 * longest_s_)) return false;
    count(time_s, raw_s, interval_s);
    return true;
  }
  /// Any other. It and those that waited for it are passed or refused, or it waits.
  void add(std::span<double> values, std::uint64_t line, double raw_s, const Stamp& stamp);
  /// After the last row.
  void finish();

  std::uint64_t rows() const { return rows_; }
  double duration_s() const { return last_s_ - first_s_ - static_cast<double>(steps_) * kUnknownInterval_s; }
  double shortest_s() const { return shortest_s_; }
  double longest_s() const { return longest_s_; }
  const IntervalMedian& intervals() const { return intervals_; }
  std::size_t steps() const { return steps_; }
  /// What was done to time, in sentences.
  std::vector<std::string> notes() const;

 private:
  void count(double time_s, double raw_s, double interval_s) {
    if (interval_s > 0.0) {
      intervals_.add(interval_s);
      shortest_s_ = shortest_s_ == 0.0 || interval_s < shortest_s_ ? interval_s : shortest_s_;
      longest_s_ = interval_s > longest_s_ ? interval_s : longest_s_;
    }
    last_s_ = time_s;
    last_raw_s_ = raw_s;
    recent_s_[rows_ % recent_s_.size()] = time_s;
    ++rows_;
  }
  void resolve(bool end);
  bool resolve_back(bool end);
  bool can_step() const { return last_s_ + kUnknownInterval_s > last_s_; }
  bool wraps(const Row& row);
  void pass_front(double interval_s);
  void refuse_front(const std::string& why);
  void step_to_front(double step_s);
  double time_of(const Row& row) const;
  double after_last(const Row& row) const;
  bool repeats(const Row& row) const;
  bool usual(double interval_s) const;

  std::string name_;
  double raw_unit_s_;
  Pass pass_;
  Refuse refuse_;
  std::deque<Row> waiting_;
  std::uint64_t rows_ = 0;
  double first_s_ = 0.0, last_s_ = 0.0, last_raw_s_ = 0.0;
  std::array<double, 16> recent_s_{};
  double shortest_s_ = 0.0, longest_s_ = 0.0;
  IntervalMedian intervals_;
  double shift_s_ = 0.0;   ///< of small times
  bool on_epoch_ = false;  ///< times began beyond kLargeTime_s: since start_, and from start_s_ on
  Stamp start_;
  double start_s_ = 0.0;
  std::size_t steps_ = 0, wraps_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace furcula::log
