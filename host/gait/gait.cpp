#include "host/gait/gait.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::gait {
namespace {

/// f(law, law without derivatives, apex) of a gait, with T as the scalar of the state.
template <class T, class F>
auto with_law(const Gait& gait, const F& f) {
  if (const auto* free = std::get_if<FreeGait>(&gait.motion)) {
    const FreeLaw law(gait.machine, *free);
    return f(law, law, law.apex());
  }
  const FourierGait& fourier = std::get<FourierGait>(gait.motion);
  const auto values = fourier.law.values();
  std::array<T, FourierParameters<T>::kCount> full;
  std::copy(values.begin(), values.end(), full.begin());
  return f(FourierLaw<T>(FourierParameters<T>::of(full)), FourierLaw<double>(fourier.law), fourier.apex);
}

}  // namespace

StrideEnd<double> stride_of(const Gait& gait, const StrideOptions& options) {
  return with_law<double>(gait, [&](const auto& law, const auto& plain, const Apex<double>& apex) {
    return run_stride<double>(gait.machine, law, plain, apex, options);
  });
}

StrideEnd<identify::Dual<6>> stride_with_derivatives(const Gait& gait, const StrideOptions& options) {
  using D = identify::Dual<6>;
  return with_law<D>(gait, [&](const auto& law, const auto& plain, const Apex<double>& apex) {
    const auto values = apex.values();
    std::array<D, 6> start;
    for (std::size_t i = 0; i < 6; ++i) start[i] = D(values[i], static_cast<int>(i));
    return run_stride<D>(gait.machine, law, plain, Apex<D>::of(start), options);
  });
}

Apex<double> apex_of(const Gait& gait) {
  return with_law<double>(gait, [](const auto&, const auto&, const Apex<double>& apex) { return apex; });
}

std::vector<Moment> moments_of(const Gait& gait) {
  std::vector<Moment> out;
  StrideOptions options;
  options.lift_off = gait.task.lift_off;
  options.moment = [&](const Moment& m) { out.push_back(m); };
  stride_of(gait, options);
  return out;
}

Evaluation evaluate(const Gait& gait, bool with_multipliers) {
  Evaluation out;
  StrideOptions options;
  options.lift_off = gait.task.lift_off;
  options.longest_step_s = 1e-3;
  const auto start = apex_of(gait).values();
  out.stride = stride_of(gait, options);
  const StrideEnd<double>& e = out.stride;
  const auto after = e.apex.values();
  for (std::size_t i = 0; i < 6; ++i) out.closure = std::max(out.closure, std::abs(after[i] - start[i]));
  out.cost_j = e.electric;
  out.stride_s = e.fall + e.stance + e.rise;
  out.speed_mps = e.distance / out.stride_s;
  out.eta = e.joint > 0.0 ? 1.0 - e.motor / e.joint : 0.0;
  const Machine& m = gait.machine;
  if (gait.task.speed_mps) out.cot = e.electric / (m.leg.mass_kg * m.leg.gravity_mps2 * std::abs(e.distance));
  if (!e.whole) return out;

  const auto limit = [&](bool broken, const std::string& what) {
    if (broken) out.limits.push_back(what);
  };
  const auto text = [](double v) { return core::rounded(v, 3); };
  limit(e.joint_excess_rad > 1e-3, "a joint leaves its range by " + text(e.joint_excess_rad) + " rad");
  limit(e.lowest_toe < -1e-6, "the toe is " + text(-e.lowest_toe) + " m below the ground in flight");
  if (gait.task.lift_off == LegLiftOff::knee)
    limit(e.toe_acceleration_mps2 <= 0.0, "the toe does not leave the ground where the knee ends the stance");
  limit(m.motors.supply_v > 0.0 && e.voltage_v > 1.001 * m.motors.supply_v,
        "a motor needs " + text(e.voltage_v) + " V of " + text(m.motors.supply_v) + " V");
  limit(m.motors.current_a > 0.0 && e.current_a > 1.001 * m.motors.current_a,
        "a motor needs " + text(e.current_a) + " A of " + text(m.motors.current_a) + " A");
  if (gait.task.friction)
    limit(e.friction > 1.05 * *gait.task.friction, "the toe slips: " + text(e.friction) +
                                                       " of friction is needed, " +
                                                       text(*gait.task.friction) + " is there");

  if (with_multipliers) {
    options.longest_step_s = 4e-3;
    options.energies = false;
    const auto d = stride_with_derivatives(gait, options).apex.values();
    Eigen::Matrix<double, 6, 6> map;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        map(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = d[i].derivative(j);
    if (map.allFinite()) {
      const Eigen::Matrix<std::complex<double>, 6, 1> values = map.eigenvalues();
      out.multipliers.assign(values.data(), values.data() + 6);
      std::sort(out.multipliers.begin(), out.multipliers.end(), [](const auto& a, const auto& b) {
        return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
      });
    }
  }
  return out;
}

}  // namespace furcula::gait
