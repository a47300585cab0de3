// A virtual hopper that differs from its model by one cause, both drawn from a seed, and its recordings.
#pragma once

#include <cstdint>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::sim {

struct HiddenCase {
  model::Model model;          ///< what is believed of the machine: without the cause, the dampings free
  model::Model truth;          ///< the machine itself, the cause among its effects
  dynamics::Effect cause;      ///< the only effect of `truth`
  std::vector<log::Log> logs;  ///< eight experiments of about six hops each, with the rig's sensor errors
};

/// The same seed gives the same machine and the same logs. Any effect of the catalogue that a hopper can have
/// is as likely as any other, in a size that a careful experimenter could find.
HiddenCase draw_hidden_case(std::uint64_t seed);

}  // namespace furcula::sim
