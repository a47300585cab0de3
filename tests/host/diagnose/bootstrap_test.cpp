// Intervals by drawing anew against the closed form of a mean.
#include "host/diagnose/bootstrap.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>

using namespace furcula;
using diagnose::Units;

namespace {

double mean_of(const std::vector<double>& values, const std::vector<double>& times) {
  return std::inner_product(values.begin(), values.end(), times.begin(), 0.0) /
         std::accumulate(times.begin(), times.end(), 0.0);
}

std::vector<identify::Window> windows(const std::vector<std::size_t>& recordings) {
  std::vector<identify::Window> all;
  for (const std::size_t r : recordings) {
    identify::Window w;
    w.recording = r;
    all.push_back(w);
  }
  return all;
}

}  // namespace

TEST_CASE("The interval of a mean is 1.96 of its standard errors to either side") {
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(3.0, 2.0);
  std::vector<double> values(200);
  for (double& v : values) v = noise(random);
  const double mean = mean_of(values, std::vector<double>(values.size(), 1.0));
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const double error = std::sqrt(squares) / 200.0;
  const auto figure = [&](const std::vector<double>& times) { return mean_of(values, times); };
  const auto interval = diagnose::bootstrap(values.size(), figure);
  REQUIRE(interval);
  CHECK(interval->lower == Approx(mean - 1.96 * error).margin(0.2 * error));
  CHECK(interval->upper == Approx(mean + 1.96 * error).margin(0.2 * error));
  // Always the same draws.
  CHECK(diagnose::bootstrap(values.size(), figure)->lower == interval->lower);
}

TEST_CASE("Of what does not differ the interval is a point, and of one unit there is none") {
  const auto same = diagnose::bootstrap(5, [](const std::vector<double>& times) {
    return mean_of({7.0, 7.0, 7.0, 7.0, 7.0}, times);
  });
  REQUIRE(same);
  CHECK(same->lower == Approx(7.0));
  CHECK(same->upper == Approx(7.0));
  CHECK_FALSE(diagnose::bootstrap(1, [](const auto&) { return 0.0; }));
}

TEST_CASE("Recordings are drawn whole where there are four, else blocks within them, ten in all") {
  CHECK(diagnose::units_of(windows({0, 0, 1, 2, 2, 3})) == Units{{0, 1}, {2}, {3, 4}, {5}});
  CHECK(diagnose::units_of(windows({2, 2, 5})) == Units{{0}, {1}, {2}});
  std::vector<std::size_t> two;
  for (std::size_t i = 0; i < 40; ++i) two.push_back(i < 25 ? 0 : 1);
  const Units blocks = diagnose::units_of(windows(two));
  CHECK(blocks.size() == 11);  // 25 / 4 and 15 / 4, rounded up
  CHECK(blocks[6] == std::vector<std::size_t>{24});
  CHECK(blocks[7] == std::vector<std::size_t>{25, 26, 27, 28});
}

TEST_CASE("A mean is so many standard errors as its values scatter, and of one value none") {
  // Mean 2, deviation 1, standard error 1/sqrt(3).
  CHECK(diagnose::in_standard_errors({1.0, 2.0, 3.0}) == Approx(2.0 * std::sqrt(3.0)));
  // All in one is 1, whatever its size.
  CHECK(diagnose::in_standard_errors({0.0, 0.0, 7e4, 0.0}) == Approx(1.0));
  CHECK(diagnose::in_standard_errors(std::vector<double>{5.0}) == 0.0);
  CHECK(diagnose::in_standard_errors({0.5, 0.5, 2.0, 1.0, 2.0}, {{0, 1}, {2}, {3, 4}}) ==
        Approx(2.0 * std::sqrt(3.0)));
}
