#include "host/identify/contact_switch.hpp"

#include <algorithm>

#include "host/core/message.hpp"

namespace furcula::identify {
namespace {

constexpr double kSmallest_m = 3e-3;  // as a hop's (windows.cpp)
constexpr double kNoises = 5.0;

enum class Phase { neither, flight, stance };

Phase phase_at(const Recording& r, std::size_t row, double height_m) {
  if (!r.not_followed.empty() && r.not_followed[row] != 0) return Phase::neither;
  const double above_m = r.position[row] - r.touchdown_height_m(row, height_m);
  const double margin_m = std::max(kSmallest_m, kNoises * r.position_noise);
  if (above_m > margin_m) return Phase::flight;
  return above_m < -margin_m ? Phase::stance : Phase::neither;
}

/// The longest time on end within the rows [first, last] of one phase in which the switch says the opposite, s.
double contradicted_for_s(const Recording& r, std::size_t first, std::size_t last, Phase phase) {
  double longest_s = 0.0;
  std::size_t since = first;
  for (std::size_t i = first; i <= last; ++i) {
    if ((r.on_ground[i] != 0.0) == (phase == Phase::stance)) since = i + 1;
    if (since <= i) longest_s = std::max(longest_s, r.time_s[i] - r.time_s[since]);
  }
  return longest_s;
}

}  // namespace

SwitchAgreement switch_agreement(const std::vector<Recording>& recordings, double height_m) {
  SwitchAgreement all;
  for (const Recording& r : recordings) {
    const std::size_t n = r.on_ground.size();
    for (std::size_t first = 0; first < n;) {
      const Phase phase = phase_at(r, first, height_m);
      std::size_t last = first;
      while (last + 1 < n && phase_at(r, last + 1, height_m) == phase &&
             r.time_s[last + 1] - r.time_s[last] < kLongestReportDelay_s)
        ++last;
      if (phase != Phase::neither && r.time_s[last] - r.time_s[first] > kLongestReportDelay_s) {
        ++all.phases;
        const double for_s = contradicted_for_s(r, first, last, phase);
        if (for_s > kLongestReportDelay_s) ++all.contradicted;
        if (for_s > all.longest_s) {
          all.longest_s = for_s;
          all.longest_in = r.name;
        }
      }
      first = last + 1;
    }
  }
  return all;
}

std::string in_words(const SwitchAgreement& agreement) {
  return "the contact switch contradicts the measured height in " + std::to_string(agreement.contradicted) +
         " of " + std::to_string(agreement.phases) + " flights and stances, for up to " +
         core::rounded(agreement.longest_s, 2) + " s (" + agreement.longest_in + ")";
}

}  // namespace furcula::identify
