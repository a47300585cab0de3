// The examples of document 002, chapter 3, against closed forms and an independent calculation.
#include "host/reproduce/examples.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula;
using namespace furcula::reproduce;

TEST_CASE("The example of section 3.2.1 settles to an apex of 0.361 m, with the printed sign it dies") {
  const Trajectory t = hop(example_parameters(), {}, 0.35, 20.0);
  // 0.361 m: calculated elsewhere, with a general integrator.
  REQUIRE(t.apexes_m.size() > 30);
  CHECK(t.apexes_m.back() == Approx(0.361).margin(0.001));
  CHECK(std::abs(t.apexes_m.back() - t.apexes_m[t.apexes_m.size() - 2]) < 1e-4);
  const Trajectory reversed = hop(example_parameters(), {-2.0, 0.3}, 0.35, 20.0);
  CHECK(*std::max_element(reversed.apexes_m.end() - 10, reversed.apexes_m.end()) < 0.33);
}

TEST_CASE("The first fall of an example is a damped fall in closed form, and its losses are what was asked") {
  auto p = example_parameters();
  p.restitution_touchdown = 0.8;
  p.restitution_liftoff = 0.9;
  const Trajectory t = hop(p, {}, 0.35, 3.0);
  // m z'' = -m g - d z' from rest: z = z0 - g T (t - T (1 - exp(-t/T))), T = m / d.
  const double relax_s = p.mass_kg / p.damping_flight_nspm, at_s = 0.1;
  const double fallen = p.gravity_mps2 * relax_s * (at_s - relax_s * (1.0 - std::exp(-at_s / relax_s)));
  CHECK(t.height_m[100] == Approx(0.35 - fallen).epsilon(1e-9));
  REQUIRE(t.touchdown_ratios.size() > 3);
  for (const double ratio : t.touchdown_ratios) CHECK(ratio == Approx(0.8));
  for (const double ratio : t.liftoff_ratios) CHECK(ratio == Approx(0.9));
}

TEST_CASE("Links by the definition below eq. 3.14") {
  // By hand: lower 0.1 kg at 7.5 cm, upper 0.8 kg at 2 cm.
  const auto links = links_of_section_3_2_2(0.075, 0.02);
  CHECK(links.b == Approx(0.0075));
  CHECK(links.e == Approx(0.1 * 0.225 + 0.8 * 0.02));
  CHECK(links.a == Approx(0.002 + 0.1 * (0.005625 + 0.0225) + 0.8 * 0.0004));
}
