// A robot in motion: rigid bodies, drives, dry friction and whatever is planted in them.
//
// Between two instants at which an input changes, a step is one of classic Runge-Kutta in which each joint
// with dry friction slides one way or is held. Where a joint's speed changes sign inside of a step, the step is
// cut there and the joint is at rest. At rest, friction and accelerations are the solution of the
// complementarity problem |friction| <= level, acceleration 0 or friction at its bound and opposing, found by
// projected Gauss-Seidel sweeps.
//
// Where the contract's line leaves a choice, it is made here:
// - From the command to the joint: delay -> limit -> lag -> gain -> ripple, amplitude sin(cycles q + phase). A
//   measured torque is the drive's current times its nominal constant: without gain and ripple.
// - The drive's position law reads its encoder: an offset of the encoder moves the robot.
// - joint_elasticity: rotor, viscous damping and drive before the spring, dry friction at the joint.
// - base_tilt: the base stands turned by roll about x, then pitch about y; gravity is turned back.
// - com_error keeps the inertia about the moved centre.
//
// A leg flies, or its toe stands on one spot of the ground (contact.cpp). The toe comes down where its height
// falls to the ground's: inelastic, all places kept, by an impulse in x and z. It leaves where the ground's force
// upwards falls to zero and the toe would then rise. For 0.5 ms after either it does neither. The ground is so
// rough that the toe never slips.
// - The spring at the knee rests at the angle of touch-down and acts in stance alone; a parallel one always.
// - latch_delay: it catches so much after touch-down, at the angle of that instant. latch_offset: it rests so
//   far from the angle at which it caught. second_spring: a constant torque while the toe is in the air.
// - length_error: a link is that much longer from joint to joint, or from knee to toe; its mass stays.
// - On a prismatic joint all parameters carry linear names.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/hidden/trees/pinned.hpp"
#include "tests/hidden/trees/robot.hpp"

namespace furcula::hidden::trees {

/// A law with its values at one or more seats; several joints share the values.
struct Cause {
  std::string effect;
  std::vector<std::string> at;  ///< joint, link or "base"
  std::map<std::string, double> parameters;
};

/// What the model file says of a joint.
struct DriveData {
  double kp_nmprad = 0.0, kd_nmsprad = 0.0;  ///< position law
  double rotor_kgm2 = 0.0;
  double damping_nmspr = 0.0;
  double friction_nm = 0.0;  ///< dry friction that the model knows of
};

/// All that acts in a joint, N m, rad, s.
struct Act {
  DriveData drive;
  double up_nm = 0, down_nm = 0;  // dry friction against motion forth and back
  double static_extra_nm = 0, stribeck_radps = 1;
  double load_ratio = 0;
  double binding_nm = 0, binding_centre_rad = 0, binding_width_rad = 0;
  double drag = 0, offset_nm = 0;
  double delay_s = 0, limit_nm = 0, lag_s = 0, gain = 1;  // limit 0: none
  double ripple_nm = 0, cycles = 0, phase_rad = 0;
  double spring_nmprad = 0;  // 0: rigid
  double encoder_rad = 0;
  // Not in the catalogue.
  double cubic_nmprad3 = 0, cubic_centre_rad = 0;
  double growth_nmps = 0;  // of dry friction
  double other_nm = 0;     // dry friction, more or less of it with the angle of joint `other`
  std::size_t other = 0;
  double crosstalk = 0;  // share of the torque of the drive `talker`
  std::size_t talker = 0;
  double periodic_nm = 0, periodic_hz = 0;
  double linear_npm = 0, linear_nspm = 0;  // spring and damper of a resonator

  bool dry() const {
    return up_nm > 0 || down_nm > 0 || static_extra_nm > 0 || load_ratio > 0 || binding_nm > 0 ||
           growth_nmps > 0 || other_nm > 0;
  }
};

struct State {
  Values q{}, v{};
  Values lag{};               // torque behind the lag
  Values rotor{}, rotor_v{};  // of elastic joints
  // Of a leg.
  bool stance = false;
  bool caught = false;                                  // the switched spring holds on
  bool phase_kept = false;                              // neither touch-down nor lift-off: of a restart
  double rest_rad = 0.0;                                // of the switched spring, once it has caught
  Pair toe_m;                                           // where the toe stands
  double ground_m = 0.0;                                // height of the ground where the toe comes down next
  double touch_down_s = -1.0, lift_off_s = -1.0;        // the last ones
  double touch_down_rad = 0.0, touch_down_radps = 0.0;  // the knee then, after the impact
  Pair impulse_ns;                                      // of the last impact, on the toe
};

/// What is planted at the switch of a leg's spring.
struct Switch {
  double delay_s = 0.0, offset_rad = 0.0;
  double second_nm = 0.0;  ///< of the second spring, towards the straight knee
};

/// The name that a parameter of a rotary joint has on a prismatic one; others stay as they are.
std::string linear_name(const std::string& rotary);

/// The robot with its causes in place.
class Machine {
 public:
  /// Throws std::invalid_argument for an effect, seat or parameter that it does not know.
  Machine(const Robot& robot, const std::vector<DriveData>& drives, bool position_control,
          const std::vector<Cause>& causes);

  std::size_t size() const { return robot_.size(); }
  const Robot& robot() const { return robot_; }
  const Act& act(std::size_t joint) const { return acts_[joint]; }
  bool position_control() const { return position_law_; }
  const Dynamics& dynamics() const { return dynamics_; }
  const std::vector<Act>& acts() const { return acts_; }

  /// One step of at most `h` seconds under constant inputs and disturbance; ends at zero crossings of a speed
  /// with dry friction. Returns the time that passed.
  double step(State& s, double t, double h, const Values& input, const Values& disturbance) const;
  /// Runs to t + h in steps of at most `longest`.
  void run(State& s, double t, double h, double longest, const Values& input,
           const Values& disturbance) const;

  /// Drive's torque at the motor before gain and ripple.
  Values drive_torque(const State& s, const Values& input) const;
  /// Accelerations at this instant, friction at rest solved for.
  Values acceleration(const State& s, double t, const Values& input, const Values& disturbance) const;
  /// Of a leg: its toe's place and speed, and the ground's force on it (zero in flight, N).
  Point toe(const State& s) const;
  Pair ground_force(const State& s, double t, const Values& input, const Values& disturbance) const;
  /// Stops the toe where it is by an impulse: the impact, without any spring's catch.
  void stop_toe(State& s) const;
  /// A leg that takes over in the midst of a stance: stands where its toe is, which must not move.
  void stand(State& s) const;
  const Switch& spring_switch() const { return switch_; }
  /// Energy that the knee's spring holds, J.
  double spring_energy_j(const State& s) const;
  /// The state of drives and springs of a robot that starts at rest or takes over with q and v.
  void settle(State& s, const Values& input) const;

 private:
  enum class Mode : signed char { back = -1, held = 0, forth = 1, free = 2 };
  using Modes = std::array<Mode, kMost>;
  struct Rates {
    Values a{}, lag{}, rotor{};
    Pair force;
  };

  void plant(const Cause& cause);
  bool plant_in_leg(const Cause& cause, const std::string& at);
  std::size_t joint_named(const std::string& name) const;
  double raw_torque(std::size_t j, const State& s, double input) const;
  double motor_torque(std::size_t j, const State& s, double input) const;
  Values delivered(const State& s, const Values& input) const;
  double level(std::size_t j, const State& s, double t, double torque, int direction) const;
  /// Torque on each joint but for dry friction.
  Values smooth_torque(const State& s, double t, const Values& torque, const Values& disturbance) const;
  Rates rates(const State& s, double t, const Values& input, const Values& disturbance,
              const Modes& modes) const;
  Modes modes(const State& s, double t, const Values& input, const Values& disturbance) const;
  State stepped(const State& s, double t, double h, const Values& input, const Values& disturbance,
                const Modes& modes) const;
  void mass_and_bias(const State& s, Matrix& mass, Values& bias) const;
  /// As `mass` says, with the toe held where it stands; `still` joints do not move. Sets the toe's drift.
  Pinned pinned(const Matrix& mass, const State& s, const Modes& modes, Pair& drift) const;

  // Of a leg, in contact.cpp.
  double knee_torque(const State& s) const;
  double stretch_rad(const State& s) const;
  double height_m(const State& s) const;
  bool would_rise(const State& s, double t, const Values& input, const Values& disturbance) const;
  void lift_off(State& s, double t) const;
  void touch_down(State& s, double t) const;
  void catch_spring(State& s) const;
  double next_catch_s(const State& s) const;
  void stay_put(State& s) const;
  /// A step of `reached` seconds ends in `next`, or at an event before.
  double with_contact(const State& s, State& next, double t, double reached, const Values& input,
                      const Values& disturbance, const Modes& modes) const;

  Robot robot_;
  Vec3 gravity_{0, 0, -kGravity_mps2};
  bool position_law_;
  std::vector<Act> acts_;
  Dynamics dynamics_;
  bool any_dry_ = false;
  Switch switch_;
};

}  // namespace furcula::hidden::trees
