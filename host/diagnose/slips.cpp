#include "host/diagnose/slips.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace furcula::diagnose {
namespace {

using identify::Recording;
using identify::Slip;
using identify::Window;

/// Whether each training recording has the same slips at the same times as the first.
bool slips_agree(const std::vector<Recording>& training) {
  constexpr double kSameStep = 0.1, kSameTime_s = 0.01;
  const Recording& first = training.front();
  return training.size() > 1 && !first.slips.empty() &&
         std::all_of(training.begin(), training.end(), [&](const Recording& r) {
           if (r.slips.size() != first.slips.size()) return false;
           for (std::size_t i = 0; i < r.slips.size(); ++i) {
             const auto &a = first.slips[i], &b = r.slips[i];
             const double apart_s =
                 (first.time_s[a.row] - first.time_s.front()) - (r.time_s[b.row] - r.time_s.front());
             if (std::abs(apart_s) > kSameTime_s ||
                 std::abs(a.step - b.step) > kSameStep * std::abs(a.step) + 3.0 * a.deviation)
               return false;
           }
           return true;
         });
}

/// Puts the slips of `like` in at the same times.
void add_slips_of(const Recording& like, Recording& r) {
  if (r.slip_offset.empty()) r.slip_offset.assign(r.rows(), 0.0);
  for (const Slip& slip : like.slips) {
    const double time_s = like.time_s[slip.row] - like.time_s.front();
    std::size_t row = 0;
    while (row < r.rows() && r.time_s[row] - r.time_s.front() < time_s) ++row;
    if (row == 0 || row == r.rows()) continue;
    r.slips.push_back({row, slip.step, slip.deviation});
    for (std::size_t i = row; i < r.rows(); ++i) r.slip_offset[i] += slip.step;
  }
}

/// The windows that follow no slip; where all follow one, those that hold none; where all hold one, none is left out.
std::vector<Window> without_slips(const std::vector<Recording>& recordings,
                                  const std::vector<Window>& windows) {
  for (const bool only_within : {false, true}) {
    std::vector<Window> kept;
    for (const Window& w : windows) {
      const auto& slips = recordings[w.recording].slips;
      if (std::none_of(slips.begin(), slips.end(), [&](const Slip& slip) {
            return slip.row <= w.last && (!only_within || slip.row > w.first);
          }))
        kept.push_back(w);
    }
    if (!kept.empty()) return kept;
  }
  return windows;
}

}  // namespace

ExpectedSlips expected_slips(const std::vector<Recording>& training, const std::vector<Recording>& held_out,
                             const std::vector<Window>& windows) {
  ExpectedSlips expected{held_out, windows, slips_agree(training)};
  for (Recording& r : expected.recordings) {
    r.slips.clear();
    r.slip_offset.clear();
    if (const Recording* before = identify::goes_on_from(r, training); before && !before->slip_offset.empty())
      r.slip_offset.assign(r.rows(), before->slip_offset.back());
    if (expected.predictable) add_slips_of(training.front(), r);
  }
  if (!expected.predictable) expected.windows = without_slips(held_out, windows);
  return expected;
}

void tell_slips(Finding& f, dynamics::Kind kind, const std::vector<Recording>& training,
                const std::vector<Recording>& held_out) {
  const auto& table = dynamics::info(dynamics::Effect::encoder_slip).parameter_table;
  double largest = 0.0;
  for (const auto* recordings : {&training, &held_out})
    for (const Recording& r : *recordings)
      for (const Slip& slip : r.slips) {
        const double time_s = r.time_s[slip.row] - r.time_s.front();
        const double half_s = 0.5 * (r.time_s[slip.row] - r.time_s[slip.row - 1]);
        const bool observed = recordings != &training;
        (observed ? f.observed_events : f.events)
            .push_back({r.name, time_s, slip.step, dynamics::info(kind).rotary ? "rad" : "m"});
        if (observed || std::abs(slip.step) <= largest) continue;
        largest = std::abs(slip.step);
        f.parameters[std::string(name_on(table[0], kind))] = {slip.step, slip.step - 1.96 * slip.deviation,
                                                              slip.step + 1.96 * slip.deviation};
        f.parameters["time_s"] = {time_s - half_s, time_s - 2.0 * half_s, time_s};
      }
}

}  // namespace furcula::diagnose
