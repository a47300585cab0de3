// The encoder's errors against their laws.
#include "furcula/dynamics/sensing.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;
using Jet = ceres::Jet<double, 6>;

namespace {

constexpr double kReference = 0.2819;
constexpr double kValues[] = {0.003, 1.04, 0.8e-3, 0.05, 0.7};  // offset; scale; amplitude, pitch, phase

template <class T>
Effects<T> all(const T* at) {
  Effects<T> e;
  e.set(Effect::encoder_offset, 0, at[0]);
  e.set(Effect::height_scale_error, 0, at[1]);
  e.set(Effect::height_eccentricity, {at[2], at[3], at[4]});
  return e;
}

double by_hand(const double* at, double z) {
  return kReference + at[1] * (z - kReference) + at[2] * std::sin(2 * std::numbers::pi * z / at[3] + at[4]) +
         at[0];
}

}  // namespace

TEST_CASE("The measured height has the scale, the swing and the offset of the contract") {
  const Sensing<double> sensing(all(kValues), kReference);
  CHECK_FALSE(sensing.ideal());
  for (const double z : {0.21, 0.2819, 0.3333}) {
    CHECK(sensing.measured(z) == Approx(by_hand(kValues, z)).epsilon(1e-14));
    const double slope = (by_hand(kValues, z + 1e-6) - by_hand(kValues, z - 1e-6)) / 2e-6;
    CHECK(sensing.gain(z) == Approx(slope).epsilon(1e-8));
  }
}

TEST_CASE("An ideal encoder changes nothing") {
  const Sensing<double> sensing({}, kReference);
  CHECK(sensing.ideal());
  CHECK(sensing.measured(0.31) == 0.31);
  CHECK(sensing.position(0.31) == 0.31);
  CHECK(sensing.gain(0.31) == 1.0);
}

TEST_CASE("The position that is measured as a height is found back") {
  for (const double amplitude : {0.8e-3, 3e-3}) {  // a slope of up to 0.38 of the height's
    double at[5];
    std::copy(std::begin(kValues), std::end(kValues), at);
    at[2] = amplitude;
    const Sensing<double> sensing(all(at), kReference);
    for (int k = 0; k < 50; ++k) {
      const double z = 0.2 + 0.003 * k;
      CHECK(sensing.position(sensing.measured(z)) == Approx(z).epsilon(1e-13));
    }
  }
}

TEST_CASE("An eccentricity that turns the measured height back still gives a number") {
  double at[5];
  std::copy(std::begin(kValues), std::end(kValues), at);
  at[2] = 0.02;  // a slope of -1.5 at the worst
  const Sensing<double> sensing(all(at), kReference);
  for (int k = 0; k < 50; ++k) {
    CHECK(std::abs(sensing.position(0.2 + 0.003 * k) - 0.2 - 0.003 * k) < 0.2);
  }
}

TEST_CASE(
    "Measured height, its gain and the position found back have the derivatives of finite differences") {
  Jet jets[5];
  for (int i = 0; i < 5; ++i) jets[i] = Jet(kValues[i], i);
  const double z = 0.2713;
  const Sensing<Jet> sensing(all(jets), Jet(kReference));
  const Jet measured = sensing.measured(Jet(z, 5)), gain = sensing.gain(Jet(z, 5)),
            found = sensing.position(Jet(z, 5));
  for (int i = 0; i < 6; ++i) {
    CAPTURE(i);
    const auto moved = [&](double sign) {
      double at[5];
      std::copy(std::begin(kValues), std::end(kValues), at);
      const double step = 1e-6 * (i < 5 ? kValues[i] : z) * sign;
      if (i < 5) at[i] += step;
      const Sensing<double> s(all(at), kReference);
      const double place = i < 5 ? z : z + step;
      return std::array{s.measured(place), s.gain(place), s.position(place)};
    };
    const auto up = moved(1.0), down = moved(-1.0);
    const double width = 2e-6 * (i < 5 ? kValues[i] : z);
    CHECK(measured.v[i] == Approx((up[0] - down[0]) / width).epsilon(1e-6).margin(1e-8));
    CHECK(gain.v[i] == Approx((up[1] - down[1]) / width).epsilon(1e-6).margin(1e-6));
    CHECK(found.v[i] == Approx((up[2] - down[2]) / width).epsilon(1e-6).margin(1e-8));
  }
}
