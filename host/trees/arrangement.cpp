// Columns that stand for each other, see arrangement.hpp.
#include "host/trees/arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "host/trees/fit.hpp"

namespace furcula::trees {
namespace {

/// Windows are short, so that a model that is quite wrong does not fly apart in them, and few.
constexpr double kWindow_s = 0.15;
constexpr std::size_t kWindows = 16;
/// What runs are off, of the motion and squared: from the first on a model is asked about; the second still is no fit.
constexpr double kAsked = 0.05, kNoFit = 0.02;
/// What an exchange must come down to, of what is left as given; and below kAsked.
constexpr double kHelps = 0.2;
/// So many exchanges are fitted.
constexpr std::size_t kFitted = 3;

/// How the columns are read: of each joint, whose they are, and times what.
struct Reading {
  std::vector<std::size_t> angle, input;
  std::vector<double> angle_scale, input_scale;
};

std::vector<double> times(std::vector<double> x, double factor) {
  for (double& v : x) v *= factor;
  return x;
}

std::vector<Recording> read_so(std::vector<Recording> recordings, const Reading& reading) {
  for (Recording& r : recordings) {
    const Recording as_given = r;
    for (std::size_t j = 0; j < r.angle_rad.size(); ++j) {
      r.angle_rad[j] = times(as_given.angle_rad[reading.angle[j]], reading.angle_scale[j]);
      r.angle_noise_rad[j] = std::abs(reading.angle_scale[j]) * as_given.angle_noise_rad[reading.angle[j]];
      r.input[j] = times(as_given.input[reading.input[j]], reading.input_scale[j]);
      r.input_measured[j] = as_given.input_measured[reading.input[j]];
    }
  }
  return recordings;
}

/// What runs are off at the joint where that is most, of its motion, squared; `fitted`: with dry friction, damping and a rotor of
/// any size at each joint.
double off(const TreeModel& model, const std::vector<Recording>& recordings, unsigned threads, bool fitted) {
  Problem problem(model, recordings, windows_of(model, recordings, kWindow_s, kWindows), threads);
  Hypothesis h{model.drives, model.causes};
  if (!fitted) return problem.misfit(h);
  for (std::size_t j = 0; j < model.joints(); ++j) {
    h.causes.push_back({Effect::coulomb_friction, {j}, {0.05 * problem.scales().torque_nm[j], 0, 0, 0}});
    h.causes.push_back({Effect::damping_error, {j}, {model.drives[j].damping_nmspr, 0, 0, 0}});
    h.causes.push_back({Effect::rotor_inertia_error, {j}, {model.drives[j].rotor_inertia_kgm2, 0, 0, 0}});
  }
  problem.weigh(h);
  return problem.misfit(problem.fit(h, 8).at);
}

struct Exchange {
  Reading reading;
  std::string what;
};

std::vector<Exchange> exchanges(const TreeModel& m, const Reading& given) {
  std::vector<Exchange> out;
  const auto of = [&](std::size_t j) { return m.robot.joints[j].name; };
  const auto input = [&](std::size_t j) {
    return std::string(m.drives[j].law == DriveLaw::position ? "set point"
                       : m.prismatic(j)                      ? "force"
                                                             : "torque");
  };
  const auto place = [&](std::size_t j) { return std::string(m.prismatic(j) ? "position" : "angle"); };
  // Of one joint, or of all that `which` takes.
  const auto scaled = [&](std::vector<double> Reading::*what, const auto& which, double scale,
                          const std::string& noun, const std::string& one, const std::string& several) {
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < m.joints(); ++j)
      if (which(j)) joints.push_back(j);
    Reading all = given;
    std::string names;
    for (const std::size_t j : joints) {
      Reading r = given;
      (r.*what)[j] = (all.*what)[j] = scale;
      names += (names.empty() ? "" : " and ") + of(j);
      out.push_back({r, "the " + noun + " of " + of(j) + " " + one});
    }
    if (joints.size() > 1) out.push_back({all, "the " + noun + "s of " + names + " " + several});
  };
  const auto torque = [&](std::size_t j) { return !m.prismatic(j) && m.drives[j].law == DriveLaw::torque; };
  scaled(
      &Reading::angle_scale, [&](std::size_t j) { return !m.prismatic(j); }, std::numbers::pi / 180.0,
      "angle", "is in degrees", "are in degrees");
  scaled(
      &Reading::angle_scale, [&](std::size_t j) { return m.prismatic(j); }, 1e-3, "position",
      "is in millimetres", "are in millimetres");
  scaled(&Reading::input_scale, torque, 1e-3, "torque", "is in N mm", "are in N mm");
  if (m.joints() > 1 && std::all_of(m.drives.begin(), m.drives.end(),
                                    [](const Drive& d) { return d.law == DriveLaw::torque; })) {
    Reading all = given;
    std::fill(all.input_scale.begin(), all.input_scale.end(), -1.0);
    out.push_back({all, "the torques of all joints have the other sign"});
  }
  for (std::size_t j = 0; j < m.joints(); ++j) {
    if (!m.driven(j)) continue;
    Reading r = given;
    r.input_scale[j] = -1.0;
    out.push_back({r, "the " + input(j) + " of " + of(j) + " has the other sign"});
    r.angle_scale[j] = -1.0;
    out.push_back({r, "the " + place(j) + " and the " + input(j) + " of " + of(j) + " have the other sign"});
    r.input_scale[j] = 1.0;
    out.push_back({r, "the " + place(j) + " of " + of(j) + " has the other sign"});
    for (std::size_t k = j + 1; k < m.joints(); ++k) {
      if (m.prismatic(j) != m.prismatic(k)) continue;
      Reading s = given;
      if (m.drives[j].law == m.drives[k].law) {
        std::swap(s.input[j], s.input[k]);
        out.push_back({s, "the " + input(j) + "s of " + of(j) + " and " + of(k) + " are swapped"});
        std::swap(s.angle[j], s.angle[k]);
        out.push_back({s, of(j) + " and " + of(k) + " are swapped"});
        std::swap(s.input[j], s.input[k]);
      } else {
        std::swap(s.angle[j], s.angle[k]);
      }
      out.push_back({s, "the " + place(j) + "s of " + of(j) + " and " + of(k) + " are swapped"});
    }
  }
  return out;
}

}  // namespace

std::optional<Arrangement> other_arrangement(const TreeModel& model, const std::vector<Recording>& recordings,
                                             unsigned threads) {
  const std::size_t n = model.joints();
  if (windows_of(model, recordings, kWindow_s, 1).empty() || off(model, recordings, threads, false) < kAsked)
    return std::nullopt;
  std::vector<std::size_t> own(n);
  std::iota(own.begin(), own.end(), std::size_t{0});
  const Reading given{own, own, std::vector<double>(n, 1.0), std::vector<double>(n, 1.0)};
  std::vector<std::pair<double, Exchange>> all;
  for (Exchange& e : exchanges(model, given)) {
    const double left = off(model, read_so(recordings, e.reading), threads, false);
    all.emplace_back(left, std::move(e));
  }
  const std::size_t most = std::min(kFitted, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(most), all.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  const double as_given = off(model, recordings, threads, true);
  std::optional<Arrangement> best;
  for (std::size_t k = 0; k < most && as_given > kNoFit; ++k) {
    const double left = off(model, read_so(recordings, all[k].second.reading), threads, true);
    if (left < std::min(kHelps * as_given, kAsked) && (!best || left < best->off_arranged))
      best = {all[k].second.what, as_given, left};
  }
  return best;
}

}  // namespace furcula::trees
