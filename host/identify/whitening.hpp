// Residuals of a free run under a random force: what a Kalman filter finds new from row to row, which is white where the model is right.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace furcula::identify {

/// Of one window, linearised about a run of it: the state is what disturbances have done to position and velocity, and the random force.
struct Whitening {
  struct Row {
    Eigen::Vector3d gain = Eigen::Vector3d::Zero();  ///< of what is new, on the state
    double scale = 0.0;  ///< noise of the sensor over the deviation of what is new
    Eigen::Matrix3d step = Eigen::Matrix3d::Zero();  ///< to the next row
  };
  std::vector<Row> rows;

  /// Replaces residuals, or their derivatives, by what is new in them, in units of its deviation. Row by row; rows that the filter does not reach become 0.
  void apply(double* values, std::size_t count, std::size_t columns) const;
};

}  // namespace furcula::identify
