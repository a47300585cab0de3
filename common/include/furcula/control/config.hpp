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

/// All values that the controller is configured with.
struct Config {
  float link_length_m = 0.15f;     ///< of each of the four links
  float gravity_mps2 = 9.81f;      ///< along the rail, positive downwards
  HeightConfig height;             ///< height and velocity from the height encoder
  DebounceConfig debounce;         ///< of the contact switch
  PhaseConfig phase;               ///< detection of stance and flight
  TorqueProfileConfig torque;      ///< motor torque during stance
  LimitsConfig limits;             ///< of the motor's torque
  SupervisorConfig supervisor;     ///< thresholds of the faults
  EnvelopeConfig envelope;         ///< limits of height, touch-down speed and leg angle
  ClutchConfig clutch;             ///< clutch, spring and the contraction of the leg in flight
  CoilConfig coil;                 ///< of the clutch
  LegPositionConfig leg;           ///< position control of the leg in flight
  BenchConfig bench;               ///< trials on the clutch's bench
  ContactObserverConfig observer;  ///< contact from the leg's motion, without the switch
  /// Time without a message after which a robot that the host started stops (firmware/app/node.hpp); 0: no limit.
  float host_timeout_s = 2.0f;
};

}  // namespace furcula::control
