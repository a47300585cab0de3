// Motions that tell causes apart, see next_experiment.hpp.
#include "host/trees/next_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/tree/dry_friction.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/trees/fit.hpp"
#include "host/trees/run.hpp"
#include "host/trees/simulate.hpp"

namespace furcula::trees {
namespace {

constexpr double kDuration_s = 4.0, kInterval_s = 4e-3;

/// What the drives have to be given so that the joints follow these paths; empty where a limit is broken.
Recording on_paths(const TreeModel& m, const Setup& setup, const std::vector<Path>& paths) {
  const std::size_t n = m.joints();
  Recording r;
  r.path = "planned";
  r.interval_s = kInterval_s;
  r.angle_rad.resize(n);
  r.input.resize(n);
  for (double t = 0.0; t < kDuration_s; t += kInterval_s) {
    model::RobotModel::Joints q{}, v{}, a{};
    // The input is held to the next row: that of the middle.
    for (std::size_t j = 0; j < n; ++j) {
      r.angle_rad[j].push_back(paths[j].at(t).q + setup.joints[j].encoder_offset_rad);
      const Path::Point p = paths[j].at(t + 0.5 * kInterval_s);
      q[j] = p.q;
      v[j] = p.v;
      a[j] = p.a;
    }
    auto tree = setup.model;
    for (std::size_t j = 0; j < n; ++j)
      if (const Setup::Joint& d = setup.joints[j]; Runner::is_spring(d)) {
        tree.laws[j].stiffness_nmprad -= d.gain * d.kp_nmprad;
        tree.laws[j].damping_nmspr -= d.gain * d.kd_nmsprad;
      }
    const auto needed = dynamics::tree::inverse_dynamics(tree, q, v, a);
    r.time_s.push_back(t);
    for (std::size_t j = 0; j < n; ++j) {
      const Setup::Joint& d = setup.joints[j];
      const int direction = v[j] > 0.0 ? 1 : v[j] < 0.0 ? -1 : 0;
      double torque = needed[j] - d.offset_nm;
      if (direction != 0)
        torque += direction * dynamics::tree::friction_in_motion(tree.laws[j], v[j], torque, direction,
                                                                 dynamics::tree::spot_at(tree.laws[j], q[j]));
      const auto& limits = m.robot.joints[j].limits;
      if (limits && limits->effort > 0.0 && std::abs(torque) > limits->effort) return {};
      if (limits && limits->velocity > 0.0 && std::abs(v[j]) > limits->velocity) return {};
      torque /= std::max(d.gain, 0.05);
      r.input[j].push_back(d.law == ControlMode::torque
                               ? torque
                               : q[j] + d.encoder_offset_rad + (torque + d.kd_nmsprad * v[j]) / d.kp_nmprad);
    }
  }
  r.angle_noise_rad.assign(n, 1e-4);
  r.input_measured.assign(n, false);
  return r;
}

std::string described(const TreeModel& m, const std::vector<Path>& paths) {
  std::string moving;
  std::size_t count = 0;
  const Path* one = nullptr;
  for (std::size_t j = 0; j < m.joints(); ++j) {
    if (paths[j].profile == Path::Profile::hold) continue;
    ++count;
    one = &paths[j];
    moving = m.robot.joints[j].name + ": a sine of " + core::rounded(paths[j].amplitude_rad, 2) + " " +
             std::string(channel_unit(m, j)) + " about " + core::rounded(paths[j].centre_rad, 2) + " " +
             std::string(channel_unit(m, j));
  }
  if (count > 1)
    return "Move all joints together, each on a sine, the slowest of " +
           core::rounded(paths.back().period_s, 2) + " s a period";
  return "Move " + moving + " with " + core::rounded(one->period_s, 2) + " s a period, and hold the others";
}

/// A robot on a foot has no paths that it could be told: of the motions that were recorded, the one that parts the causes most, and when.
std::vector<Experiment> among_recorded(const TreeModel& m, const std::vector<Recording>& recordings,
                                       const Hypothesis& named, const std::vector<Hypothesis>& others,
                                       double window_s, std::size_t most) {
  const std::size_t n = m.joints();
  const SetupMaker maker(m);
  const Setup setup = maker.make(named);
  std::vector<Experiment> out;
  for (const Recording& r : recordings)
    for (const bool stance : {true, false}) {
      const std::vector<Recording> one{r};
      Experiment e{
          "Record more like " + r.path + ", whose " + (stance ? "stances" : "flights") + " part them most",
          {},
          1e300};
      for (const Hypothesis& other : others) {
        const Setup another = maker.make(other);
        double squares = 0.0, rows = 0.0;
        for (const Window& w : windows_of(m, one, window_s)) {
          if (r.phase_at(w.first).stance != stance) continue;
          std::vector<double> a((w.last - w.first + 1) * n), b(a.size());
          run(setup, r, w.first, w.last, w.angle_rad, w.velocity_radps, a);
          run(another, r, w.first, w.last, w.angle_rad, w.velocity_radps, b);
          for (std::size_t i = 0; i < a.size(); ++i)
            if (!m.prismatic(i % n) && std::isfinite(a[i] - b[i]))
              squares += std::pow(a[i] - b[i], 2), rows += 1.0;
        }
        e.apart_rad = std::min(e.apart_rad, std::sqrt(squares / std::max(rows, 1.0)));
      }
      if (e.apart_rad < 1e300) out.push_back(std::move(e));
    }
  std::stable_sort(out.begin(), out.end(),
                   [](const Experiment& a, const Experiment& b) { return a.apart_rad > b.apart_rad; });
  if (out.size() > most) out.resize(most);
  return out;
}

}  // namespace

std::vector<Experiment> next_experiments(const TreeModel& m, const std::vector<Recording>& recordings,
                                         const Hypothesis& named, const std::vector<Hypothesis>& others,
                                         double window_s, std::size_t most) {
  if (m.foot) return among_recorded(m, recordings, named, others, window_s, most);
  const std::size_t n = m.joints();
  const Scales scales = scales_of(m, recordings);
  const SetupMaker maker(m);
  const Setup setup = maker.make(named);
  std::vector<std::vector<Path>> library;
  std::vector<Path> still(n);
  for (std::size_t j = 0; j < n; ++j) {
    // About where the robot has been.
    still[j].profile = Path::Profile::hold;
    still[j].centre_rad = 0.5 * (scales.lowest_rad[j] + scales.highest_rad[j]);
    if (const auto& l = m.robot.joints[j].limits; l && l->lower < l->upper)
      still[j].centre_rad = std::clamp(still[j].centre_rad, l->lower, l->upper);
  }
  const auto room = [&](std::size_t j) {
    const auto& l = m.robot.joints[j].limits;
    const double usual = m.prismatic(j) ? 0.2 : 1.2;
    if (!l || !(l->lower < l->upper)) return usual;
    return std::min({usual, still[j].centre_rad - l->lower, l->upper - still[j].centre_rad});
  };
  for (const double share : {0.25, 0.8})
    for (const double period : {0.35, 0.8, 2.5}) {
      std::vector<Path> together = still;
      for (std::size_t j = 0; j < n; ++j) {
        Path p = still[j];
        p.profile = Path::Profile::sine;
        p.amplitude_rad = share * room(j);
        p.period_s = period;
        if (!(p.amplitude_rad > 0.0)) continue;
        std::vector<Path> alone = still;
        alone[j] = p;
        library.push_back(alone);
        p.period_s = period * (1.0 + 0.3 * static_cast<double>(j));
        p.phase_rad = 0.9 * static_cast<double>(j);
        together[j] = p;
      }
      if (n > 1) library.push_back(together);
    }
  std::vector<Experiment> out;
  for (const std::vector<Path>& paths : library) {
    const std::vector<Recording> planned{on_paths(m, setup, paths)};
    if (planned.front().rows() == 0) continue;
    Experiment e{described(m, paths), paths, 1e300};
    const std::vector<Window> windows = windows_of(m, planned, window_s);
    const auto run_of = [&](const Setup& s, const Window& w) {
      std::vector<double> x((w.last - w.first + 1) * n);
      std::vector<double> q, v;
      for (std::size_t j = 0; j < n; ++j) {
        const Path::Point p = paths[j].at(planned.front().time_s[w.first]);
        q.push_back(p.q + setup.joints[j].encoder_offset_rad);
        v.push_back(p.v);
      }
      run(s, planned.front(), w.first, w.last, q, v, x);
      return x;
    };
    for (const Hypothesis& other : others) {
      const Setup another = maker.make(other);
      double squares = 0.0, rows = 0.0;
      for (const Window& w : windows) {
        const std::vector<double> a = run_of(setup, w), b = run_of(another, w);
        for (std::size_t i = 0; i < a.size(); ++i)
          squares += std::pow(std::isfinite(a[i] - b[i]) ? a[i] - b[i] : 0.0, 2);
        rows += static_cast<double>(a.size());
      }
      e.apart_rad = std::min(e.apart_rad, std::sqrt(squares / std::max(rows, 1.0)));
    }
    out.push_back(std::move(e));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Experiment& a, const Experiment& b) { return a.apart_rad > b.apart_rad; });
  if (out.size() > most) out.resize(most);
  return out;
}

std::string other_way_of_moving(const TreeModel& m, const std::vector<Recording>& recordings) {
  // In place a leg drifts, and a hop begins and ends at the same height.
  constexpr double kRuns_mps = 0.15, kLevel = 0.1;
  if (!m.foot) return "";
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const auto &axis = m.robot.joints[j].axis, &g = m.gravity_mps2;
    const double down = std::abs(dot(axis, g)) / std::sqrt(std::max(dot(g, g), 1e-12));
    if (m.driven(j) || !m.prismatic(j) || down > kLevel) continue;
    std::size_t running = 0;
    for (const Recording& r : recordings)
      running += std::abs(r.angle_rad[j].back() - r.angle_rad[j].front()) >
                 kRuns_mps * (r.time_s.back() - r.time_s.front());
    const std::string& name = m.robot.joints[j].name;
    if (running == 0)
      return "All recordings are in place, where " + name +
             " hardly moves and the leg hardly swings: friction and masses along the way, and what grows with the swing, show in a run. Record one as "
             "well.";
    if (running == recordings.size())
      return "In all recordings the robot runs, and " + name +
             " moves whenever the leg swings: hops in place, of two heights, leave both out, and load leg and spring alone. Record some as well.";
  }
  return "";
}

std::string scenario_of(const TreeModel& m, const Experiment& e) {
  if (e.paths.empty()) return "";
  return format_scenario(m, {10.0, 250.0, e.paths});
}

}  // namespace furcula::trees
