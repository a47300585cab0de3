#include "host/walk/gait_walk.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "furcula/control/walk/walk_parameters.hpp"
#include "furcula/dynamics/biped/energy.hpp"

namespace furcula::walk {

using namespace biped;

State<double> state_of(const Description& robot, const GaitPhase::At& at, const Stance<double>& stance) {
  State<double> s;
  const Moving<double>& p = stance.pelvis;
  s.position_m = p.at_m;
  s.position_m.z -= robot.vertices_m[kLeft][0].z;
  // A pelvis that stands more or less upright: w is far from zero.
  const Mat3<double>& r = p.rotation;
  const double w = 0.5 * std::sqrt(1.0 + r.x.x + r.y.y + r.z.z);
  s.attitude = {w, (r.z.y - r.y.z) / (4.0 * w), (r.x.z - r.z.x) / (4.0 * w), (r.y.x - r.x.y) / (4.0 * w)};
  s.w_radps = p.w_radps;
  s.v_mps = p.v_mps;
  for (std::size_t i = 0; i < kJoints; ++i) {
    set_joint<double>(s.q_rad, i, at.q[i]);
    set_joint<double>(s.qd_radps, i, at.qd[i]);
  }
  return s;
}

namespace {

/// The joints that have targets, as LegTargets has them, and the sign outwards.
constexpr std::array<std::size_t, 5> kTargets{kHipPitch, kKnee, kAnklePitch, kHipRoll, kAnkleRoll};

/// What the drives are told at a moment of the controller's step, which begins when the other foot lands: outwards for rolls, without feedback.
struct Wanted {
  double time_s;
  std::array<double, 5> stance, swing;
};

std::vector<Wanted> wanted(const Description& robot, WalkMode mode, const Gait& gait,
                           const Parameters& gains) {
  constexpr int kMoments = 120;
  const StanceDynamics<double> dynamics(robot);
  const biped::Parameters<double> parameters(robot);
  const double length = gait.duration_s();
  const double swing_s = gait.phases.front().duration_s, double_support_s = length - swing_s;
  std::vector<Wanted> out;
  for (int k = 0; k <= kMoments; ++k) {
    Wanted w{length * k / kMoments, {}, {}};
    // First what the last step's end, in a mirror, has on both feet: there the right leg becomes the stance.
    const bool before = w.time_s < double_support_s;
    const auto [phase, time] = gait.phase_at(before ? swing_s + w.time_s : w.time_s - double_support_s);
    const GaitPhase::At at = phase->at(time);
    const Stance<double> s = dynamics(at.q, at.qd, at.qdd, at.other);
    const auto motor = motor_torques(robot, mode, at, s);
    const std::size_t stance = before ? kRight : kLeft;
    for (const std::size_t side : {kLeft, kRight})
      for (std::size_t t = 0; t < kTargets.size(); ++t) {
        const std::size_t j = kTargets[t], i = side * kLegJoints + j;
        const Drive<double>& drive = robot.drives[side][j];
        const double outwards = (j == kHipRoll || j == kAnkleRoll) && side == kRight ? -1.0 : 1.0;
        (side == stance ? w.stance : w.swing)[t] =
            outwards * (at.q[i] + (motor[i] + drive.kd_nmsprad * at.qd[i]) / drive.kp_nmprad);
      }
    // The feedback's share is taken off.
    const auto sums = totals(parameters, state_of(robot, at, s));
    const auto centre = sums.centre_m(), speed = sums.linear_ns * (1.0 / sums.mass_kg);
    const double d = centre.x - (before ? gait.step_m : 0.0), v = speed.x;
    const double y = (before ? centre.y + gait.step_width_m : -centre.y) - gains.side_m,
                 vy = before ? speed.y : -speed.y;
    const auto& g = gains.gains;
    w.swing[0] += g[0] * d + g[1] * v;
    w.stance[2] -= g[2] * d + g[3] * v;
    w.swing[3] -= g[4] * y + g[5] * vy;
    w.stance[4] -= g[6] * y + g[7] * vy;
    w.stance[0] -= g[8] * d + g[9] * v;
    w.stance[3] -= g[10] * y + g[11] * vy;
    out.push_back(w);
  }
  return out;
}

/// Shares of the last `down`'s, of `up`'s and of `down`'s target in what is commanded.
std::array<double, 3> shares(double time_s, double up_s, double up_blend_s, double down_blend_s) {
  const double up = std::min(1.0, std::min(time_s, up_s) / up_blend_s);
  const double down = std::clamp((time_s - up_s) / down_blend_s, 0.0, 1.0);
  return {(1.0 - up) * (1.0 - down), up * (1.0 - down), down};
}

struct Fitted {
  double squares = std::numeric_limits<double>::infinity();
  std::array<std::array<double, 4>, 5>
      targets{};  ///< up and down of the stance, up and down of the swing leg
};

/// The legs change: the stance begins at the swing leg's `down`, and the other way round.
Fitted fitted(const std::vector<Wanted>& wanted, double up_s, double up_blend_s, double down_blend_s) {
  Fitted out;
  out.squares = 0.0;
  const auto rows = static_cast<Eigen::Index>(2 * wanted.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, 4), b(rows, 5);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto [last, up, down] = shares(wanted[k].time_s, up_s, up_blend_s, down_blend_s);
    const auto r = static_cast<Eigen::Index>(2 * k);
    a.row(r) << up, down, 0.0, last;
    a.row(r + 1) << 0.0, last, up, down;
    for (std::size_t t = 0; t < kTargets.size(); ++t) {
      b(r, static_cast<Eigen::Index>(t)) = wanted[k].stance[t];
      b(r + 1, static_cast<Eigen::Index>(t)) = wanted[k].swing[t];
    }
  }
  const Eigen::MatrixXd x =
      (a.transpose() * a + 1e-9 * Eigen::MatrixXd::Identity(4, 4)).ldlt().solve(a.transpose() * b);
  out.squares = (a * x - b).squaredNorm() / static_cast<double>(b.size());
  for (std::size_t t = 0; t < kTargets.size(); ++t)
    for (std::size_t n = 0; n < 4; ++n)
      out.targets[t][n] = x(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(t));
  return out;
}

}  // namespace

GaitWalk walk_of(const Description& robot, WalkMode mode, const Gait& gait) {
  std::array<double, Parameters::kCount> start;
  for (std::size_t i = 0; i < start.size(); ++i) start[i] = control::kWalkParameters[i].start;
  GaitWalk out;
  Parameters& w = out.walk = Parameters::of(start);
  const std::vector<Wanted> all = wanted(robot, mode, gait, w);
  const double length = gait.duration_s();

  Fitted best;
  for (double up = 0.2; up < 0.75; up += 0.05)
    for (double up_blend = 0.2; up_blend <= up; up_blend += 0.05)
      for (double down_blend = 0.15; down_blend <= 1.0 - up; down_blend += 0.05) {
        const Fitted f = fitted(all, up * length, up_blend * length, down_blend * length);
        if (!(f.squares < best.squares)) continue;
        best = f;
        w.up_s = up * length, w.up_blend_s = up_blend * length, w.down_blend_s = down_blend * length;
      }
  out.error_rad = std::sqrt(best.squares);
  // A foot that lands late is waited for.
  w.down_s = 1.25 * (length - w.up_s);
  const auto& t = best.targets;
  w.knee_rad = 0.5 * (t[1][0] + t[1][1]);
  // The posture within its range first: the targets are beside it.
  w.knee_rad = std::clamp(w.knee_rad, control::kWalkParameters[0].least, control::kWalkParameters[0].most);
  const auto beside = [&](std::size_t n) {
    return control::LegTargets<double>{t[0][n] - (w.hip_rad - 0.5 * w.knee_rad), t[1][n] - w.knee_rad,
                                       t[2][n] - (w.ankle_rad - 0.5 * w.knee_rad), t[3][n], t[4][n]};
  };
  w.up_stance = beside(0), w.down_stance = beside(1), w.up_swing = beside(2), w.down_swing = beside(3);
  auto values = w.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& p = control::kWalkParameters[i];
    values[i] =
        std::clamp(mode == WalkMode::semi_passive && p.of_hip_pitch ? p.start : values[i], p.least, p.most);
  }
  w = Parameters::of(values);
  return out;
}

}  // namespace furcula::walk
