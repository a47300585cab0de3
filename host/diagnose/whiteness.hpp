// Whether what is new in one row hangs on what was new in the rows before it: Ljung and Box's test, of series
// that begin anew with each window.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace furcula::diagnose {

inline constexpr std::size_t kLags = 20;

/// Products of values so many rows apart, and how many there are, of one series or of several.
struct LagSums {
  std::array<double, kLags + 1> products{};
  std::array<double, kLags + 1> pairs{};

  void add(const std::vector<double>& series);
  LagSums& operator+=(const LagSums& other);
};

struct Whiteness {
  double statistic = 0.0;    ///< chi-square of kLags degrees, if the values are white
  double p_value = 1.0;      ///< with which probability white values give as much, or more
  double correlation = 0.0;  ///< the largest by size of the first kLags
  std::size_t lag = 0;       ///< of that one, rows
  double rows = 0.0;

  /// Of a hundred white series one is called coloured.
  bool white() const { return p_value >= 0.01; }
};

/// Of no values: white, of no rows.
Whiteness ljung_box(const LagSums& sums);

}  // namespace furcula::diagnose
