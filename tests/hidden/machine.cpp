// See machine.hpp.
#include "tests/hidden/machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace furcula::hidden {

namespace {
constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kEventWidth_s = 1e-10;
}  // namespace

Machine::Machine(const Truth& truth, double position, double velocity)
    : kind_(truth.kind),
      planted_(truth.planted),
      position_(position),
      velocity_(velocity),
      touchdown_s_(kNever),
      liftoff_s_(kNever) {
  const auto parameter = [&](std::string_view name) {
    return truth.parameters.at(*dynamics::parameter_index(truth.kind, name));
  };
  switch (kind_) {
    case Kind::hopper_linear:
      inertia_ = parameter("mass_kg");
      damping_ = parameter("damping_flight_nspm");
      leg_damping_nspm_ = parameter("damping_stance_nspm") - damping_;
      gravity_ = parameter("gravity_mps2");
      stiffness_npm_ = parameter("stiffness_npm");
      rest_height_m_ = parameter("rest_height_m");
      link_length_m_ = parameter("link_length_m");
      restitution_touchdown_ = parameter("restitution_touchdown");
      restitution_liftoff_ = parameter("restitution_liftoff");
      touchdown_height_m_ = 2.0 * link_length_m_ * std::cos(parameter("touchdown_angle_rad"));
      break;
    case Kind::motor_axis:
      inertia_ = parameter("mass_kg");
      damping_ = parameter("damping_nspm");
      break;
    case Kind::rotary_joint:
      inertia_ = parameter("inertia_kgm2");
      damping_ = parameter("damping_nmspr");
      gravity_ = parameter("gravity_torque_nm");
      break;
  }
  if (is(Effect::stiffness_error)) stiffness_npm_ = value();
  if (is(Effect::touchdown_loss)) restitution_touchdown_ = value();
  dry_friction_ =
      is(Effect::coulomb_friction) || is(Effect::stribeck_friction) || is(Effect::asymmetric_friction);
  stance_ = kind_ == Kind::hopper_linear && position_ <= touchdown_height_m_;
  // At rest the direction is decided by the first command; see advance().
  direction_ = velocity_ > 0 ? 1 : velocity_ < 0 ? -1 : 0;
}

// Force of the leg on the body, which is the ground's on the toe: the leg has no mass.
double Machine::leg_force(const Motion& m, double command) const {
  const double cosine = m.position / (2.0 * link_length_m_);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double torque = is(Effect::torque_gain_error) ? value() * command : command;
  double force = -torque / (2.0 * link_length_m_ * sine) - stiffness_npm_ * (m.position - rest_height_m_) -
                 leg_damping_nspm_ * m.velocity;
  if (is(Effect::spring_preload)) force += value();
  return force;
}

double Machine::ground_force_n(double command) const {
  return stance_ ? std::max(0.0, leg_force({position_, velocity_}, command)) : 0.0;
}

// Everything but dry friction.
double Machine::smooth_force(const Motion& m, double command) const {
  double force = -damping_ * m.velocity;
  switch (kind_) {
    case Kind::hopper_linear:
      force -= inertia_ * gravity_;
      if (stance_) force += std::max(0.0, leg_force(m, command));
      break;
    case Kind::motor_axis:
      force += command;
      break;
    case Kind::rotary_joint:
      force += command - gravity_ * std::sin(m.position);
      break;
  }
  if (is(Effect::quadratic_drag)) force -= value() * m.velocity * std::abs(m.velocity);
  if (is(Effect::force_offset)) force += value();
  return force;
}

double Machine::friction_size(int direction, double speed) const {
  if (is(Effect::coulomb_friction)) return value();
  if (is(Effect::stribeck_friction)) {
    const double relative = speed / value(2);
    return value(0) + (value(1) - value(0)) * std::exp(-relative * relative);
  }
  if (is(Effect::asymmetric_friction)) return direction > 0 ? value(0) : value(1);
  return 0.0;
}

double Machine::acceleration(const Motion& m, double command) const {
  double force = smooth_force(m, command);
  if (dry_friction_) force -= direction_ * friction_size(direction_, std::abs(m.velocity));
  return force / inertia_;
}

Machine::Motion Machine::stepped(const Motion& m, double h, double command) const {
  const auto rate = [&](const Motion& s) { return Motion{s.velocity, acceleration(s, command)}; };
  const auto along = [&](const Motion& d, double dt) {
    return Motion{m.position + d.position * dt, m.velocity + d.velocity * dt};
  };
  const Motion k1 = rate(m), k2 = rate(along(k1, h / 2)), k3 = rate(along(k2, h / 2)),
               k4 = rate(along(k3, h));
  return {m.position + h / 6 * (k1.position + 2 * k2.position + 2 * k3.position + k4.position),
          m.velocity + h / 6 * (k1.velocity + 2 * k2.velocity + 2 * k3.velocity + k4.velocity)};
}

bool Machine::turns(const Motion& m) const { return dry_friction_ && m.velocity * direction_ < 0; }

// A hop too low to straighten the leg touches down again as soon as it falls.
bool Machine::touches_down(const Motion& m) const {
  return kind_ == Kind::hopper_linear && !stance_ && m.velocity < 0 && m.position <= touchdown_height_m_;
}

bool Machine::lifts_off(const Motion& m, double command) const {
  return stance_ && m.velocity > 0 && (m.position >= touchdown_height_m_ || leg_force(m, command) <= 0);
}

// At standstill: where the axis breaks away to, or 0 if dry friction holds it.
int Machine::direction_from_rest(double command) const {
  const double applied = smooth_force({position_, 0.0}, command);
  if (applied > friction_size(1, 0.0)) return 1;
  if (applied < -friction_size(-1, 0.0)) return -1;
  return 0;
}

void Machine::advance(double until_s, double command, double step_s) {
  while (time_s_ < until_s) {
    if (dry_friction_ && direction_ == 0) {
      direction_ = direction_from_rest(command);
      // At rest nothing changes while the command is held.
      if (direction_ == 0) break;
    }
    const double remaining = until_s - time_s_;
    // The last sliver goes into the step before it, so that no step is all rounding.
    const double h = remaining < 1.001 * step_s ? remaining : step_s;
    const Motion start{position_, velocity_};
    const auto event = [&](const Motion& m) { return turns(m) || touches_down(m) || lifts_off(m, command); };
    Motion end = stepped(start, h, command);
    double taken = h;
    if (event(end)) {
      double before = 0;
      while (taken - before > kEventWidth_s) {
        const double middle = 0.5 * (before + taken);
        const Motion m = stepped(start, middle, command);
        if (event(m)) {
          taken = middle;
          end = m;
        } else {
          before = middle;
        }
      }
    }
    time_s_ = taken < remaining ? time_s_ + taken : until_s;
    position_ = end.position;
    velocity_ = end.velocity;
    if (stance_ && velocity_ < 0 && leg_force(end, command) < 0) ground_pulled_ = true;
    if (touches_down(end)) {
      stance_ = true;
      touchdown_s_ = time_s_;
      velocity_ *= restitution_touchdown_;
    } else if (lifts_off(end, command)) {
      stance_ = false;
      liftoff_s_ = time_s_;
      velocity_ *= restitution_liftoff_;
    } else if (turns(end)) {
      velocity_ = 0;
      direction_ = 0;
    }
  }
  time_s_ = until_s;
}

}  // namespace furcula::hidden
