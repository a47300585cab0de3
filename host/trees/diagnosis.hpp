// What a diagnosis of a tree says: the figures, the findings and the traces that JSON, report and files are made from.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "host/result/diagnosis.hpp"
#include "host/trees/base_parameters.hpp"
#include "host/trees/fit.hpp"
#include "host/trees/model.hpp"
#include "host/trees/path.hpp"
#include "host/trees/recording.hpp"

namespace furcula::trees {

using furcula::Verdict;

using result::Estimate;
using result::Trace;  ///< one a joint and held-out log

/// Of one joint over all held-out windows: measured less predicted.
struct ChannelError {
  double nmse = 0.0, mae = 0.0, rmse = 0.0;  ///< rad, or m of a prismatic joint
};

struct Finding {
  Cause cause;
  std::vector<std::string> at;  ///< names of the sites
  std::vector<Estimate> parameters;
  double explainable_removed =
      0.0;  ///< of the training windows' loss that could be explained, what this cause alone is worth
  std::vector<ChannelError> without;  ///< held out, of each joint, without it, all else fitted again
  double confidence = 0.0;
  std::vector<std::string> lowered_by;  ///< what limits the confidence, in words
  std::vector<result::Rival> alternatives, indistinguishable_from;
  std::string explanation, where_to_look, next_experiment;
};

/// The torque that a model lacks at one joint, over its recordings: what inverse dynamics asks for less what drive and friction give.
struct MissingTorque {
  std::vector<std::size_t> recording;
  std::vector<double> time_s, angle_rad, velocity_radps;
  std::vector<double> before_nm, after_nm;  ///< with the model re-fitted, and extended
  double rms_before_nm = 0.0, rms_after_nm = 0.0;
  double rms_torque_nm = 0.0, rms_drive_nm = 0.0;  ///< Scales
  double persistent_after_nm = 0.0;  ///< of what is missing then, without the noise (missing_torque.hpp)
  double
      predictable_before = 0.0,
      predictable_after =
          0.0;  ///< share of its square that a flexible law of the state predicts, on recordings it was not fitted on
  std::string correlated_with;  ///< what it follows most, after; empty: nothing
};

/// For the picture: the robot's pose over one held-out recording.
struct Motion {
  std::string log;
  std::vector<double> time_s;
  std::vector<std::vector<double>> measured, simulated;  ///< [joint][row]
};

/// A motion that would tell causes apart, and by how much their predictions then differ, RMS, of those two that differ least.
struct Experiment {
  std::string what;
  std::vector<Path> paths;  ///< of each joint
  double apart_rad = 0.0;
};

struct Diagnosis : result::Summary {
  TreeModel model;  ///< as given
  Hypothesis refitted, extended;
  std::size_t windows = 0;
  double window_s = 0.3;
  std::vector<ChannelError> as_given_error, refitted_error, extended_error;  ///< held out, of each joint
  std::vector<double> noise_floor;                                           ///< nmse of each joint
  std::vector<Finding> findings;
  std::vector<MissingTorque> missing;         ///< of each joint
  std::vector<result::Parameter> parameters;  ///< free ones
  std::vector<BaseParameter> base_parameters;
  std::vector<result::Candidate> candidates;
  double unexplained_share = 0.0;
  std::vector<Experiment> experiments;  ///< where causes cannot be told apart, the most telling first
  std::vector<Trace> traces;
  std::vector<Motion> motions;
};

/// "angle_elbow" and "rad" of a joint.
std::string channel_name(const TreeModel& model, std::size_t joint);
std::string_view channel_unit(const TreeModel& model, std::size_t joint);

}  // namespace furcula::trees
