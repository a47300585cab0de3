// Windows and scales, see windows.hpp.
#include "host/trees/windows.hpp"

#include <algorithm>
#include <cmath>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/trees/run.hpp"

namespace furcula::trees {
namespace {

constexpr std::size_t kBins = 24;
/// A start is known from the angles around it no better than so many times what their noise says: they bend, too.
constexpr double kStartDoubt = 2.0;
constexpr double kSmoothing_s = 0.02;
/// A shorter stance or flight is no window.
constexpr double kShortest_s = 0.08;
/// A motion of no more than so many times the noise, from end to end, is that of a joint at rest.
constexpr double kStill = 10.0;
/// A joint that is driven by less than this share of what its motion takes is moved by gravity and the other joints: that share is its scale.
constexpr double kOfMotion = 0.02;
/// Of a joint that has no drive: there is nothing smaller to compare with.
constexpr double kOfUndriven = 0.2;
constexpr double kOfStep = 12.0;

double root_mean_square(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return x.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(x.size()));
}

}  // namespace

Scales scales_of(const TreeModel& model, std::span<const Recording> recordings) {
  const std::size_t n = model.joints();
  const auto bodies = SetupMaker(model).make({model.drives, model.causes}).model;
  std::vector<std::vector<double>> torque(n), of_motion(n), velocity(n), acceleration(n);
  std::vector<double> low(n, 1e300), high(n, -1e300), noise(n, 0.0), inertia(n, 0.0);
  for (const Recording& r : recordings) {
    const std::size_t step =
        std::max<std::size_t>(1, static_cast<std::size_t>(0.02 / std::max(r.interval_s, 1e-6)));
    for (std::size_t j = 0; j < n; ++j) noise[j] = std::max(noise[j], r.angle_noise_rad[j]);
    for (std::size_t k = 0; k < r.rows(); k += step) {
      model::RobotModel::Joints posture{};
      for (std::size_t j = 0; j < n; ++j) {
        const LocalState s = local_state(r, j, k, kSmoothing_s);
        posture[j] = s.angle_rad;
        velocity[j].push_back(s.velocity_radps);
        acceleration[j].push_back(s.acceleration_radps2);
        const Drive& d = model.drives[j];
        torque[j].push_back(d.law == ControlMode::torque ? r.input[j][k]
                                                         : d.kp_nmprad * (r.input[j][k] - s.angle_rad) -
                                                               d.kd_nmsprad * s.velocity_radps);
        low[j] = std::min(low[j], s.angle_rad);
        high[j] = std::max(high[j], s.angle_rad);
      }
      const auto mass = dynamics::tree::mass_matrix(bodies, posture);
      for (std::size_t j = 0; j < n; ++j) {
        of_motion[j].push_back(mass[j][j] * acceleration[j].back());
        inertia[j] = std::max(inertia[j], mass[j][j]);
      }
    }
  }
  Scales out;
  for (std::size_t j = 0; j < n; ++j) {
    out.drive_nm.push_back(root_mean_square(torque[j]));
    // What a step of its encoder makes of a joint without a drive.
    const double of_step =
        model.driven(j) ? 0.0 : kOfStep * inertia[j] * noise[j] / (kSmoothing_s * kSmoothing_s);
    out.torque_nm.push_back(std::max(
        {out.drive_nm.back(), (model.driven(j) ? kOfMotion : kOfUndriven) * root_mean_square(of_motion[j]),
         of_step, 1e-6}));
    out.velocity_radps.push_back(std::max(root_mean_square(velocity[j]), 1e-3));
    out.acceleration_radps2.push_back(std::max(root_mean_square(acceleration[j]), 1e-2));
    out.lowest_rad.push_back(low[j]);
    out.highest_rad.push_back(high[j]);
    out.still.push_back(high[j] - low[j] <= kStill * noise[j]);
  }
  return out;
}

std::vector<Window> windows_of(const TreeModel& model, std::span<const Recording> recordings, double window_s,
                               std::size_t most) {
  std::vector<Window> out;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& r = recordings[i];
    const std::vector<Phase> all{{0, r.rows() - 1, false, true, {}, {}, 0.0, 0.0}};
    for (const Phase& phase : r.phases.empty() ? all : r.phases) {
      // Between two changes of contact the windows are of one length, whatever that is.
      double span = window_s;
      if (model.foot) {
        const double whole_s = r.time_s[phase.last] - r.time_s[phase.first];
        if (whole_s < std::min(kShortest_s, window_s) || (phase.stance && !phase.whole)) continue;
        span = whole_s / std::ceil(whole_s / window_s - 1e-9);
      }
      for (std::size_t first = phase.first; first + 1 <= phase.last;) {
        std::size_t last = first;
        while (last + 1 <= phase.last && r.time_s[last + 1] - r.time_s[first] <= span * (1.0 + 1e-9) &&
               !gap_after(r, last))
          ++last;
        const bool gap = last + 1 <= phase.last && gap_after(r, last);
        if (r.time_s[last] - r.time_s[first] > 0.8 * span && last - first >= 8)
          out.push_back({i, first, last, window_s, {}, {}, {}, {}, {}});
        first = gap || last == first ? last + 1 : last;
      }
    }
  }
  if (most > 0 && out.size() > most) {
    std::vector<Window> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(std::move(out[k * out.size() / most]));
    out = std::move(some);
  }
  std::size_t fewest = kBins;
  for (const Window& w : out) fewest = std::min(fewest, w.last - w.first);
  const std::size_t n = model.joints();
  for (Window& w : out) {
    const Recording& r = recordings[w.recording];
    w.start_precision = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 * n));
    for (std::size_t j = 0; j < n; ++j) {
      const LocalState s = local_state(r, j, w.first, kSmoothing_s);
      w.angle_rad.push_back(s.angle_rad);
      w.velocity_radps.push_back(s.velocity_radps);
      double a = kStartDoubt * s.angle_sd_rad, v = kStartDoubt * s.velocity_sd_radps + 1e-4;
      if (model.foot) {
        // After a change of contact they bend more than a cubic does.
        const LocalState near = local_state(r, j, w.first, 0.5 * kSmoothing_s);
        a = std::hypot(a, kStartDoubt * (near.angle_rad - s.angle_rad));
        v = std::hypot(v, kStartDoubt * (near.velocity_radps - s.velocity_radps));
      }
      w.start_precision(static_cast<Eigen::Index>(j)) = 1.0 / (a * a);
      w.start_precision(static_cast<Eigen::Index>(n + j)) = 1.0 / (v * v);
    }
    w.measured = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fewest * n));
    const double t0 = r.time_s[w.first], span = r.time_s[w.last] - t0;
    std::vector<double> count(fewest, 0.0);
    for (std::size_t k = w.first; k <= w.last; ++k) {
      const auto bin = std::min(
          fewest - 1, static_cast<std::size_t>((r.time_s[k] - t0) / span * static_cast<double>(fewest)));
      w.bin.push_back(bin);
      count[bin] += 1.0;
      for (std::size_t j = 0; j < n; ++j)
        w.measured(static_cast<Eigen::Index>(bin * n + j)) += r.angle_rad[j][k];
    }
    for (std::size_t b = 0; b < fewest; ++b)
      if (count[b] > 0.0)
        w.measured.segment(static_cast<Eigen::Index>(b * n), static_cast<Eigen::Index>(n)) /= count[b];
  }
  return out;
}

}  // namespace furcula::trees
