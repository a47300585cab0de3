// What the host must know of a machine beyond its equations: what the columns of its logs mean, how recordings
// are cut into windows, what its scenario files say, which experiments it can do. One file a machine, named after
// it; rules() gives that of a kind.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "furcula/control/torque_profile.hpp"
#include "furcula/dynamics/machines.hpp"
#include "host/model/model.hpp"

namespace furcula::machines {

/// What the coil is told, and when.
struct ClutchAction {
  double time_s;
  bool release;  ///< switched on; else off, and the belt or cable caught
};

/// How a run starts, how long it is, and what it is told.
struct Run {
  double start_position = 0.0;  ///< m or rad
  double start_velocity = 0.0;  ///< m/s or rad/s
  double duration_s = 5.0;
  /// On the hopper restarted at each touch-down and zero in flight, positive pumps energy in; on an axis from
  /// the start on: A sin(2 pi t / P), A, or 0.
  control::ProfileShape profile = control::ProfileShape::harmonic;
  double amplitude = 0.0;  ///< N m, or N on a linear axis
  double period_s = 0.3;
  /// Of a belt, and of a hopper with a clutch whose leg is on its stop in flight: in the order of time.
  std::vector<ClutchAction> clutch;
};

/// Collects experiments: runs, and what they are in words.
class ExperimentLibrary {
 public:
  struct Experiment {
    std::string what;
    Run run;
  };

  /// All are as `usual`, undriven, but for what is said of them.
  explicit ExperimentLibrary(Run usual) : base_(std::move(usual)) {
    base_.profile = control::ProfileShape::zero;
    base_.amplitude = 0.0;
  }
  Run start(double position, double velocity, double duration_s) const {
    Run run = base_;
    run.start_position = position;
    run.start_velocity = velocity;
    run.duration_s = duration_s;
    return run;
  }
  static Run driven(Run run, control::ProfileShape profile, double amplitude, double period_s) {
    run.profile = profile;
    run.amplitude = amplitude;
    run.period_s = period_s;
    return run;
  }
  void add(std::string what, Run run) { all_.push_back({std::move(what), std::move(run)}); }
  std::vector<Experiment> take() { return std::move(all_); }

 private:
  Run base_;
  std::vector<Experiment> all_;
};

/// What a rig has done in its recordings.
struct Reach {
  double input = 0.0;  ///< largest, N or N m
  double lowest = 0.0, highest = 0.0;
  double speed = 0.0;
};

/// The columns of its logs (host/log/machine_types.hpp) by what they are; empty: there is none.
struct Columns {
  std::string_view position;
  std::string_view velocity{};
  std::string_view input{};      ///< what drives it, in each row until the next; of a belt the coil
  std::string_view command{};    ///< what the drive was told, where `input` is what it reports
  std::string_view report{};     ///< what the drive reports, where `input` is what it was told
  std::string_view leg_angle{};  ///< on the motor's side
  std::string_view coil{};       ///< of a leg's clutch: 1 while it is on
  std::string_view cable{};      ///< travel of that clutch's cable
  std::string_view touchdown{};  ///< the contact switch of a leg
  std::string_view stop{};       ///< 1 in rows in which it touches the stop that it is thrown up from
};

/// How a recording is cut into windows (host/identify/windows.hpp).
enum class Cut {
  strides,    ///< from apex to apex
  flights,    ///< clear of its stop
  releases,   ///< of a belt, from rest to rest
  intervals,  ///< by time
};

/// What the keys of a scenario file are called, and how small and large their values may be. Empty: no such
/// key.
struct Keys {
  std::string_view position, position_unit;
  double position_least, position_most;
  std::string_view velocity{}, velocity_unit{};
  double velocity_most = 0.0;
  std::string_view drive{}, amplitude{}, amplitude_unit{};
  double amplitude_most = 0.0;
};

struct Rules {
  std::string_view channel;  ///< the position's name in results
  Columns columns;
  Keys keys;
  double count = 0.0;  ///< of the encoder of its simulated rig, m or rad
  Cut cut = Cut::intervals;
  /// What holds for all that a scenario leaves out.
  Run (*usual_run)(const model::Model&);
  void (*experiments)(ExperimentLibrary&, const model::Model&, const Reach&);
  /// What a force is to the acceleration that it makes, kg or kg m^2.
  double (*inertia)(const model::Model&) = [](const model::Model& m) { return m.parameters.front(); };
  /// What pulls at it all the time, N or N m; none: the root mean square of its inputs tells what moves it.
  double (*weight)(const model::Model&) = nullptr;
  /// Whether something holds it for most of the time: a position that stays is no saturated encoder then, and
  /// its noise is that of standstill.
  bool held = false;
  /// Whether its travel ends somewhere: an experiment stays within what its recordings went through.
  bool keeps_travel = false;
  // What is said where a recording holds no window; of intervals their length is.
  std::string_view fit_expects{};                                 ///< "expected ..."
  std::string (*window_expected)(const model::Model&) = nullptr;  ///< "the recordings hold no ..."
};

const Rules& rules(dynamics::Kind kind);

}  // namespace furcula::machines
