// The controller's configuration: a block for each of its parts. What may be changed from outside, and within which
// bounds: parameters.hpp. Whether it makes sense: check.hpp.
#pragma once

#include "furcula/control/bench_trial.hpp"
#include "furcula/control/clutch_sequencer.hpp"
#include "furcula/control/coil_drive.hpp"
#include "furcula/control/contact_observer.hpp"
#include "furcula/control/debounce.hpp"
#include "furcula/control/envelope.hpp"
#include "furcula/control/height.hpp"
#include "furcula/control/leg_position.hpp"
#include "furcula/control/limits.hpp"
#include "furcula/control/phase.hpp"
#include "furcula/control/supervisor.hpp"
#include "furcula/control/torque_profile.hpp"

namespace furcula::control {

struct Config {
  float link_length_m = 0.15f;  ///< of each of the four links
  float gravity_mps2 = 9.81f;
  HeightConfig height;
  DebounceConfig debounce;
  PhaseConfig phase;
  TorqueProfileConfig torque;
  LimitsConfig limits;
  SupervisorConfig supervisor;
  EnvelopeConfig envelope;
  ClutchConfig clutch;
  CoilConfig coil;
  LegPositionConfig leg;
  BenchConfig bench;
  ContactObserverConfig observer;
  /// Of whoever lets it run (firmware/app/node.hpp); 0: for ever.
  float desk_silent_s = 2.0f;
};

}  // namespace furcula::control
