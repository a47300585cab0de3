// The manoeuvres of a hopper with a clutch or a leg that folds in flight: where its leg was, and which rows no model of it follows.
#pragma once

#include <string>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/model/model.hpp"

namespace furcula::identify {

/// Fills in `leg_length` and `not_followed` of a hopper's recordings; on other machines nothing.
///
/// The leg's length comes from its encoder, in recordings in which the motor folds it in flight by more than 0.05
/// rad. A zero that is off by more than 5 mrad is put where the leg rests on its stop.
///
/// Not followed are:
/// - without a clutch in the model, stances in which the spring is let go, or is held elsewhere than with the leg
///   straight. It is home again after a catch in flight with the leg straight, 10 ms or more before touch-down.
///   Where the log has the cable's travel, that decides.
/// - flights in which the motor drives the leg while the spring is let go, and no leg angle says where it was.
void follow_manoeuvres(std::vector<Recording>& recordings, const model::Model& model);

/// Prediction windows that hold rows which are not followed, and are left out for that.
struct Excluded {
  std::string why;
  std::size_t windows = 0;
  double share = 0.0;  ///< of all windows
  double seconds = 0.0;
  std::vector<std::string> logs;
};
std::vector<Excluded> excluded(const std::vector<Recording>& recordings, const model::Model& model,
                               double window_s);

/// "3 of 24 strides (1.2 s) are left out, in a.csv, b.csv: why".
std::string sentence(const Excluded& of);

/// What a refusal says of them where no window is left; empty where none was left out.
std::string nothing_left(const std::vector<Recording>& recordings, const model::Model& model,
                         double window_s);

}  // namespace furcula::identify
