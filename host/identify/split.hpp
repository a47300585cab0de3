// Which recordings are held out where the user does not say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/log/log.hpp"

namespace furcula::identify {

/// Splits logs into training and held-out ones: a seeded fifth, at least one; of fewer than `least_logs` the last quarter of each
/// that has at least 80 rows.
/// @throws core::DataError where there is no log, or no quarter that can be held out.
std::pair<std::vector<log::Log>, std::vector<log::Log>> split(std::vector<log::Log> logs, std::uint64_t seed,
                                                              std::size_t least_logs = 2);

}  // namespace furcula::identify
