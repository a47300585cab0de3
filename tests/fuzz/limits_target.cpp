// The reader of a bench test's limits.
#include "host/bench/limits.hpp"
#include "host/core/error.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  try {
    const bench::Limits l = bench::parse_limits(input, "input");
    for (const auto& limit : {l.caught_after_max_s, l.released_after_max_s, l.drop_max_m, l.not_released_max,
                              l.not_caught_max, l.slips_max, l.holding_min_kg})
      require(!limit || *limit >= 0.0, "a limit is not negative");
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
