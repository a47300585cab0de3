// The fits of document 002 the way they were made there: a general variable-step integrator (Dormand and
// Prince 5(4), as ode45), the cost of eq. 4.5 as one number, its gradient by finite differences, a
// quasi-Newton search (BFGS, as fmincon). A peer for the time and the estimates of host/identify, nothing
// else.
#pragma once

#include <cstddef>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/identify/unknowns.hpp"
#include "host/identify/windows.hpp"

namespace furcula::reproduce {

struct PlainFit {
  std::vector<double> values;
  double cost = 0.0;            ///< eq. 4.5 at `values`
  std::size_t evaluations = 0;  ///< of the cost
  bool converged = false;       ///< else it stopped short
};

/// Fits on stances or flights, each from its measured state (as the document has it: the start is not
/// fitted), the recorded torque in straight lines between the rows.
PlainFit fit_plainly(const model::Model& model, const std::vector<identify::Unknown>& unknowns,
                     const std::vector<double>& start, const std::vector<identify::Recording>& recordings,
                     const std::vector<identify::Window>& windows);

}  // namespace furcula::reproduce
