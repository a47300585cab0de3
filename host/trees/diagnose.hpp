// The diagnosis of a robot of several joints: what its model gets wrong, at which joint, link or drive.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "host/log/log.hpp"
#include "host/trees/diagnosis.hpp"
#include "host/trees/search.hpp"

namespace furcula::trees {

struct Options {
  double window_s = 0.3;
  unsigned threads = 2;
  std::function<void(double, std::string_view)> progress;
  std::size_t most_work = kMostWork;  ///< see search.hpp
  bool trust_columns = false;         ///< units, signs and zeros are not tried (host/conventions/trial.hpp)
};

/// @throws core::DataError: what recording_of and require_conventions throw, no window in the training or the held-out logs.
Diagnosis diagnose(const TreeModel& model, const std::vector<log::Log>& training,
                   const std::vector<log::Log>& held_out, const Options& options = {});

/// Errors of predictions over held-out windows, of each joint. A window starts from a state estimated from its first 50 ms alone,
/// by the motion that the model itself leaves there: one from another model would be wrong by what that lacks.
struct Predictions {
  std::vector<ChannelError> errors;
  std::vector<double> floor;  ///< nmse of the measuring noise
};
Predictions predict(const TreeModel& model, const std::vector<Recording>& recordings, double window_s,
                    const Hypothesis& h, std::vector<Trace>* traces = nullptr,
                    std::vector<double> Trace::*into = nullptr);

}  // namespace furcula::trees
