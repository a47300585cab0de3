// The virtual hopper with one hidden cause, see host/sim/hidden_case.hpp.
#include "host/sim/hidden_case.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace furcula;

TEST_CASE("a drawn machine_type is its model with other dampings and exactly one effect") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    const sim::HiddenCase m = sim::draw_hidden_case(seed);
    CHECK(m.model.effects.empty());
    REQUIRE(m.truth.effects.size() == 1);
    CHECK(m.truth.effects.begin()->first == m.cause);
    for (std::size_t i = 0; i < m.model.parameters.size(); ++i) {
      const bool free = m.model.free.contains(i);
      CHECK((m.truth.parameters[i] == m.model.parameters[i]) == !free);
      if (free) {
        CHECK(m.truth.parameters[i] > m.model.free.at(i).lower);
        CHECK(m.truth.parameters[i] < m.model.free.at(i).upper);
      }
    }
  }
}

TEST_CASE("every effect that a hopper can have is drawn, with a size") {
  std::set<dynamics::Effect> drawn;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const sim::HiddenCase m = sim::draw_hidden_case(seed);
    drawn.insert(m.cause);
    const auto& e = dynamics::info(m.cause);
    for (std::size_t i = 0; i < e.parameter_count; ++i) {
      const auto& p = e.parameter_table[i];
      CAPTURE(seed, e.name, p.name);
      const double value = m.truth.effects.at(m.cause)[i];
      CHECK(value != (std::isnan(p.neutral) ? 0.0 : p.neutral));
      CHECK((p.lower <= value && value <= p.upper));
    }
  }
  for (const auto& e : dynamics::kCatalogue) {
    CAPTURE(e.name);
    // The dampings are free parameters of the drawn model; backlash hardly moves the body; it has no clutch.
    const bool possible = dynamics::applies(e.effect, dynamics::Kind::hopper_linear) &&
                          e.effect != dynamics::Effect::damping_error &&
                          e.effect != dynamics::Effect::backlash && !dynamics::needs_clutch(e.effect);
    CHECK(drawn.contains(e.effect) == possible);
  }
}

TEST_CASE("a drawn machine keeps hopping, and its height is an encoder's") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const sim::HiddenCase m = sim::draw_hidden_case(seed);
    REQUIRE(m.logs.size() == 8);
    // The first two are a drop without torque and one with little of it.
    for (std::size_t i = 2; i < m.logs.size(); ++i) {
      CAPTURE(seed, i);
      const auto& height = m.logs[i].at("height_m");
      const auto& time = m.logs[i].time_s();
      int apexes = 0;
      double last_fall_s = 0.0;
      for (std::size_t row = 1; row < height.size(); ++row) {
        if (height[row - 1] >= 0.285 && height[row] < 0.285 && time[row] - last_fall_s > 0.1) {
          ++apexes;
          last_fall_s = time[row];
        }
        // 2000 counts a turn on 0.18 m a turn.
        const double counts = height[row] / 0.00009;
        REQUIRE(std::abs(counts - std::round(counts)) < 1e-6);
      }
      CHECK(apexes >= 4);
    }
  }
}

TEST_CASE("the same seed draws the same machine and the same logs, another seed others") {
  const sim::HiddenCase a = sim::draw_hidden_case(7), b = sim::draw_hidden_case(7),
                        c = sim::draw_hidden_case(8);
  CHECK(a.truth.parameters == b.truth.parameters);
  CHECK(a.cause == b.cause);
  for (std::size_t i = 0; i < a.logs.size(); ++i) CHECK(a.logs[i].columns == b.logs[i].columns);
  CHECK(a.truth.parameters != c.truth.parameters);
}
