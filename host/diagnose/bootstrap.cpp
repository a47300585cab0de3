#include "host/diagnose/bootstrap.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/quantile.hpp"
#include "host/core/random.hpp"

namespace furcula::diagnose {

Units units_of(const std::vector<identify::Window>& windows) {
  constexpr std::size_t kFewestRecordings = 4, kBlocks = 10;
  std::vector<std::size_t> recordings;
  for (const auto& w : windows)
    if (std::find(recordings.begin(), recordings.end(), w.recording) == recordings.end())
      recordings.push_back(w.recording);
  const bool whole = recordings.size() >= kFewestRecordings;
  const std::size_t longest = whole ? windows.size() : std::max<std::size_t>(windows.size() / kBlocks, 1);
  Units units;
  for (const std::size_t recording : recordings) {
    std::size_t in_block = 0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      if (windows[i].recording != recording) continue;
      if (in_block % longest == 0) units.emplace_back();
      ++in_block;
      units.back().push_back(i);
    }
  }
  return units;
}

double in_standard_errors(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  if (values.size() < 2) return 0.0;
  double mean = 0.0, scatter = 0.0;
  for (const double x : values) mean += x / n;
  for (const double x : values) scatter += (x - mean) * (x - mean) / (n - 1.0);
  return mean / std::sqrt(std::max(scatter, 1e-300) / n);
}

double in_standard_errors(const std::vector<double>& of_window, const Units& units) {
  std::vector<double> sums;
  for (const auto& unit : units) {
    double sum = 0.0;
    for (const std::size_t i : unit) sum += of_window[i];
    sums.push_back(sum);
  }
  return in_standard_errors(sums);
}

std::optional<Interval> bootstrap(std::size_t units,
                                  const std::function<double(const std::vector<double>&)>& figure) {
  constexpr std::size_t kDraws = 2000;
  constexpr std::uint64_t kSeed = 17, kStream = 1;
  if (units < 2) return std::nullopt;
  core::Random random(kSeed, kStream);
  std::vector<double> figures, times(units);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    std::fill(times.begin(), times.end(), 0.0);
    for (std::size_t i = 0; i < units; ++i) times[random.next() % units] += 1.0;
    figures.push_back(figure(times));
  }
  return Interval{core::quantile(figures, 0.025), core::quantile(figures, 0.975)};
}

}  // namespace furcula::diagnose
