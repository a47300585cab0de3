// What a fit says of the model's free parameters: those of drives as they are fitted, those of bodies as a URDF has them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

struct Reported {
  struct Row {
    std::string name, unit;           ///< "damping_nmspr.elbow", "mass_kg.fore"
    std::size_t unknown = 0;          ///< of the fit; of a body the first of its coordinates
    std::optional<std::size_t> link;  ///< of a body
    std::size_t part = 0;             ///< in kInertialNames
    double given = 0.0, value = 0.0;
    std::vector<double> folds;  ///< fitted on each fold alone
  };
  std::vector<Row> rows;
  /// Of the rows' values, to first order; the part of it that is known beforehand alone; and the variance
  /// that this alone has, at the given body or here, whichever is more.
  Eigen::MatrixXd covariance, of_prior;
  Eigen::VectorXd prior_variance;
};

/// Drives first. Parameters of causes are left out.
Reported reported(const TreeModel& model, const Fit& fit);

/// Whether recordings and what is known beforehand say how large a row is: "identified", "correlated" with another row, "not_excited".
struct ParameterVerdict {
  std::string verdict, with;
};
/// By the covariance alone; `still`: joints that stand still.
ParameterVerdict parameter_verdict(const TreeModel& model, const Reported& all, std::size_t row,
                                   const std::vector<bool>& still);

/// 95 % of a body's row: a mass within its bounds, a principal moment not below 0.
Interval interval_of(const Fit& fit, const Reported& all, std::size_t row);

}  // namespace furcula::trees
