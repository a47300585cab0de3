// A gait under a feedback in stance: against strides that are simulated, and against what the gait is without it.
#include "host/gait/stability.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "host/gait/evidence.hpp"
#include "host/gait/gait_file.hpp"
#include "tests/host/gait/legs.hpp"

using namespace furcula;
using namespace furcula::gait;

namespace {

/// The largest difference from the gait's apex after each of so many strides from a start that much too high.
std::vector<double> deviations(const HeldGait& gait, double height_m, int strides) {
  Apex<double> at = gait.apex();
  at.height += height_m;
  StrideOptions options;
  options.energies = false;
  options.longest_step_s = 1e-3;
  std::vector<double> out{height_m};
  for (int k = 0; k < strides; ++k) {
    const StrideEnd<double> e = gait.stride(at, options);
    REQUIRE(e.whole);
    at = e.apex;
    double most = 0.0;
    for (std::size_t i = 0; i < 6; ++i)
      most = std::max(most, std::abs(at.values()[i] - gait.apex().values()[i]));
    out.push_back(most);
  }
  return out;
}

}  // namespace

TEST_CASE("a feedback in stance makes the gait in place stable, and costs nothing on the gait") {
  const Search s = test::found(LegSpring::switched, test::in_place(0.075));
  REQUIRE(s.gait);
  HeldGait gait(*s.gait);
  // Without it the multipliers are those of docs/studies.md, and of an independent calculation with the print's
  // parameters 4.81.
  REQUIRE(gait.multipliers().size() == 6);
  CHECK(std::abs(gait.multipliers().front()) ==
        Approx(std::abs(s.evaluation.multipliers.front())).epsilon(1e-6));
  const std::vector<double> grown = deviations(gait, 1e-8, 6);
  CHECK(grown[6] / grown[5] == Approx(4.84).epsilon(0.02));

  gait.set_gains(kStanceGains);
  StrideOptions fine;
  fine.longest_step_s = 1e-3;
  const StrideEnd<double> e = gait.stride(gait.apex(), fine);
  CHECK(e.electric == Approx(s.evaluation.cost_j).epsilon(1e-9));
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(e.apex.values()[i] == Approx(gait.apex().values()[i]).margin(1e-8));
  CHECK(std::abs(gait.multipliers().front()) < 0.25);
  CHECK(deviations(gait, 1e-4, 3).back() < 5e-6);
}

TEST_CASE("multipliers with the feedback are those of differences of strides") {
  for (const bool fourier : {false, true}) {
    const Search s = test::found(LegSpring::switched, test::in_place(0.075), fourier);
    REQUIRE(s.gait);
    const HeldGait gait(*s.gait, {{100.0, 100.0}, {2.5, 2.5}});
    const auto m = gait.multipliers();
    REQUIRE(m.size() == 6);
    // Their sum is the trace of the map.
    double trace = 0.0;
    StrideOptions options;
    options.energies = false;
    options.longest_step_s = 1e-3;
    for (std::size_t i = 0; i < 6; ++i) {
      constexpr double kStep = 1e-5;
      auto up = gait.apex().values(), down = up;
      up[i] += kStep;
      down[i] -= kStep;
      trace += (gait.stride(Apex<double>::of(up), options).apex.values()[i] -
                gait.stride(Apex<double>::of(down), options).apex.values()[i]) /
               (2.0 * kStep);
    }
    std::complex<double> sum = 0.0;
    for (const auto& v : m) sum += v;
    CHECK(sum.real() == Approx(trace).margin(2e-3));
    CHECK(std::abs(sum.imag()) < 1e-9);
    // Touch-down leaves four of six: hip and knee, and their rates.
    CHECK(std::abs(m[4]) < 1e-3);
    CHECK(std::abs(m[5]) < 1e-3);
  }
}

TEST_CASE(
    "with the feedback most starts return, without it next to none, and the same seed gives the same share") {
  const Search s = test::found(LegSpring::switched, test::in_place(0.075));
  REQUIRE(s.gait);
  const Stability a = stability_of(*s.gait);
  CHECK(a.stable());
  CHECK(a.basin.starts == 200);
  CHECK(a.basin.share() > 0.5);
  CHECK(a.open_loop.share() < 0.05);
  CHECK(stability_of(*s.gait).basin.returned == a.basin.returned);
  // A start on the gait itself returns, even where it would not be kept.
  BasinOptions point;
  point.spread = {1e-12, 1e-12, {1e-12, 1e-12}, {1e-12, 1e-12}};
  point.near = 1e6;
  point.starts = 3;
  CHECK(basin_of(HeldGait(*s.gait), point).returned == 3);
}

TEST_CASE("a run whose toe lands softly is not kept, and the cheapest that is lands faster and costs more") {
  Query q;
  q.machine = spear(LegSpring::switched);
  q.task = test::forward(1.0);
  q.starts = 1;
  const Search s = find_gait(q);
  REQUIRE(s.gait);
  CHECK(s.evaluation.stride.touchdown_speed_mps < 0.3);
  const Evidence e = evidence_of(q, s);
  CHECK_FALSE(e.stability.stable());
  REQUIRE(e.stable);
  CHECK(e.stable->stability.stable());
  CHECK(e.stable->evaluation.stride.touchdown_speed_mps >= e.stable->landing_speed_mps - 1e-6);
  CHECK(e.stable->evaluation.is_gait());
  CHECK(*e.stable->evaluation.cot > *s.evaluation.cot);
  CHECK(*e.stable->evaluation.cot < 1.05 * *s.evaluation.cot);
  // It is kept over a hundred strides from a start beside it.
  const HeldGait kept(e.stable->gait, kStanceGains);
  StrideOptions options;
  options.energies = false;
  Apex<double> at = kept.apex();
  at.speed += 0.01;
  for (int k = 0; k < 100; ++k) {
    const StrideEnd<double> stride = kept.stride(at, options);
    REQUIRE(stride.whole);
    at = stride.apex;
  }
  CHECK(at.speed == Approx(kept.apex().speed).margin(1e-4));
  // The gait's file says with which speed it lands.
  CHECK(parse_gait(format_gait(e.stable->gait), "gait.toml").task.landing_speed_mps ==
        e.stable->landing_speed_mps);
}

TEST_CASE(
    "open digits go through to the figures: the independent calculation's other readings are the ends") {
  // Elsewhere (docs/studies.md): 2.551 J with 56.67 N m/rad, 2.366 J with 65.67, 2.461 J with 60.67.
  Query q;
  q.machine = spear(LegSpring::switched);
  q.machine.open = {{"stiffness_nmprad", 56.67, 65.67}};
  q.task = test::in_place(0.075);
  q.starts = 1;
  const Search s = find_gait(q);
  REQUIRE(s.gait);
  const OpenFigures open = open_figures(q, s);
  CHECK(open.corners == 2);
  CHECK(open.without == 0);
  CHECK(open.cost_j.low == Approx(2.366).epsilon(0.01));
  CHECK(open.cost_j.high == Approx(2.551).epsilon(0.01));
  CHECK(open.cost_j.low < s.evaluation.cost_j);
  CHECK(open.cost_j.high > s.evaluation.cost_j);
  CHECK(open.eta.low < open.eta.high);

  q.machine.open.clear();
  CHECK(open_figures(q, s).corners == 0);
}
