// What a diagnosis says, of machines of every family: what diagnosis.json and the page are made from.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/core/verdict.hpp"
#include "host/log/data_quality.hpp"

namespace furcula::result {

/// A figure that was not computed; null in JSON, a dash on the page.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A 95 % interval.
struct Interval {
  double lower = kUnknown, upper = kUnknown;
};

/// A fitted number with its 95 % interval. Its name ends in its unit (`force_n`); `unit` is "N", "N m", ..., empty for a ratio.
struct Estimate {
  std::string name, unit;
  double value = 0.0, lower = 0.0, upper = 0.0;
};

/// A law of the catalogue at its locations, or a free parameter of the model.
struct Cause {
  std::string effect;           ///< name in the catalogue; empty: a parameter of the model
  std::string model_parameter;  ///< name in the model file; empty: an effect
  /// "joint", "drive", "encoder", "link", "base", "log", "spring"; empty on machines with one joint.
  std::string location_type;
  std::vector<std::string> locations;  ///< names of joints or links; one value holds at all of them
  std::vector<Estimate> parameters;
};

/// For a person: "coulomb_friction@elbow,wrist" or "damping_nspm", several joined by " + ".
std::string label(const Cause& cause);
std::string label(const std::vector<Cause>& causes);

/// A set of causes that competes with a finding; an empty set is the model without any cause, re-fitted.
struct Rival {
  std::vector<Cause> causes;
  std::vector<Cause>
      retained;  ///< other findings that stay beside it, with their values then; machines with one joint
  std::string reason;     ///< why it was not chosen, or why it cannot be distinguished
  bool same_law = false;  ///< under another name: no recording distinguishes the two
};

/// Errors of one channel of the held-out recordings, measured less predicted, in `unit` ("m", "rad", "rad/s", "s", "N m").
struct ChannelError {
  std::string channel, unit;
  double nmse = kUnknown;  ///< over the sum of squares about the mean; unknown for instants (unit "s")
  double mae = kUnknown, rmse = kUnknown;
  std::string location = {};  ///< of the channel's sensor; empty on machines with one joint
};

/// Held-out errors of one channel without a finding, all else fitted again, and with it.
struct ChannelGain {
  std::string channel, unit;
  double mae_without = kUnknown, mae_with = kUnknown;
  double nmse_without = kUnknown, nmse_with = kUnknown;
};

/// An encoder's slip.
struct Event {
  std::string log;
  double time_s = 0.0;  ///< since the log's first row
  double step = 0.0;
  std::string unit;  ///< of the step: "m" or "rad"
};

struct Finding {
  Cause cause;
  std::string title;  ///< in plain words: "dry friction", "the model's mass"
  std::string phase;  ///< of a stride in which it acts; empty: the machine has no strides
  std::string law, explanation, where_to_look, next_experiment;
  /// Share of the held-out squared error above the noise floor that it removes. Machines with one joint.
  double explainable_nmse_removed = kUnknown;
  Interval explainable_nmse_removed_ci95;  ///< over the held-out recordings
  /// Share of the training windows' loss that could be explained. Robots.
  double explainable_training_loss_removed = kUnknown;
  std::vector<ChannelGain> gains;  ///< the channel it is judged on, or all channels of a robot
  Interval mae_reduction_ci95;     ///< of gains.front(); machines with one joint
  double confidence = 0.0;
  std::vector<std::string> confidence_lowered_by;
  std::vector<Event> events, observed_events;  ///< of training recordings; those seen in held-out ones
  bool undecided = false;                      ///< another law explains the training recordings as well
  std::vector<Rival> alternatives, indistinguishable_from;
};

/// A set of causes that was tried.
struct Candidate {
  std::vector<Cause> causes;
  double cross_validated_gain = kUnknown;  ///< share of the cross-validated training error removed; one joint
  double score_test_gain = kUnknown;  ///< share of the training residuals removed by the linear test; robots
  double held_out_gain = kUnknown;    ///< share of the held-out error above the floor removed; one joint
  double posterior = kUnknown;        ///< share among all sets that were fitted; one joint
  bool chosen = false;
  std::string outcome;  ///< "named", or in words why it was not chosen; empty: not said
};

/// A channel over one held-out window: measured, and predicted by three models.
struct Trace {
  std::string log, channel, unit;
  std::vector<double> time_s, measured, as_given, refitted, extended;
};

/// What force the model lacks, where: against the extended model with the findings' effects taken out (the
/// re-fitted model where there is none); one sample an instant of the logs, averaged over a few ms.
struct ResidualForce {
  std::string unit;           ///< "N" or "N m"
  std::string velocity_unit;  ///< "m/s" or "rad/s"
  std::string position_unit;
  std::vector<double> time_s;  ///< since the log's start
  std::vector<double> velocity;
  std::vector<double> position;
  std::vector<double> force;  ///< what would have to be added to the re-fitted model
  std::vector<double> law;    ///< what the findings' laws add at the same instants (empty: no finding)
  // What else the residual may be correlated with, at the same instants.
  std::vector<std::size_t> recording;  ///< index
  std::vector<double> acceleration, input;
  std::vector<double> interval_s;  ///< from the row before
  std::vector<double> since_touchdown_s,
      since_liftoff_s;  ///< on the hopper, in stance and in flight; else NaN
};

/// What force or torque a robot's model lacks at one joint over the training recordings, with the model re-fitted (`before`) and
/// extended (`after`). Columns have one length; the units are `unit`, `velocity_unit` and `position_unit`.
struct MissingForce {
  std::string location, unit, velocity_unit, position_unit;
  std::vector<double> time_s, velocity, position, before, after;
  double rms_before = kUnknown, rms_after = kUnknown;
  double rms_joint = kUnknown, rms_drive = kUnknown;  ///< that moves the joint; that the drive gives
  double persistent_after = kUnknown;                 ///< still there some 50 ms later
  double predictable_before = kUnknown,
         predictable_after = kUnknown;  ///< shares of its square, cross-validated
  std::string correlated_with;          ///< in words; empty: nothing
};

/// A signal that the residual is correlated with.
struct Association {
  std::string location;  ///< joint of the residual; empty on machines with one joint
  std::string signal;
  double strength = 0.0;
  std::string description;
};

/// What a flexible law of motion, input and time predicts on recordings that it was not fitted to.
struct Predictable {
  double force = 0.0;  ///< RMS, N or N m
  double share_of_squares = 0.0;
  double standard_errors = 0.0;
  bool significant = false;
};

/// What remains, split into what the machine does not repeat and what could be predicted. Machines with one joint.
struct Remainder {
  std::string unit;  ///< of forces: "N" or "N m"
  double typical_force = 0.0;
  std::string typical_force_is;
  double random_force = 0.0, random_force_held_out = 0.0;  ///< RMS
  double correlation_s = 0.0, impact_scatter = 0.0;
  double share = 0.0;  ///< of the larger random force in the typical one
  Predictable held_out, cross_validated;
  // Ljung and Box's test of the innovations of the held-out recordings.
  double p_value = 0.0, chi_square = 0.0, rows = 0.0, largest_correlation = 0.0;
  std::size_t lags = 0, at_lag = 0;
  bool white = true;
};

/// A recording that would distinguish causes.
struct Experiment {
  std::string description;
  std::string scenario;         ///< TOML for `furcula sim`; empty: in words alone
  double rms_difference = 0.0;  ///< of the two nearest predictions
  std::string unit;             ///< of it: "m" or "rad"
  double deviance = kUnknown;  ///< of one recording, for those two: twice the log-likelihood ratio; one joint
  std::optional<int> recordings;  ///< that it takes at this noise; one joint
};

/// A parameter of the model as given, re-fitted and extended.
struct Parameter {
  std::string name, unit, meaning;
  bool free = true;
  double baseline = 0.0;
  Estimate refitted, extended;
  std::string verdict;  ///< identified, correlated with ..., at_bound ..., not_excited; empty if held
};

/// A combination of inertial parameters on which the torques of a robot's joints depend.
struct BaseParameter {
  std::string combination, unit;
  double baseline = 0.0, extended = 0.0, sd = kUnknown;
  std::string location;  ///< the joint where its share of the torque is largest
  double torque_rms = 0.0;
  std::string torque_unit;  ///< "N m" or "N"
  bool identified = false;  ///< its standard deviation is small enough
};

/// Windows of recordings that no model of the kind describes.
struct ExcludedWindows {
  std::string reason;
  std::size_t windows = 0;
  double share = 0.0, duration_s = 0.0;
  std::vector<std::string> logs;
};

/// What the engines of all families fill in alike.
struct Summary {
  Verdict verdict = Verdict::adequate;
  std::string summary;  ///< the verdict in one plain sentence
  std::size_t logs = 0, held_out_logs = 0, samples = 0;
  std::vector<std::string> training_files, held_out_files;
  std::vector<std::string> notes;  ///< sentences about model and result
  log::DataQuality data_quality;   ///< of the recordings
  std::string next_experiment;     ///< of the whole diagnosis
};

struct Diagnosis : Summary {
  std::string kind;   ///< as in the model file
  std::string robot;  ///< name in the URDF; empty: a machine with one joint
  std::size_t joints = 1;
  std::optional<std::size_t> hops;     ///< strides; nothing where they are not counted
  std::optional<std::size_t> windows;  ///< of the training recordings; nothing where not counted
  std::size_t fitted_windows = 0;      ///< those that the search was made on
  double window_s = kUnknown;          ///< their length where all have one
  std::size_t held_out_windows_excluded = 0;
  std::vector<ExcludedWindows> excluded_windows;
  std::vector<ChannelError> baseline, refitted, extended, noise_floor;  ///< held out
  std::string main_channel, main_unit;                                  ///< of the page's headline figures
  std::vector<Finding> findings;
  double unexplained_fraction_of_nmse = kUnknown;   ///< of the held-out error above the noise; one joint
  double unexplained_fraction_of_force = kUnknown;  ///< of the missing force that could be predicted; robots
  std::optional<bool> white;                        ///< the innovations are; one joint
  std::optional<bool> only_noise_left;              ///< of the held-out error; one joint
  double none_of_catalogue = kUnknown;              ///< the posterior that no finding has; one joint
  std::vector<Association> correlated_with;
  std::optional<Remainder> remainder;
  std::vector<MissingForce> missing_force;
  std::vector<Experiment> experiments;  ///< the most informative first
  std::vector<Parameter> parameters;
  std::vector<BaseParameter> base_parameters;
  std::vector<Candidate> candidates;
  std::vector<Trace> traces;
  ResidualForce residual;
};

}  // namespace furcula::result
