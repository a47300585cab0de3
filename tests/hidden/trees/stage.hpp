// A robot and its laboratory before anything is planted, and what it does then: the measure of all sizes.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "tests/hidden/trees/cases.hpp"

namespace furcula::hidden::trees {

/// What the robot of the model does: rows of a few recordings without disturbance.
struct Baseline {
  std::vector<Values> q, v, a, torque, input;
  std::vector<Values> input_rate;  ///< over the row, zero across recordings
  std::vector<State> state;
  /// Of a leg's boom, which nothing drives, the torque is a force of the weight's size.
  Values rms_torque{}, rms_v{}, rms_vv{}, rms_a{}, rms_input_rate{}, low{}, high{};
};

/// A robot, its laboratory and what it does without causes.
struct Stage {
  Case c;
  Baseline base;
  std::vector<Experiment> experiments;
  Values inertia{};             ///< that each joint moves alone, rotor included
  std::vector<Recording> some;  ///< of a leg: the recordings of `base`
};

Values rms_of(const std::vector<Values>& rows);
Baseline baseline_of(const Machine& machine, const std::vector<Recording>& logs);
bool in(const std::vector<std::string>& list, const std::string& x);
bool wants(const Question& q, std::initializer_list<const char*> names);

/// A robot that its drives can move. Nothing if the draw does not.
std::optional<Stage> draw_stage(const Question& question, Random& random);
/// A leg that hops all along, in leg_stage.cpp.
std::optional<Stage> draw_leg_stage(const Question& question, Random& random);

/// A recording in which the leg hops all along; experiments in which it falls are drawn anew, up to four times.
std::optional<Recording> record_hops(const Machine& machine, const Case& c, Experiment& experiment,
                                     bool disturbed, Random& random, std::size_t& redrawn);

/// Records all experiments. False where the robot runs away, or swings on its own, which drives show first, or
/// where a leg does not hop.
bool record_all(Stage& stage, const Random& random);

}  // namespace furcula::hidden::trees
