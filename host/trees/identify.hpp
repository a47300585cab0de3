// The free parameters of a tree from its logs.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/log.hpp"
#include "host/trees/diagnose.hpp"

namespace furcula::trees {

struct Identification {
  struct Row {
    std::string name, unit, verdict;  ///< identified, correlated, at_bound, not_excited
    std::string with;                 ///< correlated: the other; at_bound: lower or upper
    double given = 0.0, value = 0.0, lower = 0.0, upper = 0.0;
    std::vector<double> folds;
  };
  TreeModel model;                 ///< at the estimate, but for its bodies
  std::vector<FittedBody> bodies;  ///< of each link whose inertial parameters are free
  std::vector<Row> parameters;
  Eigen::MatrixXd covariance;                                  ///< of the parameters, in their order
  std::vector<ChannelError> as_given_error, identified_error;  ///< held out, of each joint
  std::size_t logs = 0, held_out_logs = 0, windows = 0;
  log::DataQuality data_quality;
  std::vector<std::string> notes;  ///< what the model was taken for
};

/// @throws core::DataError: no free parameter, and what diagnose() throws.
Identification identify(const TreeModel& model, const std::vector<log::Log>& training,
                        const std::vector<log::Log>& held_out, const Options& options = {});

/// `furcula-identification/2`.
std::string to_json_text(const Identification& found);

}  // namespace furcula::trees
