// The virtual rigs: a machine (machine.hpp) with its controller and its imperfect sensors, recorded as a log
// in the columns of docs/contracts.md, section 1. What a planted law does to the sensors is done here: the
// log has it, `Trajectory` has not. A skew of the position is the log's alone, as of time stamps: the
// controller does not see it.
#pragma once

#include <cstddef>
#include <vector>

#include "host/log/log.hpp"
#include "tests/hidden/machine.hpp"
#include "tests/hidden/random.hpp"

namespace furcula::hidden {

/// What really happened, row for row (none dropped): for judging predictions without the sensors' errors.
struct Trajectory {
  std::vector<double> time_s, position, velocity, command;
  std::vector<bool> held;  ///< rail carriage: on its stop; empty: never
};

// ---- The hopper's rig -------------------------------------------------------------------------------------

enum class Profile { none, harmonic, constant };

/// A drop from rest, then hopping with the profile restarted at each touch-down that the rig believes in.
struct HopperExperiment {
  Profile profile = Profile::harmonic;
  double amplitude_nm = 1.5;
  double period_s = 0.3;  ///< of the harmonic profile
  double drop_height_m = 0.34;
  /// In each flight after a stance that is long enough for the first: so long after its lift-off is seen the leg
  /// is folded, so deep, and straight again after so long. With a clutch the spring is let go before the first
  /// fold and caught after it.
  struct Fold {
    double after_s, depth_m, length_s;
  };
  std::vector<Fold> folds = {};
  int hops = 8;            ///< the recording ends after so many lift-offs ...
  double longest_s = 5.0;  ///< ... or after this time, or when the body has come to rest
};

struct HopperSensors {
  double quantum_m = 9e-5;        ///< 2000 counts a revolution on the rack (002, chapter 4)
  double noise_m = 3e-5;          ///< standard deviation, before quantisation
  double report_error_s = 0.0;    ///< the switch reports up to so much early or late, drawn for each event
  double bounce_s = 0.0;          ///< the raw switch chatters for so long after each report
  double vibration_m = 0.0;       ///< of the body on the encoder after touch-down, at 1 m/s of impact
  bool velocity_column = true;    ///< backward difference over 8 ms
  double dropped_fraction = 0.0;  ///< of the rows
  bool torque_column = false;     ///< what the drive makes of its current
  bool leg_angle_column = false;  ///< on the motor's side, of an encoder of 14 bit
};

struct HopperRecording {
  log::Log log;
  Trajectory truth;
  int liftoffs = 0;
  bool ground_pulled = false;  ///< see Machine::ground_pulled
};

HopperRecording record_hopper(const Truth& truth, const HopperExperiment& experiment,
                              const HopperSensors& sensors, Random& random);

// ---- The rigs of the two axes -----------------------------------------------------------------------------

struct Sine {
  double amplitude, frequency_hz, phase_rad;
};

/// A smooth course of position: minimum-jerk moves between targets with rests, or a sum of sines that fades
/// in over half a second.
struct Course {
  struct Move {
    double begin_s, end_s, from, to;
  };
  std::vector<Move> moves;
  std::vector<Sine> sines;

  double at(double time_s) const;
  double velocity(double time_s) const;
  double acceleration(double time_s) const;
};

/// Feedback plus feed-forward along a course, plus an open-loop sum of sines; neither: a free swing.
struct AxisExperiment {
  Course course;
  std::vector<Sine> open_loop;  ///< N or N m
  double feedback_hz = 0.0;     ///< bandwidth of the position loop; 0: no feedback and no feed-forward
  double limit = 1e9;           ///< of the command
  double start_position = 0.0, start_velocity = 0.0;
  double duration_s = 4.0;
};

struct AxisSensors {
  double quantum = 1e-6;           ///< of the position, m or rad
  double noise = 0.0;              ///< standard deviation, before quantisation
  double interval_s = 1e-3;        ///< between rows
  double interval_spread_s = 0.0;  ///< each interval is longer by up to so much
  bool velocity_column = false;    ///< backward difference over at least 8 ms
  double dropped_fraction = 0.0;
  bool drive_reports = false;  ///< rotary joint: torque_cmd_nm is logged, and torque_nm is the drive's own
};

/// `known` holds the parameters that the rig's controller believes in (its feed-forward).
struct AxisRecording {
  log::Log log;
  Trajectory truth;
};

AxisRecording record_axis(const Truth& truth, const std::vector<double>& known,
                          const AxisExperiment& experiment, const AxisSensors& sensors, Random& random);

// ---- The rail carriage's rig ------------------------------------------------------------------------------

/// Let fall once, and thrown up from its stop by hand again and again; it comes to rest there each time.
struct CarriageExperiment {
  double fall_m = 0.0;             ///< height that it falls from; 0: it does not
  std::vector<double> speeds_mps;  ///< of the throws
  double rest_s = 0.15;            ///< on the stop before each
};

AxisRecording record_carriage(const Truth& truth, const CarriageExperiment& experiment,
                              const AxisSensors& sensors, Random& random);

}  // namespace furcula::hidden
