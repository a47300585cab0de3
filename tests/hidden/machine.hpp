// The virtual machines that the hidden-effect tests record: the three kinds with at most one effect planted,
// integrated by classic Runge-Kutta steps with events found by bisection. It is written from the equations
// (docs/physics.md, section 1, and the catalogue's laws) and shares no code with the plant that the diagnosis
// simulates with, so that a slip in one of the two shows.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "furcula/dynamics/kinds.hpp"

namespace furcula::hidden {

using dynamics::Effect;
using dynamics::Kind;

/// An effect with its parameters in the order of the catalogue.
struct Planted {
  Effect effect;
  std::array<double, dynamics::kMaxEffectParameters> values{};
};

/// What the machine really is.
struct Truth {
  Kind kind = Kind::hopper_linear;
  std::vector<double> parameters;  ///< in the order of dynamics::info(kind).parameters
  std::optional<Planted> planted;
};

/// Position and velocity in m, m/s or rad, rad/s. On the hopper the position is the body's height.
class Machine {
 public:
  /// Starts at time 0; a hopper above its touch-down height is in flight, else in stance.
  Machine(const Truth& truth, double position, double velocity);

  /// Runs to `until_s` with the actuator's command (N or N m) held. `step_s` is the longest Runge-Kutta step.
  void advance(double until_s, double command, double step_s = 50e-6);

  double time_s() const { return time_s_; }
  double position() const { return position_; }
  double velocity() const { return velocity_; }
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
  /// Hopper: force between ground and toe at the present state, N.
  double ground_force_n(double command) const;

 private:
  struct Motion {
    double position, velocity;
  };
  double leg_force(const Motion& m, double command) const;
  double smooth_force(const Motion& m, double command) const;
  double friction_size(int direction, double speed) const;
  double acceleration(const Motion& m, double command) const;
  Motion stepped(const Motion& m, double h, double command) const;
  bool turns(const Motion& m) const;
  bool touches_down(const Motion& m) const;
  bool lifts_off(const Motion& m, double command) const;
  int direction_from_rest(double command) const;
  bool is(Effect e) const { return planted_ && planted_->effect == e; }
  double value(std::size_t i = 0) const { return planted_->values[i]; }

  Kind kind_;
  std::optional<Planted> planted_;
  double inertia_ = 1, damping_ = 0, gravity_ = 0;  // kg or kg m^2; of the axis or guide; m/s^2 or N m
  double stiffness_npm_ = 0, rest_height_m_ = 0, leg_damping_nspm_ = 0, link_length_m_ = 1;
  double restitution_touchdown_ = 1, restitution_liftoff_ = 1, touchdown_height_m_ = 0;
  bool dry_friction_ = false;

  double time_s_ = 0, position_, velocity_;
  bool stance_ = false;
  int direction_ = 1;  // of the motion that dry friction opposes; 0 while it holds the axis
  double touchdown_s_, liftoff_s_;
  bool ground_pulled_ = false;
};

}  // namespace furcula::hidden
