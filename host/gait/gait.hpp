// A gait that was found, and what an independent integrator says of it.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "host/gait/fourier_gait.hpp"
#include "host/gait/free_gait.hpp"
#include "host/gait/machine.hpp"
#include "host/identify/dual.hpp"

namespace furcula::gait {

struct Gait {
  Machine machine;
  Task task;
  std::variant<FreeGait, FourierGait> motion;

  bool is_fourier() const { return std::holds_alternative<FourierGait>(motion); }
};

/// One stride of it from its apex.
StrideEnd<double> stride_of(const Gait& gait, const StrideOptions& options);
/// With its derivatives by the state at the apex.
StrideEnd<identify::Dual<6>> stride_with_derivatives(const Gait& gait, const StrideOptions& options);
Apex<double> apex_of(const Gait& gait);

struct Evaluation {
  StrideEnd<double> stride;
  double closure = 0.0;  ///< largest difference of the state after a stride; SI units
  double cost_j = 0.0, stride_s = 0.0, speed_mps = 0.0, eta = 0.0;
  std::optional<double> cot;
  std::vector<std::complex<double>> multipliers;  ///< of the return map, largest first
  std::vector<std::string> limits;                ///< what the machine or the ground cannot give, in words

  bool is_gait() const { return stride.whole && closure < 1e-7; }
};
Evaluation evaluate(const Gait& gait, bool with_multipliers = true);

/// Every step of a stride.
std::vector<Moment> moments_of(const Gait& gait);

}  // namespace furcula::gait
