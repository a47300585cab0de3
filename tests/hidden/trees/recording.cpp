#include "tests/hidden/trees/recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace furcula::hidden::trees {
namespace {

double quantised(double x, double step) { return step > 0 ? step * std::round(x / step) : x; }

// Tells the recording of touch-downs and lift-offs, and gives the toe other ground for each stride.
class Strides {
 public:
  Strides(const Machine& machine, double scatter_m) : machine_(machine), scatter_m_(scatter_m) {}

  void after(State& s, Recording& out, Random& random) {
    if (!machine_.robot().leg) return;
    if (s.lift_off_s > lift_off_s_) {
      lift_off_s_ = s.lift_off_s;
      out.contacts.push_back({s.lift_off_s, false, {}});
      same_ = true;
    }
    if (s.touch_down_s > touch_down_s_) {
      touch_down_s_ = s.touch_down_s;
      out.contacts.push_back({s.touch_down_s, true, s.impulse_ns});
    }
    // Once the toe is well off: it shall not be in the ground at once.
    if (s.stance || !same_ || machine_.toe(s).at.z < s.ground_m + 0.01) return;
    s.ground_m = scatter_m_ * random.normal();
    same_ = false;
  }

 private:
  const Machine& machine_;
  double scatter_m_;
  double touch_down_s_ = -1.0, lift_off_s_ = -1.0;
  bool same_ = true;
};

// The true angle of the knee in the stance that goes on at row `row`: cubic between rows and from touch-down on.
double knee_at(const Recording& r, std::size_t knee, std::size_t row, double time_s) {
  const State& s = r.state[row];
  std::size_t next = row;
  while (next > 0 && r.time_s[next - 1] >= time_s && r.time_s[next - 1] >= s.touch_down_s) --next;
  double t0 = s.touch_down_s, q0 = s.touch_down_rad, v0 = s.touch_down_radps;
  if (next > 0 && r.time_s[next - 1] >= s.touch_down_s) {
    t0 = r.time_s[next - 1];
    q0 = r.state[next - 1].q[knee];
    v0 = r.state[next - 1].v[knee];
  }
  const double h = r.time_s[next] - t0;
  if (h < 1e-9) return q0;
  const double q1 = r.state[next].q[knee], v1 = r.state[next].v[knee];
  const double x = std::clamp((time_s - t0) / h, 0.0, 1.0), y = 1.0 - x;
  return y * y * (1 + 2 * x) * q0 + x * x * (1 + 2 * y) * q1 + x * y * h * (y * v0 - x * v1);
}

// From row `row` to `until_s`; an input reaches its drive after the drive's delay.
class Runner {
 public:
  Runner(const Machine& machine, const std::vector<double>& time, const std::vector<Values>& input)
      : machine_(machine), time_(time), input_(input) {}

  void run(State& s, std::size_t row, double until_s, const Values& disturbance, double from_s) const {
    double t = from_s;
    while (until_s - t > 1e-9) {
      Values now{};
      double next = until_s;
      for (std::size_t j = 0; j < machine_.size(); ++j) {
        const double delay = machine_.act(j).delay_s;
        std::size_t r = row;
        while (r > 0 && time_[r] + delay > t + 1e-9) --r;
        now[j] = input_[r][j];
        if (r < row) next = std::min(next, time_[r + 1] + delay);
      }
      machine_.run(s, t, next - t, kStep_s, now, disturbance);
      t = next;
    }
  }

 private:
  const Machine& machine_;
  const std::vector<double>& time_;
  const std::vector<Values>& input_;
};

}  // namespace

double Path::at(double t) const {
  double sum = centre;
  for (const Sine& s : sines) sum += s.amplitude * std::sin(s.radps * t + s.phase);
  for (const Move& m : moves) {
    const double x = std::clamp((t - m.begin_s) / m.duration_s, 0.0, 1.0);
    sum += (m.to - m.from) * x * x * x * (10 - 15 * x + 6 * x * x);
  }
  return sum;
}

double Path::rate(double t) const {
  double sum = 0.0;
  for (const Sine& s : sines) sum += s.amplitude * s.radps * std::cos(s.radps * t + s.phase);
  for (const Move& m : moves) {
    const double x = (t - m.begin_s) / m.duration_s;
    if (x > 0 && x < 1) sum += (m.to - m.from) / m.duration_s * 30 * x * x * (1 - x) * (1 - x);
  }
  return sum;
}

Experiment draw_experiment(Random& random, const Robot& robot, double duration_s, double size) {
  Experiment e;
  e.duration_s = duration_s;
  const double kind = random.unit();
  const double speed = random.uniform(0.6, 1.4);
  const auto sure = static_cast<std::size_t>(random.uniform(0, static_cast<double>(robot.size())));
  for (std::size_t j = 0; j < robot.size(); ++j) {
    const Joint& joint = robot.joints[j];
    Path p;
    const double reach = size * joint.range * random.uniform(0.7, 1.0);
    p.centre = joint.centre + (joint.range - reach) * random.uniform(-1, 1);
    const bool moves = j == sure || random.chance(0.88);
    if (!moves) {
      e.paths.push_back(p);
      continue;
    }
    if (kind < 0.5) {
      const double shares[] = {0.55, 0.3, 0.15};
      double hz = speed * random.uniform(0.15, 0.45);
      for (double share : shares) {
        p.sines.push_back({share * reach, 2 * std::numbers::pi * hz, random.uniform(0, 6.28)});
        hz *= random.uniform(1.6, 2.8);
      }
    } else {
      const bool quick = kind < 0.7;
      double t = random.uniform(0.1, 0.5), last = 0.0;
      while (t < duration_s) {
        double to = reach * random.uniform(-1, 1);
        if (std::fabs(to - last) < 0.4 * reach) to = last > 0 ? last - reach : last + reach;
        const double takes = (quick ? random.uniform(0.15, 0.35) : random.uniform(0.5, 1.2)) / speed;
        p.moves.push_back({t, takes, last, to});
        last = to;
        t += takes + random.uniform(0.15, 0.6);
      }
    }
    e.paths.push_back(p);
  }
  return e;
}

Experiment draw_hops(Random& random, double duration_s, double fastest_mps) {
  const bool in_place = fastest_mps <= 0.0;
  Experiment e;
  e.duration_s = duration_s;
  Path speed, drop;
  drop.centre = random.uniform(in_place ? 0.06 : 0.09, 0.15);
  double t = random.uniform(0.2, 0.8), now = 0.0;
  while (t < duration_s && !in_place) {
    double to = fastest_mps * random.uniform(-0.67, 1.0);
    if (std::fabs(to - now) < 0.3 * fastest_mps) to = now + (now > 0.2 ? -0.5 : 0.5) * fastest_mps;
    speed.moves.push_back({t, std::fabs(to - now) * random.uniform(0.8, 1.4), now, to});
    now = to;
    t += speed.moves.back().duration_s + random.uniform(0.5, 1.6);
  }
  t = random.uniform(0.8, 2.0);
  now = 0.0;
  while (t < duration_s) {
    const double to = random.uniform(in_place ? 0.06 : 0.09, 0.15) - drop.centre;
    drop.moves.push_back({t, 0.3, now, to});
    now = to;
    t += random.uniform(0.8, 2.0);
  }
  e.paths = {speed, drop};
  return e;
}

Recording record(const Machine& machine, const Dynamics& model, const Lab& lab, const Experiment& experiment,
                 bool disturbed, Random random) {
  Recording out;
  const auto& leg = machine.robot().leg;
  const std::size_t n = machine.size(), visible = leg ? leg->knee + 1 : experiment.paths.size();
  const double period = 1.0 / lab.rate_hz;
  const auto rows = static_cast<std::size_t>(experiment.duration_s * lab.rate_hz);
  State s;
  const auto hops = [&](double t) { return HopTarget{experiment.paths[0].at(t), experiment.paths[1].at(t)}; };
  std::optional<Hopper> hopper = lab.hopper;
  if (leg) {
    s.q = hopper->start(hops(0.0));
  } else {
    for (std::size_t j = 0; j < visible; ++j) s.q[j] = experiment.paths[j].at(0.0);
  }
  Strides strides(machine, disturbed ? lab.ground_m : 0.0);
  Values noise{};
  if (disturbed)
    for (std::size_t j = 0; j < visible; ++j) noise[j] = lab.disturbance_nm[j] * random.normal();
  const Runner runner(machine, out.time_s, out.input);
  for (std::size_t row = 0; row < rows; ++row) {
    // The period's grid, so that early and late rows do not add up.
    double t = static_cast<double>(row) * period;
    if (lab.jitter && row > 0) t += 0.3 * period * random.uniform(-1, 1);
    t = quantised(t, 1e-6);
    if (row > 0) {
      double from = out.time_s.back();
      const double chunks = std::ceil((t - from) / (2 * kStep_s));
      const double chunk = (t - from) / chunks;
      for (double c = 0; c < chunks; ++c) {
        runner.run(s, row - 1, from + chunk, noise, from);
        from += chunk;
        strides.after(s, out, random);
        if (!disturbed) continue;
        for (std::size_t j = 0; j < visible; ++j) {
          const double keeps = std::exp(-chunk / lab.disturbance_s[j]);
          noise[j] =
              keeps * noise[j] + lab.disturbance_nm[j] * std::sqrt(1 - keeps * keeps) * random.normal();
        }
      }
    }
    Values input{}, read{};
    for (std::size_t j = 0; j < visible; ++j)
      read[j] =
          quantised(s.q[j] + machine.act(j).encoder_rad + lab.noise[j] * random.normal(), lab.resolution[j]);
    Values gravity{};
    if (!lab.position_control && !leg) {
      Matrix unused;
      model.evaluate(read, Values{}, unused, gravity);
    }
    if (leg) {
      input = hopper->command(t, hops(t), read, s.v, switched_on(out, lab, t));
      for (std::size_t j = 0; j < visible; ++j)
        input[j] = quantised(std::clamp(input[j], -lab.effort[j], lab.effort[j]), 1e-6);
    }
    for (std::size_t j = 0; j < visible && !leg; ++j) {
      const Path& p = experiment.paths[j];
      if (lab.position_control)
        input[j] = quantised(p.at(t), 1e-6);
      else
        input[j] = quantised(std::clamp(lab.feed_forward[j] * gravity[j] + lab.kp[j] * (p.at(t) - read[j]) +
                                            lab.kd[j] * (p.rate(t) - s.v[j]),
                                        -lab.effort[j], lab.effort[j]),
                             1e-6);
    }
    if (row == 0) {
      Values first = input;
      machine.settle(s, first);
    }
    out.time_s.push_back(t);
    out.input.push_back(input);
    out.state.push_back(s);
    out.torque_nm.push_back(machine.drive_torque(s, input));
    if (leg) out.ground_n.push_back(machine.ground_force(s, t, input, noise));
    for (std::size_t j = 0; j < n; ++j)
      if (!std::isfinite(s.q[j]) || std::fabs(s.q[j]) > 1e3) return out;
  }
  return out;
}

bool sound(const Recording& recording, const Robot& robot, std::size_t visible, double beyond) {
  for (const State& s : recording.state)
    for (std::size_t j = 0; j < visible; ++j) {
      const Joint& joint = robot.joints[j];
      const double out = std::fabs(s.q[j] - joint.centre) - joint.range;
      if (!(out < (joint.prismatic ? 0.3 * beyond : beyond)) || !(std::fabs(s.v[j]) < 40)) return false;
    }
  return recording.state.size() > 10;
}

bool hopped(const Recording& recording, const Robot& robot) {
  const Leg& leg = *robot.leg;
  double weight = 0.0;
  for (const Body& b : robot.bodies) weight += kGravity_mps2 * b.mass_kg;
  // Out of the cone for some ms a toe slips by less than the ground is uneven.
  constexpr double kSlips_s = 0.004;
  const double beside = 0.1 * weight;
  double slips_from_s = 1e9;
  for (std::size_t row = 0; row < recording.state.size(); ++row) {
    const State& s = recording.state[row];
    const double knee = s.q[leg.knee];
    if (!(s.q[1] > 0.25 && s.q[1] < 1.2 && std::fabs(s.q[leg.hip]) < 1.8)) return false;
    if (!(knee > 0.02 && knee < 2.44)) return false;
    for (std::size_t j = 0; j <= leg.knee; ++j)
      if (!(std::fabs(s.v[j]) < 40)) return false;
    const Pair f = recording.ground_n[row];
    if (!s.stance || std::fabs(f.x) < kGroundFriction * f.z + beside)
      slips_from_s = 1e9;
    else
      slips_from_s = std::min(slips_from_s, recording.time_s[row]);
    if (recording.time_s[row] - slips_from_s > kSlips_s) return false;
  }
  double last = 0.0;
  for (const Contact& c : recording.contacts) {
    if (c.time_s - last > 0.7) return false;
    last = c.time_s;
    if (c.down && !(std::fabs(c.impulse_ns.x) < kGroundFriction * c.impulse_ns.z + 0.01 * beside))
      return false;
  }
  return recording.state.size() > 10 && recording.time_s.back() - last < 0.7;
}

bool switched_on(const Recording& recording, const Lab& lab, double time_s) {
  for (auto c = recording.contacts.rbegin(); c != recording.contacts.rend(); ++c)
    if (c->time_s + lab.switch_late_s <= time_s) return c->down;
  return false;
}

std::vector<Values> restarted(const Machine& machine, const Machine& truth, const Recording& recording,
                              std::size_t begin, std::size_t end) {
  State s = recording.state[begin];
  const std::size_t shared = std::min(machine.size(), truth.size());
  for (std::size_t j = 0; j < shared; ++j) s.q[j] += truth.act(j).encoder_rad - machine.act(j).encoder_rad;
  State own = s;
  machine.settle(own, recording.input[begin]);
  for (std::size_t j = 0; j < shared; ++j) {
    if (machine.act(j).lag_s > 0 && truth.act(j).lag_s <= 0) s.lag[j] = own.lag[j];
    if (machine.act(j).spring_nmprad > 0 && truth.act(j).spring_nmprad <= 0) {
      s.rotor[j] = own.rotor[j];
      s.rotor_v[j] = own.rotor_v[j];
    }
  }
  if (machine.robot().leg) {
    s.phase_kept = true;
    if (s.stance) {
      const std::size_t knee = machine.robot().leg->knee;
      const double catch_s = s.touch_down_s + machine.spring_switch().delay_s;
      const double shift = truth.act(knee).encoder_rad - machine.act(knee).encoder_rad;
      s.caught = machine.robot().leg->switched && catch_s <= recording.time_s[begin];
      if (s.caught)
        s.rest_rad = knee_at(recording, knee, begin, catch_s) + shift + machine.spring_switch().offset_rad;
      machine.stand(s);
    }
  }
  const Runner runner(machine, recording.time_s, recording.input);
  std::vector<Values> out;
  for (std::size_t row = begin; row < end; ++row) {
    runner.run(s, row, recording.time_s[row + 1], Values{}, recording.time_s[row]);
    Values seen = s.q;
    for (std::size_t j = 0; j < shared; ++j) seen[j] += machine.act(j).encoder_rad;
    out.push_back(seen);
  }
  return out;
}

std::string log_of(const Machine& truth, const Lab& lab, const Recording& recording, std::size_t visible,
                   Random random) {
  const auto& joints = truth.robot().joints;
  std::string out = "# format: furcula-log/1\n# machine_type: tree\ntime_s";
  const auto column = [&](const char* what, const Joint& j, const char* turning, const char* sliding) {
    out += "," + std::string(what) + "_" + j.name + (j.prismatic ? sliding : turning);
  };
  for (std::size_t i = 0; i < visible; ++i) {
    const Joint& j = joints[i];
    column(j.prismatic ? "position" : "angle", j, "_rad", "_m");
    if (lab.velocity_column) column("velocity", j, "_radps", "_mps");
    if (truth.robot().leg && j.prismatic) continue;  // a boom has no drive
    if (lab.position_control) {
      column(j.prismatic ? "position_cmd" : "angle_cmd", j, "_rad", "_m");
    } else {
      if (lab.torque_column) column(j.prismatic ? "force" : "torque", j, "_nm", "_n");
      if (lab.command_column) column(j.prismatic ? "force_cmd" : "torque_cmd", j, "_nm", "_n");
    }
  }
  if (truth.robot().leg) out += ",contact_toe";
  out += "\n";
  char number[40];
  const auto add = [&](const char* format, double value) {
    std::snprintf(number, sizeof number, format, value);
    out += number;
  };
  for (std::size_t row = 0; row < recording.time_s.size(); ++row) {
    add("%.6f", recording.time_s[row]);
    const State& s = recording.state[row];
    for (std::size_t i = 0; i < visible; ++i) {
      const double scale = joints[i].prismatic ? 0.1 : 1.0;
      add(",%.8g",
          quantised(s.q[i] + truth.act(i).encoder_rad + lab.noise[i] * random.normal(), lab.resolution[i]));
      if (lab.velocity_column)
        add(",%.8g", quantised(s.v[i] + 0.3 * scale * lab.velocity_resolution * random.normal(),
                               scale * lab.velocity_resolution));
      if (truth.robot().leg && joints[i].prismatic) continue;
      if (lab.position_control) {
        add(",%.8g", recording.input[row][i]);
      } else {
        if (lab.torque_column)
          add(",%.8g", recording.torque_nm[row][i] + lab.torque_noise * lab.rms_nm[i] * random.normal());
        if (lab.command_column) add(",%.8g", recording.input[row][i]);
      }
    }
    if (truth.robot().leg) out += switched_on(recording, lab, recording.time_s[row]) ? ",1" : ",0";
    out += "\n";
  }
  return out;
}

}  // namespace furcula::hidden::trees
