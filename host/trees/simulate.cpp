// Simulated logs of a tree, see simulate.hpp.
#include "host/trees/simulate.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/trees/recording.hpp"
#include "host/trees/run.hpp"

namespace furcula::trees {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::array<std::string_view, 4> kProfiles{"hold", "sine", "steps", "fourier"};  // as Path::Profile
constexpr std::size_t kMostHarmonics = 100;

double chosen(const toml::table& table, std::string_view key, const std::string& name,
              const std::string& where, double otherwise, double lower, double upper, std::string_view unit) {
  const toml::node* node = table.get(key);
  return node == nullptr ? otherwise
                         : core::number(*node, name, where + " " + std::string(key), lower, upper, unit);
}

std::vector<double> numbers(const toml::table& table, const std::string& key, const std::string& name,
                            const std::string& where, double lower, double upper, const std::string& unit) {
  const toml::node* node = table.get(key);
  if (node == nullptr)
    core::fail(name, table.source(), where + " has no key '" + key + "'; expected one number a harmonic");
  const toml::array* list = node->as_array();
  if (list == nullptr || list->empty() || list->size() > kMostHarmonics)
    core::fail(name, node->source(),
               where + " " + key + " = " + core::value_text(*node) + "; expected 1 to " +
                   std::to_string(kMostHarmonics) + " numbers, one a harmonic");
  std::vector<double> out;
  for (const toml::node& entry : *list)
    out.push_back(core::number(entry, name, where + " " + key, lower, upper, unit));
  return out;
}

std::vector<Harmonic> harmonics(const toml::table& table, const std::string& name, const std::string& where,
                                const std::string& unit) {
  const std::vector<double> number = numbers(table, "harmonics", name, where, 0.0, 1e5, ""),
                            sine = numbers(table, "sine_" + unit, name, where, -1e3, 1e3, unit),
                            cosine = numbers(table, "cosine_" + unit, name, where, -1e3, 1e3, unit);
  if (sine.size() != number.size() || cosine.size() != number.size())
    core::fail(name, table.source(),
               where + " has " + std::to_string(number.size()) + " harmonics, " +
                   std::to_string(sine.size()) + " numbers in sine_" + unit + " and " +
                   std::to_string(cosine.size()) + " in cosine_" + unit + "; expected as many of each");
  std::vector<Harmonic> out;
  for (std::size_t k = 0; k < number.size(); ++k) out.push_back({number[k], sine[k], cosine[k]});
  return out;
}

/// Of each joint; of one that is not named none.
std::vector<double> noises(const toml::table& table, const std::string& name, const TreeModel& model) {
  std::vector<std::string_view> joints;
  for (const auto& j : model.robot.joints) joints.emplace_back(j.name);
  core::refuse_unknown_keys(table, name, "[disturbance] torque_nm", joints);
  std::vector<double> out;
  for (const std::string_view joint : joints)
    out.push_back(chosen(table, joint, name, "[disturbance] torque_nm", 0.0, 0.0, 1e6, "N m"));
  return out;
}

/// From 0 to 1 within `rise_s`, and its derivatives.
Path::Point smooth_step(double t, double rise_s) {
  const double x = std::clamp(t / rise_s, 0.0, 1.0);
  return {x * x * x * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * x * x * (1.0 - x) * (1.0 - x) / rise_s,
          60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (rise_s * rise_s)};
}

std::string listed(const std::vector<Harmonic>& harmonics, double Harmonic::*part) {
  std::string out = "[";
  for (const Harmonic& h : harmonics) out += (out.size() > 1 ? ", " : "") + core::toml_float(h.*part);
  return out + "]";
}

}  // namespace

Path::Point Path::at(double t) const {
  if (profile == Profile::hold) return {centre_rad, 0.0, 0.0};
  if (profile == Profile::fourier) {
    Point p{centre_rad, 0.0, 0.0};
    for (const Harmonic& h : harmonics) {
      const double w = kTurn * h.number / period_s, s = std::sin(w * t), c = std::cos(w * t);
      p.q += h.sine_rad * s + h.cosine_rad * c;
      p.v += w * (h.sine_rad * c - h.cosine_rad * s);
      p.a -= w * w * (h.sine_rad * s + h.cosine_rad * c);
    }
    if (ramp_s <= 0.0) return p;
    const Point u = smooth_step(std::min(t, end_s - t), ramp_s);
    const double q = p.q - centre_rad, du = t < 0.5 * end_s ? u.v : -u.v;
    return {centre_rad + u.q * q, du * q + u.q * p.v, u.a * q + 2.0 * du * p.v + u.q * p.a};
  }
  const double w = kTurn / period_s, s = std::sin(w * t + phase_rad), c = std::cos(w * t + phase_rad);
  if (profile == Profile::steps) return {centre_rad + (s >= 0.0 ? 1.0 : -1.0) * amplitude_rad, 0.0, 0.0};
  constexpr double kRise_s = 0.5;
  const auto [u, du, ddu] = smooth_step(t, kRise_s);
  return {centre_rad + amplitude_rad * u * s, amplitude_rad * (du * s + u * w * c),
          amplitude_rad * (ddu * s + 2.0 * du * w * c - u * w * w * s)};
}

Scenario default_scenario(const TreeModel& model) {
  Scenario s;
  s.angle_noise_rad = model.angle_noise_rad;
  if (model.torque_noise_nm > 0.0) s.torque_noise_nm.assign(model.joints(), model.torque_noise_nm);
  for (std::size_t j = 0; j < model.joints(); ++j) {
    const auto& limits = model.robot.joints[j].limits;
    Path p;
    const bool limited = limits && limits->lower < limits->upper;
    const double most = model.prismatic(j) ? 0.1 : 0.6;
    if (limited)
      p.centre_rad = std::clamp(0.0, limits->lower + 0.3 * (limits->upper - limits->lower),
                                limits->upper - 0.3 * (limits->upper - limits->lower));
    p.amplitude_rad = limited ? std::min(most, 0.2 * (limits->upper - limits->lower)) : most;
    p.period_s = 1.3 + 0.37 * static_cast<double>(j);
    p.phase_rad = 0.9 * static_cast<double>(j);
    s.paths.push_back(p);
  }
  return s;
}

Scenario parse_scenario(std::string_view text, const std::string& name, const TreeModel& model) {
  const toml::table file = core::parse_toml(text, name);
  static constexpr std::array<std::string_view, 4> kSections{"run", "path", "disturbance", "sensors"};
  core::refuse_unknown_keys(file, name, "the scenario of a tree", kSections);
  Scenario s = default_scenario(model);
  if (const toml::node* node = file.get("run")) {
    const toml::table& run = core::table(*node, name, "[run]");
    static constexpr std::array<std::string_view, 2> kKeys{"duration_s", "sample_rate_hz"};
    core::refuse_unknown_keys(run, name, "[run]", kKeys);
    s.duration_s = chosen(run, "duration_s", name, "[run]", s.duration_s, 0.5, 3600.0, "s");
    s.sample_rate_hz = chosen(run, "sample_rate_hz", name, "[run]", s.sample_rate_hz, 20.0, 10000.0, "Hz");
  }
  if (const toml::node* node = file.get("path")) {
    std::vector<std::string_view> joints;
    for (const auto& j : model.robot.joints) joints.emplace_back(j.name);
    const toml::table& paths = core::table(*node, name, "[path]");
    core::refuse_unknown_keys(paths, name, "[path]", joints);
    // Joints that the file does not name stand still.
    for (Path& p : s.paths) p.profile = Path::Profile::hold;
    for (std::size_t j = 0; j < model.joints(); ++j) {
      const toml::node* entry = paths.get(joints[j]);
      if (entry == nullptr) continue;
      const std::string where = "[path." + model.robot.joints[j].name + "]";
      const toml::table& table = core::table(*entry, name, where);
      const bool slides = model.prismatic(j);
      const std::string unit = slides ? "m" : "rad", centre = "centre_" + unit,
                        amplitude = "amplitude_" + unit;
      Path& p = s.paths[j];
      p.profile = Path::Profile::sine;
      if (const toml::node* profile = table.get("profile")) {
        const std::string which = core::text(*profile, name, where + " profile");
        const auto* const found = std::find(kProfiles.begin(), kProfiles.end(), which);
        if (found == kProfiles.end())
          core::fail(name, profile->source(),
                     where + " profile = " + core::quoted(which) + "; expected sine, steps, fourier or hold");
        p.profile = static_cast<Path::Profile>(found - kProfiles.begin());
      }
      if (p.profile == Path::Profile::fourier) {
        const std::string sine = "sine_" + unit, cosine = "cosine_" + unit;
        const std::array<std::string_view, 7> keys{"profile", centre, "period_s", "harmonics",
                                                   sine,      cosine, "ramp_s"};
        core::refuse_unknown_keys(table, name, where, keys);
        p.harmonics = harmonics(table, name, where, unit);
        p.ramp_s = chosen(table, "ramp_s", name, where, 0.0, 0.0, 0.5 * s.duration_s, "s");
        p.end_s = s.duration_s;
      } else {
        const std::array<std::string_view, 5> keys{"profile", centre, amplitude, "period_s", "phase_rad"};
        core::refuse_unknown_keys(table, name, where, keys);
      }
      p.centre_rad = chosen(table, centre, name, where, p.centre_rad, -1e3, 1e3, unit);
      p.amplitude_rad = chosen(table, amplitude, name, where, p.amplitude_rad, 0.0, 1e3, unit);
      p.period_s = chosen(table, "period_s", name, where, p.period_s, 0.02, 1e4, "s");
      p.phase_rad = chosen(table, "phase_rad", name, where, p.phase_rad, -100.0, 100.0, "rad");
    }
  }
  if (const toml::node* node = file.get("disturbance")) {
    const toml::table& table = core::table(*node, name, "[disturbance]");
    static constexpr std::array<std::string_view, 3> kKeys{"share", "time_s", "torque_nm"};
    core::refuse_unknown_keys(table, name, "[disturbance]", kKeys);
    if (const toml::node* torque = table.get("torque_nm"))
      s.torque_noise_nm = noises(core::table(*torque, name, "[disturbance] torque_nm"), name, model);
    s.disturbance_share = chosen(table, "share", name, "[disturbance]", s.disturbance_share, 0.0, 1.0, "");
    s.disturbance_time_s =
        chosen(table, "time_s", name, "[disturbance]", s.disturbance_time_s, 1e-4, 100.0, "s");
  }
  if (const toml::node* node = file.get("sensors")) {
    const toml::table& table = core::table(*node, name, "[sensors]");
    static constexpr std::array<std::string_view, 2> kKeys{"angle_noise_rad", "torque_noise_share"};
    core::refuse_unknown_keys(table, name, "[sensors]", kKeys);
    s.angle_noise_rad =
        chosen(table, "angle_noise_rad", name, "[sensors]", s.angle_noise_rad, 0.0, 1.0, "rad");
    s.torque_noise_share =
        chosen(table, "torque_noise_share", name, "[sensors]", s.torque_noise_share, 0.0, 1.0, "");
  }
  return s;
}

std::string format_scenario(const TreeModel& m, const Scenario& scenario) {
  std::string out = "[run]\nduration_s = " + core::toml_float(scenario.duration_s) +
                    "\nsample_rate_hz = " + core::toml_float(scenario.sample_rate_hz) + "\n";
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const Path& p = scenario.paths[j];
    const std::string unit = m.prismatic(j) ? "m" : "rad";
    out += "\n[path." + toml_key(m.robot.joints[j].name) + "]\nprofile = \"" +
           std::string(kProfiles[static_cast<std::size_t>(p.profile)]) + "\"\ncentre_" + unit + " = " +
           core::toml_float(p.centre_rad) + "\n";
    if (p.profile == Path::Profile::hold) continue;
    if (p.profile == Path::Profile::fourier)
      out += "period_s = " + core::toml_float(p.period_s) +
             "\nharmonics = " + listed(p.harmonics, &Harmonic::number) + "\nsine_" + unit + " = " +
             listed(p.harmonics, &Harmonic::sine_rad) + "\ncosine_" + unit + " = " +
             listed(p.harmonics, &Harmonic::cosine_rad) +
             (p.ramp_s > 0.0 ? "\nramp_s = " + core::toml_float(p.ramp_s) + "\n" : "\n");
    else
      out += "amplitude_" + unit + " = " + core::toml_float(p.amplitude_rad) +
             "\nperiod_s = " + core::toml_float(p.period_s) +
             "\nphase_rad = " + core::toml_float(p.phase_rad) + "\n";
  }
  if (scenario.torque_noise_nm.empty()) return out;
  out += "\n[disturbance.torque_nm]\n";
  for (std::size_t j = 0; j < m.joints(); ++j)
    out += toml_key(m.robot.joints[j].name) + " = " + core::toml_float(scenario.torque_noise_nm[j]) + "\n";
  return out;
}

Scenario read_scenario(const std::string& path, const TreeModel& model) {
  return parse_scenario(core::read_small_file(path, "a scenario (TOML)"), path, model);
}

namespace {

/// The angles as they stand in a log whose clocks are apart: measured(t) = true(t - skew). Rows that nothing was measured for go.
void skew_angles(log::Log& log, const TreeModel& model, double skew_s) {
  const std::vector<double> time = log.columns["time_s"];
  std::vector<std::vector<double>*> angles, others;
  for (auto& [name, values] : log.columns) {
    bool measured = false;
    for (std::size_t j = 0; j < model.joints(); ++j) measured |= name == column_of(model, j, "angle");
    (measured ? angles : others).push_back(&values);
  }
  std::vector<std::size_t> kept, from;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double t = time[k] - skew_s;
    const auto after = std::upper_bound(time.begin(), time.end(), t);
    if (after == time.begin() || after == time.end()) continue;
    kept.push_back(k);
    from.push_back(static_cast<std::size_t>(after - time.begin()) - 1);
  }
  for (std::vector<double>* values : angles) {
    std::vector<double> out;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const double part = (time[kept[i]] - skew_s - time[from[i]]) / (time[from[i] + 1] - time[from[i]]);
      out.push_back((*values)[from[i]] + part * ((*values)[from[i] + 1] - (*values)[from[i]]));
    }
    *values = std::move(out);
  }
  for (std::vector<double>* values : others) {
    std::vector<double> out;
    for (const std::size_t k : kept) out.push_back((*values)[k]);
    *values = std::move(out);
  }
}

}  // namespace

log::Log simulate(const TreeModel& model, const Scenario& scenario, std::uint64_t seed) {
  const std::size_t n = model.joints();
  if (model.foot)
    throw core::DataError(
        model.file + ": foot " + core::quoted(model.foot->name) +
        " has no ground in a simulation along paths; expected a robot without a foot, or a planar_leg with a gait");
  const SetupMaker maker(model);
  std::vector<Cause> of_robot;
  double skew_s = 0.0;  // of the log's clocks
  for (const Cause& c : model.causes)
    if (c.effect == Effect::time_skew)
      skew_s += c.values[0];
    else
      of_robot.push_back(c);
  const Setup true_one = maker.make({model.drives, of_robot}), believed = maker.make({model.drives, {}});
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  log::Log out;
  out.rig = "tree";
  out.metadata["robot"] = model.robot.name;
  auto column = [&](std::size_t j, const std::string& what) -> std::vector<double>& {
    return out.columns[column_of(model, j, what)];
  };

  std::vector<double> q(n), v(n), input(n), disturbance(n, 0.0), torque_rms(n, 0.0), wanted(n);
  for (std::size_t j = 0; j < n; ++j) {
    const Path::Point p = scenario.paths[j].at(0.0);
    q[j] = p.q + true_one.joints[j].encoder_offset_rad;
    v[j] = p.v;
  }
  // What a drive gives on such a path, for the sizes of noise and disturbance.
  const auto steps = static_cast<std::size_t>(std::lround(scenario.duration_s * scenario.sample_rate_hz));
  auto tree = believed.model;
  for (std::size_t j = 0; j < n; ++j)
    if (model.drives[j].law == ControlMode::position) {
      tree.laws[j].stiffness_nmprad -= model.drives[j].kp_nmprad;
      tree.laws[j].damping_nmspr -= model.drives[j].kd_nmsprad;
    }
  const auto on_path = [&](double t) {
    model::RobotModel::Joints pq{}, pv{}, pa{};
    for (std::size_t j = 0; j < n; ++j) {
      const Path::Point p = scenario.paths[j].at(t);
      pq[j] = p.q;
      pv[j] = p.v;
      pa[j] = p.a;
    }
    return dynamics::tree::inverse_dynamics(tree, pq, pv, pa);
  };
  constexpr std::size_t kLooks = 400;
  for (std::size_t k = 0; k < kLooks; ++k) {
    const auto tau = on_path(scenario.duration_s * static_cast<double>(k) / kLooks);
    for (std::size_t j = 0; j < n; ++j) torque_rms[j] += tau[j] * tau[j] / kLooks;
  }
  for (double& t : torque_rms) t = std::sqrt(t);
  std::vector<double> disturbed_nm, noise_nm;
  for (std::size_t j = 0; j < n; ++j) {
    const bool said = !scenario.torque_noise_nm.empty();
    disturbed_nm.push_back(said ? scenario.torque_noise_nm[j] : scenario.disturbance_share * torque_rms[j]);
    noise_nm.push_back(said ? scenario.torque_noise_nm[j] : scenario.torque_noise_share * torque_rms[j]);
  }
  Runner runner(true_one);
  runner.reset(q, v);
  std::vector<std::vector<double>> late(n);  // inputs on their way to a drive with a delay
  const double dt = 1.0 / scenario.sample_rate_hz;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * dt;
    const auto feed_forward = on_path(t);
    model::RobotModel::Joints posture{};
    out.columns["time_s"].push_back(t);
    for (std::size_t j = 0; j < n; ++j) {
      const Path::Point p = scenario.paths[j].at(t);
      const double measured = runner.measured(j) + scenario.angle_noise_rad * normal(random);
      column(j, "angle").push_back(measured);
      constexpr double kFollows_radps = 10.0;
      wanted[j] = kFollows_radps * kFollows_radps * (p.q - measured) +
                  2.0 * kFollows_radps * (p.v - runner.velocity(j));
      posture[j] = p.q;
      if (model.drives[j].law == ControlMode::position) {
        input[j] = p.q;
        column(j, "angle_cmd").push_back(p.q);
        wanted[j] = 0.0;
      }
      const double keep = std::exp(-dt / scenario.disturbance_time_s);
      disturbance[j] =
          keep * disturbance[j] + std::sqrt(1.0 - keep * keep) * disturbed_nm[j] * normal(random);
      runner.disturb(j, disturbance[j]);
    }
    // Through the mass matrix each joint's error is corrected on its own, however many links it carries.
    const auto mass = dynamics::tree::mass_matrix(believed.model, posture);
    for (std::size_t j = 0; j < n; ++j) {
      if (model.drives[j].law == ControlMode::torque) {
        input[j] = feed_forward[j];
        for (std::size_t o = 0; o < n; ++o) input[j] += mass[j][o] * wanted[o];
        column(j, "torque_cmd").push_back(input[j]);
      }
      late[j].push_back(input[j]);
    }
    // Delays are taken to the next twentieth of a sample.
    constexpr int kParts = 20;
    std::vector<double> now(n);
    bool delayed = false;
    for (std::size_t j = 0; j < n; ++j) delayed |= true_one.joints[j].delay_s > 0.0;
    const int loops = delayed ? kParts : 1;
    for (int part = 0; part < loops; ++part) {
      for (std::size_t j = 0; j < n; ++j) {
        const double from = (static_cast<double>(k) + (part + 0.5) / loops) - true_one.joints[j].delay_s / dt;
        now[j] = late[j][from <= 0.0 ? 0 : std::min(k, static_cast<std::size_t>(from))];
      }
      runner.advance(now, dt / loops);
    }
    for (std::size_t j = 0; j < n; ++j) {
      if (!std::isfinite(runner.measured(j)))
        throw core::DataError("the motion is not finite any more at " + core::shortest(t) +
                              " s; expected slower paths or stronger drives");
      if (model.drives[j].law == ControlMode::torque)
        column(j, "torque").push_back(input[j] + noise_nm[j] * normal(random));
    }
  }
  if (skew_s != 0.0) skew_angles(out, model, skew_s);
  return out;
}

}  // namespace furcula::trees
