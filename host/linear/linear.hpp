// Decompositions of dense matrices. A compiler takes seconds for each of Eigen's, in every file that names one: here each is compiled
// once, and who solves needs <Eigen/Core> alone.
#pragma once

#include <Eigen/Core>

namespace furcula::linear {

/// Of all x for which |a x - b| is least, the shortest. Pivots below `threshold` times the largest count as none (0: a few roundings).
Eigen::VectorXd least_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold = 0.0);
Eigen::VectorXd least_norm(const Eigen::MatrixXd& a, const Eigen::Vector3d& b);
Eigen::MatrixXd least_norm(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// Of three columns.
Eigen::Vector3d least_norm_of_three(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a);

/// An x for which |a x - b| is least, column by column.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Of a square matrix.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

/// a x = b with a symmetric and not indefinite (L D L').
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::Vector3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);

/// a x = b with a positive definite (L L').
Eigen::VectorXd solve_positive(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// `positive`: whether it is positive definite; without it the result is of no use.
Eigen::MatrixXd inverse_of_positive(const Eigen::MatrixXd& a, bool* positive = nullptr);
/// The lower triangular L with L L' = a; where rounding leaves `a` not positive definite, that of its diagonal.
Eigen::MatrixXd root_of_positive(const Eigen::MatrixXd& a);
/// x with L x = b.
Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& root, const Eigen::MatrixXd& b);
/// Natural logarithm of the determinant.
double log_determinant_of_positive(const Eigen::MatrixXd& a);

/// Eigenvalues in ascending order, and the eigenvectors in columns, each of length one.
struct Axes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
struct Axes3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};
/// Of a symmetric matrix, of which the lower half is read.
Axes axes(const Eigen::MatrixXd& symmetric);
Axes3 axes_of_three(const Eigen::Matrix3d& symmetric);
/// The values alone.
Eigen::Vector3d axes_values_of_three(const Eigen::Matrix3d& symmetric);

}  // namespace furcula::linear
