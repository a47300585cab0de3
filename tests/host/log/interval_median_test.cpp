// The median of sampling intervals, against sorting.
#include "host/log/interval_median.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

TEST_CASE("the median of many intervals is that of the sorted intervals, to 0.1 %") {
  std::mt19937_64 random(3);
  std::lognormal_distribution<double> interval(-7.0, 2.0);
  furcula::log::IntervalMedian median;
  std::vector<double> all;
  for (int i = 0; i < 10001; ++i) {
    all.push_back(interval(random));
    median.add(all.back());
  }
  std::sort(all.begin(), all.end());
  CHECK(median.value() == Approx(all[5000]).epsilon(1e-3));
}

TEST_CASE("the median of equal intervals is that interval to the bit") {
  furcula::log::IntervalMedian median;
  CHECK(median.value() == 0.0);
  for (int i = 0; i < 3; ++i) median.add(0.001);
  CHECK(median.value() == 0.001);
}
