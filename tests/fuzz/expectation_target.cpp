// The reader of a scenario's section [expect].
#include "host/core/error.hpp"
#include "host/sim/expectation.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  try {
    const sim::Expectation e = sim::parse_expectation(input, "input");
    for (const auto& limit : {e.apex_least_m, e.apex_most_m, e.torque_zero_after_s, e.coil_off_after_s,
                              e.releases_least, e.caught_share_least})
      require(!limit || (*limit >= 0.0 && *limit <= 1e6), "a limit within its bounds");
    require(static_cast<std::size_t>(e.fault) < control::kFaultCount, "a fault of the table");
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
