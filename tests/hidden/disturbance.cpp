// See disturbance.hpp.
#include "tests/hidden/disturbance.hpp"

#include <cmath>

#include "tests/hidden/random.hpp"

namespace furcula::hidden {

namespace {

constexpr double kGrid_s = 2e-3, kLongest_s = 60.0;
constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15u;

double normal_of(std::uint64_t draw, std::uint64_t which, int event) {
  Random random((draw * kOdd + which) * kOdd + static_cast<std::uint64_t>(event));
  return random.normal();
}

}  // namespace

Disturbed::Disturbed(const Disturbance& size, std::uint64_t draw) : size_(size), draw_(draw) {
  if (!(size.force > 0.0)) return;
  Random random(draw * kOdd + 41);
  const double kept = std::exp(-kGrid_s / size.correlation_s), fresh = std::sqrt(1.0 - kept * kept);
  std::vector<double> values{size.force * random.normal()};
  while (static_cast<double>(values.size()) * kGrid_s < kLongest_s)
    values.push_back(kept * values.back() + fresh * size.force * random.normal());
  force_ = std::make_shared<const std::vector<double>>(std::move(values));
}

double Disturbed::force(double time_s) const {
  if (!force_) return 0.0;
  const double at = std::max(0.0, time_s / kGrid_s);
  const auto i = std::min(static_cast<std::size_t>(at), force_->size() - 2);
  const double share = std::min(1.0, at - static_cast<double>(i));
  return (*force_)[i] * (1.0 - share) + (*force_)[i + 1] * share;
}

double Disturbed::factor(int event) const {
  return size_.restitution > 0.0 ? 1.0 + size_.restitution * normal_of(draw_, 43, event) : 1.0;
}

double Disturbed::ground_m(int event) const {
  return size_.ground_m > 0.0 ? size_.ground_m * normal_of(draw_, 47, event) : 0.0;
}

}  // namespace furcula::hidden
