// The verdict, and the figures that it is made of: whether anything is left to explain on the held-out recordings, and how much of it.
#pragma once

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/held_out.hpp"

namespace furcula::diagnose {

/// What the verdict hangs on beside what a diagnosis says by then.
struct VerdictInputs {
  bool random_alone = false;  ///< random_alone(), of the extended model
  bool undecided = false;     ///< another law explains the training recordings as well
  bool slip_alone = false;    ///< all that is named is a slip that nothing predicts
  bool few_windows = false;   ///< of the training recordings
};

/// Whether nothing is missing in the extended model (d.extended, d.remainder) but what the machine does not repeat. What the simulator's
/// numerics leave of an ideal sensor is correlated from row to row, too.
bool random_alone(const Diagnosis& d, const HeldOut& held_out);

/// Whether the held-out recordings are predicted better with what is named than without. A slip that nothing predicts, alone, changes no
/// figure; but what was fitted beside one that is none is far off.
bool helps_held_out(const Diagnosis& d, const HeldOut& held_out, bool slip_alone);

/// Sets what is left to explain (nothing_left, residual_white, unexplained_fraction, unnamed_share) by d's errors and remainder, and by that and
/// its findings the verdict.
void judge(Diagnosis& d, const HeldOut& held_out, const VerdictInputs& inputs);

/// Takes the verdict "explained" back where by its confidence no name is more likely right than wrong: the names leave too much, or others do
/// as well.
void judge_names(Diagnosis& d);

}  // namespace furcula::diagnose
