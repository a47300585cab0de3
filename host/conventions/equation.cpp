// A joint's equation, see equation.hpp.
#include "host/conventions/equation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/conventions/trial.hpp"
#include "host/core/quantile.hpp"

namespace furcula::conventions {
namespace {

/// Friction and constant forces over the forces that act (RMS of the drive's and of gravity and springs): what moves is not held.
constexpr double kMostFriction = 0.3;

/// Least squares within bounds, by cyclic descent on the normal equations. It begins with the last coefficient, an input's scale: where the
/// inertia and that scale undo each other, the inertia stays as it is.
Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                                      const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  constexpr int kRounds = 300;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size()).cwiseMax(lower).cwiseMin(upper);
  const Eigen::Index input = x.size() - 1;
  if (gram(input, input) > 0.0)
    x(input) = std::clamp(right(input) / gram(input, input), lower(input), upper(input));
  for (int round = 0; round < kRounds; ++round) {
    double moved = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (!(gram(i, i) > 0.0)) continue;
      const double next = std::clamp(x(i) + (right(i) - gram.row(i).dot(x)) / gram(i, i), lower(i), upper(i));
      moved = std::max(moved, std::abs(next - x(i)) * std::sqrt(gram(i, i)));
      x(i) = next;
    }
    if (moved < 1e-7 * std::sqrt(right.cwiseAbs().maxCoeff() + 1e-300)) break;
  }
  return x;
}

}  // namespace

double Rest::worth_of_drive() const {
  return 0.5 * std::log1p(pushed * pushed / std::max(mean_square, 1e-300));
}

double Rest::off() const { return force > 0.0 ? std::sqrt(mean_square) / force : 0.0; }

double trimmed_mean(std::vector<double> squares) {
  const std::size_t kept = std::max<std::size_t>(
      1, static_cast<std::size_t>((1.0 - kTrimmed) * static_cast<double>(squares.size())));
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(kept) - 1, squares.end());
  return std::accumulate(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(kept), 0.0) /
         static_cast<double>(kept);
}

double Equation::likely_scale() const {
  double both = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < needed.size(); ++i)
    both += needed[i] * given[i], squares += given[i] * given[i];
  return squares > 0.0 ? both / squares : 0.0;
}

Rest Equation::solve(InputScale how, bool any_cause) const {
  const double fixed = how.scale;
  const bool free = how.estimated;
  std::vector<Column> used_columns = columns;
  if (any_cause && !falls)
    used_columns.push_back({passive, 1.0 / kInertiaWithin - 1.0, kInertiaWithin - 1.0});
  const auto rows = static_cast<Eigen::Index>(needed.size());
  const auto count = static_cast<Eigen::Index>(used_columns.size());
  Eigen::MatrixXd all(rows, count + 1);
  Eigen::VectorXd size(count + 1), lower(count + 1), upper(count + 1);
  const Eigen::Map<const Eigen::VectorXd> asked(needed.data(), rows), pushed(given.data(), rows),
      drive(of_drive.data(), rows);
  const double root = 1.0 / std::sqrt(static_cast<double>(rows));
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  for (Eigen::Index c = 0; c <= count; ++c) {
    const bool input = c == count;
    // Of unit size, so that descent is quick.
    const Eigen::VectorXd values = input
                                       ? Eigen::VectorXd(-pushed)
                                       : Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                             used_columns[static_cast<std::size_t>(c)].values.data(), rows));
    size(c) = values.norm() / std::sqrt(static_cast<double>(rows));
    const bool used = size(c) > 0.0 && (!input || free);
    if (used)
      all.col(c) = values / size(c);
    else
      all.col(c).setZero();
    lower(c) = input ? -kUnbounded : used_columns[static_cast<std::size_t>(c)].lower * size(c);
    upper(c) = input ? kUnbounded : used_columns[static_cast<std::size_t>(c)].upper * size(c);
    if ((!any_cause || c == kConstant) && !input && used_columns[static_cast<std::size_t>(c)].friction) {
      const double most =
          kMostFriction * std::max(((free ? likely_scale() : fixed) * pushed - drive).norm() * root, acting);
      lower(c) = std::max(lower(c), -most);
      upper(c) = std::min(upper(c), most);
    }
    if (!used) lower(c) = upper(c) = 0.0;
  }
  const Eigen::VectorXd target = (free ? 0.0 : fixed) * pushed - asked;
  // Twice: what stands out of the first time, a slip or an impact, does not bend the second.
  Eigen::VectorXd x, left, kept = Eigen::VectorXd::Ones(rows);
  for (int round = 0; round < 2; ++round) {
    const Eigen::MatrixXd weighed = kept.asDiagonal() * all;
    x = bounded_least_squares(weighed.transpose() * weighed, weighed.transpose() * target, lower, upper);
    left = target - all * x;
    std::vector<double> sizes(needed.size());
    Eigen::Map<Eigen::VectorXd>(sizes.data(), rows) = left.cwiseAbs();
    const double far = core::quantile(std::move(sizes), 1.0 - kTrimmed);
    for (Eigen::Index i = 0; i < rows; ++i) kept(i) = std::abs(left(i)) <= far ? 1.0 : 0.0;
  }
  Rest rest;
  rest.input_scale = free && size(count) > 0.0 ? x(count) / size(count) : fixed;
  std::vector<double> squares(needed.size());
  Eigen::Map<Eigen::VectorXd>(squares.data(), rows) = left.cwiseAbs2();
  rest.mean_square = trimmed_mean(std::move(squares));
  rest.pushed = (rest.input_scale * pushed - drive).norm() * root;
  Eigen::VectorXd fitted = asked - drive;  // with what was fitted to the bodies
  for (Eigen::Index c = 0; c < count; ++c)
    if (!used_columns[static_cast<std::size_t>(c)].friction) fitted += all.col(c) * x(c);
  rest.force = std::max({rest.pushed, fitted.norm() * root, acting});
  if (size(kConstant) > 0.0) rest.constant = x(kConstant) / size(kConstant);
  // Of a free parameter that changes the inertia the same part counts as of a rotor.
  if (size(kRotor) > 0.0) rest.inertia = x(kRotor) / size(kRotor);
  for (Eigen::Index c = kFree; c < count; ++c)
    if (size(c) > 0.0)
      rest.inertia += used_columns[static_cast<std::size_t>(c)].inertia * x(c) / size(c) *
                      static_cast<double>(rows) / rotor_share;
  rest.inertia_factor = 1.0 + rest.inertia * rotor_share / static_cast<double>(rows);
  return rest;
}

}  // namespace furcula::conventions
