#include "tests/hidden/trees/stage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace furcula::hidden::trees {
namespace {

constexpr double kPi = std::numbers::pi;

Values effective_inertia(const Machine& m, const Values& q, Values& diagonal) {
  Matrix mass;
  Values bias{};
  m.dynamics().evaluate(q, Values{}, mass, bias);
  const std::size_t n = m.size();
  for (std::size_t j = 0; j < n; ++j) {
    mass[j][j] += m.act(j).drive.rotor_kgm2;
    diagonal[j] = mass[j][j];
  }
  const Matrix factor = cholesky(mass, n);
  Values out{};
  for (std::size_t j = 0; j < n; ++j) {
    Values unit{};
    unit[j] = 1.0;
    out[j] = 1.0 / solved(factor, unit, n)[j];
  }
  return out;
}

}  // namespace

Values rms_of(const std::vector<Values>& rows) {
  Values out{};
  for (const Values& row : rows)
    for (std::size_t j = 0; j < kMost; ++j) out[j] += row[j] * row[j];
  for (double& x : out) x = std::sqrt(x / static_cast<double>(std::max<std::size_t>(rows.size(), 1)));
  return out;
}

Baseline baseline_of(const Machine& machine, const std::vector<Recording>& logs) {
  Baseline b;
  b.low.fill(1e9);
  b.high.fill(-1e9);
  for (const Recording& log : logs)
    for (std::size_t row = 5; row + 1 < log.time_s.size(); row += 4) {
      const State& s = log.state[row];
      b.state.push_back(s);
      b.q.push_back(s.q);
      b.v.push_back(s.v);
      b.a.push_back(machine.acceleration(s, log.time_s[row], log.input[row], Values{}));
      b.torque.push_back(log.torque_nm[row]);
      b.input.push_back(log.input[row]);
      Values rate{};
      for (std::size_t j = 0; j < machine.size(); ++j) {
        rate[j] = (log.input[row + 1][j] - log.input[row][j]) / (log.time_s[row + 1] - log.time_s[row]);
        b.low[j] = std::min(b.low[j], s.q[j]);
        b.high[j] = std::max(b.high[j], s.q[j]);
      }
      b.input_rate.push_back(rate);
    }
  b.rms_torque = rms_of(b.torque);
  b.rms_v = rms_of(b.v);
  b.rms_a = rms_of(b.a);
  b.rms_input_rate = rms_of(b.input_rate);
  std::vector<Values> squares = b.v;
  for (Values& row : squares)
    for (double& x : row) x *= x;
  b.rms_vv = rms_of(squares);
  return b;
}

bool in(const std::vector<std::string>& list, const std::string& x) {
  return std::find(list.begin(), list.end(), x) != list.end();
}

bool wants(const Question& q, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* x) { return in(q.effects, x); });
}

std::optional<Stage> draw_stage(const Question& question, Random& random) {
  Stage out;
  Case& c = out.c;
  c.question = question;
  c.robot = draw_robot(random, question.joints);
  const std::size_t n = c.robot.size();
  Lab& lab = c.lab;
  // Where the drive closes its loop on the joint's angle, a gain is a gain of its law, and a spring swings.
  const bool torque_only = wants(question, {"joint_elasticity", "torque_gain_error", "torque_crosstalk"});
  lab.position_control = wants(question, {"position_gain_error"}) || (!torque_only && random.chance(0.35));
  if (lab.position_control && torque_only) return std::nullopt;

  // Drives, from what each joint has to move.
  Values centre{};
  for (std::size_t j = 0; j < n; ++j) centre[j] = c.robot.joints[j].centre;
  c.drives.assign(n, {});
  Values diagonal{};
  effective_inertia(c.with({}), centre, diagonal);
  const bool rotors = random.chance(0.5) || wants(question, {"rotor_inertia_error", "joint_elasticity"});
  const bool frictions = random.chance(0.35);
  for (std::size_t j = 0; j < n; ++j) {
    if (rotors || diagonal[j] < 2e-4)
      c.drives[j].rotor_kgm2 = std::max(diagonal[j] * random.log_uniform(0.08, 0.6), 2e-4);
    c.drives[j].damping_nmspr = (diagonal[j] + c.drives[j].rotor_kgm2) * random.uniform(0.1, 0.8);
  }
  const Values apparent = effective_inertia(c.with({}), centre, diagonal);
  out.inertia = diagonal;
  Matrix unused;
  Values gravity{};
  c.with({}).dynamics().evaluate(centre, Values{}, unused, gravity);
  for (std::size_t j = 0; j < n; ++j) {
    const double inertia = std::sqrt(apparent[j] * diagonal[j]);
    const double w = 2 * kPi * (lab.position_control ? random.uniform(3.0, 6.0) : random.uniform(1.2, 2.5));
    const double zeta = random.uniform(0.5, 0.9);
    const double kp = std::max(inertia * w * w, lab.position_control ? std::fabs(gravity[j]) / 0.25 : 0.0);
    const double kd = 2 * zeta * std::sqrt(kp * inertia);
    const auto rounded = [](double x) {
      const double step = std::pow(10.0, std::floor(std::log10(x)) - 1);
      return step * std::round(x / step);
    };
    if (lab.position_control) {
      c.drives[j].kp_nmprad = rounded(kp);
      c.drives[j].kd_nmsprad = rounded(kd);
    } else {
      lab.kp[j] = kp;
      lab.kd[j] = kd;
      lab.feed_forward[j] = random.uniform(0.75, 1.15);
    }
    lab.effort[j] = 1e9;
  }
  c.free_damping = random.chance(0.5) && !wants(question, {"damping_error"});

  // Sensors.
  const double rates[] = {200, 250, 333, 400, 500};
  lab.rate_hz = question.brief ? 200 : rates[static_cast<std::size_t>(random.uniform(0, 5))];
  lab.jitter = random.chance(0.3);
  const double step = random.log_uniform(1e-4, 1e-3);
  for (std::size_t j = 0; j < n; ++j) {
    lab.resolution[j] = step * (c.robot.joints[j].prismatic ? 0.1 : 1.0);
    lab.noise[j] = lab.resolution[j] * random.uniform(0.2, 0.6);
  }
  lab.velocity_column = random.chance(0.5);
  lab.velocity_resolution = random.log_uniform(1e-3, 2e-2);
  const double columns = random.unit();
  const bool inside = wants(question, {"actuator_delay", "actuator_lag", "torque_saturation"});
  lab.torque_column = !inside && columns < 0.65;
  lab.command_column = inside || columns > 0.35;
  lab.torque_noise = random.uniform(0.005, 0.02);

  // Experiments: those held out are drawn like the others.
  const std::size_t logs = question.brief ? 4 : 5 + static_cast<std::size_t>(random.uniform(0, 6));
  const double duration = question.brief ? 4.0 : random.uniform(4.0, 10.0);
  for (std::size_t i = 0; i < logs; ++i)
    out.experiments.push_back(draw_experiment(random, c.robot, duration, random.uniform(0.4, 1.0)));
  c.held_out = (logs + 2) / 3;

  const auto run = [&] {
    const Machine machine = c.with({});
    std::vector<Recording> some;
    for (std::size_t i = 0; i < 3; ++i) {
      some.push_back(record(machine, machine.dynamics(), lab, out.experiments[i], false, random));
      if (!sound(some.back(), c.robot, n, 1.0)) return false;
    }
    out.base = baseline_of(machine, some);
    return true;
  };
  if (!run()) return std::nullopt;
  if (frictions)
    for (std::size_t j = 0; j < n; ++j)
      if (random.chance(0.6)) c.drives[j].friction_nm = out.base.rms_torque[j] * random.uniform(0.03, 0.2);
  if (frictions && !run()) return std::nullopt;

  lab.rms_nm = out.base.rms_torque;
  for (std::size_t j = 0; j < n; ++j) {
    if (lab.rms_nm[j] <= 0) return std::nullopt;
    lab.disturbance_nm[j] = lab.rms_nm[j] * random.uniform(0.005, 0.02);
    lab.disturbance_s[j] = random.log_uniform(0.005, 0.05);
    double most = 0.0;
    for (const Values& row : out.base.torque) most = std::max(most, std::fabs(row[j]));
    lab.effort[j] = std::ceil(2000 * most) / 1000;
  }
  return out;
}

bool record_all(Stage& stage, const Random& random) {
  Case& c = stage.c;
  const Machine machine = c.truth();
  const Dynamics model(c.robot, {0, 0, -kGravity_mps2});
  c.logs.clear();
  Random own = random;
  std::vector<Values> torque;
  for (Experiment& e : stage.experiments) {
    if (c.robot.leg) {
      auto log = record_hops(machine, c, e, true, own, c.redrawn_logs);
      if (!log) return false;
      c.logs.push_back(std::move(*log));
      torque.insert(torque.end(), c.logs.back().torque_nm.begin(), c.logs.back().torque_nm.end());
      continue;
    }
    const Random of_log(static_cast<std::uint64_t>(own.unit() * 0x1p53));
    c.logs.push_back(record(machine, model, c.lab, e, true, of_log));
    if (!sound(c.logs.back(), c.robot, c.visible(), 1.5)) return false;
    torque.insert(torque.end(), c.logs.back().torque_nm.begin(), c.logs.back().torque_nm.end());
  }
  const Values rms = rms_of(torque);
  for (std::size_t j = 0; j < c.visible(); ++j)
    if (rms[j] > 2.0 * c.lab.rms_nm[j]) return false;
  return true;
}

}  // namespace furcula::hidden::trees
