// A set of causes with their sizes, and the numbers in it that a fit moves.
#pragma once

#include <cstddef>
#include <vector>

#include "host/trees/run.hpp"
#include "host/trees/windows.hpp"

namespace furcula::trees {

/// One number that a fit moves.
struct Unknown {
  bool of_cause = false;
  std::size_t cause = 0;      ///< in Hypothesis::causes
  std::size_t joint = 0;      ///< where it is a drive's
  std::size_t parameter = 0;  ///< of the cause, or in kDriveParameters
  double lower = 0.0, upper = 0.0;
  double scale = 1.0;  ///< a change that matters
  bool of_body = false, of_inputs = false;
  std::size_t link = 0;   ///< where it is a body's; the parameter is then one of BodyCoordinates
  double prior_sd = 0.0;  ///< of what is known beforehand, that it is 0; 0: nothing is
};

/// Between two rows an input may change anywhere, and a torque may be that of its row's time or of all the time up to the next: anything
/// from none to this is as likely.
inline constexpr double kMostLate_rows = 0.5;

/// Whether a fit looks for it: of some drive nothing else in `h` says when its input acts.
bool inputs_may_be_late(const TreeModel& model, const Hypothesis& h);

double value_of(const Hypothesis& h, const Unknown& u);
void set_value(Hypothesis& h, const Unknown& u, double value);

/// When inputs act (Hypothesis::inputs_late_rows), the model's free parameters, its drives' and then its bodies', then the parameters of the
/// causes that the model does not have of its own: each with the bounds and the change that matters on this machine.
std::vector<Unknown> unknowns_of(const TreeModel& model, const Scales& scales, const Hypothesis& h);

/// The stiffest spring between drive and joint that a fit looks at: the rotor rings on it with 130 Hz.
double stiffest_nmprad(const Drive& drive);

}  // namespace furcula::trees
