// Reading limits, see limits.hpp.
#include "host/bench/limits.hpp"

#include <array>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::bench {
namespace {

struct Key {
  std::string_view name, unit;
  double most;
  std::optional<double> Limits::*member;
};
constexpr std::array<Key, 7> kKeys{{{"caught_after_max_s", "s", 10.0, &Limits::caught_after_max_s},
                                    {"released_after_max_s", "s", 10.0, &Limits::released_after_max_s},
                                    {"drop_max_m", "m", 10.0, &Limits::drop_max_m},
                                    {"not_released_max", "", 1e6, &Limits::not_released_max},
                                    {"not_caught_max", "", 1e6, &Limits::not_caught_max},
                                    {"slips_max", "", 1e6, &Limits::slips_max},
                                    {"holding_min_kg", "kg", 1e4, &Limits::holding_min_kg}}};

}  // namespace

Limits parse_limits(std::string_view text, const std::string& name) {
  const toml::table file = core::parse_toml(text, name);
  static constexpr std::array<std::string_view, 1> kSections{"limits"};
  core::refuse_unknown_keys(file, name, "the limits", kSections);
  const toml::node* section = file.get("limits");
  if (section == nullptr) core::fail(name, file.source(), "no section [limits]; expected one");
  const toml::table& table = core::table(*section, name, "[limits]");
  std::array<std::string_view, kKeys.size()> known;
  for (std::size_t i = 0; i < kKeys.size(); ++i) known[i] = kKeys[i].name;
  core::refuse_unknown_keys(table, name, "[limits]", known);
  Limits limits;
  for (const Key& key : kKeys)
    if (const toml::node* node = table.get(key.name))
      limits.*key.member = core::number(*node, name, key.name, 0.0, key.most, key.unit);
  if (table.empty())
    core::fail(name, section->source(), "no limit in [limits]; expected one of " + core::listed(known));
  return limits;
}

Limits read_limits(const std::string& path) {
  return parse_limits(core::read_small_file(path, "limits (TOML)"), path);
}

}  // namespace furcula::bench
