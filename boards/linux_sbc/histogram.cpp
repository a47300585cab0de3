// Reading a histogram, see histogram.hpp.
#include "boards/linux_sbc/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace furcula::linux_sbc {

std::uint64_t Histogram::count() const {
  std::uint64_t all = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) all += count(bin);
  return all;
}

double Histogram::mean_us() const {
  const std::uint64_t all = count();
  return all == 0
             ? 0.0
             : 1e-3 * static_cast<double>(sum_ns_.load(std::memory_order_relaxed)) / static_cast<double>(all);
}

double Histogram::quantile_us(double share) const {
  const double longest_us = 1e-3 * static_cast<double>(most_ns());
  const double wanted = share * static_cast<double>(count());
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
    below += count(bin);
    if (static_cast<double>(below) >= wanted)
      return std::min(longest_us, std::ldexp(1.0, static_cast<int>(bin)));
  }
  return longest_us;
}

std::string Histogram::text(const char* title) const {
  char line[160];
  const std::uint64_t all = count();
  std::snprintf(line, sizeof(line), "%s: %llu, mean %.1f us, 99.9 %% within %.1f us, longest %.1f us\n",
                title, static_cast<unsigned long long>(all), mean_us(), quantile_us(0.999),
                1e-3 * static_cast<double>(most_ns()));
  std::string out = line;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const std::uint64_t n = count(bin);
    if (n == 0) continue;
    const unsigned from_us = bin == 0 ? 0u : 1u << (bin - 1);
    const int stars = static_cast<int>(std::ceil(40.0 * static_cast<double>(n) / static_cast<double>(all)));
    if (bin + 1 == kBins)
      std::snprintf(line, sizeof(line), "  %6u us and more   %10llu %.*s\n", from_us,
                    static_cast<unsigned long long>(n), stars, "****************************************");
    else
      std::snprintf(line, sizeof(line), "  %6u to %6u us %10llu %.*s\n", from_us, 1u << bin,
                    static_cast<unsigned long long>(n), stars, "****************************************");
    out += line;
  }
  return out;
}

}  // namespace furcula::linux_sbc
