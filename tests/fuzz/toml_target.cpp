// Any text as TOML: what is parsed is no deeper than it may be, so that nothing recurses far.
#include <algorithm>
#include <cstddef>

#include "host/core/error.hpp"
#include "host/core/strict_toml.hpp"
#include "host/core/toml_depth.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

std::size_t depth_of(const toml::node& node) {
  std::size_t most = 0;
  if (const toml::table* table = node.as_table())
    for (const auto& [key, child] : *table) most = std::max(most, depth_of(child));
  if (const toml::array* array = node.as_array())
    for (const toml::node& child : *array) most = std::max(most, depth_of(child));
  return most + 1;
}

}  // namespace

bool accepts(std::string_view input) {
  // A header's names (an array and a table each, in [[a.b]]), a key's, and within its value as many brackets, each
  // with a key of as many names.
  constexpr std::size_t kMost = 3 * core::kTomlDepthMax + core::kTomlDepthMax * (core::kTomlDepthMax + 1) + 2;
  try {
    require(depth_of(core::parse_toml(input, "input")) <= kMost, "a depth that is bounded");
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
