// Base parameters of a tree, see base_parameters.hpp.
#include "host/trees/base_parameters.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string_view>
#include <utility>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/message.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/run.hpp"

namespace furcula::trees {
namespace {

using dynamics::tree::Inertia;
using dynamics::tree::Sym3;
using dynamics::tree::Vec3;
using Joints = model::RobotModel::Joints;

constexpr std::size_t kOf = kInertialParameters;
constexpr std::array<std::string_view, kOf> kNames{"m",   "mx",  "my",  "mz",  "Ixx",
                                                   "Ixy", "Ixz", "Iyy", "Iyz", "Izz"};

/// Columns that differ by less than so much of the longest are one: angles of a URDF are often written with five digits.
constexpr double kSame = 1e-5;
/// And coefficients below this are none.
constexpr double kNone = 3e-5;
/// A parameter is shown whose standard deviation is below this share of its size.
constexpr double kShown = 0.1;
/// Samples of the recordings that are looked at.
constexpr std::size_t kMostStates = 400;

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// 0 of a mass, 1 of a first moment, 2 of an inertia: the power of a length in it.
int power(std::size_t parameter) { return parameter == 0 ? 0 : parameter < 4 ? 1 : 2; }
std::string_view unit(int power) { return power == 0 ? "kg" : power == 1 ? "kg m" : "kg m^2"; }

std::array<double, kOf> numbers(const Inertia<double>& b) {
  const Sym3<double>& s = b.inertia_kgm2;
  return {b.mass_kg, b.moment_kgm.x, b.moment_kgm.y, b.moment_kgm.z, s.xx, s.xy, s.xz, s.yy, s.yz, s.zz};
}
/// A body that has only this one.
Inertia<double> only(std::size_t parameter) {
  std::array<double, kOf> x{};
  x[parameter] = 1.0;
  return {x[0], {x[1], x[2], x[3]}, {x[4], x[5], x[6], x[7], x[8], x[9]}};
}

/// A length of the robot's size, so that the ten have columns of about one size.
double arm_m(const model::RobotModel& robot) {
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < robot.count(); ++i) {
    const double square = dot(robot.tree(i).at, robot.tree(i).at);
    if (robot.shape().parent(i) < 0 || square < 1e-6) continue;
    squares += square;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.2;
}

/// The order in which a body's columns are taken: what is customarily counted elsewhere comes last.
std::array<std::size_t, kOf> order(const model::RobotModel& robot, std::size_t body) {
  if (robot.shape().kind(body) == dynamics::tree::JointKind::prismatic) return {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const Vec3<double>& z = robot.aligned(body).turn.z;  // the axis in the link
  const std::array<double, 3> axis{std::abs(z.x), std::abs(z.y), std::abs(z.z)};
  std::array<std::size_t, 3> across{0, 1, 2}, along{0, 1, 2};
  std::stable_sort(across.begin(), across.end(), [&](auto a, auto b) { return axis[a] < axis[b] - 1e-9; });
  std::stable_sort(along.begin(), along.end(), [&](auto a, auto b) { return axis[a] > axis[b] + 1e-9; });
  constexpr std::array<std::size_t, 3> kDiagonal{4, 7, 9};
  return {1 + across[0],       1 + across[1], 5, 6, 8, kDiagonal[along[0]], kDiagonal[along[1]],
          kDiagonal[along[2]], 1 + across[2], 0};
}

/// Torques of random motions in which gravity, rates and accelerations make about as much each. A column a parameter, in units of
/// `arm` to its power.
Eigen::MatrixXd random_motions(const model::RobotModel& robot, double arm) {
  constexpr std::size_t kStates = 60;
  const std::size_t n = robot.count();
  std::mt19937_64 random(1);
  const auto between = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  Eigen::MatrixXd out(at(kStates * n), at(kOf * n));
  for (std::size_t k = 0; k < kStates; ++k) {
    Joints q{}, v{}, a{};
    for (std::size_t j = 0; j < n; ++j) {
      const bool slides = robot.shape().kind(j) == dynamics::tree::JointKind::prismatic;
      const double length = slides ? arm : 1.0, rate2 = 9.81 / arm;
      q[j] = slides ? between(arm) : between(3.1);
      v[j] = length * between(std::sqrt(rate2));
      a[j] = length * between(rate2);
    }
    out.middleRows(at(k * n), at(n)) = inertial_regressor(robot, q, v, a);
  }
  for (std::size_t c = 0; c < kOf * n; ++c) out.col(at(c)) *= std::pow(arm, power(c % kOf));
  return out;
}

std::string in_words(const TreeModel& m, const BaseStructure& structure, std::size_t row) {
  const std::size_t leading = structure.leading[row];
  const auto name = [&](std::size_t p) {
    return std::string(kNames[p % kOf]) + "(" + m.robot.joints[p / kOf].link + ")";
  };
  std::string out = name(leading);
  for (std::size_t p = 0; p < kOf * m.joints(); ++p) {
    const double c = structure.combination(at(row), at(p));
    if (p == leading || c == 0.0) continue;
    const double size = std::abs(c);
    out +=
        (c < 0.0 ? " - " : " + ") + (std::abs(size - 1.0) < kNone ? "" : core::rounded(size) + " ") + name(p);
  }
  return out;
}

/// What each of the bodies' numbers can be at most, see base_parameters().
Eigen::VectorXd most(const Eigen::VectorXd& given) {
  Eigen::VectorXd out(given.size());
  for (Eigen::Index b = 0; b < given.size(); b += at(kOf)) {
    const double mass = given(b), j = 0.5 * (given(b + 4) + given(b + 7) + given(b + 9));
    for (std::size_t p = 0; p < kOf; ++p)
      out(b + at(p)) = power(p) == 0 ? mass : power(p) == 1 ? std::sqrt(std::max(0.0, mass * j)) : j;
  }
  return out;
}

/// Of all joints' samples, states that are further apart than what one measurement is smoothed over, at most kMostStates.
struct State {
  std::size_t recording;
  double time_s;
  Joints q{}, v{}, a{};
};
std::vector<State> states_of(const std::vector<TorqueSamples>& samples) {
  std::vector<State> all;
  double apart_s = 0.0;
  for (const TorqueSamples& s : samples) {
    apart_s = std::max(apart_s, 2.0 * s.half_s);
    for (std::size_t k = 0; k < s.time_s.size(); ++k) {
      State state{s.recording[k], s.time_s[k]};
      bool finite = true;
      for (std::size_t j = 0; j < s.others.size(); ++j) {
        state.q[j] = s.others[j].angle_rad[k];
        state.v[j] = s.others[j].velocity_radps[k];
        state.a[j] = s.others[j].acceleration_radps2[k];
        finite = finite && std::isfinite(state.q[j] + state.v[j] + state.a[j]);
      }
      if (finite) all.push_back(state);
    }
  }
  const auto place = [](const State& s) { return std::pair(s.recording, s.time_s); };
  std::sort(all.begin(), all.end(), [&](const State& a, const State& b) { return place(a) < place(b); });
  std::vector<State> apart;
  for (const State& s : all)
    if (apart.empty() || s.recording != apart.back().recording || s.time_s - apart.back().time_s > apart_s)
      apart.push_back(s);
  const std::size_t step = (apart.size() + kMostStates - 1) / kMostStates;
  std::vector<State> out;
  for (std::size_t k = 0; k < apart.size(); k += step) out.push_back(apart[k]);
  return out;
}

double rms_of(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

/// Standard deviations of unknowns with this information, each in its own unit. What has none has no end.
Eigen::VectorXd deviations(const Eigen::MatrixXd& information) {
  const linear::Axes axes = linear::axes(information);
  const double least = 1e-13 * std::max(axes.values.maxCoeff(), 1e-300);
  Eigen::VectorXd out(information.rows());
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    double variance = 0.0;
    for (Eigen::Index k = 0; k < out.size(); ++k) {
      const double share = std::pow(axes.vectors(i, k), 2), of = axes.values(k);
      if (of > least)
        variance += share / of;
      else if (share > 1e-9)
        variance = std::numeric_limits<double>::infinity();
    }
    out(i) = std::sqrt(variance);
  }
  return out;
}

}  // namespace

Eigen::VectorXd inertial_parameters(const model::RobotModel& robot) {
  Eigen::VectorXd out(at(kOf * robot.count()));
  for (std::size_t b = 0; b < robot.count(); ++b) {
    const std::array<double, kOf> body = numbers(robot.body(b));
    for (std::size_t p = 0; p < kOf; ++p) out(at(kOf * b + p)) = body[p];
  }
  return out;
}

Eigen::MatrixXd inertial_regressor(const model::RobotModel& robot, const Joints& q, const Joints& qd,
                                   const Joints& qdd) {
  const std::size_t n = robot.count();
  Eigen::MatrixXd out(at(n), at(kOf * n));
  model::RobotModel one = robot;
  for (std::size_t b = 0; b < n; ++b) one.set_body(b, {});
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t p = 0; p < kOf; ++p) {
      one.set_body(b, only(p));
      const Joints torque = dynamics::tree::body_torques(one, q, qd, qdd);
      for (std::size_t j = 0; j < n; ++j) out(at(j), at(kOf * b + p)) = torque[j];
    }
    one.set_body(b, {});
  }
  return out;
}

BaseStructure base_structure(const model::RobotModel& robot) {
  const double arm = arm_m(robot);
  const Eigen::MatrixXd columns = random_motions(robot, arm);
  const double longest = columns.colwise().norm().maxCoeff();
  // Gram and Schmidt, each column made orthogonal twice: in a given order, which a QR with pivots would not keep.
  BaseStructure out;
  std::vector<std::size_t> dependent;
  Eigen::MatrixXd basis(columns.rows(), columns.cols());
  for (std::size_t b = 0; b < robot.count(); ++b)
    for (const std::size_t p : order(robot, b)) {
      const std::size_t c = kOf * b + p;
      const auto known = basis.leftCols(at(out.leading.size()));
      Eigen::VectorXd rest = columns.col(at(c));
      for (int twice = 0; twice < 2; ++twice) rest -= known * (known.transpose() * rest);
      if (rest.norm() > kSame * longest) {
        basis.col(at(out.leading.size())) = rest.normalized();
        out.leading.push_back(c);
      } else {
        dependent.push_back(c);
      }
    }
  std::sort(out.leading.begin(), out.leading.end());
  Eigen::MatrixXd leading(columns.rows(), at(out.leading.size()));
  for (std::size_t i = 0; i < out.leading.size(); ++i) leading.col(at(i)) = columns.col(at(out.leading[i]));
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(leading);
  out.combination = Eigen::MatrixXd::Zero(leading.cols(), columns.cols());
  for (std::size_t i = 0; i < out.leading.size(); ++i) out.combination(at(i), at(out.leading[i])) = 1.0;
  for (const std::size_t c : dependent) {
    const Eigen::VectorXd x = solver.solve(columns.col(at(c)));
    for (std::size_t i = 0; i < out.leading.size(); ++i)
      if (std::abs(x(at(i))) > kNone)
        out.combination(at(i), at(c)) =
            x(at(i)) * std::pow(arm, power(out.leading[i] % kOf) - power(c % kOf));
  }
  return out;
}

std::vector<BaseParameter> base_parameters(const TreeModel& model, const Hypothesis& extended,
                                           const std::vector<TorqueSamples>& samples,
                                           const std::vector<double>& torque_nm) {
  const SetupMaker maker(model);
  const model::RobotModel robot = maker.make({model.drives, model.causes}).model;
  const Eigen::VectorXd given = inertial_parameters(robot);
  const BaseStructure structure = base_structure(robot);
  const Eigen::VectorXd value = structure.combination * given,
                        with_causes = structure.combination * inertial_parameters(maker.make(extended).model);
  const std::size_t n = model.joints(), count = structure.leading.size();
  // What each is measured by; without one, its unit.
  const Eigen::VectorXd bodies = most(given);
  Eigen::VectorXd size(at(count));
  for (std::size_t i = 0; i < count; ++i) {
    size(at(i)) = std::max(bodies(at(structure.leading[i])), std::abs(value(at(i))));
    if (!(size(at(i)) > 0.0)) size(at(i)) = 1.0;
  }

  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(at(count), at(count)),
                  squares = Eigen::MatrixXd::Zero(at(n), at(count));
  // A joint without samples stands still: dry friction holds it with any torque.
  std::vector<double> noise_nm(n, 0.0);
  for (std::size_t j = 0; j < n; ++j)
    if (!samples[j].missing_nm.empty())
      noise_nm[j] = std::max(rms_of(samples[j].missing_nm), 1e-4 * torque_nm[j]);
  const std::vector<State> states = states_of(samples);
  for (const State& s : states) {
    const Eigen::MatrixXd all = inertial_regressor(robot, s.q, s.v, s.a);
    for (std::size_t j = 0; j < n; ++j) {
      Eigen::VectorXd row(at(count));
      for (std::size_t i = 0; i < count; ++i) row(at(i)) = all(at(j), at(structure.leading[i]));
      squares.row(at(j)) += row.cwiseAbs2();
      row = row.cwiseProduct(size);
      if (noise_nm[j] > 0.0) information += row * row.transpose() / (noise_nm[j] * noise_nm[j]);
    }
  }
  const Eigen::VectorXd sd = deviations(information);

  std::vector<BaseParameter> out;
  for (std::size_t i = 0; i < count; ++i) {
    BaseParameter b;
    b.combination = in_words(model, structure, i);
    b.unit = unit(power(structure.leading[i] % kOf));
    const auto clean = [&](double x) { return std::abs(x) < 1e-12 * size(at(i)) ? 0.0 : x; };
    b.value = clean(value(at(i)));
    b.extended = clean(with_causes(at(i)));
    b.sd = sd(at(i)) * size(at(i));
    b.shown = sd(at(i)) < kShown;
    double largest = -1.0;
    for (std::size_t j = 0; j < n; ++j) {
      const double of_one =
          std::sqrt(squares(at(j), at(i)) / static_cast<double>(std::max<std::size_t>(1, states.size())));
      const double share = torque_nm[j] > 0.0 ? of_one / torque_nm[j] : 0.0;
      if (share > largest) {
        largest = share;
        b.joint = j;
        b.torque_rms_nm = of_one * std::abs(b.value);
      }
    }
    out.push_back(std::move(b));
  }
  return out;
}

}  // namespace furcula::trees
