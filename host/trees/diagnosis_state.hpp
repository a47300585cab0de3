// What the steps of a diagnosis share.
#pragma once

#include <string>
#include <vector>

#include "host/trees/diagnose.hpp"
#include "host/trees/missing_torque.hpp"

namespace furcula::trees {

struct DiagnosisState {
  const TreeModel& model;
  const Options& options;
  std::vector<Recording> training{}, held_out{};
  std::vector<ChannelError> training_error{};  ///< of the extended model
  std::vector<TorqueSamples> after{};          ///< of the extended model, of each joint
  std::vector<Hypothesis> undecided{};         ///< rivals that cannot be told from a finding
  bool at_bound = false;                       ///< of a finding
  double disputed = 0.0;                       ///< see Found
  bool ended_early = false, unjudged = false;  ///< see Found
  Diagnosis d{};
};

/// "a, b and c".
std::string joined(const std::vector<std::string>& all);

}  // namespace furcula::trees
