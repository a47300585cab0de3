// Whether a log's columns are what their names say: their unit, sign and zero, which joint they belong to, and where gravity points.
// One trial for all machines, before any cause is looked for.
//
// Each joint's equation of motion is written at instants of the recordings: the force that the model asks for at the measured position,
// velocity and acceleration, less the force that its drive gives. What a joint may have beside the model in any case (Coulomb and
// viscous friction, rotor inertia, an inertia that is off by up to four, a constant force), and the model's free parameters within their bounds, are fitted by least squares.
// The rest counts. Another reading of the columns changes positions, velocities, accelerations and inputs by algebra alone, so that
// hundreds of readings cost as much as some runs of the model.
//
// Likelihood: given position, velocity and input, the accelerations as logged are Gaussian, each joint's by itself. The rest of a joint's
// force is r = (what does not depend on the acceleration) - M a, and a = (scale / time scale^2) a_logged. So an instant's log likelihood is
//     -1/2 sum_joints log(mean r^2) + log det M + sum_joints log(scale) - 2 joints log(time scale),
// and readings in different units can be compared. M has the inertias that were fitted.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/conventions/units.hpp"

namespace furcula::conventions {

/// A model's inertia may be off by so much before a unit is blamed: masses and radii are guessed within two.
inline constexpr double kInertiaWithin = 4.0;
/// With a rotor that the model does not have, reflected through its gear: of a motor with a gear of 160 that moves a finger.
inline constexpr double kWithRotor = 100.0;

/// One joint or axis, as its columns are logged.
struct Joint {
  std::string name;             ///< "elbow"; empty on a machine of one
  std::string position_column;  ///< "angle_elbow_rad"
  std::string input_column;     ///< "torque_elbow_nm"; empty: nothing drives it
  Quantity position = Quantity::angle;
  Quantity input = Quantity::torque;
  bool sets_position = false;  ///< the input is a set point of the position
  bool last = false;           ///< its body carries no further joint
  std::string link;            ///< that it moves; may be empty
  /// Its inertia may be so much of the model's, its weight being as in the model. What falls with g has at least the model's.
  double lightest = 1.0 / kInertiaWithin, heaviest = kWithRotor;
};

/// A column of the log that one of ours is made of: ours = scale x theirs + offset.
struct Source {
  std::string column;
  double scale = 1.0, offset = 0.0;
};

/// One recording's columns, a vector a joint.
struct Columns {
  std::string path;
  std::vector<double> time_s;
  std::vector<std::vector<double>> position, input;
  std::vector<std::vector<double>> velocity{};  ///< where the log has such a column; empty where not
  std::vector<bool>
      breaks{};  ///< per row: no equation may reach over the step from it to the next; empty: none
  std::map<std::string, Source> sources{};  ///< of those of ours that a map file has
};

/// How the columns are read. Position = scale x logged + offset.
struct Reading {
  std::vector<std::size_t> position_of, input_of;  ///< per joint: whose column
  std::vector<double> scale, offset;               ///< of positions
  std::vector<double> input_offset{};              ///< of set points, in the position's unit; empty: none
  double time_scale = 1.0;
  /// Of a machine of one joint: what its model's inertia, and its gravity and springs, are multiplied by.
  double inertia_scale = 1.0, passive_scale = 1.0;
  std::size_t gravity = 0;  ///< 0: the model's; else an entry of Family::other_gravities(), from 1
};

/// A parameter that the model leaves free: by how much it may differ from what the model says.
struct FreeParameter {
  double lower = 0.0, upper = 0.0;
};

/// What the family says of a machine at one instant. The rest of a joint's equation is input_gain x input - needed.
struct Forces {
  std::vector<double> needed;      ///< without the drive's, N m or N
  std::vector<double> input_gain;  ///< 1, of a position law kp
  std::vector<double> of_drive;    ///< part of `needed` that is the drive's: kp q + kd v of a position law
  std::vector<double> inertia;     ///< that a joint's acceleration meets, all others being free, kg m^2 or kg
  double log_det = 0.0;            ///< of the inertia matrix
  std::vector<double> mass;        ///< that matrix, row by row
  std::vector<std::vector<double>> by_free;  ///< [free parameter][joint]: what one of it adds to `needed`
  std::vector<std::vector<double>> inertia_by_free;  ///< the same to `inertia`
};

/// State at an instant, as read; `low` and `high`: what its position spans around the instant.
struct State {
  std::vector<double> position, velocity, acceleration, low, high;
};

/// A machine that can be asked for its equations.
class Family {
 public:
  virtual ~Family() = default;
  virtual const std::vector<Joint>& joints() const = 0;
  virtual std::vector<FreeParameter> free_parameters() const = 0;
  /// What gravity may be besides what the model says: "gravity_mps2 = [9.81, 0, 0]", as a sentence's object.
  virtual std::vector<std::string> other_gravities() const = 0;
  /// False where the model says nothing of this state (an impact near by).
  virtual bool forces(const State& state, std::size_t gravity, Forces& out) const = 0;
};

/// What the columns seem to be.
struct Finding {
  std::string what;                 ///< "torque_nm is in N mm"
  std::string map;                  ///< what to write, as lines of a map or model file
  std::vector<std::string> same;    ///< what of the machine would look just the same in any recording
  std::vector<std::string> others;  ///< readings that fit nearly as well
  double off_given = 0.0,
         off_read = 0.0;  ///< RMS of the rest over that of the force, at the joint where that is most
  bool of_time = false;   ///< time is in another unit
};

/// The reading that fits far better than the columns as named, if there is one. `threads`: of the search.
std::optional<Finding> find_convention(const Family& family, std::span<const Columns> recordings);

/// How well the columns fit as they are named.
struct AsNamed {
  bool asked = false;       ///< there are enough instants of motion to say
  std::vector<double> off;  ///< of each joint: RMS of the rest over that of the force
};
AsNamed as_named(const Family& family, std::span<const Columns> recordings);

/// Whether other columns than time may be mended: not where rows are so far apart that nothing could be fitted to them.
enum class Asked { all_columns, time_alone };

/// The same; throws core::DataError that says what the columns seem to be and what to write.
void require_convention(const Family& family, std::span<const Columns> recordings,
                        Asked asked = Asked::all_columns);

}  // namespace furcula::conventions
