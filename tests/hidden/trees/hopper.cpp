#include "tests/hidden/trees/hopper.hpp"

#include <algorithm>
#include <cmath>

namespace furcula::hidden::trees {

Hopper::Hopper(const Robot& model, const Hopping& how)
    : hip_(model.leg->hip),
      knee_(model.leg->knee),
      thigh_m_(length(model.joints[model.leg->knee].at)),
      shank_m_(length(model.leg->toe_m)),
      weight_n_(0.0),
      spring_nmprad_(model.leg->spring_nmprad),
      rest_rad_(model.leg->rest_rad),
      switched_(model.leg->switched),
      how_(how),
      swing_s_(how.swing_s) {
  for (const Body& b : model.bodies) {
    weight_n_ += kGravity_mps2 * b.mass_kg;
    if (b.joint == static_cast<int>(hip_)) {
      thigh_kgm_ += b.mass_kg * length(b.centre_m);
    } else if (b.joint == static_cast<int>(knee_)) {
      thigh_kgm_ += b.mass_kg * thigh_m_;
      shank_kgm_ += b.mass_kg * length(b.centre_m);
    }
  }
}

double Hopper::forward_mps(const Values& q, const Values& v) const {
  const double f = q[hip_] + q[knee_], turns = v[hip_] + v[knee_];
  return v[0] + (thigh_kgm_ * std::cos(q[hip_]) * v[hip_] + shank_kgm_ * std::cos(f) * turns) /
                    (weight_n_ / kGravity_mps2);
}

double Hopper::length_m(double knee_rad) const {
  return std::sqrt(thigh_m_ * thigh_m_ + shank_m_ * shank_m_ + 2 * thigh_m_ * shank_m_ * std::cos(knee_rad));
}

double Hopper::bend_rad(double knee_rad) const {
  return std::atan2(shank_m_ * std::sin(knee_rad), thigh_m_ + shank_m_ * std::cos(knee_rad));
}

double Hopper::shortens_m(double knee_rad) const {
  return -thigh_m_ * shank_m_ * std::sin(knee_rad) / length_m(knee_rad);
}

Values Hopper::start(const HopTarget& target) const {
  Values q{};
  q[knee_] = how_.landing_rad;
  q[hip_] = -bend_rad(how_.landing_rad);
  q[1] = length_m(how_.landing_rad) + target.drop_m;
  return q;
}

Values Hopper::command(double t, const HopTarget& target, const Values& q, const Values& v, bool contact) {
  const double hip = q[hip_], knee = q[knee_];
  const double landing_m = length_m(how_.landing_rad);
  if (first_) {
    hip_then_ = hip;
    knee_then_ = knee;
  }
  if (contact != stance_) {
    if (!contact) {
      stance_s_ += 0.5 * (std::clamp(t - since_s_, 0.08, 0.3) - stance_s_);
      // The leg swings within the flight that this speed gives.
      const double flies = 2 * std::max(v[1], 0.0) / kGravity_mps2;
      swing_s_ = std::clamp(0.75 * flies, 0.06, how_.swing_s);
    }
    stance_ = contact;
    since_s_ = t;
    hip_then_ = hip;
    knee_then_ = knee;
    extends_ = rose_ = false;
  }

  double hip_nm = 0.0, knee_nm = 0.0;
  if (!stance_) {
    if (v[1] > 0.0) rose_ = true;
    if (rose_ && v[1] <= 0.0) {
      misses_m_ = landing_m + target.drop_m - q[1];
      more_nm_ += how_.push_gain_npm * misses_m_;
      more_nm_ = std::clamp(more_nm_, -0.4 * how_.push_most_nm, how_.push_most_nm);
      rose_ = false;
    }
    // Raibert: half of the way of the next stance ahead, and further if too fast.
    const double speed = forward_mps(q, v);
    const double ahead = speed * stance_s_ / 2 + how_.speed_gain_s * (speed - target.speed_mps);
    const double lands = std::asin(std::clamp(ahead / landing_m, -0.55, 0.55));
    const double x = std::clamp((t - since_s_) / swing_s_, 0.0, 1.0), share = x * x * (3 - 2 * x);
    const double knee_to = how_.landing_rad + (v[1] > 0.0 ? how_.folds_rad : 0.0);
    const double knee_by = std::clamp((t - since_s_) / (0.5 * swing_s_), 0.0, 1.0);
    const double knee_at = first_ ? knee : knee_then_ + knee_by * (knee_to - knee_then_);
    const double hip_at = hip_then_ + share * (lands - bend_rad(knee) - hip_then_);
    hip_nm = how_.hip_kp * (hip_at - hip) - how_.hip_kd * v[hip_];
    knee_nm = how_.knee_kp * (knee_at - knee) - how_.knee_kd * v[knee_];
  } else {
    if (!extends_ && v[knee_] < 0.0 && t - since_s_ > 0.02) {
      extends_ = true;
      extends_s_ = t;
    }
    // The damper bears what a spring that catches late does not.
    knee_nm =
        -how_.stiffens_nmprad * std::max(knee - knee_then_, 0.0) - how_.damps_nmspr * std::max(v[knee_], 0.0);
    // All fades out towards the angle where the spring is slack; there the knee lifts the toe.
    const double slack = switched_ ? knee_then_ : std::max(knee_then_, rest_rad_);
    // A hop loses about as much as it is high, in the impact and in the links that are stopped at its end.
    const double push =
        std::clamp(how_.pushes * weight_n_ * target.drop_m + more_nm_ + 2 * how_.push_gain_npm * misses_m_,
                   0.0, how_.push_most_nm);
    if (extends_)
      knee_nm += -push * std::clamp((t - extends_s_) / 0.015, 0.0, 1.0) *
                     std::clamp((knee - slack) / 0.12, 0.0, 1.0) +
                 how_.lifts_nm * std::clamp((slack + 0.1 - knee) / 0.1, 0.0, 1.0);
    // The leg's force, from the knee's torque; the hip may use a part of it sidewards.
    const double spring = spring_nmprad_ * std::max(knee - (switched_ ? knee_then_ : rest_rad_), 0.0);
    const double force = std::max(spring - knee_nm, 0.0) / std::max(-shortens_m(knee), 0.05);
    const double length = length_m(knee);
    // A spring may catch late: no drive sidewards before the leg bears.
    const double bears = std::clamp((t - since_s_ - 0.02) / 0.03, 0.0, 1.0);
    const double bound = bears * how_.grip * force * length;
    // Of the line from hip to toe.
    const double bends = shank_m_ * (shank_m_ + thigh_m_ * std::cos(knee)) / (length * length);
    const double turns = v[hip_] + bends * v[knee_];
    hip_nm = std::clamp(how_.drives_nmspr * (-target.speed_mps / length - turns), -bound, bound);
    // The links' inertia pushes the toe forth as the leg's force falls: the hip takes it along.
    if (extends_)
      hip_nm += how_.sweeps_nms2 * v[knee_] * v[knee_] * std::clamp((slack + 0.2 - knee) / 0.2, 0.0, 1.0);
  }
  const double period = t - last_s_;
  const double keeps = first_ ? 0.0 : std::exp(-period / how_.smooth_s);
  hip_nm_ = keeps * hip_nm_ + (1 - keeps) * hip_nm;
  knee_nm_ = keeps * knee_nm_ + (1 - keeps) * knee_nm;
  last_s_ = t;
  first_ = false;
  Values out{};
  out[hip_] = std::clamp(hip_nm_, -how_.most_nm, how_.most_nm);
  out[knee_] = std::clamp(knee_nm_, -how_.most_nm, how_.most_nm);
  return out;
}

}  // namespace furcula::hidden::trees
