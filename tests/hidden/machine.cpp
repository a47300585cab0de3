// See machine.hpp.
#include "tests/hidden/machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "tests/hidden/random.hpp"

namespace furcula::hidden {

namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kEventWidth_s = 1e-10;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

bool within(double x, double from, double to) { return from < x && x < to; }

}  // namespace

Machine::Machine(const Truth& truth, double position, double velocity, double start_s)
    : hopper_(is_kind(truth.kind, "hopper_linear")),
      rotary_(is_kind(truth.kind, "rotary_joint")),
      carriage_(is_kind(truth.kind, "rail_carriage")),
      disturbed_(truth.disturbance, truth.draw),
      drive_(truth.planted, start_s, truth.draw),
      time_s_(start_s),
      touchdown_s_(kNever),
      liftoff_s_(kNever) {
  state_[kX] = position;
  state_[kV] = velocity;
  const auto parameter = [&](std::string_view name) {
    return truth.parameters.at(*dynamics::parameter_index(truth.kind, name));
  };
  if (!machine_has(truth.kind)) throw std::invalid_argument("no machine of this kind");
  inertia_ = parameter(rotary_ ? "inertia_kgm2" : "mass_kg");
  if (hopper_) {
    damping_ = parameter("damping_flight_nspm");
    leg_damping_nspm_ = parameter("damping_stance_nspm") - damping_;
    gravity_ = parameter("gravity_mps2");
    stiffness_npm_ = parameter("stiffness_npm");
    rest_height_m_ = parameter("rest_height_m");
    link_length_m_ = parameter("link_length_m");
    restitution_touchdown_ = parameter("restitution_touchdown");
    restitution_liftoff_ = parameter("restitution_liftoff");
    touchdown_height_m_ = 2.0 * link_length_m_ * std::cos(parameter("touchdown_angle_rad"));
  } else {
    damping_ = parameter(rotary_ ? "damping_nmspr" : "damping_nspm");
    if (rotary_) gravity_ = parameter("gravity_torque_nm");
    if (carriage_) gravity_ = parameter("gravity_mps2");
  }

  auxiliary_npm_ = truth.clutch[2];
  pitch_m_ = truth.clutch[3];
  for (const Planted& p : truth.planted) {
    const LawInfo* law = law_named(p.law);
    if (!law || !law->on(truth.kind)) throw std::invalid_argument("no machine of this kind has " + p.law);
    const auto is = [&](std::string_view name) { return p.law == name; };
    const auto [v0, v1, v2] = p.values;
    if (is("coulomb_friction")) {
      friction_up_ += v0;
      friction_down_ += v0;
    } else if (is("stribeck_friction")) {
      friction_up_ += v0;
      friction_down_ += v0;
      stribeck_excess_ = v1 - v0;
      stribeck_velocity_ = v2;
    } else if (is("asymmetric_friction")) {
      friction_up_ += v0;
      friction_down_ += v1;
    } else if (is("quadratic_drag")) {
      drag_ = v0;
    } else if (is("binding_spot") || is("cable_snag")) {
      (is("binding_spot") ? binding_ : snag_) = v0;
      (is("binding_spot") ? binding_from_ : snag_from_) = v1 - v2 / 2;
      (is("binding_spot") ? binding_to_ : snag_to_) = v1 + v2 / 2;
    } else if (is("damping_error")) {
      if (hopper_)
        damping_ += v0;
      else
        damping_ = v0;
    } else if (is("force_offset")) {
      offset_ = v0;
    } else if (is("guide_tilt")) {
      cosine_of_tilt_ = std::cos(v0);
    } else if (is("mass_error")) {
      inertia_ = v0;
    } else if (is("stiffness_error")) {
      stiffness_npm_ = v0;
    } else if (is("rest_height_error")) {
      rest_height_m_ = v0;
    } else if (is("spring_preload")) {
      preload_n_ = v0;
    } else if (is("spring_hardening")) {
      cubic_npm3_ = v0;
    } else if (is("spring_hysteresis")) {
      hysteresis_ = v0;
    } else if (is("leg_inertia")) {
      links_ = true;
      links_a_ = v0;
      links_b_ = v1;
      links_e_ = v2;
    } else if (is("backlash")) {
      half_gap_rad_ = v0 / 2;
    } else if (is("touchdown_loss")) {
      restitution_touchdown_ = v0;
    } else if (is("liftoff_loss")) {
      restitution_liftoff_ = v0;
    } else if (is("ground_compliance")) {
      ground_npm_ = v0;
      ground_nspm_ = v1;
      if (v0 <= 0 || v1 <= 0) throw std::invalid_argument("a ground that gives needs a spring and a damper");
    } else if (is("toe_sticking")) {
      sticking_n_ = v0;
    } else if (is("side_mass")) {
      side_mass_ = v0;
      const double frequency = kTwoPi * v1;
      side_stiffness_ = v0 * frequency * frequency;
      side_damping_ = 2 * v0 * frequency * v2;
    } else if (is("bump_stop")) {
      bump_compression_m_ = v0;
      bump_npm_ = v1;
    } else if (is("incomplete_release")) {
      left_in_ = v0;
    } else if (is("auxiliary_spring")) {
      auxiliary_npm_ = v0;
    } else if (is("end_stop")) {
      end_position_ = v0;
      end_stiffness_ = v1;
    } else if (is("detents")) {
      detent_ = v0;
      detent_pitch_ = v1;
      detent_phase_rad_ = v2;
    } else if (is("periodic_force")) {
      periodic_ = v0;
      periodic_hz_ = v1;
      periodic_phase_rad_ = v2;
    } else if (is("gusts")) {
      constexpr double kLongest_s = 60.0;
      Random random(truth.draw * 0x9E3779B97F4A7C15u + 29);
      for (double t = 0; t < kLongest_s;) {
        t -= std::log(1.0 - random.unit()) / v2;
        const double length_s = v1 * random.uniform(0.5, 1.5);
        gusts_.push_back({t, t + length_s, v0 * random.normal()});
        t += length_s;
      }
    } else if (is("warming_friction")) {
      warm_friction_ = v0;
      warming_s_ = v1;
    } else if (is("fading_spring")) {
      fading_ = v0;
      fading_s_ = v1;
    } else if (is("creeping_spring")) {
      creep_ = v0;
      creep_s_ = v1;
    }
    // All others are in the drive (drive.cpp) or in the sensors (rig.cpp).
  }
  dry_friction_ = friction_up_ != 0 || friction_down_ != 0 || stribeck_excess_ != 0 || binding_ != 0 ||
                  hysteresis_ != 0 || warm_friction_ != 0;
  stance_ = hopper_ && position <= touchdown_height_m_;
  ground_m_ = stance_ ? 0.0 : disturbed_.ground_m(0);
  // At rest the direction is decided by the first command; see advance().
  direction_ = velocity > 0 ? 1 : velocity < 0 ? -1 : 0;
  state_[kGap] = half_gap_rad_;
}

// At the motor, ripple and all; on the hopper it counts in stance alone.
double Machine::torque(const State& s, double t) const {
  if (!hopper_) return drive_.delivered(t, s[kX]);
  const double angle = std::acos(std::min(1.0, (s[kX] - s[kToe]) / (2.0 * link_length_m_)));
  return drive_.delivered(t, angle + s[kGap]);
}

// Spring with all that makes it another one, without the preload.
double Machine::elastic_force(double length, double t) const {
  const double rate = stiffness_npm_ * (1 - fading_ * (1 - std::exp(-t / fading_s_)));
  if (cable_ != Cable::held)
    return stiffness_npm_ * (rest_height_m_ - touchdown_height_m_) +
           loose_rate_npm() * (touchdown_height_m_ - length);
  const double compression = rest_height_m_ - travel_m_ - length;
  return rate * compression + cubic_npm3_ * compression * compression * compression;
}

// Of the two springs in series, and what an incomplete release leaves of the rest.
double Machine::loose_rate_npm() const {
  const double series = stiffness_npm_ * auxiliary_npm_ / (stiffness_npm_ + auxiliary_npm_);
  return series + left_in_ * (stiffness_npm_ - series);
}

double Machine::loose_travel_m(double length) const {
  return std::max(0.0, touchdown_height_m_ - length) * (1 - loose_rate_npm() / stiffness_npm_);
}

double Machine::cable_travel_m() const {
  if (cable_ == Cable::held) return travel_m_;
  return loose_travel_m(leg_length_m());
}

// After a step: has the cable come to a tooth since its travel was `from_m`?
void Machine::seek_tooth(double from_m) {
  if (cable_ != Cable::seeking) return;
  const double to_m = cable_travel_m();
  const double tooth =
      to_m > from_m ? pitch_m_ * std::floor(to_m / pitch_m_) : pitch_m_ * std::ceil(to_m / pitch_m_);
  if (to_m > 0 && !(to_m > from_m ? tooth > from_m : tooth < from_m)) return;
  travel_m_ = to_m > 0 ? tooth : 0.0;
  cable_ = Cable::held;
}

// In stance. Without links' inertia the leg has no mass: its force on the body is the ground's on the toe.
Machine::Leg Machine::leg(const State& s, double t) const {
  const double length = s[kX] - s[kToe];
  Leg out{};
  const double cosine = length / (2.0 * link_length_m_);
  out.sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double spring = elastic_force(length, t);
  const double motor = rotor_end_ == 0 && half_gap_rad_ > 0 ? 0.0 : torque(s, t);
  double still =
      spring - creep_ * stiffness_npm_ * s[kCrept] + preload_n_ - motor / (2.0 * link_length_m_ * out.sine);
  still += bump_npm_ * std::max(0.0, touchdown_height_m_ - length - bump_compression_m_);
  if (hysteresis_ != 0 && direction_ != 0) still -= hysteresis_ * std::abs(spring) * direction_;
  if (sticking_n_ >= 0 && length > touchdown_height_m_)
    still -= kLegStop_npm * (length - touchdown_height_m_);
  if (ground_npm_ > 0) {
    // The massless toe moves so that leg and ground push on it equally; on the leg's stop it moves with the
    // body.
    out.toe_velocity = (leg_damping_nspm_ * s[kV] - ground_npm_ * (s[kToe] - ground_m_) - still) /
                       (leg_damping_nspm_ + ground_nspm_);
    if (length >= touchdown_height_m_ && s[kV] > out.toe_velocity && sticking_n_ < 0)
      out.toe_velocity = s[kV];
    out.force = out.ground_force = -ground_npm_ * (s[kToe] - ground_m_) - ground_nspm_ * out.toe_velocity;
  } else {
    out.force = out.ground_force = still - leg_damping_nspm_ * s[kV];
  }
  const double least = sticking_n_ > 0 ? -sticking_n_ : 0.0;
  if (!links_) out.force = out.ground_force = std::max(least, out.force);
  return out;
}

double Machine::gust(double t) const {
  for (const Gust& g : gusts_)
    if (within(t, g.begin_s, g.end_s))
      return g.force * std::sin(std::numbers::pi * (t - g.begin_s) / (g.end_s - g.begin_s));
  return 0.0;
}

// On the body from without, in both phases: everything but leg, gravity on the hopper, and dry friction.
double Machine::outer_force(const State& s, double t) const {
  const double x = s[kX], v = s[kV];
  double force = -damping_ * v - drag_ * v * std::abs(v) + offset_;
  if (!hopper_) force += torque(s, t);
  if (rotary_) force -= gravity_ * std::sin(x);
  if (side_mass_ > 0) force += side_stiffness_ * s[kSideX] + side_damping_ * s[kSideV];
  force -= end_stiffness_ * std::max(0.0, x - end_position_);
  if (snag_ != 0 && v > 0 && within(x, snag_from_, snag_to_)) force -= snag_;
  if (detent_ != 0) force += detent_ * std::sin(kTwoPi * x / detent_pitch_ + detent_phase_rad_);
  if (periodic_ != 0) force += periodic_ * std::sin(kTwoPi * periodic_hz_ * t + periodic_phase_rad_);
  return force + gust(t) + disturbed_.force(t);
}

// Of the guide or the bearings.
double Machine::friction_size(const State& s, double t, int direction, double speed) const {
  double size = direction > 0 ? friction_up_ : friction_down_;
  if (stribeck_excess_ != 0) {
    const double relative = speed / stribeck_velocity_;
    size += stribeck_excess_ * std::exp(-relative * relative);
  }
  if (binding_ != 0 && within(s[kX], binding_from_, binding_to_)) size += binding_;
  if (warm_friction_ != 0) size += warm_friction_ * (1 - std::exp(-t / warming_s_));
  return size;
}

// Of the body with its links in stance: M of docs/physics.md along z = 2 L cos(theta).
double Machine::effective_inertia(double length) const {
  if (!links_ || !stance_) return inertia_;
  const double c2 = length * length / (4 * link_length_m_ * link_length_m_);  // cos^2(theta)
  return inertia_ - links_e_ / link_length_m_ +
         (links_a_ - 2 * link_length_m_ * links_b_ * (2 * c2 - 1)) /
             (4 * link_length_m_ * link_length_m_ * (1 - c2));
}

double Machine::acceleration(const State& s, double t) const {
  double force = outer_force(s, t);
  if (dry_friction_) force -= direction_ * friction_size(s, t, direction_, std::abs(s[kV]));
  if (!hopper_ && !carriage_) return force / inertia_;
  const double gravity = gravity_ * cosine_of_tilt_;
  if (!stance_) {
    // Of the links' momentum, e d(cos theta)/dt = e l' / (2 L), the second half of it differentiated.
    double shaken = 0;
    if (const double since = t - fold_.begin_s; links_ && within(since, 0, fold_.length_s)) {
      const double w = kTwoPi / fold_.length_s;
      shaken = -links_e_ / (2 * link_length_m_) * fold_.depth_m / 2 * w * w * std::cos(w * since);
    }
    return (force + shaken) / inertia_ - gravity;
  }
  force += leg(s, t).force;
  if (!links_) return force / inertia_ - gravity;
  // d/dt of (M z') less half of dM/dz z'^2; of the links' weight, half sinks with the body.
  const double length = s[kX] - s[kToe], L = link_length_m_, c2 = length * length / (4 * L * L);
  const double numerator = links_a_ - 2 * L * links_b_ * (2 * c2 - 1), denominator = 4 * L * L * (1 - c2);
  const double slope =
      length / (2 * L * L) *
      (-4 * L * links_b_ / denominator + 4 * L * L * numerator / (denominator * denominator));
  return (force - (inertia_ - links_e_ / (2 * L)) * gravity - 0.5 * slope * s[kV] * s[kV]) /
         effective_inertia(length);
}

Machine::State Machine::rates(const State& s, double t) const {
  State r{};
  const double a = direction_ == 0 && dry_friction_ ? 0.0 : acceleration(s, t);
  r[kX] = s[kV];
  r[kV] = a;
  if (ground_npm_ > 0 && stance_) r[kToe] = leg(s, t).toe_velocity;
  if (creep_ != 0)  // a spring beside a spring and damper in series, which follow its compression
    r[kCrept] = ((stance_ ? touchdown_height_m_ - (s[kX] - s[kToe]) : 0.0) - s[kCrept]) / creep_s_;
  if (side_mass_ > 0) {  // its position and velocity against the body's
    r[kSideX] = s[kSideV];
    r[kSideV] = -(side_stiffness_ * s[kSideX] + side_damping_ * s[kSideV]) / side_mass_ - a;
  }
  if (half_gap_rad_ > 0 && rotor_end_ == 0) {
    double leg_acceleration = 0;
    if (stance_) {
      const double x = s[kX] - s[kToe], L = link_length_m_;
      const double sine = std::sqrt(1 - x * x / (4 * L * L));
      // z = 2 L cos(theta), differentiated twice.
      const double turning = -s[kV] / (2 * L * sine);
      leg_acceleration = -(a + x * turning * turning) / (2 * L * sine);
    }
    r[kGap] = s[kGapV];
    r[kGapV] = torque(s, t) / kRotor_kgm2 - leg_acceleration;
  }
  return r;
}

Machine::State Machine::stepped(const State& s, double h) const {
  const auto along = [&](const State& d, double dt) {
    State out = s;
    for (std::size_t i = 0; i < kCoordinates; ++i) out[i] += d[i] * dt;
    return out;
  };
  // The drive's closed form holds up to the end of the piece, which may be its next change.
  const State k1 = rates(s, time_s_), k2 = rates(along(k1, h / 2), time_s_ + h / 2),
              k3 = rates(along(k2, h / 2), time_s_ + h / 2), k4 = rates(along(k3, h), time_s_ + h);
  State out = s;
  for (std::size_t i = 0; i < kCoordinates; ++i) out[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  return out;
}

bool Machine::turns(const State& s) const { return dry_friction_ && s[kV] * direction_ < 0; }

// A hop too low to straighten the leg touches down again as soon as it falls.
bool Machine::touches_down(const State& s, double t) const {
  return hopper_ && !stance_ && s[kV] < 0 && s[kX] <= length_in_flight(t) + ground_m_;
}

double Machine::length_in_flight(double t) const {
  const double since = t - fold_.begin_s;
  if (!(since > 0 && since < fold_.length_s)) return touchdown_height_m_;
  return touchdown_height_m_ - fold_.depth_m / 2 * (1 - std::cos(kTwoPi * since / fold_.length_s));
}

bool Machine::lifts_off(const State& s, double t) const {
  if (!stance_ || s[kV] <= 0) return false;
  if (sticking_n_ >= 0) return leg(s, t).ground_force <= -sticking_n_;
  if (ground_npm_ > 0) return leg(s, t).ground_force <= 0;
  if (s[kX] - s[kToe] >= touchdown_height_m_) return true;
  if (!links_) return leg(s, t).ground_force <= 0;
  // Momentum of body and links, m z' + e sin(theta) theta', changes by what acts from without.
  double outer = outer_force(s, t) - inertia_ * gravity_ * cosine_of_tilt_;
  if (dry_friction_) outer -= direction_ * friction_size(s, t, direction_, std::abs(s[kV]));
  return (inertia_ - links_e_ / (2 * link_length_m_)) * acceleration(s, t) - outer <= 0;
}

bool Machine::rotor_arrives(const State& s) const {
  return half_gap_rad_ > 0 && rotor_end_ == 0 &&
         ((s[kGap] >= half_gap_rad_ && s[kGapV] > 0) || (s[kGap] <= -half_gap_rad_ && s[kGapV] < 0));
}

double Machine::ground_force_n() const { return stance_ ? leg(state_, time_s_).ground_force : 0.0; }

double Machine::motor_angle_rad() const {
  const double length = std::min(touchdown_height_m_, leg_length_m());
  return std::acos(length / (2.0 * link_length_m_)) + state_[kGap];
}

// At standstill: where the axis breaks away to, or 0 if dry friction holds it.
void Machine::choose_direction_from_rest() {
  for (int way : {1, -1}) {
    direction_ = way;
    State still = state_;
    still[kV] = 0.0;
    if (acceleration(still, time_s_) * way > 0) return;
  }
  direction_ = 0;
}

// While the rotor rests on an end of the gap: does it stay there?
void Machine::follow_rotor() {
  if (half_gap_rad_ == 0 || rotor_end_ == 0) return;
  rotor_end_ = rotor_end_ > 0 ? 1 : -1;
  const int end = rotor_end_;
  rotor_end_ = 0;
  const double away = rates(state_, time_s_)[kGapV];  // of the rotor against the leg, were it free
  if (away * end >= 0) rotor_end_ = end;
}

void Machine::advance(double until_s, double command, double step_s) {
  drive_.command(time_s_, command);
  while (time_s_ < until_s) {
    drive_.settle(time_s_);
    if (dry_friction_ && direction_ == 0) choose_direction_from_rest();
    follow_rotor();
    const double change_s = drive_.next_change_s();
    const double piece_s = std::min(until_s, change_s) - time_s_;
    // The last sliver goes into the step before it, so that no step is all rounding.
    const double h = piece_s < 1.001 * step_s ? piece_s : step_s;
    const State start = state_;
    const double travelled_m = cable_travel_m();
    const double from_s = time_s_;
    const auto event = [&](const State& s, double t) {
      return turns(s) || touches_down(s, t) || lifts_off(s, t) || rotor_arrives(s);
    };
    State end = stepped(start, h);
    double taken = h;
    if (event(end, from_s + h)) {
      double before = 0;
      while (taken - before > kEventWidth_s) {
        const double middle = 0.5 * (before + taken);
        const State s = stepped(start, middle);
        if (event(s, from_s + middle)) {
          taken = middle;
          end = s;
        } else {
          before = middle;
        }
      }
    }
    const bool whole = taken >= piece_s;
    time_s_ = whole ? std::min(until_s, change_s) : from_s + taken;
    state_ = end;
    if (stance_ && sticking_n_ < 0 && end[kV] < 0) {
      const Leg l = leg(end, time_s_);
      if (l.ground_force <= 0) ground_pulled_ = true;
    }
    if (rotor_arrives(end)) {
      // Plastic: what the rotor has gained against the leg goes to the leg, which on its stop does not feel
      // it.
      rotor_end_ = end[kGap] > 0 ? 1 : -1;
      if (stance_) {
        const double sine = leg(end, time_s_).sine;
        state_[kV] -=
            kRotor_kgm2 * end[kGapV] / (2 * link_length_m_ * sine * effective_inertia(end[kX] - end[kToe]));
      }
      state_[kGapV] = 0;
      state_[kGap] = rotor_end_ * half_gap_rad_;
    } else if (touches_down(end, time_s_)) {
      stance_ = true;
      touchdown_s_ = time_s_;
      state_[kV] *= restitution_touchdown_ * disturbed_.factor(2 * hops_);
      state_[kToe] = ground_m_;
    } else if (lifts_off(end, time_s_)) {
      stance_ = false;
      liftoff_s_ = time_s_;
      state_[kV] *= restitution_liftoff_ * disturbed_.factor(2 * hops_ + 1);
      state_[kToe] = 0;
      ground_m_ = disturbed_.ground_m(++hops_);
    } else if (turns(end)) {
      state_[kV] = 0;
      direction_ = 0;
    }
    seek_tooth(travelled_m);
  }
  drive_.settle(until_s);
}

}  // namespace furcula::hidden
