#include "tests/hidden/trees/recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace furcula::hidden::trees {
namespace {

double quantised(double x, double step) { return step > 0 ? step * std::round(x / step) : x; }

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

Recording record(const Machine& machine, const Dynamics& model, const Lab& lab, const Experiment& experiment,
                 bool disturbed, Random random) {
  Recording out;
  const std::size_t n = machine.size(), visible = experiment.paths.size();
  const double period = 1.0 / lab.rate_hz;
  const auto rows = static_cast<std::size_t>(experiment.duration_s * lab.rate_hz);
  State s;
  for (std::size_t j = 0; j < visible; ++j) s.q[j] = experiment.paths[j].at(0.0);
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
    if (!lab.position_law) {
      Matrix unused;
      model.evaluate(read, Values{}, unused, gravity);
    }
    for (std::size_t j = 0; j < visible; ++j) {
      const Path& p = experiment.paths[j];
      if (lab.position_law)
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
  std::string out = "# format: furcula-log/1\n# rig: tree\ntime_s";
  const auto column = [&](const char* what, const Joint& j, const char* turning, const char* sliding) {
    out += "," + std::string(what) + "_" + j.name + (j.prismatic ? sliding : turning);
  };
  for (std::size_t i = 0; i < visible; ++i) {
    const Joint& j = joints[i];
    column(j.prismatic ? "position" : "angle", j, "_rad", "_m");
    if (lab.velocity_column) column("velocity", j, "_radps", "_mps");
    if (lab.position_law) {
      column(j.prismatic ? "position_cmd" : "angle_cmd", j, "_rad", "_m");
    } else {
      if (lab.torque_column) column(j.prismatic ? "force" : "torque", j, "_nm", "_n");
      if (lab.command_column) column(j.prismatic ? "force_cmd" : "torque_cmd", j, "_nm", "_n");
    }
  }
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
      if (lab.position_law) {
        add(",%.8g", recording.input[row][i]);
      } else {
        if (lab.torque_column)
          add(",%.8g", recording.torque_nm[row][i] + lab.torque_noise * lab.rms_nm[i] * random.normal());
        if (lab.command_column) add(",%.8g", recording.input[row][i]);
      }
    }
    out += "\n";
  }
  return out;
}

}  // namespace furcula::hidden::trees
