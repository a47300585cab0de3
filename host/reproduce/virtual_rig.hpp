// A rig like that of document 002, chapter 4, whose true parameters are drawn from a seed, what is measured
// of it beforehand, and its recordings.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::reproduce {

/// How an experiment was driven.
struct Experiment {
  double start_m = 0.0, amplitude_nm = 0.0, period_s = 0.0;
};

struct VirtualRig {
  /// hopper_nonlinear with friction in the guide and a motor whose torque is not quite what it was told: no
  /// fit sees it.
  model::Model truth;
  /// What can be measured before (section 4.2): weight, spring on a force plate; the rest of hopper_linear as
  /// a first guess.
  double weighed_kg = 0.0, stiffness_npm = 0.0, rest_height_m = 0.0;
  std::vector<Experiment> stance_experiments, flight_experiments;
  std::vector<log::Log> stance_logs, flight_logs;  ///< one stride each; a drop, a stance and a flight
};

/// One cause switched off or on: the same draws, the same experiments, another machine.
struct RigChange {
  bool weightless_links = false;          ///< a, b and e are zero
  bool exact_positions = false;           ///< neither counts nor noise
  bool punctual_switch = false;           ///< it neither chatters nor is early or late
  std::optional<double> friction_n = {};  ///< dry, in the guide
  /// What an impact leaves in the measured height: A exp(-t / decay) sin(2 pi f t), from each touch-down and
  /// lift-off on.
  struct Ringing {
    double amplitude_m, frequency_hz, decay_s;
  };
  std::optional<Ringing> ringing = {};
};

/// 60 and 20 experiments "with different excitation period and amplitude", the sensors as published: counts
/// of 0.09 mm, noise, a switch that chatters and reports up to 10 ms early or late.
VirtualRig draw_rig(std::uint64_t seed, std::size_t stances = 60, std::size_t flights = 20,
                    const RigChange& change = {});

}  // namespace furcula::reproduce
