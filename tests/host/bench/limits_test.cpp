// Limits of the release/catch test.
#include "host/bench/limits.hpp"

#include <catch2/catch.hpp>

#include "tests/host/error_message.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("Limits that are not given are not asked") {
  const bench::Limits l =
      bench::parse_limits("[limits]\ncaught_after_max_s = 0.05\nslips_max = 0\n", "l.toml");
  CHECK(l.caught_after_max_s == 0.05);
  CHECK(l.slips_max == 0.0);
  CHECK_FALSE(l.drop_max_m.has_value());
  CHECK_FALSE(l.holding_min_kg.has_value());
}

TEST_CASE("A limit with a typo, a wrong value or no section is refused with file and line") {
  const auto refused = [](const char* text) {
    return test::error_message([&] { bench::parse_limits(text, "l.toml"); });
  };
  CHECK_THAT(refused("[limits]\ncaugth_after_max_s = 0.05\n"),
             Contains("l.toml:2: unknown key 'caugth_after_max_s'") &&
                 Contains("did you mean 'caught_after_max_s'?"));
  CHECK_THAT(refused("[limits]\ndrop_max_m = -1\n"),
             Contains("l.toml:2: drop_max_m = -1; expected a number from 0"));
  CHECK_THAT(refused("caught_after_max_s = 0.05\n"),
             Contains("unknown key 'caught_after_max_s' in the limits"));
  CHECK_THAT(refused(""), Contains("no section [limits]"));
  CHECK_THAT(refused("[limits]\n"), Contains("no limit in [limits]; expected one of caught_after_max_s"));
}
