// Least squares by orthogonal factors, see linear.hpp.
#include <Eigen/QR>

#include "host/linear/linear.hpp"

namespace furcula::linear {

using Orthogonal = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

Eigen::VectorXd least_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold) {
  Orthogonal solver(a.rows(), a.cols());
  if (threshold > 0.0) solver.setThreshold(threshold);
  solver.compute(a);
  return solver.solve(b);
}
Eigen::VectorXd least_norm(const Eigen::MatrixXd& a, const Eigen::Vector3d& b) {
  return Orthogonal(a).solve(b);
}
Eigen::MatrixXd least_norm(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Orthogonal(a).solve(b);
}
Eigen::Vector3d least_norm_of_three(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return Orthogonal(a).solve(b);
}
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a) { return Orthogonal(a).pseudoInverse(); }

Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

}  // namespace furcula::linear
