// A log of a tree as the fits want it: what each joint did, and what its drive was given.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "host/log/clean.hpp"
#include "host/log/log.hpp"
#include "host/trees/model.hpp"

namespace furcula::trees {

/// Rows between two changes of the foot's contact: all of them where there is no foot.
struct Phase {
  std::size_t first = 0, last = std::numeric_limits<std::size_t>::max() - 1;
  bool stance = false;
  bool whole = true;                     ///< the touch-down is in the recording
  std::vector<double> at_touchdown_rad;  ///< of a stance: each joint's angle as its encoder reads it
  std::vector<double> touchdown_sd_rad;  ///< how well that is known: the touch-down lies between two rows
  double touchdown_s = 0.0;
  double switched_s = 0.0;  ///< of a whole one: its switch's change
};

/// Columns over joints of the tree. Units of a revolute joint; of a prismatic one m and N.
struct Recording {
  std::string path;
  std::vector<double> time_s;
  std::vector<std::vector<double>> angle_rad;
  /// Torque law: the torque that the drive reports, else the one commanded, N m. Position law: the set point, rad.
  std::vector<std::vector<double>> input;
  std::vector<double> angle_noise_rad;              ///< of one sample, standard deviation
  std::vector<bool> input_measured;                 ///< the torque is the drive's report
  double interval_s = 0.0;                          ///< median
  std::vector<log::RejectedRow> refused;            ///< rows of the log that are not among these
  std::vector<std::string> log_notes;               ///< what else was done to it, in sentences
  std::vector<std::size_t> log_row;                 ///< of the log that it was made of, of each row
  std::map<std::string, log::MappedColumn> mapped;  ///< of the map file that it was read with

  /// How late the foot's switch is by this recording's hard touch-downs, and what that is worth: one over a variance. 0: nothing tells.
  double switch_late_s = 0.0, switch_late_precision = 0.0;
  /// What all recordings' lateness together is not known by: it moves all their touch-downs alike.
  double switch_late_sd_s = 0.0;

  std::vector<Phase>
      phases;  ///< one after the other; none: all rows are one; rows that are in none are too near to a change

  std::size_t rows() const { return time_s.size(); }
  const Phase& phase_at(std::size_t row) const;
};

/// "angle_elbow_rad", "torque_cmd_elbow_nm", ...: `quantity` is angle, velocity, torque, torque_cmd or angle_cmd.
std::string column_of(const TreeModel& model, std::size_t joint, const std::string& quantity);

/// @throws core::DataError naming file, joint and what was expected: a joint without its columns, fewer than 50 rows. Rows that their neighbours refute (host/log/clean.hpp) and those of `refuted` are left out.
Recording recording_of(const TreeModel& model, const log::Log& log,
                       const std::vector<log::Refuted>& refuted = {});

/// One switch is late by one time in all recordings: that of `training` together, in both. Those of one alone scatter by some 0.3 ms.
void share_lateness(std::vector<Recording>& training, std::vector<Recording>& held_out);

/// @throws core::DataError naming a joint whose angle is one value in all rows of all recordings, though its input is not: its encoder
/// is dead, or it is held.
void require_motion(const TreeModel& model, const std::vector<Recording>& recordings);

/// What was wrong with a recording, added to what was with others.
void add_data_quality(log::DataQuality& data_quality, const Recording& r);

/// A joint's state about a row, from its measured angles alone: a cubic through those within `half_s` of it.
struct LocalState {
  double angle_rad, velocity_radps, acceleration_radps2;
  double angle_sd_rad, velocity_sd_radps;  ///< for the recording's noise
};
LocalState local_state(const Recording& r, std::size_t joint, std::size_t row, double half_s);

/// A joint's angle so long after a stance's touch-down, by the measured rows about then; below zero from what it does afterwards.
double angle_after_touchdown(const Recording& r, const Phase& stance, std::size_t joint, double delay_s);

/// A joint's mean velocity in the 5 ms after a stance's touch-down.
double velocity_after_touchdown(const Recording& r, const Phase& stance, std::size_t joint);

/// The joint's velocity about a row, by the rows beside it.
double velocity_about(const Recording& r, std::size_t joint, std::size_t row);
/// Whether rows are missing between this one and the next, or the foot's contact changes.
bool gap_after(const Recording& r, std::size_t row);

/// Rows `first` to `last`.
Recording part_of(const Recording& r, std::size_t first, std::size_t last);

/// Columns of the log that name joints the tree does not have.
std::vector<std::string> foreign_joints(const TreeModel& model, const log::Log& log);

}  // namespace furcula::trees
