// See manoeuvres.hpp.
#include "host/identify/manoeuvres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/identify/windows.hpp"
#include "host/machines/hopper.hpp"

namespace furcula::identify {
namespace {

/// In the order of Recording::not_followed.
enum Why : char { followed, spring_away, leg_unseen };
constexpr std::array<const char*, 2> kWhy{
    "the spring is let go, or held elsewhere than with the leg straight, and the model has no clutch "
    "(tooth_pitch_m above 0)",
    "the motor drives the leg in flight with the spring let go, and no leg_angle_rad that follows the height in "
    "stance says where it was"};

/// No key is out so soon after its coil is switched on.
constexpr double kAtOnce_s = 5e-3;

/// Rows [first, last].
struct Rows {
  std::size_t first, last;
};

double median_over(const std::vector<double>& values, const Rows& rows) {
  return core::median({values.begin() + static_cast<std::ptrdiff_t>(rows.first),
                       values.begin() + static_cast<std::ptrdiff_t>(rows.last) + 1});
}

/// Stretches that the contact switch reports as stances: without its bounces, and none that is shorter than a
/// stance can be.
std::vector<Rows> reported_stances(const Recording& r) {
  constexpr double kBounce_s = 0.015, kShortest_s = 0.03;
  std::vector<Rows> found;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.on_ground[i] == 0.0) continue;
    if (found.empty() || r.time_s[i] - r.time_s[found.back().last] > kBounce_s)
      found.push_back({i, i});
    else
      found.back().last = i;
  }
  std::erase_if(found, [&](const Rows& s) { return r.time_s[s.last] - r.time_s[s.first] < kShortest_s; });
  return found;
}

/// Its middle half: in stance, however late or early the switch is.
Rows middle(const Rows& s) {
  const std::size_t quarter = (s.last - s.first) / 4;
  return {s.first + quarter, s.last - quarter};
}

class Manoeuvres {
 public:
  Manoeuvres(Recording& r, const model::Model& model)
      : r_(r),
        has_clutch_(model::has_clutch(model)),
        reach_m_(2.0 * model.parameter("link_length_m")),
        stop_rad_(model.parameter("touchdown_angle_rad")),
        straight_m_(machines::touchdown_height_m(model)) {}

  void follow() {
    if (r_.on_ground.empty()) return;
    stances_ = reported_stances(r_);
    if (stances_.empty()) return;
    flies_.resize(r_.rows());
    for (std::size_t i = 0; i < r_.rows(); ++i) flies_[i] = r_.position[i] > straight_m_;
    const bool seen = see_leg();
    if (seen) {
      find_flights();
      if (folds()) lead_leg();
    }
    if (r_.leg_length.empty()) mark_unseen(seen);
    if (!has_clutch_ && !r_.solenoid.empty()) mark_spring();
    if (has_clutch_ && !r_.cable.empty()) forget_releases();
  }

 private:
  /// The leg's length by its encoder; false where that does not follow the height in stance.
  bool see_leg() {
    constexpr double kFollows = 0.35;  // of the height's own way; of a skew of 10 ms a fifth is left
    constexpr double kZero_rad = 5e-3, kOnStop_rad = 0.01;
    if (r_.leg_angle.empty()) return false;
    std::vector<double> in_flight;
    for (std::size_t i = 0; i < r_.rows(); ++i)
      if (r_.on_ground[i] == 0.0) in_flight.push_back(r_.leg_angle[i]);
    if (in_flight.empty()) return false;
    const double least = core::quantile(in_flight, 0.02);
    std::erase_if(in_flight, [&](double angle) { return angle > least + kOnStop_rad; });
    double zero = core::median(in_flight) - stop_rad_;
    if (std::abs(zero) < kZero_rad) zero = 0.0;
    for (double angle : r_.leg_angle) length_.push_back(reach_m_ * std::cos(angle - zero));
    std::vector<double> toe, height;
    for (const Rows& s : stances_) {
      const Rows m = middle(s);
      levels_.push_back(level_in(m));
      spreads_.push_back(spread_in(m));
      const double height_m = median_over(r_.position, m);
      for (std::size_t i = m.first; i <= m.last; ++i) {
        toe.push_back(std::abs(r_.position[i] - length_[i] - levels_.back()));
        height.push_back(std::abs(r_.position[i] - height_m));
      }
    }
    return core::median(toe) < kFollows * core::median(height);
  }

  /// Of the toe, by the height above the leg's length: the ground under this stance, and what is off in either.
  double level_in(const Rows& rows) const {
    std::vector<double> toe;
    for (std::size_t i = rows.first; i <= rows.last; ++i) toe.push_back(r_.position[i] - length_[i]);
    return core::median(toe);
  }

  /// By how much it varies there, as a wrong scale of the height, or a leg that gives, make it.
  double spread_in(const Rows& rows) const {
    std::vector<double> toe;
    for (std::size_t i = rows.first; i <= rows.last; ++i) toe.push_back(r_.position[i] - length_[i]);
    std::sort(toe.begin(), toe.end());
    const std::size_t twentieth = toe.size() / 20;
    return toe[toe.size() - 1 - twentieth] - toe[twentieth];
  }

  /// From where the toe is highest between two stances to either side, up to where it is down.
  void find_flights() {
    constexpr double kOffGround_m = 5e-4;
    const std::size_t n = r_.rows();
    const auto toe = [&](std::size_t i) { return r_.position[i] - length_[i]; };
    for (std::size_t k = 0; k <= stances_.size(); ++k) {
      const std::size_t from = k == 0 ? 0 : middle(stances_[k - 1]).last + 1;
      const std::size_t to = k == stances_.size() ? n : middle(stances_[k]).first;  // the first row after
      if (from >= to) continue;
      std::size_t top = from;
      for (std::size_t i = from; i < to; ++i)
        if (toe(i) > toe(top)) top = i;
      const std::size_t b = k == 0 ? 0 : k - 1, a = std::min(k, levels_.size() - 1);
      const double before = levels_[b] + spreads_[b] + kOffGround_m;
      const double after = levels_[a] + spreads_[a] + kOffGround_m;
      if (!(toe(top) > std::max(before, after))) continue;
      Rows f{top, top};
      while (f.first > from && toe(f.first - 1) > before) --f.first;
      while (f.last + 1 < to && toe(f.last + 1) > after) ++f.last;
      flights_.push_back(f);
    }
    std::fill(flies_.begin(), flies_.end(), false);
    for (const Rows& f : flights_)
      std::fill(flies_.begin() + static_cast<std::ptrdiff_t>(f.first),
                flies_.begin() + static_cast<std::ptrdiff_t>(f.last) + 1, true);
  }

  /// Whether the motor folds the leg in any flight. What a backlash does is no fold: there nothing drives it.
  bool folds() const {
    constexpr double kFolded_rad = 0.05, kDriven = 0.9, kClear_m = 0.01;
    constexpr std::size_t kRows = 20;
    const double folded_m = reach_m_ * std::cos(stop_rad_ + kFolded_rad);
    const double level_m = core::median(levels_);
    for (const Rows& f : flights_) {
      std::size_t rows = 0, driven = 0;
      for (std::size_t i = f.first; i <= f.last; ++i) {
        const bool now = length_[i] < folded_m && r_.on_ground[i] == 0.0 &&
                         r_.position[i] - length_[i] > level_m + kClear_m;
        rows = now ? rows + 1 : 0;
        driven = now ? driven + (r_.input[i] != 0.0) : 0;
        if (rows >= kRows &&
            (!r_.solenoid.empty() || static_cast<double>(driven) >= kDriven * static_cast<double>(rows)))
          return true;
      }
    }
    return false;
  }

  void lead_leg() {
    constexpr double kSlope_s = 6e-3, kSwings_s = 0.015, kOnStop_m = 5e-4;
    const std::size_t n = r_.rows();
    r_.leg_length.assign(n, straight_m_);
    for (const Rows& f : flights_) {
      std::size_t first = f.first;
      // A leg that leaves the ground early swings to its stop: that is part of the lift-off.
      if (first > 0) {
        std::size_t at = first;
        while (at < f.last && r_.time_s[at] - r_.time_s[first] < kSwings_s &&
               length_[at] < straight_m_ - kOnStop_m)
          ++at;
        if (length_[at] >= straight_m_ - kOnStop_m) first = at;
      }
      for (std::size_t i = first; i <= f.last; ++i) {
        std::size_t a = i, b = i;
        while (a > first && r_.time_s[i] - r_.time_s[a - 1] <= kSlope_s) --a;
        while (b < f.last && r_.time_s[b + 1] - r_.time_s[i] <= kSlope_s) ++b;
        const double smooth =
            b - a >= 4 ? local_polynomial(r_.time_s, length_, a, b, r_.time_s[i], 2).value : length_[i];
        r_.leg_length[i] = std::min(smooth, straight_m_);
      }
      if (f.last + 1 == n) continue;
      land(f);
    }
  }

  /// What the leg was at touch-down stays up to the lowest point of the stance: a body that a model lets fall
  /// later lands on the same leg.
  void land(const Rows& f) {
    constexpr double kVibrates_s = 0.015;
    const std::size_t n = r_.rows(), touchdown = f.last + 1;
    std::size_t before = f.last;
    while (before > f.first && f.last - before < 6) --before;
    double length = r_.leg_length[f.last];
    // The last row may have the toe on the ground.
    if (f.last - before >= 4)
      length = local_polynomial(r_.time_s, length_, before, f.last - 1, r_.time_s[f.last], 1).value;
    length = std::min(length, straight_m_);
    r_.leg_length[f.last] = length;
    for (std::size_t i = touchdown; i < n && !flies_[i]; ++i) {
      r_.leg_length[i] = length;
      if (r_.time_s[i] - r_.time_s[touchdown] < kVibrates_s) continue;
      const std::size_t ahead = std::min(n - 1, i + 5);
      if (r_.position[ahead] > r_.position[i]) break;
    }
  }

  /// Flights in which the leg is driven with the coil on, of which nothing says where it was.
  void mark_unseen(bool seen) {
    constexpr double kDriven_s = 0.04;
    if (seen || r_.solenoid.empty()) return;
    for_each_run(true, [&](const Rows& f) {
      bool let_go = false;
      double driven_s = 0.0;
      for (std::size_t i = f.first; i < f.last; ++i) {
        let_go = let_go || r_.solenoid[i] != 0.0;
        if (let_go && r_.input[i] != 0.0) driven_s += r_.time_s[i + 1] - r_.time_s[i];
      }
      if (driven_s > kDriven_s) mark(f, leg_unseen);
    });
  }

  /// Stances that begin or go on with the spring elsewhere than the model has it.
  void mark_spring() {
    constexpr double kCaught_s = 0.01, kStraight_m = 4e-3, kHome_m = 2e-3;
    std::vector<char> away(r_.rows());
    bool home = r_.solenoid[0] == 0.0;
    for (std::size_t i = 0; i < r_.rows(); ++i) {
      if (r_.solenoid[i] != 0.0) home = false;
      if (i > 0 && r_.solenoid[i] == 0.0 && r_.solenoid[i - 1] != 0.0)
        home = flies_[i] && flies_for(i, kCaught_s) &&
               (r_.leg_length.empty() || r_.leg_length[i] > straight_m_ - kStraight_m);
      away[i] = !home;
    }
    for_each_run(false, [&](const Rows& s) {
      bool lost = false;
      for (std::size_t i = s.first; i <= s.last; ++i)
        lost = lost || (r_.cable.empty() ? away[i] != 0 && r_.time_s[s.last] - r_.time_s[i] > kAtOnce_s
                                         : std::abs(r_.cable[i]) > kHome_m);
      if (lost) mark(s, spring_away);
    });
  }
  /// A release that begins and ends in one flight and leaves the cable at home does nothing to the body. To the
  /// millisecond the model's two delays do not say when the key came, and whether a pull at the spring moved the
  /// cable before: where the log has the cable, that does.
  void forget_releases() {
    constexpr double kHome_m = 1.5e-3, kLoaded_m = 0.01;
    for (std::size_t i = 0; i < r_.rows();) {
      const std::size_t first = i;
      while (i < r_.rows() && flies_[i] == flies_[first]) ++i;
      if (!flies_[first] || first == 0 || i == r_.rows()) continue;
      std::size_t from = first;
      while (from > 0 && r_.solenoid[from - 1] != 0.0 && r_.time_s[first] - r_.time_s[from - 1] <= kAtOnce_s)
        --from;
      if (from == 0 || r_.solenoid[from - 1] != 0.0 || r_.solenoid[i] != 0.0) continue;
      // Still at home under the load of the stance.
      bool home = true, loaded = false;
      for (std::size_t k = i; k < r_.rows() && !flies_[k] && r_.solenoid[k] == 0.0 && !loaded; ++k) {
        home = home && std::abs(r_.cable[k]) < kHome_m;
        loaded = r_.position[k] < r_.position[i] - kLoaded_m;
      }
      if (home && loaded)
        std::fill(r_.solenoid.begin() + static_cast<std::ptrdiff_t>(from),
                  r_.solenoid.begin() + static_cast<std::ptrdiff_t>(i), 0.0);
    }
  }

  bool flies_for(std::size_t row, double span_s) const {
    for (std::size_t i = row; i < r_.rows() && r_.time_s[i] - r_.time_s[row] <= span_s; ++i)
      if (!flies_[i]) return false;
    return true;
  }

  /// Calls use(Rows) for the runs of rows in flight, or of those that are not.
  template <class Use>
  void for_each_run(bool in_flight, const Use& use) const {
    for (std::size_t i = 0; i < r_.rows();) {
      std::size_t last = i;
      while (last + 1 < r_.rows() && flies_[last + 1] == flies_[i]) ++last;
      if (flies_[i] == in_flight) use(Rows{i, last});
      i = last + 1;
    }
  }
  void mark(const Rows& rows, Why why) {
    r_.not_followed.resize(r_.rows(), followed);
    for (std::size_t i = rows.first; i <= rows.last; ++i) r_.not_followed[i] = why;
  }

  Recording& r_;
  bool has_clutch_;
  double reach_m_, stop_rad_, straight_m_;
  std::vector<Rows> stances_;    // as the switch reports them
  std::vector<double> length_;   // of the leg, by its encoder
  std::vector<double> levels_;   // of the toe in each stance
  std::vector<double> spreads_;  // and by how much it varies in it
  std::vector<Rows> flights_;
  std::vector<bool> flies_;
};

}  // namespace

void follow_manoeuvres(std::vector<Recording>& recordings, const model::Model& model) {
  if (!dynamics::has(model.kind, dynamics::LocationType::leg)) return;
  for (Recording& r : recordings) Manoeuvres(r, model).follow();
}

std::vector<Excluded> excluded(const std::vector<Recording>& recordings, const model::Model& model,
                               double window_s) {
  if (std::all_of(recordings.begin(), recordings.end(),
                  [](const Recording& r) { return r.not_followed.empty(); }))
    return {};
  std::vector<Recording> whole = recordings;
  for (Recording& r : whole) r.not_followed.clear();
  const std::vector<Window> windows = prediction_windows(whole, model, window_s);
  std::vector<Excluded> all;
  for (std::size_t k = 0; k < kWhy.size(); ++k) {
    Excluded one;
    one.why = kWhy[k];
    for (const Window& w : windows) {
      const Recording& r = recordings[w.recording];
      if (r.not_followed.empty()) continue;
      const auto rows = std::span(r.not_followed).subspan(w.first, w.rows());
      const auto first = std::find_if(rows.begin(), rows.end(), [](char why) { return why != followed; });
      if (first == rows.end() || *first != static_cast<char>(k + 1)) continue;
      ++one.windows;
      one.seconds += r.time_s[w.last] - r.time_s[w.first];
      if (one.logs.empty() || one.logs.back() != r.name) one.logs.push_back(r.name);
    }
    one.share = static_cast<double>(one.windows) / std::max<double>(1.0, static_cast<double>(windows.size()));
    if (one.windows > 0) all.push_back(std::move(one));
  }
  return all;
}

std::string sentence(const Excluded& of) {
  std::string logs;
  for (const std::string& name : of.logs) logs += (logs.empty() ? "" : ", ") + name;
  return std::to_string(of.windows) + (of.windows == 1 ? " stride" : " strides") + " (" +
         core::rounded(of.seconds, 2) + " s, " + core::rounded(1e2 * of.share, 3) +
         " % of all) left out, in " + logs + ": " + of.why;
}

std::string nothing_left(const std::vector<Recording>& recordings, const model::Model& model,
                         double window_s) {
  std::string text;
  for (const Excluded& one : excluded(recordings, model, window_s))
    text += (text.empty() ? "" : "; ") + sentence(one);
  return text;
}

}  // namespace furcula::identify
