#include "host/identify/windows.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/identify/contact_switch.hpp"
#include "host/identify/simulate.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

using machines::Cut;

constexpr double kSmallestHop_m = 3e-3;
constexpr double kShortestPhase_s = 0.03;
constexpr double kAfterTouchdown_s = 0.015;
constexpr double kAfterLiftoff_s = 0.007;
constexpr double kStart_s = 0.05;
constexpr double kLongestGap = 0.2;  // of a window's length
constexpr double kLongestPause_s = 0.05;

/// A stretch of rows in the air: [first, last] above the touch-down height, or with the toe of a folded leg
/// off the ground.
struct Flight {
  std::size_t first, last, apex;
  bool starts_here, ends_here;  ///< the recording starts (ends) in it
};

bool in_air(const Recording& r, std::size_t row, double straight_m) {
  return r.position[row] > r.touchdown_height_m(row, straight_m);
}

std::vector<Flight> find_flights(const Recording& r, double touchdown_height) {
  std::vector<Flight> found;
  const std::size_t n = r.rows();
  for (std::size_t i = 0; i < n;) {
    if (!in_air(r, i, touchdown_height)) {
      ++i;
      continue;
    }
    std::size_t last = i;
    while (last + 1 < n && in_air(r, last + 1, touchdown_height)) ++last;
    // The quantised top is flat: its middle is the apex.
    const auto begin = r.position.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = r.position.begin() + static_cast<std::ptrdiff_t>(last) + 1;
    const double top = *std::max_element(begin, end);
    double weight = 0.0, moment = 0.0;
    for (std::size_t k = i; k <= last; ++k)
      if (r.position[k] > top - 2e-4) {
        weight += 1.0;
        moment += static_cast<double>(k);
      }
    bool hops = top > touchdown_height + kSmallestHop_m;
    if (!r.leg_length.empty())
      for (std::size_t k = i; k <= last && !hops; ++k)
        hops = r.position[k] > r.leg_length[k] + kSmallestHop_m;
    if (hops && r.time_s[last] - r.time_s[i] > kShortestPhase_s)
      found.push_back(
          {i, last, static_cast<std::size_t>(std::lround(moment / weight)), i == 0, last + 1 == n});
    i = last + 1;
  }
  return found;
}

/// Without the windows that hold rows which no model follows.
std::vector<Window> without_unfollowed(std::vector<Window> windows, const Recording& r) {
  if (r.not_followed.empty()) return windows;
  std::erase_if(windows, [&](const Window& w) {
    return std::any_of(r.not_followed.begin() + static_cast<std::ptrdiff_t>(w.first),
                       r.not_followed.begin() + static_cast<std::ptrdiff_t>(w.last) + 1,
                       [](char why) { return why != 0; });
  });
  return windows;
}

/// And without those that hold a pause, rows further apart than a model can be trusted to bridge.
std::vector<Window> without_pauses(std::vector<Window> windows, const Recording& r) {
  std::erase_if(windows, [&](const Window& w) {
    for (std::size_t i = w.first; i < w.last; ++i)
      if (r.time_s[i + 1] - r.time_s[i] > kLongestPause_s) return true;
    return false;
  });
  return without_unfollowed(std::move(windows), r);
}

bool is_apex(const Flight& f) {
  if (f.starts_here && f.apex < 5) return true;  // dropped from rest
  return f.apex > f.first + 2 && f.apex + 2 < f.last;
}

}  // namespace

std::vector<Window> strides(const Recording& r, std::size_t index, const model::Model& model) {
  std::vector<Window> found;
  const std::vector<Flight> all = find_flights(r, machines::touchdown_height_m(model));
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    if (!is_apex(all[i]) || !is_apex(all[i + 1])) continue;
    const std::size_t first = all[i].starts_here && all[i].apex < 5 ? 0 : all[i].apex;
    found.push_back({index, first, all[i + 1].apex, WindowKind::stride, all[i].last + 1, all[i + 1].first});
  }
  return without_pauses(std::move(found), r);
}

std::vector<Window> stances(const Recording& r, std::size_t index, const model::Model& model) {
  std::vector<Window> found;
  const double touchdown = machines::touchdown_height_m(model);
  const std::size_t n = r.rows();
  for (std::size_t i = 0; i < n;) {
    if (in_air(r, i, touchdown)) {
      ++i;
      continue;
    }
    std::size_t last = i;
    while (last + 1 < n && !in_air(r, last + 1, touchdown)) ++last;
    std::size_t first = i;
    if (i > 0)
      while (first < last && r.time_s[first] < r.time_s[i] + kAfterTouchdown_s) ++first;
    std::size_t end = last;
    if (last + 1 < n)
      while (end > first && r.time_s[end] > r.time_s[last] - kAfterLiftoff_s) --end;
    if (r.time_s[end] - r.time_s[first] > kShortestPhase_s)
      found.push_back({index, first, end, WindowKind::stance, 0, 0});
    i = last + 1;
  }
  return without_pauses(std::move(found), r);
}

std::vector<Window> flights(const Recording& r, std::size_t index, const model::Model& model) {
  std::vector<Window> found;
  for (const Flight& f : find_flights(r, machines::touchdown_height_m(model))) {
    std::size_t first = f.first;
    if (!f.starts_here)
      while (first < f.last && r.time_s[first] < r.time_s[f.first] + kAfterLiftoff_s) ++first;
    std::size_t last = f.last;
    // The smoothed velocity looks 6 ms ahead: not into the impact.
    if (!f.ends_here)
      while (last > first && r.time_s[last] > r.time_s[f.last] - kAfterLiftoff_s) --last;
    if (r.time_s[last] - r.time_s[first] > kShortestPhase_s)
      found.push_back({index, first, last, WindowKind::flight, 0, 0});
  }
  return without_pauses(std::move(found), r);
}

namespace {

/// The least time in which a flight shows: what falls with a quarter of gravity at least, dry friction taking the rest, stays within so many
/// deviations of its encoder's noise no longer than about its apex. Of an encoder without noise, two rows about the apex are no rest.
constexpr double kNoises = 8.0;
double apex_s(const Recording& r, double gravity_mps2) {
  constexpr double kOfGravity = 0.25;
  const double fall_s =
      std::sqrt(2.0 * kNoises * r.position_noise / (kOfGravity * std::max(gravity_mps2, 1e-3)));
  return std::max(kShortestPhase_s, 2.0 * fall_s);
}

/// Marks rows of a carriage at rest: held by a hand, hung up, on its stop.
void mark_rest(const Recording& r, double least_s, const std::vector<bool>& touches,
               std::vector<bool>& marks) {
  // Each row's longest stretch without a position further away, by the rows of least and most position in it.
  std::deque<std::size_t> least, most;
  std::size_t first = 0, marked = 0;
  for (std::size_t last = 0; last < r.rows(); ++last) {
    if (touches[last]) {
      least.clear();
      most.clear();
      first = last + 1;
      continue;
    }
    while (!least.empty() && r.position[least.back()] >= r.position[last]) least.pop_back();
    while (!most.empty() && r.position[most.back()] <= r.position[last]) most.pop_back();
    least.push_back(last);
    most.push_back(last);
    while (r.position[most.front()] - r.position[least.front()] > kNoises * r.position_noise) {
      ++first;
      if (least.front() < first) least.pop_front();
      if (most.front() < first) most.pop_front();
    }
    if (r.time_s[last] - r.time_s[first] <= least_s) continue;
    for (marked = std::max(marked, first); marked <= last; ++marked) marks[marked] = true;
  }
}

/// Marks rows in which it is pushed: nothing else makes it rise faster and faster.
void mark_push(const Recording& r, double least_s, const std::vector<bool>& touches,
               std::vector<bool>& marks) {
  // Standard deviations of a position's distance from the chord of two others, each sqrt(1.5) times the noise.
  constexpr double kSurely = 4.0;
  const double clear_m = kSurely * std::sqrt(1.5) * r.position_noise;
  std::size_t middle = 0, last = 0, touched = 0;  // the last row so far that touches, counted from 1
  bool before = false;                            // one row alone may be wrong
  for (std::size_t first = 0; first < r.rows(); ++first) {
    while (middle < r.rows() && r.time_s[middle] - r.time_s[first] < 0.5 * least_s) ++middle;
    for (; last < r.rows() && r.time_s[last] - r.time_s[first] < least_s; ++last)
      if (touches[last]) touched = last + 1;
    if (last == r.rows()) return;
    const double whole_s = r.time_s[last] - r.time_s[first], whole_m = r.position[last] - r.position[first],
                 chord_m = r.position[first] + whole_m * (r.time_s[middle] - r.time_s[first]) / whole_s;
    const bool pushed = touched <= first && !touches[last] && whole_s <= 2.0 * least_s && whole_m > 0.0 &&
                        chord_m - r.position[middle] > clear_m;
    for (std::size_t row = first - 1; pushed && before && row <= middle; ++row) marks[row] = true;
    before = pushed;
  }
}

}  // namespace

std::vector<Window> free_flights(const Recording& r, std::size_t index, double gravity_mps2) {
  constexpr std::size_t kFewestRows = 6;
  std::vector<Window> found;
  const std::size_t n = r.rows();
  std::vector<bool> touches(n, false), held(n, false);
  for (std::size_t i = 0; i < n && !r.contact.empty(); ++i) touches[i] = r.contact[i] != 0.0;
  mark_rest(r, apex_s(r, gravity_mps2), touches, held);
  mark_push(r, apex_s(r, gravity_mps2), touches, held);
  const auto flies = [&](std::size_t i) { return !touches[i] && !held[i]; };
  for (std::size_t first = 0; first < n; ++first) {
    if (!flies(first)) continue;
    std::size_t last = first;
    while (last + 1 < n && flies(last + 1) && r.time_s[last + 1] - r.time_s[last] <= kLongestPause_s) ++last;
    if (last - first + 1 >= kFewestRows && r.time_s[last] - r.time_s[first] >= kShortestPhase_s)
      found.push_back({index, first, last, WindowKind::flight, 0, 0});
    first = last;
  }
  return found;
}

std::vector<Window> releases(const Recording& r, std::size_t index) {
  constexpr double kRest_s = 0.05, kAfterwards_s = 0.25;
  constexpr std::size_t kFewestRows = 3;
  std::vector<Window> found;
  const auto on = [&](std::size_t i) { return r.input[i] != 0.0; };
  const std::size_t n = r.rows();
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < n; ++i) intervals_s.push_back(r.time_s[i] - r.time_s[i - 1]);
  const double usual_s = core::median(intervals_s);
  std::size_t free = 0;  // the first row that no earlier release needs
  for (std::size_t i = 1; i < n; ++i) {
    if (!on(i) || on(i - 1)) continue;
    std::size_t first = i, off = i;
    while (first > free && r.time_s[i] - r.time_s[first - 1] <= kRest_s && !on(first - 1)) --first;
    while (off < n && on(off)) ++off;
    if (off == n) break;  // not switched off any more
    std::size_t last = off;
    while (last + 1 < n && !on(last + 1) && r.time_s[last + 1] - r.time_s[off] <= kAfterwards_s) ++last;
    // Switched within a gap it is not known when: such a release is left out.
    const auto known = [&](std::size_t row) { return r.time_s[row] - r.time_s[row - 1] < 1.5 * usual_s; };
    if (known(i) && known(off) && i - first >= kFewestRows &&
        r.time_s[last] - r.time_s[off] >= kShortestPhase_s)
      found.push_back({index, first, last, WindowKind::release, i, off});
    free = off;
    i = last;
  }
  return without_pauses(std::move(found), r);
}

namespace {

/// A recording that begins under a command does not say since when: how long a drive's delay or lag may show that.
double unknown_past_s(const Recording& r) {
  constexpr double kDriveMemory_s = 0.1, kCommanded = 0.1;
  if (r.input.empty()) return 0.0;
  double squares = 0.0;
  for (const double u : r.input) squares += u * u;
  const double rms = std::sqrt(squares / static_cast<double>(r.input.size()));
  return std::abs(r.input.front()) > kCommanded * rms ? kDriveMemory_s : 0.0;
}

}  // namespace

std::vector<Window> intervals(const Recording& r, std::size_t index, double length_s, double from_s) {
  std::vector<Window> found;
  const std::size_t n = r.rows();
  const double longest_s = std::min(kLongestGap * length_s, longest_pause_s(r.time_s));
  std::size_t first = 0;
  from_s += unknown_past_s(r);
  while (first < n && r.time_s[first] < r.time_s[0] + from_s) ++first;
  while (first + 1 < n) {
    std::size_t last = first;
    while (last + 1 < n && r.time_s[last + 1] <= r.time_s[first] + length_s &&
           r.time_s[last + 1] - r.time_s[last] <= longest_s)
      ++last;
    if (last - first < 5 || r.time_s[last] - r.time_s[first] < 0.5 * length_s) {
      first = last + 1;  // a pause, or the end
      continue;
    }
    found.push_back({index, first, last, WindowKind::interval, 0, 0});
    first = last;
  }
  return found;
}

namespace {

/// Fills in the lags of the contact reports, and their spread over all windows (median absolute deviation, at
/// least what the sample interval lets one see).
void attach_reports(std::vector<Window>& windows, const std::vector<Recording>& recordings, double height_m) {
  std::vector<double> lags;
  double interval_s = 0.0;
  for (Window& w : windows) {
    const Recording& r = recordings[w.recording];
    const std::size_t i = w.touchdown;
    if (i == 0 || i >= r.rows()) continue;
    const double from_m = r.position[i - 1] - r.touchdown_height_m(i - 1, height_m),
                 to_m = r.position[i] - r.touchdown_height_m(i, height_m);
    const double fall = r.leg_length.empty() ? r.position[i - 1] - r.position[i] : from_m - to_m;
    const double share = fall > 0.0 ? from_m / fall : 0.5;
    const double crossing_s = r.time_s[i - 1] + share * (r.time_s[i] - r.time_s[i - 1]);
    const std::size_t before = i > 4 ? i - 4 : 0;  // clear of the impact
    w.touchdown_velocity = r.velocity_smoothed[before];
    interval_s = std::max(interval_s, r.time_s[i] - r.time_s[i - 1]);
    double best = kLongestReportDelay_s;
    for (double report : r.touchdown_reports_s)
      if (std::abs(report - crossing_s) < std::abs(best)) best = report - crossing_s;
    if (std::abs(best) < kLongestReportDelay_s) lags.push_back(w.report_lag_s = best);
  }
  if (lags.empty()) return;
  const double centre = core::median(lags);
  for (double& lag : lags) lag = std::abs(lag - centre);
  const double spread = std::max(1.4826 * core::median(lags), interval_s / std::sqrt(12.0));
  for (Window& w : windows) w.report_spread_s = spread;
}

/// A recording that never leaves the ground and moves there: a slow compression, a swing.
bool moves_on_the_ground(const Recording& r, const model::Model& model) {
  constexpr double kSmallestMotion_m = 3e-3;
  const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
  const bool hops = *high > machines::touchdown_height_m(model) + kSmallestHop_m || !r.leg_length.empty();
  const double moved_m = *high - *low;
  return !hops && moved_m > kSmallestMotion_m;
}

/// The windows of one recording.
std::vector<Window> cut(const Recording& r, std::size_t index, const model::Model& model, double interval_s) {
  switch (machines::rules(model.kind).cut) {
    case Cut::strides:
      if (moves_on_the_ground(r, model)) break;
      return strides(r, index, model);
    case Cut::flights:
      return free_flights(r, index, model.parameter("gravity_mps2"));
    case Cut::releases:
      return releases(r, index);
    case Cut::intervals:
      break;
  }
  return without_unfollowed(intervals(r, index, interval_s), r);  // which end at pauses
}

}  // namespace

std::vector<Window> prediction_windows(const std::vector<Recording>& recordings, const model::Model& model,
                                       double interval_s) {
  std::vector<Window> all;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const auto some = cut(recordings[i], i, model, interval_s);
    all.insert(all.end(), some.begin(), some.end());
  }
  if (machines::rules(model.kind).cut == Cut::strides)
    attach_reports(all, recordings, machines::touchdown_height_m(model));
  return all;
}

namespace {

/// How far the leg turned, going by the height, while its encoder stood at one reading; 0 for fewer rows
/// than 20.
double turned_at(double reading, const std::vector<double>& angle, const std::vector<double>& by_height) {
  constexpr int kFewest = 20;
  int rows = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    if (angle[i] != reading) continue;
    ++rows;
    low = std::min(low, by_height[i]);
    high = std::max(high, by_height[i]);
  }
  return rows < kFewest ? 0.0 : high - low;
}

bool plausible_leg_angle(Recording& r, const model::Model& model) {
  constexpr double kFewest = 20.0;
  constexpr double kDegrees = 180.0 / std::numbers::pi, kAbout = 0.3;
  constexpr double kLeastSlope = 0.3, kMostSlope = 3.0;  // a backlash as wide as half the travel stays within
  constexpr double kFolded_rad = 0.03;                   // at the highest reading
  constexpr double kStraight_rad = 0.1;  // at the lowest, where a height that is measured wrongly shows, too
  const double length = 2.0 * model.parameter("link_length_m"), stop = model.parameter("touchdown_angle_rad");
  const double top = machines::touchdown_height_m(model);
  std::vector<double> by_height(r.rows(), stop);
  double rows = 0.0, height_sum = 0.0, angle_sum = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const bool folded = !r.leg_length.empty() && in_air(r, i, top);
    if (folded) by_height[i] = std::acos(std::clamp(r.leg_length[i] / length, -1.0, 1.0));
    if (folded || r.position[i] >= top) continue;
    by_height[i] = std::acos(std::clamp(r.position[i] / length, -1.0, 1.0));
    rows += 1.0;
    height_sum += by_height[i];
    angle_sum += r.leg_angle[i];
  }
  if (rows < kFewest) return false;
  double square = 0.0, product = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.position[i] >= top || (!r.leg_length.empty() && in_air(r, i, top))) continue;
    const double from_mean = by_height[i] - height_sum / rows;
    square += from_mean * from_mean;
    product += from_mean * (r.leg_angle[i] - angle_sum / rows);
  }
  if (std::abs(product / (kDegrees * square) - 1.0) < kAbout)
    r.notes.push_back(
        r.name + ": " + std::string(machines::rules(r.kind).columns.leg_angle) + " moves " +
        core::rounded(product / square, 3) +
        " times as much as the height says, as degrees would: it is not looked at (a --map file with "
        "scale = 0.0174533 makes radians).");
  const auto [low, high] = std::minmax_element(r.leg_angle.begin(), r.leg_angle.end());
  return product > kLeastSlope * square && product < kMostSlope * square &&
         turned_at(*high, r.leg_angle, by_height) < kFolded_rad &&
         turned_at(*low, r.leg_angle, by_height) < kStraight_rad;
}

}  // namespace

void keep_plausible_leg_angles(std::vector<Recording>& recordings, const model::Model& model) {
  for (Recording& r : recordings)
    if (!r.leg_angle.empty() && !plausible_leg_angle(r, model)) r.leg_angle.clear();
}

TrainingWindows training_windows(const std::vector<Recording>& recordings, const model::Model& model,
                                 double interval_s) {
  constexpr std::size_t kEnough = 24;
  constexpr std::size_t kMostLayers = 4;
  TrainingWindows t;
  t.windows = prediction_windows(recordings, model, interval_s);
  if (machines::rules(model.kind).cut != Cut::intervals || t.windows.empty()) return t;
  t.layers = std::clamp<std::size_t>((kEnough + t.windows.size() - 1) / t.windows.size(), 1, kMostLayers);
  for (std::size_t layer = 1; layer < t.layers; ++layer)
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      const double from_s = interval_s * static_cast<double>(layer) / static_cast<double>(t.layers);
      const auto more = without_unfollowed(intervals(recordings[i], i, interval_s, from_s), recordings[i]);
      t.windows.insert(t.windows.end(), more.begin(), more.end());
    }
  // In the order of their begin, so that folds are stretches of a recording.
  std::stable_sort(t.windows.begin(), t.windows.end(), [](const Window& a, const Window& b) {
    return a.recording != b.recording ? a.recording < b.recording : a.first < b.first;
  });
  return t;
}

namespace {

/// The last row of the window's first 50 ms, or tenth; at least three rows.
std::size_t start_rows_end(const Recording& r, const Window& w) {
  const double span = std::min(kStart_s, 0.1 * (r.time_s[w.last] - r.time_s[w.first]));
  std::size_t last = w.first;
  while (last < w.last && r.time_s[last + 1] <= r.time_s[w.first] + span) ++last;
  // Not across a jump of the encoder.
  for (const Slip& slip : r.slips)
    if (slip.row > w.first && slip.row <= last) last = slip.row - 1;
  return std::max(last, std::min(w.last, w.first + 2));
}

/// What the noise alone leaves at most, of a start's variance.
constexpr double kNoMoreThanNoise = 2.5;

/// About the time `at_s` the lowest order that leaves no more than the measuring noise: more would let the noise into the start's
/// velocity, less would bias it where the force changes within the stretch. An order wants three rows more
/// than its terms.
LocalPolynomial start_polynomial(const std::vector<double>& time_s, const std::vector<double>& values,
                                 std::size_t first, std::size_t last, double at_s, double noise) {
  const std::size_t rows = last - first + 1;
  LocalPolynomial p = local_polynomial(time_s, values, first, last, at_s, rows >= 5 ? 2 : 1);
  const double enough = kNoMoreThanNoise * noise * noise;
  for (int order = 3;
       order <= 4 && rows >= static_cast<std::size_t>(order) + 4 && p.residual_variance > enough; ++order)
    p = local_polynomial(time_s, values, first, last, at_s, order);
  return p;
}

/// The same about the first row, surviving a wrong one: where the rows leave far more than noise, and without one of them noise alone,
/// that one is no part of the motion. What a machine does would take several rows.
LocalPolynomial robust_start(const std::vector<double>& time_s, const std::vector<double>& values,
                             std::size_t first, std::size_t last, double noise) {
  constexpr double kFarOut = 3.0;
  constexpr std::size_t kFewest = 6;
  const double at_s = time_s[first];
  const LocalPolynomial all = start_polynomial(time_s, values, first, last, at_s, noise);
  if (last - first + 1 < kFewest || !(all.residual_variance > std::pow(kFarOut * noise, 2))) return all;
  LocalPolynomial best = all;
  for (std::size_t leave = first; leave <= last; ++leave) {
    std::vector<double> t, x;
    for (std::size_t i = first; i <= last; ++i)
      if (i != leave) {
        t.push_back(time_s[i]);
        x.push_back(values[i]);
      }
    const LocalPolynomial p = start_polynomial(t, x, 0, t.size() - 1, at_s, noise);
    if (p.residual_variance < best.residual_variance) best = p;
  }
  return best.residual_variance <= kNoMoreThanNoise * noise * noise ? best : all;
}

StartState rest_before(const Recording& r, const Window& w) {
  StartState s;
  const auto rows = static_cast<double>(w.touchdown - w.first);
  for (std::size_t i = w.first; i < w.touchdown; ++i) s.position += r.position[i] / rows;
  s.position_variance = 1.0 / rows;
  return s;
}

}  // namespace

StartState start_state(const Recording& r, const Window& w) {
  if (w.kind == WindowKind::release) return rest_before(r, w);
  const LocalPolynomial p =
      robust_start(r.time_s, r.position, w.first, start_rows_end(r, w), r.position_noise);
  return {p.value, p.slope, p.value_variance, p.slope_variance, p.covariance};
}

StartState start_state(const Recording& r, const Window& w, const model::Model& reference) {
  if (w.kind == WindowKind::release) return rest_before(r, w);
  const StartState first = start_state(r, w);
  Window start = w;
  start.last = start_rows_end(r, w);
  std::vector<double> time_s, left;
  simulate(PlantSetup<double>(reference, {}, nullptr), r, start, first.position, first.velocity,
           [&](std::size_t row, double position, double, double, const auto&) {
             time_s.push_back(r.time_s[row]);
             left.push_back(r.position[row] - position);
           });
  const LocalPolynomial p = robust_start(time_s, left, 0, left.size() - 1, r.position_noise);
  return {first.position + p.value, first.velocity + p.slope, p.value_variance, p.slope_variance,
          p.covariance};
}

}  // namespace furcula::identify
