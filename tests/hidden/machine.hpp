// The virtual machines that the hidden-effect tests record: the three kinds with any laws planted (laws.hpp),
// integrated by classic Runge-Kutta steps with events found by bisection. It is written from the equations
// (docs/physics.md, and the contract's table of effects) and shares no code with the plant that the diagnosis
// simulates with, so that a slip in one of the two shows.
//
// Where the contract's line leaves a choice, it is made here:
// - damping_error on the hopper is so much more viscous damping of the guide, in both phases.
// - spring_hysteresis takes its share of the spring's force, hardening included, in the leg: through the toe.
// - leg_inertia: the links turn in stance only; z = 2 L cos(theta) then reduces M, B, G of docs/physics.md to
//   one coordinate. The velocity does not jump when they begin to turn.
// - ground_compliance: the toe has no mass, the leg's stop holds until the spring gives way; flat again by touch-down.
// - toe_sticking: beyond the touch-down height the stop pulls with 6,000 N/m beside spring, damper and motor, until
//   all of them together pull at the toe with the force. Where a leg pulls short of that height, the toe holds on as
//   well.
// - bump_stop: the compression is that of the leg, from its length at touch-down; the stop's force goes through the
//   toe and is no part of the spring's, of which hysteresis takes its share.
// - backlash: in contact the leg gets the motor's torque; across the gap the rotor is free, and what it has gained
//   against the leg there it gives to the leg at the end, so that no impulse is lost. At touch-down it turns along.
// - A leg that is folded in flight has the length that is asked for: it touches down at that height, and the cable of
//   a clutch that is let go follows it. Links that are planted take part: m z' + e sin(theta) theta' changes by gravity
//   and guide alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/hidden/disturbance.hpp"
#include "tests/hidden/drive.hpp"
#include "tests/hidden/laws.hpp"

namespace furcula::hidden {

inline constexpr double kLegStop_npm = 6000.0;  // contract, toe_sticking
inline constexpr double kRotor_kgm2 = 4e-4;     // contract, backlash

/// What the machine really is.
struct Truth {
  Kind kind = Kind::hopper_linear;
  std::vector<double> parameters;  ///< in the order of dynamics::info(kind).parameters
  std::vector<Planted> planted;    ///< hidden causes; none twice
  std::uint64_t draw = 0;          ///< decides what is random in a cause: another one for each recording
  /// Hopper: release and catch delay, s, auxiliary spring, N/m, and tooth pitch, m; a pitch of 0: no clutch.
  std::array<double, 4> clutch{};
  Disturbance disturbance{};  ///< what is random and no cause
};

/// Position and velocity in m, m/s or rad, rad/s. On the hopper the position is the body's height.
class Machine {
 public:
  /// A hopper above its touch-down height is in flight, else in stance.
  Machine(const Truth& truth, double position, double velocity, double start_s = 0.0);

  /// Hopper with a clutch: the key goes out of the teeth, or comes back on the cable, now.
  void pull_key() { cable_ = Cable::loose; }
  void press_key() {
    if (cable_ == Cable::loose) cable_ = Cable::seeking;
  }
  double cable_travel_m() const;
  /// Hopper in flight: from now on the leg becomes shorter by `depth_m` and straight again, within `length_s`.
  void fold_leg(double depth_m, double length_s) { fold_ = {time_s_, length_s, depth_m}; }
  /// Of the leg, m: in flight what fold_leg() makes of it.
  double leg_length_m() const { return stance_ ? state_[kX] - state_[kToe] : length_in_flight(time_s_); }

  /// Runs to `until_s` with the command (N or N m) held. `step_s` is the longest Runge-Kutta step.
  void advance(double until_s, double command, double step_s = 50e-6);

  double time_s() const { return time_s_; }
  double position() const { return state_[kX]; }
  double velocity() const { return state_[kV]; }
  bool stance() const { return stance_; }
  bool sticking() const { return direction_ == 0; }
  /// Hopper: the last touch-down and lift-off; before the first of each, -infinity.
  double touchdown_s() const { return touchdown_s_; }
  double liftoff_s() const { return liftoff_s_; }
  /// Hopper: whether the leg's force was ever below zero on the way down. There the ground would have had to
  /// pull; the force is taken as zero, but a linear leg says nothing certain about what follows.
  bool ground_pulled() const { return ground_pulled_; }
  /// Hopper: height of touch-down, m.
  double touchdown_height_m() const { return touchdown_height_m_; }
  /// Hopper: force between ground and toe at the present state, N. After advance().
  double ground_force_n() const;
  /// Hopper: height of the toe in stance, 0 on hard flat ground, m.
  double toe_m() const { return state_[kToe]; }
  /// Hopper: leg angle on the motor's side; in flight the leg rests on its stop.
  double motor_angle_rad() const;
  /// What the drive makes of its current as soon as it has this command, which then holds on.
  double reported_torque(double command) {
    drive_.command(time_s_, command);
    return drive_.reported(time_s_);
  }
  /// The drive as it is now, for a machine that takes over in the middle of a recording.
  const Drive& drive() const { return drive_; }
  void take_over(const Drive& drive) { drive_ = drive; }

 private:
  // Body; toe; the side mass against its rest; the rotor against the leg; by how much the spring has crept.
  enum Coordinate : std::size_t { kX, kV, kToe, kSideX, kSideV, kGap, kGapV, kCrept, kCoordinates };
  using State = std::array<double, kCoordinates>;
  struct Leg {
    double force;         // on the body, N
    double ground_force;  // on the toe
    double toe_velocity;  // m/s
    double sine;          // of the leg angle
  };

  double torque(const State& s, double t) const;
  double elastic_force(double length, double t) const;
  Leg leg(const State& s, double t) const;
  double outer_force(const State& s, double t) const;
  double friction_size(const State& s, double t, int direction, double speed) const;
  double effective_inertia(double length) const;
  double acceleration(const State& s, double t) const;
  State rates(const State& s, double t) const;
  State stepped(const State& s, double h) const;
  bool turns(const State& s) const;
  bool touches_down(const State& s, double t) const;
  double length_in_flight(double t) const;
  bool lifts_off(const State& s, double t) const;
  bool rotor_arrives(const State& s) const;
  void choose_direction_from_rest();
  void follow_rotor();
  double gust(double t) const;
  double loose_rate_npm() const;
  double loose_travel_m(double length) const;
  void seek_tooth(double from_m);

  bool hopper_, rotary_, carriage_;                 // none of them: a motor axis
  double inertia_ = 1, damping_ = 0, gravity_ = 0;  // kg or kg m^2; of the axis or guide; m/s^2 or N m
  double creep_ = 0, creep_s_ = 1;                  // of the spring: which share, how soon
  double stiffness_npm_ = 0, rest_height_m_ = 0, leg_damping_nspm_ = 0, link_length_m_ = 1;
  double restitution_touchdown_ = 1, restitution_liftoff_ = 1, touchdown_height_m_ = 0;

  // The laws' values; each is nothing until it is planted.
  double friction_up_ = 0, friction_down_ = 0, stribeck_excess_ = 0, stribeck_velocity_ = 1;
  double binding_ = 0, binding_from_ = 0, binding_to_ = 0, snag_ = 0, snag_from_ = 0, snag_to_ = 0;
  double drag_ = 0, offset_ = 0, cosine_of_tilt_ = 1, preload_n_ = 0, cubic_npm3_ = 0, hysteresis_ = 0;
  double links_a_ = 0, links_b_ = 0, links_e_ = 0;
  bool links_ = false;
  double ground_npm_ = 0, ground_nspm_ = 0, sticking_n_ = -1, half_gap_rad_ = 0;
  double side_mass_ = 0, side_stiffness_ = 0, side_damping_ = 0;
  double bump_compression_m_ = 0, bump_npm_ = 0;
  double end_position_ = 0, end_stiffness_ = 0, detent_ = 0, detent_pitch_ = 1, detent_phase_rad_ = 0;
  double periodic_ = 0, periodic_hz_ = 0, periodic_phase_rad_ = 0;
  double warm_friction_ = 0, warming_s_ = 1, fading_ = 0, fading_s_ = 1;
  struct Gust {
    double begin_s, end_s, force;
  };
  std::vector<Gust> gusts_;
  bool dry_friction_ = false;
  struct Fold {
    double begin_s, length_s, depth_m;
  } fold_{0, 0, 0};

  Disturbed disturbed_;
  double ground_m_ = 0;  // under the toe's next touch-down, or its present one
  int hops_ = 0;
  Drive drive_;
  double time_s_;
  State state_{};
  bool stance_ = false;
  int direction_ = 1;  // of the motion that dry friction opposes; 0 while it holds the axis
  int rotor_end_ = 1;  // the end of the gap that the rotor rests on; 0 while it crosses
  double touchdown_s_, liftoff_s_;
  bool ground_pulled_ = false;
  // A cable that is let go is in balance between the leg's spring and an auxiliary one, which is pretensioned
  // to what the leg's pulls with the leg straight; caught, it keeps its travel.
  enum class Cable { held, loose, seeking } cable_ = Cable::held;
  double auxiliary_npm_ = 0, pitch_m_ = 0, left_in_ = 0, travel_m_ = 0;
};

}  // namespace furcula::hidden
