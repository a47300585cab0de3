// See equations.hpp.
#include "host/conventions/equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/linear/linear.hpp"

namespace furcula::conventions {
namespace {

/// Usually an inertia is known within a tenth, and a constant force is a twentieth of what acts.
constexpr double kInertiaKnown = 0.1, kConstantUsual = 0.05;

/// Minus the log prior density of what was fitted beside the reading, once for all instants: it decides where a scale, an inertia and a
/// constant force undo each other. Cauchy: either may be far more than usual.
double cost_of_fitted(const Rest& r) {
  const double inertia = std::log(std::max(r.inertia_factor, 1e-3)) / kInertiaKnown;
  const double constant = r.force > 0.0 ? r.constant / (kConstantUsual * r.force) : 0.0;
  return std::log1p(inertia * inertia) + std::log1p(constant * constant);
}

}  // namespace

bool Equations::write(const Family& family, std::span<const Instant> instants, std::size_t step,
                      const Reading& r) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  const std::vector<Joint>& joints = family.joints();
  const std::size_t n = joints.size();
  const std::vector<FreeParameter> free = family.free_parameters();
  of.assign(n, {});
  for (Equation& e : of) {
    e.columns = {{{}, 0.0, kUnbounded, true},
                 {{}, 0.0, kUnbounded, true},
                 {{}, -kUnbounded, kUnbounded},
                 {{}, -kUnbounded, kUnbounded, true}};
    for (const FreeParameter& p : free) e.columns.push_back({{}, p.lower, p.upper});
  }
  double log_det = 0.0;
  mass.setZero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  std::vector<std::vector<double>> curvatures(n);
  State s{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n), std::vector<double>(n),
          std::vector<double>(n)};
  Forces f;
  std::size_t used = 0;
  for (std::size_t at = 0; at < instants.size(); at += step) {
    const Instant& instant = instants[at];
    for (std::size_t j = 0; j < n; ++j) {
      const Sample& x = instant[r.position_of[j]];
      s.position[j] = r.scale[j] * x.value + r.offset[j];
      s.velocity[j] = r.scale[j] * x.slope / r.time_scale;
      s.acceleration[j] = r.scale[j] * x.curvature / (r.time_scale * r.time_scale);
      s.low[j] = r.scale[j] * (r.scale[j] > 0.0 ? x.low : x.high) + r.offset[j];
      s.high[j] = r.scale[j] * (r.scale[j] > 0.0 ? x.high : x.low) + r.offset[j];
    }
    if (!family.forces(s, r.gravity, f)) continue;
    if (n == 1) {  // numbers of the model in other units
      const double inertial = f.inertia[0] * s.acceleration[0];
      f.needed[0] = f.of_drive[0] + r.passive_scale * (f.needed[0] - f.of_drive[0] - inertial) +
                    r.inertia_scale * inertial;
      f.inertia[0] *= r.inertia_scale;
      f.mass[0] *= r.inertia_scale;
      f.log_det += std::log(r.inertia_scale);
    }
    double finite = f.log_det;
    for (std::size_t j = 0; j < n; ++j) finite += f.needed[j];
    if (!std::isfinite(finite)) return false;
    ++used;
    log_det += f.log_det;
    mass += Eigen::Map<const Eigen::MatrixXd>(f.mass.data(), mass.rows(), mass.cols());
    for (std::size_t j = 0; j < n; ++j) {
      curvatures[j].push_back(std::pow(instant[r.position_of[j]].curvature, 2));
      Equation& e = of[j];
      const double shifted = r.input_offset.empty() ? 0.0 : f.input_gain[j] * r.input_offset[j];
      e.needed.push_back(f.needed[j] - shifted);
      e.of_drive.push_back(f.of_drive[j] - shifted);
      e.falls = !(joints[j].lightest < 1.0);
      e.passive.push_back(f.needed[j] - f.of_drive[j] - f.inertia[j] * s.acceleration[j]);
      e.acting += e.passive.back() * e.passive.back();
      e.given.push_back(f.input_gain[j] * instant[r.input_of[j]].mean);
      e.columns[kCoulomb].values.push_back(s.velocity[j] > 0.0 ? 1.0 : s.velocity[j] < 0.0 ? -1.0 : 0.0);
      e.columns[kViscous].values.push_back(s.velocity[j]);
      e.columns[kRotor].values.push_back(s.acceleration[j]);
      e.rotor_share += 1.0 / f.inertia[j];
      e.columns[kConstant].values.push_back(1.0);
      for (std::size_t k = 0; k < free.size(); ++k) {
        e.columns[kFree + k].values.push_back(f.by_free[k][j]);
        e.columns[kFree + k].inertia += f.inertia_by_free[k][j] / f.inertia[j];
      }
    }
  }
  if (used < kFewestInstants) return false;
  mass /= static_cast<double>(used);
  beside = log_det / static_cast<double>(used) - 2.0 * static_cast<double>(n) * std::log(r.time_scale);
  for (std::size_t j = 0; j < n; ++j)
    beside += std::log(std::abs(r.scale[j])) + 0.5 * std::log(trimmed_mean(curvatures[j]) + 1e-300);
  for (std::size_t j = 0; j < n; ++j) {
    Equation& e = of[j];
    for (Column& c : e.columns) c.inertia /= static_cast<double>(used);
    e.acting = std::sqrt(e.acting / static_cast<double>(used));
    const double inertia = static_cast<double>(used) / e.rotor_share;
    e.columns[kRotor].upper = (joints[j].heaviest - 1.0) * inertia;
    // Of what the free parameters leave of the inertia at least a part remains. An n-th of each joint's may be taken from all n at
    // once: the inertia matrix stays positive definite.
    double least = 1.0;
    for (auto c = static_cast<std::size_t>(kFree); c < e.columns.size(); ++c)
      least += std::min(e.columns[c].lower * e.columns[c].inertia, e.columns[c].upper * e.columns[c].inertia);
    e.columns[kRotor].lower =
        (joints[j].lightest - 1.0) * std::max(0.0, least) * inertia / static_cast<double>(n);
  }
  return true;
}

double Equations::fit(const std::vector<Rest>& rests, std::size_t instants) const {
  double out = beside;
  Eigen::MatrixXd with_fitted = mass;
  for (std::size_t j = 0; j < rests.size(); ++j) {
    const Rest& r = rests[j];
    out -= 0.5 * std::log(std::max({r.mean_square, 1e-12 * r.force * r.force, 1e-300}));
    out -= cost_of_fitted(r) / static_cast<double>(instants);
    const auto at = static_cast<Eigen::Index>(j);
    with_fitted(at, at) += r.inertia;
  }
  return out + linear::log_determinant_of_positive(with_fitted) - linear::log_determinant_of_positive(mass);
}

}  // namespace furcula::conventions
