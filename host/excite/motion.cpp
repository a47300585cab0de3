// Motions within limits, see motion.hpp.
#include "host/excite/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/tree/dry_friction.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/trees/recording.hpp"
#include "host/trees/run.hpp"

namespace furcula::excite {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kSines = 2;
constexpr double kRamp_s = 0.5;
/// Of the torque limit, what the posture in the middle of a motion may take.
constexpr double kHeld = 0.6;
/// Of a torque, where the model does not say it: of the joint's limit.
constexpr double kNoise = 0.01;
/// Attempts to get within the limits. Where a joint alone was made smaller by so much, or after half of them, all joints are: the motion of
/// one takes torque of another.
constexpr int kAttempts = 24;
constexpr double kAlone = 0.3;
/// Times of a motion that are looked at, a period of its fastest harmonic.
constexpr double kLooks = 24.0;

bool follows(const trees::TreeModel& m) {
  return std::all_of(m.drives.begin(), m.drives.end(),
                     [](const trees::Drive& d) { return d.law == trees::ControlMode::torque; });
}

void add(Extremes& e, bool first, double q, double v, double torque) {
  e.lowest_rad = first ? q : std::min(e.lowest_rad, q);
  e.highest_rad = first ? q : std::max(e.highest_rad, q);
  e.velocity_radps = std::max(e.velocity_radps, std::abs(v));
  e.torque_nm = std::max(e.torque_nm, std::abs(torque));
}

std::vector<Extremes> on_paths(const trees::TreeModel& m, const trees::Scenario& s, double step_s) {
  const std::size_t n = m.joints();
  const auto tree = trees::SetupMaker(m).make({m.drives, m.causes}).model;
  std::vector<Extremes> out(n);
  const auto looks = static_cast<std::size_t>(std::ceil(s.duration_s / step_s));
  for (std::size_t k = 0; k <= looks; ++k) {
    const double t = std::min(static_cast<double>(k) * step_s, s.duration_s);
    model::RobotModel::Joints q{}, v{}, a{};
    for (std::size_t j = 0; j < n; ++j) {
      const trees::Path::Point p = s.paths[j].at(t);
      q[j] = p.q;
      v[j] = p.v;
      a[j] = p.a;
    }
    const auto torque = dynamics::tree::inverse_dynamics(tree, q, v, a);
    for (std::size_t j = 0; j < n; ++j) {
      const auto& law = tree.laws[j];
      const int direction = v[j] < 0.0 ? -1 : 1;
      const double friction = std::max(
          law.static_friction_nm, dynamics::tree::friction_in_motion(law, v[j], torque[j], direction,
                                                                     dynamics::tree::spot_at(law, q[j])));
      add(out[j], k == 0, q[j], v[j], std::abs(torque[j]) + friction);
    }
  }
  return out;
}

std::vector<Extremes> simulated(const trees::TreeModel& m, trees::Scenario s) {
  s.disturbance_share = s.angle_noise_rad = s.torque_noise_share = 0.0;
  s.torque_noise_nm.clear();
  const log::Log log = trees::simulate(m, s, 1);
  const std::vector<double>& time = log.columns.at("time_s");
  std::vector<Extremes> out(m.joints());
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const trees::Drive& d = m.drives[j];
    const std::vector<double>& q = log.columns.at(trees::column_of(m, j, "angle"));
    const std::vector<double>& input = log.columns.at(
        trees::column_of(m, j, d.law == trees::ControlMode::position ? "angle_cmd" : "torque_cmd"));
    for (std::size_t k = 0; k < q.size(); ++k) {
      const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, q.size() - 1);
      const double v = (q[b] - q[a]) / (time[b] - time[a]);
      add(out[j], k == 0, q[k], v,
          d.law == trees::ControlMode::position ? d.kp_nmprad * (input[k] - q[k]) - d.kd_nmsprad * v
                                                : input[k]);
      // The set point, too, is within the range.
      if (d.law == trees::ControlMode::position) add(out[j], false, input[k], 0.0, 0.0);
    }
  }
  return out;
}

}  // namespace

std::vector<Extremes> extremes(const trees::TreeModel& model, const trees::Scenario& scenario,
                               double step_s) {
  return follows(model) ? on_paths(model, scenario, step_s) : simulated(model, scenario);
}

double used(const Extremes& e, const JointLimits& l) {
  const double middle = 0.5 * (l.lower_rad + l.upper_rad), half = 0.5 * (l.upper_rad - l.lower_rad);
  return std::max({std::abs(e.lowest_rad - middle) / half, std::abs(e.highest_rad - middle) / half,
                   e.velocity_radps / l.velocity_radps, e.torque_nm / l.torque_nm});
}

Sines::Sines(std::vector<double> posture, double duration_s, double highest_hz)
    : posture_(std::move(posture)), duration_s_(duration_s), highest_hz_(highest_hz) {}

std::size_t Sines::size() const { return posture_.size() * (1 + 3 * kSines); }

std::optional<trees::Scenario> Sines::within(const trees::TreeModel& m, std::span<const JointLimits> limits,
                                             std::span<const double> x, double rate_hz) const {
  const std::size_t n = m.joints();
  trees::Scenario out = trees::default_scenario(m);
  out.duration_s = duration_s_;
  out.sample_rate_hz = rate_hz;
  // The same whatever the motion is: else the best motion were one of little torque.
  if (out.torque_noise_nm.empty())
    for (const JointLimits& l : limits) out.torque_noise_nm.push_back(kNoise * l.torque_nm);
  const double lowest_hz = std::min(1.0 / duration_s_, 0.5 * highest_hz_);
  std::vector<double> centre;  // -1 to 1, of what the motion leaves of the range
  std::size_t at = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const JointLimits& l = limits[j];
    trees::Path& p = out.paths[j];
    p = {trees::Path::Profile::fourier, 0.0, 0.0, 1.0, 0.0};
    p.ramp_s = std::min(kRamp_s, 0.25 * duration_s_);
    p.end_s = duration_s_;
    centre.push_back(std::tanh(x[at++]));
    for (std::size_t k = 0; k < kSines; ++k, at += 3) {
      // Of a normal number about evenly spread over the logarithm of the frequency.
      const double share = 1.0 / (1.0 + std::exp(-1.7 * x[at])),
                   hz = lowest_hz * std::pow(highest_hz_ / lowest_hz, share);
      // A sine that is alone would be about as large as range and velocity let it.
      const double most = std::min(0.5 * kOfRange * (l.upper_rad - l.lower_rad),
                                   kOfVelocity * l.velocity_radps / (kTurn * hz));
      p.harmonics.push_back({hz, most * x[at + 1], most * x[at + 2]});
    }
  }
  const double step_s = 1.0 / (kLooks * highest_hz_);
  std::vector<double> alone(n, 1.0);
  double pulled = 0.0;  // towards the easiest posture
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::vector<double> middle, room,
        offset;  // of the range; left to both sides of the motion; of the motion's middle
    for (std::size_t j = 0; j < n; ++j) {
      const JointLimits& l = limits[j];
      trees::Path& p = out.paths[j];
      double lowest = 0.0, highest = 0.0, fastest = 0.0;
      p.centre_rad = 0.0;
      for (double t = 0.0; t < duration_s_; t += step_s) {
        const trees::Path::Point point = p.at(t);
        lowest = std::min(lowest, point.q);
        highest = std::max(highest, point.q);
        fastest = std::max(fastest, std::abs(point.v));
      }
      const double range = kOfRange * (l.upper_rad - l.lower_rad),
                   share = std::min({1.0, range / std::max(highest - lowest, 1e-12),
                                     kOfVelocity * l.velocity_radps / std::max(fastest, 1e-12)});
      for (trees::Harmonic& h : p.harmonics) h.sine_rad *= share, h.cosine_rad *= share;
      middle.push_back(0.5 * (l.lower_rad + l.upper_rad));
      room.push_back(0.5 * (range - share * (highest - lowest)));
      offset.push_back(0.5 * share * (lowest + highest));
    }
    // A posture that leaves little torque for the motion is moved.
    for (bool held = false; !held; pulled += 0.1) {
      std::vector<double> posture;
      for (std::size_t j = 0; j < n; ++j) {
        const double wanted = std::lerp(middle[j] + centre[j] * room[j], posture_[j], std::min(1.0, pulled));
        posture.push_back(std::clamp(wanted, middle[j] - room[j], middle[j] + room[j]));
        out.paths[j].centre_rad = posture.back() - offset[j];
      }
      const std::vector<double> needed = holding_nm(m, posture);
      held = true;
      for (std::size_t j = 0; j < n; ++j) held = held && needed[j] < kHeld * limits[j].torque_nm;
      if (held || pulled >= 1.0) break;
    }
    const std::vector<Extremes> now = extremes(m, out, step_s);
    // A joint that follows its set point with an error may leave the range, or be too fast.
    std::vector<double> of_limits;
    for (std::size_t j = 0; j < n; ++j)
      of_limits.push_back(used(now[j], {limits[j].lower_rad, limits[j].upper_rad, limits[j].velocity_radps,
                                        kOfTorque * limits[j].torque_nm}));
    const double most = *std::max_element(of_limits.begin(), of_limits.end());
    if (most <= 1.0) return out;
    bool all = attempt >= kAttempts / 2;
    for (std::size_t j = 0; j < n; ++j) all = all || (of_limits[j] > 1.0 && alone[j] < kAlone);
    for (std::size_t j = 0; j < n; ++j) {
      if (of_limits[j] <= 1.0 && !all) continue;
      const double share = std::max(0.6, 0.97 / (all ? most : of_limits[j]));
      if (!all) alone[j] *= share;
      for (trees::Harmonic& h : out.paths[j].harmonics) h.sine_rad *= share, h.cosine_rad *= share;
    }
  }
  return std::nullopt;
}

}  // namespace furcula::excite
