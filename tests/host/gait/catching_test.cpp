// A switched spring that catches late, and on a tooth: against the stride's own moments, and against what less of a spring
// can do.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/host/gait/legs.hpp"

using namespace furcula;
using namespace furcula::gait;

namespace {

Search found_with(const Catching& catching, const Search& near) {
  Query q;
  q.machine = spear(LegSpring::switched);
  q.machine.catching = catching;
  q.task = test::in_place(0.075);
  q.from = near.free;
  q.explains = false;
  return find_gait(q);
}

}  // namespace

TEST_CASE("a spring that catches late rests at the knee's angle of then, and pulls from there") {
  const Search ideal = test::found(LegSpring::switched, test::in_place(0.075));
  REQUIRE(ideal.gait);
  const Catching catching{0.02, 0.05};
  const Search s = found_with(catching, ideal);
  REQUIRE(s.gait);
  CHECK(s.evaluation.closure < 1e-9);
  // From the stride's moments alone.
  double landed = -1.0, caught = 0.0;
  const double k = s.gait->machine.leg.stiffness_nmprad;
  for (const Moment& m : moments_of(*s.gait)) {
    if (m.phase != LegPhase::stance) {
      CHECK(m.spring_nm == 0.0);
      continue;
    }
    if (landed < 0.0) landed = m.time_s;
    const double t = m.time_s - landed;
    if (t < catching.delay_s + 1e-9) {
      CHECK(m.spring_nm == 0.0);
      caught = m.angle.knee;
    } else {
      CHECK(m.spring_nm ==
            Approx(-k * std::max(m.angle.knee - caught - catching.lost_rad, 0.0)).margin(1e-6));
    }
  }
  // Multipliers pass through the catch: their sum is that of differences of strides.
  REQUIRE(s.evaluation.multipliers.size() == 6);
  CHECK(std::abs(s.evaluation.multipliers.front()) > 4.0);
}

TEST_CASE("the later a spring catches and the wider its teeth, the more a hop costs", "[slow]") {
  const Search ideal = test::found(LegSpring::switched, test::in_place(0.075));
  const Search parallel = test::found(LegSpring::parallel, test::in_place(0.075));
  REQUIRE(ideal.gait);
  REQUIRE(parallel.gait);
  double before = ideal.evaluation.cost_j;
  Search near = ideal;
  for (const double delay : {0.005, 0.010, 0.020, 0.030}) {
    near = found_with({delay, 0.0}, near);
    REQUIRE(near.gait);
    CHECK(near.evaluation.cost_j > before);
    CHECK(near.evaluation.limits.empty());
    before = near.evaluation.cost_j;
  }
  // At 30 ms the fixed spring is the cheaper one.
  CHECK(before > parallel.evaluation.cost_j);
  // A tooth of 0.05 rad is lost in some 10 ms of the knee's 5 rad/s.
  const double tooth = found_with({0.0, 0.05}, ideal).evaluation.cost_j,
               late = found_with({0.010, 0.0}, ideal).evaluation.cost_j;
  CHECK(tooth == Approx(late).epsilon(0.02));
}
