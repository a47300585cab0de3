// Held-out recordings, on which models are judged: all from the same start states.
#pragma once

#include <string>
#include <vector>

#include "host/identify/prediction.hpp"
#include "host/identify/statistics.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

/// "contact", "torque", "leg_angle": the channel of errors that effects are judged on which do not move the body; "" of the motion.
std::string channel_name(identify::Channel channel);

/// Share of what stands above the floor in `before` that is gone in `after`: 1 at most, 0 where next to nothing stands above it.
double explained_share(double before, double after, double floor);

class HeldOut {
 public:
  /// The recordings must outlive it. `reference`: by whose runs the windows' start states are estimated.
  HeldOut(const std::vector<identify::Recording>& recordings, std::vector<identify::Window> windows,
          const model::Model& reference);

  const std::vector<identify::Recording>& recordings() const { return recordings_; }
  const std::vector<identify::Window>& windows() const { return windows_; }
  const std::vector<identify::StartState>& starts() const { return starts_; }

  /// Of all channels.
  identify::Errors errors(const model::Model& m) const;
  /// That a perfect model would have, of which this is the nearest.
  identify::Errors noise_floor(const model::Model& m) const;
  /// An entry a window.
  std::vector<identify::ErrorSums> sums(const model::Model& m, identify::Channel channel) const;

  /// NMSE of the position, on a sample of the windows of long recordings; and that of a perfect model.
  double sample_nmse(const model::Model& m) const;
  double sample_noise_floor(const model::Model& m) const;
  /// NMSE of the position.
  double nmse(const identify::Errors& e) const;

  /// RMS error, in the channel's unit, that a perfect model would have: how far the contact switch's reports scatter about the lag that the
  /// training recordings have; what the current sensor, or the leg's encoder, resolves.
  double resolution(identify::Channel channel) const;

 private:
  const std::vector<identify::Recording>& recordings_;
  std::string position_;  ///< name of the channel
  std::vector<identify::Window> windows_, sample_;
  std::vector<identify::StartState> starts_, sample_starts_;
};

}  // namespace furcula::diagnose
