// The reader of gait files, and one stride of what it reads.
#include <cmath>

#include "host/core/error.hpp"
#include "host/gait/gait_file.hpp"
#include "tests/fuzz/message.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  gait::Gait gait;
  try {
    gait = gait::parse_gait(input, "input");
  } catch (const core::DataError& e) {
    require_printable(e);
    return false;
  }
  const std::string written = gait::format_gait(gait);
  const gait::Gait again = gait::parse_gait(written, "input");
  require(gait::format_gait(again) == written, "a gait that was read is written the same");
  gait::require_same_robot(gait, again.machine, "input");
  gait::StrideOptions options;
  options.lift_off = gait.task.lift_off;
  options.longest_step_s = 0.02;
  options.energies = false;
  try {
    const auto stride = gait::stride_of(gait, options);
    require(!stride.whole || std::isfinite(stride.apex.height), "a whole stride ends at an apex");
  } catch (const core::DataError& e) {
    require_printable(e);  // a gait whose hip does not rise and fall in flight
  }
  return true;
}

}  // namespace furcula::fuzz
