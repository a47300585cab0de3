#include "host/diagnose/whiteness.hpp"

#include <cmath>

#include "host/core/quantile.hpp"

namespace furcula::diagnose {

void LagSums::add(const std::vector<double>& series) {
  for (std::size_t lag = 0; lag <= kLags; ++lag)
    for (std::size_t i = lag; i < series.size(); ++i) {
      products[lag] += series[i] * series[i - lag];
      pairs[lag] += 1.0;
    }
}

LagSums& LagSums::operator+=(const LagSums& other) {
  for (std::size_t lag = 0; lag <= kLags; ++lag) {
    products[lag] += other.products[lag];
    pairs[lag] += other.pairs[lag];
  }
  return *this;
}

Whiteness ljung_box(const LagSums& sums) {
  Whiteness w;
  w.rows = sums.pairs[0];
  if (!(sums.products[0] > 0.0)) return w;
  // Of one series pairs[lag] is rows - lag, and this their formula.
  for (std::size_t lag = 1; lag <= kLags; ++lag) {
    if (sums.pairs[lag] == 0.0) continue;
    const double correlation = sums.products[lag] / sums.products[0];
    w.statistic += w.rows * (w.rows + 2.0) * correlation * correlation / sums.pairs[lag];
    if (std::abs(correlation) > std::abs(w.correlation)) w.correlation = correlation, w.lag = lag;
  }
  w.p_value = core::chi_square_beyond(w.statistic, static_cast<double>(kLags));
  return w;
}

}  // namespace furcula::diagnose
