// Catch2 3 under the header and the names of Catch2 2, which the tests use: Debian 12 has 2.13, Debian 13 has 3.7.
#pragma once

#include <catch2/catch_all.hpp>
#include <string>

using Catch::Approx;

namespace Catch {

using Matchers::EndsWith;
using Matchers::Matches;
using Matchers::StartsWith;
using Matchers::VectorContains;

/// Matches a string that contains `part`. Catch2 3 calls it ContainsSubstring; its own Contains is of ranges.
inline auto Contains(const std::string& part, CaseSensitive sensitive = CaseSensitive::Yes) {
  return Matchers::ContainsSubstring(part, sensitive);
}

}  // namespace Catch
