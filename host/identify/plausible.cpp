#include "host/identify/plausible.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

using core::rounded;

/// Smallest difference between neighbouring positions that is not zero: a count, or noise.
double smallest_step(const Recording& r) {
  double smallest = 0.0;
  for (std::size_t i = 1; i < r.rows(); ++i) {
    const double step = std::abs(r.position[i] - r.position[i - 1]);
    if (step > 0.0 && (smallest == 0.0 || step < smallest)) smallest = step;
  }
  return smallest;
}

/// How long, at most, the position stands at `extreme` (its largest value: sign 1, smallest: -1) although the
/// body comes and leaves so fast that it must have gone further by several counts; 0 if that happens less
/// than twice. A body at rest leaves from rest; a top that a count hides is as high as a count.
double clipped_for_s(const Recording& r, double extreme, double sign) {
  constexpr std::size_t kRows = 5;
  constexpr double kFurtherThanCounts = 10.0;
  const double count = std::max(smallest_step(r), r.position_noise);
  double longest = 0.0;
  int stretches = 0;
  for (std::size_t i = kRows; i + kRows < r.rows(); ++i) {
    if (r.position[i] != extreme || (!r.contact.empty() && r.contact[i] != 0.0)) continue;
    std::size_t last = i;
    while (last + 1 < r.rows() && r.position[last + 1] == extreme) ++last;
    const double stays_s = r.time_s[last] - r.time_s[i];
    if (last - i >= 2 && last + kRows < r.rows()) {
      const double comes = sign * (extreme - r.position[i - kRows]) / (r.time_s[i] - r.time_s[i - kRows]);
      const double leaves =
          sign * (extreme - r.position[last + kRows]) / (r.time_s[last + kRows] - r.time_s[last]);
      // Thrown back at the same rate all the way: a quarter of the way that the speed alone would make.
      if (0.25 * stays_s * std::min(comes, leaves) > kFurtherThanCounts * count) {
        ++stretches;
        longest = std::max(longest, stays_s);
      }
    }
    i = last;
  }
  return stretches >= 2 ? longest : 0.0;
}

void require_range(const Recording& r) {
  const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
  const ChannelNames names = channel_names(r.kind);
  for (const double sign : {1.0, -1.0}) {
    // A carriage is thrown up from its stop.
    if (sign < 0.0 && !machines::rules(r.kind).columns.stop.empty()) continue;
    const double extreme = sign > 0.0 ? *high : *low;
    const double stays_s = clipped_for_s(r, extreme, sign);
    if (stays_s > 0.0)
      throw core::DataError(
          r.name + ": the " + names.position + " stands at its " + (sign > 0.0 ? "largest" : "smallest") +
          " value, " + rounded(extreme) + " " + names.position_unit + ", for up to " +
          rounded(1e3 * stays_s) +
          " ms while the body passes: the encoder is saturated; expected a range that holds the motion");
  }
}

/// Root mean squares of speed, and of input.
struct Motion {
  double speed = 0.0, input = 0.0;
  bool moves = false;
};

Motion motion_of(const Recording& r) {
  constexpr double kMotionOverNoise = 50.0;
  Motion m;
  for (double v : r.velocity_smoothed) m.speed += v * v / static_cast<double>(r.rows());
  for (double u : r.input) m.input += u * u / static_cast<double>(r.rows());
  m.speed = std::sqrt(m.speed);
  m.input = std::sqrt(m.input);
  const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
  m.moves = *high - *low > kMotionOverNoise * r.position_noise;
  return m;
}

void require_one_unit(const std::vector<const Recording*>& recordings) {
  constexpr double kClash = 30.0;
  constexpr double kSameInput = 3.0;
  std::vector<Motion> motions;
  for (const Recording* r : recordings) motions.push_back(motion_of(*r));
  for (std::size_t i = 0; i < motions.size(); ++i)
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const Motion &fast = motions[i], &slow = motions[k];
      if (!fast.moves || !slow.moves || fast.speed < kClash * slow.speed) continue;
      if (fast.input > kSameInput * slow.input) continue;
      throw core::DataError(recordings[i]->name + ": moves " + rounded(fast.speed / slow.speed) +
                            " times as fast as " + recordings[k]->name +
                            " under about the same input; expected both in the same unit (" +
                            channel_names(recordings[i]->kind).position_unit + ", s)");
    }
}

}  // namespace

void require_plausible(const std::vector<Recording>& training, const std::vector<Recording>& held_out) {
  std::vector<const Recording*> all;
  for (const auto* list : {&training, &held_out})
    for (const Recording& r : *list) all.push_back(&r);
  // A belt is held where it stands, and may hang through a recording.
  if (!all.empty() && machines::rules(all.front()->kind).held) return;
  for (const Recording* r : all) require_range(*r);
  require_one_unit(all);
}

}  // namespace furcula::identify
