// What a bus does with the controller's parameters (control/parameters.hpp): one at a time is set.
#pragma once

#include "furcula/control/check.hpp"
#include "furcula/control/parameters.hpp"

namespace furcula::bus {

using control::allows;
using control::kParameters;
using control::Parameter;
using control::parameter_named;
using control::parameter_numbered;

/// Sets one parameter. `invalid`: not allowed, or the configuration would make no sense with it
/// (control::check()); `config` is then as it was.
inline Status set(control::Config& config, const Parameter& p, float value) {
  if (!allows(p, value)) return Status::invalid;
  const float before = p.get(config);
  p.put(config, value);
  if (control::check(config) == Status::ok) return Status::ok;
  p.put(config, before);
  return Status::invalid;
}

}  // namespace furcula::bus
