// A laboratory's recordings of a robot: reference paths, the computer that follows them, sensors, and what
// disturbs the robot. A leg hops in place of following paths, over ground that is not level. Time stamps are
// those at which inputs change and sensors are read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/hidden/trees/hopper.hpp"
#include "tests/hidden/trees/machine.hpp"

namespace furcula::hidden::trees {

inline constexpr double kStep_s = 0.25e-3;  ///< of the integration

struct Lab {
  bool position_control = false;
  Values kp{}, kd{};      ///< torque law: the computer's gains
  Values feed_forward{};  ///< share of the model's gravity torque that the computer adds
  Values effort{};        ///< the computer's limit of the torque
  double rate_hz = 250;
  bool jitter = false;  ///< rows up to 30 % of a period early or late
  Values resolution{};  ///< of the encoder, rad or m
  Values noise{};       ///< of the encoder, standard deviation
  bool velocity_column = false;
  double velocity_resolution = 0.005;
  bool torque_column = false, command_column = true;  ///< torque law
  double torque_noise = 0.01;                         ///< of the joint's rms torque
  Values rms_nm{};                                    ///< drive torque of the robot as the model has it
  Values disturbance_nm{};                            ///< standard deviation of an Ornstein-Uhlenbeck torque
  Values disturbance_s{};                             ///< its correlation time
  // Of a leg.
  std::optional<Hopper> hopper;  ///< the computer before the first row; it knows the leg as the model has it
  double switch_late_s = 0.0;    ///< of the toe's switch, both ways
  double ground_m = 0.001;       ///< standard deviation of the ground's height from stride to stride
};

/// A change of the toe's contact.
struct Contact {
  double time_s;
  bool down;
  Pair impulse_ns;  ///< of a touch-down, on the toe
};

/// What really happened, at the rows.
struct Recording {
  std::vector<double> time_s;
  std::vector<Values> input;  ///< torque command or set point, from the row on
  std::vector<State> state;
  std::vector<Values> torque_nm;  ///< of the drives, before gain and ripple
  // Of a leg.
  std::vector<Contact> contacts;
  std::vector<Pair> ground_n;  ///< the ground's force on the toe, at the rows
};

/// The reference of one joint.
struct Path {
  struct Sine {
    double amplitude, radps, phase;
  };
  struct Move {
    double begin_s, duration_s, from, to;
  };
  double centre = 0.0;
  std::vector<Sine> sines;
  std::vector<Move> moves;  ///< in the order of time; smooth steps of fifth order
  double at(double t) const;
  double rate(double t) const;
};

struct Experiment {
  double duration_s = 5.0;
  std::vector<Path> paths;  ///< of each joint; of a leg two: forward speed in m/s, height of the apex in m
};

/// Multi-sines, quick steps or moves from point to point, of `size` (1: the joints' whole range).
Experiment draw_experiment(Random& random, const Robot& robot, double duration_s, double size);

/// Hopping at heights that change, at speeds that change between -2/3 of the fastest and this; 0: in place.
Experiment draw_hops(Random& random, double duration_s, double fastest_mps);

/// Runs an experiment. `model` is what the computer takes the robot for. Without `disturbed` there is no
/// disturbance; the computer reads noise all the same.
Recording record(const Machine& machine, const Dynamics& model, const Lab& lab, const Experiment& experiment,
                 bool disturbed, Random random);

/// True if all numbers are finite, joints stay within `beyond` of the paths' ranges and below 40 rad/s.
bool sound(const Recording& recording, const Robot& robot, std::size_t visible, double beyond);

inline constexpr double kGroundFriction = 1.2;
/// True if a leg has hopped all along: upright, the knee bent, and without a slip on ground of that friction, but
/// for at most 4 ms at a stretch, in which a toe slips by less than the ground is uneven.
bool hopped(const Recording& recording, const Robot& robot);

/// Whether the toe's switch says that it stands at a time.
bool switched_on(const Recording& recording, const Lab& lab, double time_s);

/// Measured angles that a machine predicts for the rows begin+1 .. end from the true state at row `begin`,
/// without disturbance. The true machine `truth` says which measured angle the true one shows as. Of a leg the
/// rows must be of one flight or stance, which the machine keeps; its spring rests where the true knee was when
/// it would have caught by the machine's own rules.
std::vector<Values> restarted(const Machine& machine, const Machine& truth, const Recording& recording,
                              std::size_t begin, std::size_t end);

/// A log in the contract's form, as the sensors see it.
std::string log_of(const Machine& truth, const Lab& lab, const Recording& recording, std::size_t visible,
                   Random random);

}  // namespace furcula::hidden::trees
