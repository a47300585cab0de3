// How well a model predicts: free runs over windows from a state estimated in their first 50 ms, against the
// measured channels. The same for every model compared.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/identify/windows.hpp"
#include "host/model/model.hpp"

namespace furcula::identify {

/// Errors of a prediction on one channel, all windows pooled. NMSE: squared errors over squares about the
/// window's mean. MAE and RMSE in the channel's unit.
struct ChannelErrors {
  double nmse = 0.0;
  double mae = 0.0;
  double rmse = 0.0;
};

/// Sums of one channel's errors over rows: of one window, or of several together.
struct ErrorSums {
  double squares = 0.0;   ///< of the errors
  double absolute = 0.0;  ///< of the errors
  double spread = 0.0;    ///< squares of the measured values about their window's mean
  double count = 0.0;     ///< rows

  ErrorSums& operator+=(const ErrorSums& other);
  ChannelErrors errors() const;
};

/// By channel: "height", "velocity" on the hopper (and "height_stance", "height_flight" for the parts of a
/// stride), "height" (rail carriage), "position" or "angle", and "velocity" where it was recorded, elsewhere.
using Errors = std::map<std::string, ChannelErrors>;

/// A window's free run: one entry a row.
struct Run {
  std::vector<double> position;
  std::vector<double> velocity;
};
Run predict(const model::Model& model, const Recording& r, const Window& w, const StartState& start);

/// The start states of all windows, for every model that is to be compared: by start_state() with this
/// reference.
std::vector<StartState> start_states(const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows, const model::Model& reference);

Errors prediction_errors(const model::Model& model, const std::vector<Recording>& recordings,
                         const std::vector<Window>& windows, const std::vector<StartState>& starts);

/// Of the position, an entry a window: what prediction_errors() pools.
std::vector<ErrorSums> position_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows,
                                     const std::vector<StartState>& starts);

/// Of the three channels below, an entry a window; without rows where a window holds nothing of it.
std::vector<ErrorSums> contact_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                    const std::vector<Window>& windows);
std::vector<ErrorSums> drive_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                  const std::vector<Window>& windows);
std::vector<ErrorSums> leg_angle_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                      const std::vector<Window>& windows,
                                      const std::vector<StartState>& starts);

/// Of the contact switch, s: its reports of touch-downs against where the model has them, after the measured
/// fall through the touch-down height. Without an NMSE; nothing where no report belongs to a stride.
std::optional<ChannelErrors> contact_errors(const model::Model& model,
                                            const std::vector<Recording>& recordings,
                                            const std::vector<Window>& windows);

/// Of what the drive reports against what the model's drive makes of the commands, where it does not echo
/// them.
std::optional<ChannelErrors> drive_errors(const model::Model& model, const std::vector<Recording>& recordings,
                                          const std::vector<Window>& windows);

/// Of the leg's angle, rad, about its mean over each window: where the encoder's zero is, no model says.
std::optional<ChannelErrors> leg_angle_errors(const model::Model& model,
                                              const std::vector<Recording>& recordings,
                                              const std::vector<Window>& windows,
                                              const std::vector<StartState>& starts);

/// The NMSE that a perfect model would have: measuring noise, and what the noise in the first 50 ms does to
/// the start state and through it to the run (to first order). Only `nmse` and `rmse` are set.
Errors noise_floor(const model::Model& model, const std::vector<Recording>& recordings,
                   const std::vector<Window>& windows, const std::vector<StartState>& starts);

}  // namespace furcula::identify
