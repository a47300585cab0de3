// What a release/catch test must meet to pass.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace furcula::bench {

/// Absent: not asked.
struct Limits {
  std::optional<double> caught_after_max_s;  ///< of every trial, from the catch command to standstill
  std::optional<double>
      released_after_max_s;                ///< of every trial, from the release command to the first motion
  std::optional<double> drop_max_m;        ///< of every trial, from where the load hung to where it is held
  std::optional<double> not_released_max;  ///< trials; 0 unless it is given
  std::optional<double> not_caught_max;    ///< trials
  std::optional<double> slips_max;         ///< trials that moved again after they stood
  std::optional<double> holding_min_kg;    ///< at the pressing force of the test
};

/// A file with the section [limits] and these names as keys. @throws core::DataError naming file, line, key,
/// value and what was expected.
Limits read_limits(const std::string& path);
Limits parse_limits(std::string_view text, const std::string& name);

}  // namespace furcula::bench
