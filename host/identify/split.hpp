// Which recordings are held out where the user does not say.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "host/log/log.hpp"

namespace furcula::identify {

/// Splits logs into training and held-out ones: a seeded fifth, at least one; of a single log its last
/// quarter.
/// @throws core::DataError where there is no log, or a single one of fewer than 80 rows.
std::pair<std::vector<log::Log>, std::vector<log::Log>> split(std::vector<log::Log> logs, std::uint64_t seed);

}  // namespace furcula::identify
