// Rotors along a recording, see rotor.hpp.
#include "host/trees/rotor.hpp"

#include <cmath>

namespace furcula::trees {
namespace {

/// After so many time constants a start is forgotten.
constexpr double kForgotten = 6.0;

}  // namespace

void swing(const dynamics::tree::JointLaw<double>& law, double time_s, double& x, double& v) {
  const double decay = 0.5 * law.rotor_damping_nmspr / law.armature_kgm2,
               square = law.drive_stiffness_nmprad / law.armature_kgm2 - decay * decay;
  const double omega = std::sqrt(std::abs(square)), e = std::exp(-decay * time_s);
  const double c = square > 0.0 ? std::cos(omega * time_s) : std::cosh(omega * time_s);
  const double s = omega * time_s < 1e-9 ? time_s
                   : square > 0.0        ? std::sin(omega * time_s) / omega
                                         : std::sinh(omega * time_s) / omega;
  const double b = v + decay * x, angle = e * (x * c + b * s);
  v = e * (b * c - square * x * s) - decay * angle;
  x = angle;
}

Rotor::Rotor(const Setup& setup, const Recording& recording, std::size_t joint, std::size_t from)
    : drive_(setup.joints[joint]), law_(setup.model.laws[joint]), r_(recording), joint_(joint), row_(from) {
  if (drive_.lag_s > 0.0) lagged_nm_ = lagged_before(drive_, r_, joint, from);
  const double q = joint_rad(from), v = velocity_about(r_, joint, from);
  const std::size_t row = row_in_force(drive_, r_, from);
  const double measured = r_.angle_rad[joint][from],
               torque = drive_.lag_s > 0.0
                            ? made_torque(drive_, lagged_nm_, measured)
                            : made_torque(
                                  drive_,
                                  asked_torque(drive_, input_in_force(drive_, r_, joint, row), measured, v),
                                  measured);
  angle_rad_ = q + (torque + drive_.offset_nm - law_.rotor_damping_nmspr * v) / law_.drive_stiffness_nmprad;
  rate_radps_ = v;
}

Rotor Rotor::at(const Setup& setup, const Recording& r, std::size_t joint, std::size_t row) {
  const dynamics::tree::JointLaw<double>& law = setup.model.laws[joint];
  const double decay_1ps = 0.5 * law.rotor_damping_nmspr / law.armature_kgm2;
  std::size_t from = row;
  while (from > 0 && !gap_after(r, from - 1) && (r.time_s[row] - r.time_s[from]) * decay_1ps < kForgotten)
    --from;
  Rotor out(setup, r, joint, from);
  while (out.row_ < row) out.advance();
  return out;
}

double Rotor::joint_rad(std::size_t row) const {
  return r_.angle_rad[joint_][row] - drive_.encoder_offset_rad;
}
void Rotor::advance() {
  const double dt = r_.time_s[row_ + 1] - r_.time_s[row_];
  const double q = joint_rad(row_), slope = (joint_rad(row_ + 1) - q) / dt;
  const double measured = 0.5 * (r_.angle_rad[joint_][row_] + r_.angle_rad[joint_][row_ + 1]);
  const double input = input_in_force(drive_, r_, joint_, row_in_force(drive_, r_, row_));
  double asked = asked_torque(drive_, input, measured, slope);
  if (drive_.lag_s > 0.0) asked = passed(drive_.lag_s, dt, asked, lagged_nm_);
  const double torque = made_torque(drive_, asked, measured) + drive_.offset_nm;
  // The joint at a steady velocity: what the rotor is ahead of it swings about a constant.
  const double about = (torque - law_.rotor_damping_nmspr * slope) / law_.drive_stiffness_nmprad;
  double x = angle_rad_ - q - about, v = rate_radps_ - slope;
  swing(law_, dt, x, v);
  angle_rad_ = q + slope * dt + about + x;
  rate_radps_ = slope + v;
  ++row_;
}

double Rotor::impulse_nms(double stiff_inertia_kgm2, double stiff_damping_nmspr) const {
  return stiff_inertia_kgm2 * velocity_about(r_, joint_, row_) + stiff_damping_nmspr * joint_rad(row_) -
         law_.armature_kgm2 * rate_radps_ - law_.rotor_damping_nmspr * angle_rad_;
}

}  // namespace furcula::trees
