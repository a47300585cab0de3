// Straight lines through pairs of which a few are wrong.
#include "host/bus/line_fit.hpp"

#include <catch2/catch.hpp>

using namespace furcula::bus;

TEST_CASE("a line is found with its error, and what lies off it is left out") {
  std::vector<Pair> pairs;
  for (int i = 0; i < 100; ++i) pairs.push_back({1e6 + i, 0.5 - 2.0 * i, 1.0});
  for (std::size_t i = 0; i < 100; i += 5) pairs[i].y = 1e4;
  const auto line = fit_line(pairs, 0.1);
  REQUIRE(line);
  CHECK(line->slope == Approx(-2.0));
  CHECK(line->offset == Approx(0.5 + 2e6));
  CHECK(line->offset_at(-2.0) == Approx(line->offset));
  CHECK(line->pairs == 80);
  CHECK(line->excluded == 20);
  // Errors of one step each way have a variance of slope^2 / 12 at least; the spread of x is that of a row of numbers.
  CHECK(line->slope_error == Approx(2.0 / std::sqrt(12.0) / std::sqrt(80 * 833.0)).epsilon(0.05));
}

TEST_CASE("too few pairs, pairs at one place and pairs on no line give none") {
  CHECK_FALSE(fit_line({}, 1.0));
  CHECK_FALSE(fit_line({{0, 0, 1}, {1, 1, 1}}, 1.0));
  CHECK_FALSE(fit_line({{1, 0, 1}, {1, 1, 1}, {1, 2, 1}, {1, 3, 1}}, 1.0));
  std::vector<Pair> scattered;
  for (int i = 0; i < 100; ++i)
    scattered.push_back({static_cast<double>(i), static_cast<double>(i * 7919 % 1009), 1.0});
  CHECK_FALSE(fit_line(scattered, 1.0));
}

TEST_CASE("a sample of pairs stays bounded and even") {
  PairSample sample;
  for (int i = 0; i < 1000000; ++i) sample.add({static_cast<double>(i), 0.0, 1.0});
  REQUIRE(sample.pairs().size() < PairSample::kMost);
  REQUIRE(sample.pairs().size() >= PairSample::kMost / 2);
  const double every = sample.pairs()[1].x;
  for (std::size_t i = 0; i < sample.pairs().size(); ++i)
    REQUIRE(sample.pairs()[i].x == every * static_cast<double>(i));
}
