// A leg on its boom, the computer that lets it hop, its sensors and what disturbs it.
#include <algorithm>
#include <cmath>

#include "tests/hidden/trees/stage.hpp"

namespace furcula::hidden::trees {
namespace {

double weight_of(const Robot& robot) {
  double sum = 0.0;
  for (const Body& b : robot.bodies) sum += kGravity_mps2 * b.mass_kg;
  return sum;
}

// Gains, for the leg's springs and for what a laboratory happened to choose.
Hopping draw_hopping(const Robot& robot, Random& r) {
  Hopping h;
  const Leg& leg = *robot.leg;
  h.landing_rad = leg.switched ? r.uniform(0.62, 0.88) : leg.rest_rad - r.uniform(0.06, 0.12);
  h.stiffens_nmprad = leg.switched ? r.uniform(3.0, 9.0) : r.uniform(22.0, 30.0);
  for (double* gain : {&h.hip_kp, &h.hip_kd, &h.knee_kp, &h.knee_kd, &h.folds_rad, &h.drives_nmspr,
                       &h.swing_s, &h.push_gain_npm})
    *gain *= r.uniform(0.88, 1.12);
  return h;
}

Experiment draw_hops_of(const Robot& robot, Random& random, double duration_s, bool in_place) {
  return draw_hops(random, duration_s, in_place ? 0.0 : robot.leg->switched ? 1.5 : 1.0);
}

}  // namespace

std::optional<Recording> record_hops(const Machine& machine, const Case& c, Experiment& e, bool disturbed,
                                     Random& random, std::size_t& redrawn) {
  constexpr int kTries = 4;
  for (int i = 0; i < kTries; ++i) {
    const Random of_log(static_cast<std::uint64_t>(random.unit() * 0x1p53));
    Recording log = record(machine, machine.dynamics(), c.lab, e, disturbed, of_log);
    if (hopped(log, c.robot)) return log;
    ++redrawn;
    e = draw_hops_of(c.robot, random, e.duration_s, e.paths.front().moves.empty());
  }
  return std::nullopt;
}

std::optional<Stage> draw_leg_stage(const Question& question, Random& random) {
  Stage out;
  Case& c = out.c;
  c.question = question;
  c.robot = draw_monopod(random);
  Leg& leg = *c.robot.leg;
  leg.switched = random.chance(2.0 / 3) || wants(question, {"latch_delay", "latch_offset", "second_spring"});
  const std::size_t n = c.robot.size();
  const double weight_n = weight_of(c.robot);

  c.drives.assign(n, {});
  c.drives[leg.hip].damping_nmspr = 0.31 * random.uniform(0.8, 1.2);
  c.drives[leg.knee].damping_nmspr = 0.06 * random.uniform(0.8, 1.2);
  // The links' moments hold the rotors; some models know a rotor beside them.
  if (random.chance(0.4)) {
    c.drives[leg.hip].rotor_kgm2 = random.log_uniform(0.005, 0.03);
    c.drives[leg.knee].rotor_kgm2 = random.log_uniform(0.001, 0.006);
  }
  if (random.chance(0.5))
    for (std::size_t j = 0; j < leg.hip; ++j) c.drives[j].damping_nmspr = random.uniform(0.5, 2.5);
  c.free_damping = random.chance(0.5) && !wants(question, {"damping_error"});

  Lab& lab = c.lab;
  lab.hopper.emplace(c.robot, draw_hopping(c.robot, random));
  const double rates[] = {500, 625, 750, 800, 1000};
  lab.rate_hz = question.brief ? 500 : rates[static_cast<std::size_t>(random.uniform(0, 5))];
  lab.jitter = random.chance(0.3);
  const double boom_m = random.log_uniform(1e-4, 5e-4), joints_rad = random.log_uniform(1e-4, 4e-4);
  for (std::size_t j = 0; j < n; ++j) {
    lab.resolution[j] = c.robot.joints[j].prismatic ? boom_m : joints_rad;
    lab.noise[j] = lab.resolution[j] * random.uniform(0.2, 0.6);
    lab.effort[j] = 1e9;
  }
  const double columns = random.unit();
  const bool inside = wants(question, {"actuator_delay", "actuator_lag", "torque_saturation"});
  lab.torque_column = !inside && columns < 0.65;
  lab.command_column = inside || columns > 0.35;
  lab.torque_noise = random.uniform(0.005, 0.02);
  lab.switch_late_s = random.chance(0.5) ? random.uniform(0.001, 0.002) : 0.0;
  lab.ground_m = random.uniform(0.0005, 0.002);

  const std::size_t logs = question.brief ? 4 : 5 + static_cast<std::size_t>(random.uniform(0, 4));
  const double duration_s = question.brief ? 5.0 : random.uniform(5.0, 8.0);
  for (std::size_t i = 0; i < logs; ++i)
    out.experiments.push_back(draw_hops_of(c.robot, random, duration_s, random.chance(0.4)));
  c.held_out = (logs + 2) / 3;

  const Machine machine = c.with({});
  for (std::size_t i = 0; i < 3; ++i) {
    auto log = record_hops(machine, c, out.experiments[i], false, random, c.redrawn_logs);
    if (!log) return std::nullopt;
    out.some.push_back(std::move(*log));
  }
  out.base = baseline_of(machine, out.some);
  lab.rms_nm = out.base.rms_torque;
  for (std::size_t j = 0; j < n; ++j) {
    lab.disturbance_s[j] = random.log_uniform(0.005, 0.05);
    if (j < leg.hip) {
      // Nothing drives the boom: sizes there go by the weight, so that a large force is a tenth of it.
      out.base.rms_torque[j] = 0.25 * weight_n;
      lab.disturbance_nm[j] = weight_n * random.uniform(0.005, 0.01);
      continue;
    }
    lab.disturbance_nm[j] = lab.rms_nm[j] * random.uniform(0.005, 0.02);
    double most = 0.0;
    for (const Values& row : out.base.torque) most = std::max(most, std::fabs(row[j]));
    lab.effort[j] = std::ceil(2000 * most) / 1000;
  }
  return out;
}

}  // namespace furcula::hidden::trees
