// A contact switch that says for longer than any report delay what the height refutes.
#include "host/identify/contact_switch.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

using namespace furcula;
using Catch::Contains;

namespace {

constexpr double kTouchdown_m = 0.3, kPhase_s = 0.4;

/// A body whose height goes up and down by 0.1 m about the touchdown height, in ten flights and ten stances, 1 kHz.
/// `is_closed(k, since_s, in_stance)`: the switch, in the k-th phase, by the time since its begin.
identify::Recording hops(const std::function<bool(int, double, bool)>& is_closed) {
  identify::Recording r;
  r.name = "hops.csv";
  for (int n = 0; n < 8000; ++n) {
    const double t = 1e-3 * (n + 0.5);
    const int phase = static_cast<int>(t / kPhase_s);
    r.time_s.push_back(t);
    r.position.push_back(kTouchdown_m + 0.1 * std::sin(std::numbers::pi * t / kPhase_s));
    r.on_ground.push_back(is_closed(phase, t - phase * kPhase_s, phase % 2 == 1));
  }
  return r;
}

/// Reports `late_s` after the height.
identify::Recording late(double late_s) {
  return hops([=](int, double since_s, bool in_stance) { return since_s < late_s ? !in_stance : in_stance; });
}

}  // namespace

TEST_CASE("A contact switch that reports late by a sensor's delay agrees with the height") {
  for (const double late_s : {0.0, 0.01, 0.05}) {
    const auto agreement = identify::switch_agreement({late(late_s)}, kTouchdown_m);
    CHECK(agreement.phases == 20);
    CHECK(agreement.contradicted == 0);
    CHECK_FALSE(agreement.is_refuted());
  }
}

TEST_CASE("A contact switch that stays closed for 80 ms after lift-off contradicts the height") {
  const auto sticks = [](int phase, double since_s, bool in_stance) {
    const bool stuck = phase % 10 == 4;  // two flights of ten
    return in_stance || (stuck && since_s < 0.08);
  };
  const auto agreement = identify::switch_agreement({late(0.0), hops(sticks)}, kTouchdown_m);
  CHECK(agreement.phases == 40);
  CHECK(agreement.contradicted == 2);
  CHECK(agreement.is_refuted());
  // The 3 mm next to the touchdown height, which take asin(0.03) / pi of a phase, are neither phase.
  const double near_s = kPhase_s * std::asin(0.03) / std::numbers::pi;
  CHECK(agreement.longest_s == Approx(0.08 - near_s).margin(2e-3));
  CHECK_THAT(identify::in_words(agreement), Contains("2 of 40 flights and stances") && Contains("hops.csv"));
}

TEST_CASE(
    "A contact switch that closes 80 ms late in every stance contradicts the height, a single time is a glitch") {
  const auto open = [](int, double since_s, bool in_stance) { return in_stance && since_s > 0.08; };
  CHECK(identify::switch_agreement({hops(open)}, kTouchdown_m).contradicted == 10);
  const auto once = [](int phase, double since_s, bool in_stance) {
    return in_stance && (phase != 5 || since_s > 0.08);
  };
  const auto glitch = identify::switch_agreement({hops(once)}, kTouchdown_m);
  CHECK(glitch.contradicted == 1);
  CHECK_FALSE(glitch.is_refuted());
}

TEST_CASE("A recording without a contact switch contradicts nothing") {
  identify::Recording r = late(0.0);
  r.on_ground.clear();
  CHECK(identify::switch_agreement({r}, kTouchdown_m).phases == 0);
}
