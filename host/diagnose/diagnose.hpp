// The diagnosis: what a model gets wrong about recordings, which cause of the catalogue removes it, and how
// well the extended model predicts recordings that no fit has seen.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/rule.hpp"
#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

struct Options {
  double window_s = 0.5;  ///< length of a prediction on axes without strides
  unsigned threads = 2;   ///< the result does not depend on it
  std::function<void(double, std::string_view)>
      progress;  ///< share done, what is being tried; from any thread
  WithoutRules without;
  bool trust_columns = false;  ///< units, signs and zeros are not tried (host/conventions/trial.hpp)
};

/// Diagnoses a model on training recordings, judged on held-out ones. Both at least one log of the model's
/// rig.
/// @throws core::DataError where the logs hold no window to predict over (no stride from apex to apex, too
/// short).
Diagnosis diagnose(const model::Model& model, const std::vector<log::Log>& training,
                   const std::vector<log::Log>& held_out, const Options& options = {});

}  // namespace furcula::diagnose
