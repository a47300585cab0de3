#include "host/biped/machine_toml.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::biped {
void apply_deviations(const toml::table& deviations, const std::string& file, Machine& machine) {
  constexpr double kMost = 1e7;
  const Machine given = machine;
  const std::vector<Unknown> all = unknowns(machine.robot, true, true);
  std::vector<std::string> names;
  for (const Unknown& u : all) names.push_back(u.name());
  core::refuse_unknown_keys(deviations, file, "[deviations]",
                            std::vector<std::string_view>(names.begin(), names.end()));
  for (std::size_t i = 0; i < all.size(); ++i)
    if (const toml::node* value = deviations.get(names[i]))
      all[i].add(machine, core::number(*value, file, "[deviations] " + core::quoted(names[i]), -kMost, kMost,
                                       all[i].unit));
  Machine possible = machine;
  // A fit may end at a bound, from which a file's numbers are off by rounding.
  constexpr double kRounding = 1e-9;
  const auto off = [&](const Unknown& u) {
    return !(std::abs(u.value(possible) - u.value(machine)) <= kRounding * u.prior_sd);
  };
  if (make_possible(given, possible) && std::any_of(all.begin(), all.end(), off))
    core::fail(
        file, deviations.source(),
        "[deviations] give a robot that cannot be: a mass below a fifth of the URDF's, an inertia that no body has, "
        "negative friction, or gains below a fifth of the design's");
  machine = possible;
}

std::string format_deviations(const Machine& given, const Machine& machine) {
  std::string out = "[deviations]\n";
  for (const Unknown& u : unknowns(given.robot, true, true)) {
    const double change = u.value(machine) - u.value(given);
    if (change == 0.0) continue;
    out +=
        "\"" + u.name() + "\" = " + core::toml_float(change) + (u.unit.empty() ? "" : "  # " + u.unit) + "\n";
  }
  return out;
}

}  // namespace furcula::biped
