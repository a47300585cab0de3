// A log as the fits see it: time, input, position and velocity of one axis, whatever the rig.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "furcula/dynamics/actuation.hpp"
#include "furcula/dynamics/machines.hpp"
#include "host/log/clean.hpp"
#include "host/log/log.hpp"

namespace furcula::identify {

/// An instant at which the measured position jumps by more than the axis can move: from `row` on it is off by
/// `step`.
struct Slip {
  std::size_t row = 0;
  double step = 0.0;       ///< m or rad
  double deviation = 0.0;  ///< standard deviation of the step
};

/// One recording. All vectors have the same length. Position in m (rad), velocity in m/s (rad/s), input in N
/// (N m; on the hopper the torque command in N m; on the clutch bench 1 while the coil is on), each row's
/// input acting until the next row.
struct Recording {
  std::string name;
  dynamics::Kind kind;
  std::vector<double> time_s;
  std::vector<double> input;
  std::vector<double> position;
  std::vector<double> velocity;  ///< as recorded if the log has it, else the smoothed slope of the position
  std::vector<double> velocity_smoothed;  ///< slope of the position, without delay
  bool velocity_recorded = false;
  std::vector<double> impulse;   ///< integral of the input since the first row
  std::vector<double> driven_s;  ///< seconds since the first row in which the input was not zero
  /// What the drive reports of its torque or force; empty where the log has it not, or echoes the command.
  std::vector<double> drive;
  double drive_noise = 0.0;
  /// The commands that `drive` answers, where `input` is not the command but that answer (rotary_joint with
  /// torque_cmd_nm): then a delay, lag or limit of the drive shows in `drive` alone. And their integral.
  std::vector<double> drive_command, drive_impulse;
  /// Hopper: the leg's angle on the motor's side, rad; empty where the log has none, or none that moves.
  std::vector<double> leg_angle;
  double leg_angle_noise = 0.0;  ///< with what links and joints give
  /// Hopper: when the contact switch first reported each touch-down, s (bounces left out).
  std::vector<double> touchdown_reports_s;
  std::vector<double> on_ground;  ///< hopper: the raw contact switch
  /// Hopper with a clutch: 1 in rows in which its coil is on; empty where it never is.
  std::vector<double> solenoid;
  std::vector<double> cable;  ///< travel of its cable, m; empty where the log has none that moves
  // What follow_manoeuvres() fills in, for a hopper:
  /// Of a leg that folds in flight: the body's height at which its toe would meet the ground, m. In flight the
  /// leg's length, after touch-down what it was there, from the lowest point of the stance on that of the
  /// straight leg. Empty where the leg stays on its stop.
  std::vector<double> leg_length;
  /// Why no model of this kind follows a row: 0 where it does, else 1 + an index of kNotFollowed. Empty: 0.
  std::vector<char> not_followed;
  /// Rail carriage: 1 in rows in which it touches its stop; empty where the log has no such column.
  std::vector<double> contact;
  std::vector<Slip> slips;          ///< found in the positions alone
  std::vector<double> slip_offset;  ///< by how much each row is off by them; empty without any
  double position_noise = 0.0;      ///< standard deviation, from what neighbouring samples do not share
  double velocity_noise = 0.0;
  std::vector<log::RejectedRow> refused;            ///< rows of the log that are not among these
  std::vector<std::string> notes;                   ///< what else was done to it, in sentences
  std::vector<std::size_t> log_row;                 ///< of the log that it was made of, of each row
  std::map<std::string, log::MappedColumn> mapped;  ///< of the map file that it was read with

  std::size_t rows() const { return time_s.size(); }
  /// Of a row, where that of the straight leg is `straight_m`.
  double touchdown_height_m(std::size_t row, double straight_m) const {
    return leg_length.empty() ? straight_m : leg_length[row];
  }
  dynamics::Commands<double> commands() const { return {time_s, input, impulse, driven_s}; }
  /// What the drive was told.
  dynamics::Commands<double> drive_commands() const {
    if (drive_command.empty()) return commands();
    return {time_s, drive_command, drive_impulse, driven_s};
  }
};

/// Reads the axis out of a log of the kind's rig, without the rows that their neighbours refute (host/log/clean.hpp)
/// and those of `refuted`. Throws core::DataError where the log has too few rows to estimate anything (fewer than 20).
Recording make_recording(const log::Log& log, dynamics::Kind kind,
                         const std::vector<log::Refuted>& refuted = {});

/// All recordings of a list. The noise of one is at least a third of the noisiest one's: a recording at rest,
/// whose sensor does not flicker, would outweigh all others. @throws core::DataError where nothing moves in
/// any of them. `refuted`: rows of each log (empty: none).
std::vector<Recording> make_recordings(const std::vector<log::Log>& logs, dynamics::Kind kind,
                                       const std::vector<std::vector<log::Refuted>>& refuted = {});

/// From one row to the next, median.
double row_s(const Recording& r);

/// Inputs act by a share of a row earlier than they stand there, from 0 to 1: between two rows so much of the next one's acts in place of the
/// first one's. Half a row: what is measured at the rows' times. Less: of commands that change more often than there are rows.
void take_earlier(std::vector<Recording>& recordings, double rows);

/// The recording that this one goes on from, the end of one log being held out: of the same name, and before it; nothing where there is none.
const Recording* goes_on_from(const Recording& r, const std::vector<Recording>& earlier);

/// Where a recording goes on from one of `earlier`, its motor has worked as long as that one's.
void keep_warm(std::vector<Recording>& recordings, const std::vector<Recording>& earlier);

/// Over a longer pause between two rows it is not known what drove the axis: 50 ms, or five rows of a slow log.
double longest_pause_s(const std::vector<double>& time_s);

/// Names of the channels in results: "height" and "velocity" on hopper and rail carriage, "position",
/// "angle" on rotary joint and clutch bench.
struct ChannelNames {
  std::string position, position_unit, velocity_unit;
};
ChannelNames channel_names(dynamics::Kind kind);

/// Least-squares polynomial of `order` <= 4 through the rows [first, last] about the time `at_s`: its value,
/// slope and second derivative there. Rows: at least order + 1.
struct LocalPolynomial {
  double value = 0.0, slope = 0.0, curvature = 0.0;
  double residual_variance = 0.0;  ///< sum of squares over degrees of freedom; 0 without any
  double value_variance = 0.0, slope_variance = 0.0, covariance = 0.0;  ///< per unit of sample variance
};
LocalPolynomial local_polynomial(const std::vector<double>& time_s, const std::vector<double>& values,
                                 std::size_t first, std::size_t last, double at_s, int order);

}  // namespace furcula::identify
