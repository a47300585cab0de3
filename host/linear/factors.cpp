// Inverses and triangular factors, see linear.hpp.
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "host/linear/linear.hpp"

namespace furcula::linear {

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) { return a.inverse(); }

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.ldlt().solve(b);
}
Eigen::Vector3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd solve_positive(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.llt().solve(b);
}
Eigen::MatrixXd inverse_of_positive(const Eigen::MatrixXd& a, bool* positive) {
  const Eigen::LLT<Eigen::MatrixXd> factors(a);
  if (positive != nullptr) *positive = factors.info() == Eigen::Success;
  return factors.solve(Eigen::MatrixXd::Identity(a.rows(), a.cols()));
}
Eigen::MatrixXd root_of_positive(const Eigen::MatrixXd& a) {
  const Eigen::LLT<Eigen::MatrixXd> factors(a);
  if (factors.info() == Eigen::Success) return factors.matrixL();
  return a.diagonal().cwiseSqrt().asDiagonal();
}
Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& root, const Eigen::MatrixXd& b) {
  return root.triangularView<Eigen::Lower>().solve(b);
}
double log_determinant_of_positive(const Eigen::MatrixXd& a) {
  return 2.0 * Eigen::MatrixXd(a.llt().matrixL()).diagonal().array().log().sum();
}

}  // namespace furcula::linear
