// Slips of the encoder: those that held-out recordings are expected to have, and how a finding tells them.
#pragma once

#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/identify/recording.hpp"
#include "host/identify/windows.hpp"

namespace furcula::diagnose {

/// Held-out recordings with the slips that the training recordings let expect in the place of their own, and the windows that figures are of.
struct ExpectedSlips {
  std::vector<identify::Recording> recordings;
  std::vector<identify::Window> windows;
  bool predictable = false;
};

/// Slips that the training recordings have at the same times are to be expected in the held-out ones, and
/// are put there. Of others no figure is made: windows that hold or follow one are left out.
ExpectedSlips expected_slips(const std::vector<identify::Recording>& training,
                             const std::vector<identify::Recording>& held_out,
                             const std::vector<identify::Window>& windows);

/// Fills in the finding of encoder_slip: the largest step of the training recordings with its interval, and all of them. `held_out`: as recorded.
void tell_slips(Finding& f, dynamics::Kind kind, const std::vector<identify::Recording>& training,
                const std::vector<identify::Recording>& held_out);

}  // namespace furcula::diagnose
