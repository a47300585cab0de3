#include "tests/hidden/trees/cases.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace furcula::hidden::trees {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWindow_s = 0.3;
constexpr std::size_t kWindowsOfALog = 8;

// What the robot of the model does: rows of a few recordings without disturbance.
struct Baseline {
  std::vector<Values> q, v, a, torque, input;
  std::vector<Values> input_rate;  // over the row, zero across recordings
  Values rms_torque{}, rms_v{}, rms_vv{}, rms_a{}, rms_input_rate{}, low{}, high{};
};

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

/// A robot, its laboratory and what it does without causes.
struct Stage {
  Case c;
  Baseline base;
  std::vector<Experiment> experiments;
  Values inertia{};  // that each joint moves alone, rotor included
};

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

bool in(const std::vector<std::string>& list, const std::string& x) {
  return std::find(list.begin(), list.end(), x) != list.end();
}

bool wants(const Question& q, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* x) { return in(q.effects, x); });
}

// A robot that its drives can move. Nothing if the draw does not.
std::optional<Stage> draw_stage(const Question& question, Random& random) {
  Stage out;
  Case& c = out.c;
  c.question = question;
  c.robot = draw_robot(random, question.joints);
  const std::size_t n = c.robot.size();
  Lab& lab = c.lab;
  // Where the drive closes its loop on the joint's angle, a gain is a gain of its law, and a spring swings.
  const bool torque_only = wants(question, {"joint_elasticity", "torque_gain_error", "torque_crosstalk"});
  lab.position_law = wants(question, {"position_gain_error"}) || (!torque_only && random.chance(0.35));
  if (lab.position_law && torque_only) return std::nullopt;

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
    const double w = 2 * kPi * (lab.position_law ? random.uniform(3.0, 6.0) : random.uniform(1.2, 2.5));
    const double zeta = random.uniform(0.5, 0.9);
    const double kp = std::max(inertia * w * w, lab.position_law ? std::fabs(gravity[j]) / 0.25 : 0.0);
    const double kd = 2 * zeta * std::sqrt(kp * inertia);
    const auto rounded = [](double x) {
      const double step = std::pow(10.0, std::floor(std::log10(x)) - 1);
      return step * std::round(x / step);
    };
    if (lab.position_law) {
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

bool on_link(const std::string& effect) { return family(effect) == "mass" || effect == "resonator"; }

class Planter {
 public:
  Planter(const Stage& stage, Random& random) : stage_(stage), c_(stage.c), base_(stage.base), r_(random) {}

  // An effect at a seat that is free of `others`, of a share of the rms torque. Nothing where it cannot be.
  std::optional<Cause> propose(const std::string& effect, double share, bool tied,
                               const std::vector<Cause>& others) {
    Cause cause{effect, {}, {}};
    if (effect == "base_tilt") {
      for (const Cause& o : others)
        if (family(o.effect) == "offset") return std::nullopt;
      cause.at = {"base"};
      const double angle = r_.uniform(0, 2 * kPi);
      return scaled(share, 0.3, [&](double x) {
        Cause out = cause;
        out.parameters = {{"roll_rad", x * std::cos(angle)}, {"pitch_rad", x * std::sin(angle)}};
        return out;
      });
    }
    if (on_link(effect)) return on_a_link(cause, share, others);

    // Joints that move enough and are turned.
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < c_.robot.size(); ++j) {
      if (c_.robot.joints[j].prismatic || base_.high[j] - base_.low[j] < 0.2) continue;
      const bool own_friction = c_.drives[j].friction_nm > 0 && family(effect) == "friction";
      const bool taken = std::any_of(others.begin(), others.end(), [&](const Cause& o) {
        return in(o.at, c_.robot.joints[j].name) && family(o.effect) == family(effect);
      });
      if (!own_friction && !taken) joints.push_back(j);
    }
    if (joints.size() < (tied ? 2U : 1U)) return std::nullopt;
    for (std::size_t i = joints.size(); i-- > 1;)
      std::swap(joints[i], joints[static_cast<std::size_t>(r_.uniform(0, static_cast<double>(i + 1)))]);
    std::size_t count = 1;
    if (tied) count = r_.chance(0.5) ? joints.size() : 2;
    joints.resize(count);
    // One value for all would be far too much for the weakest of joints that differ.
    const auto [weak, strong] = std::minmax_element(joints.begin(), joints.end(), [&](auto a, auto b) {
      return base_.rms_torque[a] / base_.rms_v[a] < base_.rms_torque[b] / base_.rms_v[b];
    });
    const double spread =
        (base_.rms_torque[*strong] / base_.rms_v[*strong]) / (base_.rms_torque[*weak] / base_.rms_v[*weak]);
    const bool by_size =
        effect == "coulomb_friction" || effect == "damping_error" || effect == "quadratic_drag";
    if (by_size && spread > 4) return std::nullopt;
    std::sort(joints.begin(), joints.end());
    for (std::size_t j : joints) cause.at.push_back(c_.robot.joints[j].name);
    if (effect == "encoder_offset") {
      const double s = r_.sign();
      return scaled(share, 0.35, [&](double x) {
        Cause out = cause;
        out.parameters = {{"offset_rad", s * x}};
        return out;
      });
    }
    if (!at_joints(cause, joints, share)) return std::nullopt;
    return cause;
  }

 private:
  double mean(const std::vector<std::size_t>& joints, const Values& of) const {
    double sum = 0.0;
    for (std::size_t j : joints) sum += std::log(std::max(of[j], 1e-9));
    return std::exp(sum / static_cast<double>(joints.size()));
  }

  bool at_joints(Cause& cause, const std::vector<std::size_t>& joints, double share) {
    const std::size_t j = joints.front();
    const std::string& e = cause.effect;
    const double torque = share * mean(joints, base_.rms_torque);
    const double v = mean(joints, base_.rms_v);
    const bool position = c_.lab.position_law;
    auto& p = cause.parameters;
    if (e == "coulomb_friction") {
      p["torque_nm"] = torque;
    } else if (e == "stribeck_friction") {
      p["torque_nm"] = 0.7 * torque;
      p["static_torque_nm"] = 0.7 * torque * r_.uniform(1.6, 2.6);
      p["velocity_radps"] = v * r_.uniform(0.15, 0.5);
    } else if (e == "asymmetric_friction") {
      const bool up = r_.chance(0.5);
      p["torque_up_nm"] = torque * (up ? 1.4 : 0.5);
      p["torque_down_nm"] = torque * (up ? 0.5 : 1.4);
    } else if (e == "damping_error") {
      p["damping_nmspr"] = c_.drives[j].damping_nmspr + torque / v;
      // One value at all: only where the model's values are near to one.
      if (joints.size() > 1) p["damping_nmspr"] = mean(joints, dampings()) + torque / v;
    } else if (e == "quadratic_drag") {
      p["drag_nms2prad2"] = torque / mean(joints, base_.rms_vv);
    } else if (e == "binding_spot") {
      const double range = base_.high[j] - base_.low[j];
      p["width_rad"] = range * r_.uniform(0.2, 0.4);
      p["centre_rad"] = base_.low[j] + range * r_.uniform(0.35, 0.65);
      p["torque_nm"] = 1.6 * torque;
    } else if (e == "load_friction") {
      p["ratio"] = std::min(share, 0.5);
    } else if (e == "force_offset") {
      p["torque_nm"] = r_.sign() * torque;
    } else if (e == "rotor_inertia_error") {
      p["inertia_kgm2"] = c_.drives[j].rotor_kgm2 + torque / base_.rms_a[j];
    } else if (e == "torque_gain_error") {
      p["gain"] = 1 + r_.sign() * share;
    } else if (e == "actuator_delay" || e == "actuator_lag") {
      double rate = mean(joints, base_.rms_input_rate);
      if (position) rate *= c_.drives[j].kp_nmprad;
      const double seconds = torque / rate;
      if (seconds < 0.0015 || seconds > 0.08) return false;
      p[e == "actuator_delay" ? "delay_s" : "time_constant_s"] = seconds;
    } else if (e == "torque_saturation") {
      std::vector<double> sizes;
      for (const Values& row : base_.torque) sizes.push_back(std::fabs(row[j]));
      double low = 0.0, high = *std::max_element(sizes.begin(), sizes.end());
      for (int i = 0; i < 40; ++i) {
        const double limit = (low + high) / 2;
        double sum = 0.0;
        for (double x : sizes) sum += x > limit ? (x - limit) * (x - limit) : 0.0;
        (std::sqrt(sum / static_cast<double>(sizes.size())) > torque ? low : high) = limit;
      }
      p["limit_nm"] = high;
    } else if (e == "position_gain_error") {
      if (!position) return false;
      p["kp_nmprad"] = c_.drives[j].kp_nmprad * (1 + r_.sign() * share * r_.uniform(0.7, 1.0));
      p["kd_nmsprad"] = c_.drives[j].kd_nmsprad * (1 + r_.sign() * share * r_.uniform(0.5, 1.0));
    } else if (e == "joint_elasticity") {
      if (position || c_.drives[j].rotor_kgm2 <= 0) return false;
      // A soft spring changes more. Against all that the joint moves: 40 Hz at a share of 1 %, 7 Hz at 32 %.
      const double hz = 4.0 / std::sqrt(share);
      p["stiffness_nmprad"] = stage_.inertia[j] * (2 * kPi * hz) * (2 * kPi * hz);
    } else if (e == "torque_ripple") {
      const double turns = (base_.high[j] - base_.low[j]) / (2 * kPi);
      p["cycles_per_rev"] = std::ceil(r_.uniform(2.0, 6.0) / turns);
      p["amplitude_nm"] = 1.4 * torque;
      p["phase_rad"] = r_.uniform(0, 2 * kPi);
    } else if (e == "cable_spring") {
      const double centre = (base_.low[j] + base_.high[j]) / 2 + r_.uniform(-0.2, 0.2);
      double sum = 0.0;
      for (const Values& row : base_.q) sum += std::pow(row[j] - centre, 6);
      p["centre_rad"] = centre;
      p["stiffness_nmprad3"] = torque / std::sqrt(sum / static_cast<double>(base_.q.size()));
    } else if (e == "growing_friction") {
      p["growth_nmps"] = 2 * torque / stage_.experiments.front().duration_s;
    } else if (e == "coupled_friction") {
      std::size_t other = (j + 1) % c_.robot.size();
      p["other"] = static_cast<double>(other);
      p["torque_nm"] = torque;
    } else if (e == "torque_crosstalk") {
      const std::size_t talker = (j + 1) % c_.robot.size();
      p["talker"] = static_cast<double>(talker);
      p["share"] = torque / base_.rms_torque[talker];
      if (p["share"] > 0.7) return false;
    } else if (e == "periodic_torque") {
      p["torque_nm"] = 1.4 * torque;
      p["frequency_hz"] = r_.uniform(1.5, 9.0);
    } else {
      throw std::invalid_argument("no effect " + e);
    }
    return true;
  }

  Values dampings() const {
    Values out{};
    for (std::size_t j = 0; j < c_.robot.size(); ++j) out[j] = c_.drives[j].damping_nmspr;
    return out;
  }

  // The largest share of a joint's rms torque that a change of masses, of gravity or of an encoder makes.
  double share_of(const Cause& cause) const {
    const Machine changed = c_.with({cause}), plain = c_.with({});
    std::vector<Values> differences;
    for (std::size_t row = 0; row < base_.q.size(); row += 5) {
      Values q = base_.q[row];
      for (std::size_t j = 0; j < c_.robot.size(); ++j) q[j] += changed.act(j).encoder_rad;
      Values d = changed.dynamics().torque(q, base_.v[row], base_.a[row]);
      const Values was = plain.dynamics().torque(base_.q[row], base_.v[row], base_.a[row]);
      for (std::size_t j = 0; j < c_.robot.size(); ++j) d[j] -= was[j];
      differences.push_back(d);
    }
    const Values rms = rms_of(differences);
    const double largest = *std::max_element(base_.rms_torque.begin(), base_.rms_torque.end());
    double share = 0.0;
    for (std::size_t j = 0; j < c_.robot.size(); ++j)
      share = std::max(share, rms[j] / std::max(base_.rms_torque[j], 0.1 * largest));
    return share;
  }

  // The cause of size x <= most whose share is the one asked for.
  std::optional<Cause> scaled(double share, double most, auto&& make) {
    double x = 0.05 * most;
    for (int i = 0; i < 4; ++i) {
      const double now = share_of(make(x));
      if (now <= 0) return std::nullopt;
      x *= share / now;
      if (!(x < 20 * most)) return std::nullopt;
    }
    if (x > most) return std::nullopt;
    return make(x);
  }

  std::optional<Cause> on_a_link(Cause cause, double share, const std::vector<Cause>& others) {
    std::vector<const Body*> links;
    for (const Body& b : c_.robot.bodies) {
      const bool carries = std::any_of(c_.robot.bodies.begin(), c_.robot.bodies.end(),
                                       [&](const Body& t) { return t.tool && t.joint == b.joint; });
      const bool taken = std::any_of(others.begin(), others.end(), [&](const Cause& o) {
        return in(o.at, b.name) && family(o.effect) == family(cause.effect);
      });
      if (!carries && !taken) links.push_back(&b);
    }
    if (links.empty()) return std::nullopt;
    const Body& b = cause.effect == "resonator"
                        ? *links.back()
                        : *links[static_cast<std::size_t>(r_.uniform(0, static_cast<double>(links.size())))];
    cause.at = {b.name};
    Vec3 direction{r_.normal(), r_.normal(), r_.normal()};
    direction = (1 / length(direction)) * direction;
    const double size = 2 * length(b.centre_m);
    const double sign = r_.sign();
    if (cause.effect == "mass_error")
      return scaled(share, sign > 0 ? 1.5 : 0.6, [&](double x) {
        Cause out = cause;
        out.parameters = {{"mass_kg", b.mass_kg * (1 + sign * x)}};
        return out;
      });
    if (cause.effect == "com_error")
      return scaled(share, std::max(0.8 * size, 0.03), [&](double x) {
        Cause out = cause;
        out.parameters = {{"offset_x_m", x * direction.x},
                          {"offset_y_m", x * direction.y},
                          {"offset_z_m", x * direction.z}};
        return out;
      });
    const Vec3 at = r_.uniform(1.2, 2.0) * b.centre_m + 0.2 * size * direction;
    if (cause.effect == "payload")
      return scaled(share, 1.5 * b.mass_kg, [&](double x) {
        Cause out = cause;
        out.parameters = {{"mass_kg", x}, {"x_m", at.x}, {"y_m", at.y}, {"z_m", at.z}};
        return out;
      });
    const double mass = b.mass_kg * r_.uniform(0.25, 0.5), w = 2 * kPi * r_.uniform(1.5, 5.0);
    cause.parameters = {{"mass_kg", mass},
                        {"x_m", at.x},
                        {"y_m", at.y},
                        {"z_m", at.z},
                        {"axis_x", direction.x},
                        {"axis_y", direction.y},
                        {"axis_z", direction.z},
                        {"stiffness_npm", mass * w * w},
                        {"damping_nspm", 0.1 * mass * w}};
    return cause;
  }

  const Stage& stage_;
  const Case& c_;
  const Baseline& base_;
  Random& r_;
};

std::pair<double, double> shares(Tier tier) {
  switch (tier) {
    case Tier::small:
      return {0.01, 0.03};
    case Tier::medium:
      return {0.05, 0.12};
    case Tier::tied:
    case Tier::pairs:
    case Tier::triple:
      return {0.08, 0.30};
    case Tier::clean:
    case Tier::large:
    case Tier::outside:
      break;
  }
  return {0.15, 0.40};
}

// What each cause changes, over what the disturbance does, at the joint where that is most.
std::vector<double> shown(const Case& c) {
  const Restarts restarts(c);
  const auto full = restarts.of(restarts.truth);
  const Values noise = rms_difference(full, restarts.happened);
  std::vector<double> out;
  for (std::size_t i = 0; i < c.planted.size(); ++i) {
    std::vector<Cause> others = c.planted;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Values changed = rms_difference(restarts.of(c.with(others)), full);
    double most = 0.0;
    for (std::size_t j = 0; j < c.visible(); ++j)
      most = std::max(most, changed[j] / std::max(noise[j], c.lab.resolution[j]));
    out.push_back(most);
  }
  return out;
}

// Records all experiments. False where the robot runs away, or swings on its own, which drives show first.
bool record_all(Stage& stage, const Random& random) {
  Case& c = stage.c;
  const Machine machine = c.truth();
  const Dynamics model(c.robot, {0, 0, -kGravity_mps2});
  c.logs.clear();
  Random own = random;
  std::vector<Values> torque;
  for (const Experiment& e : stage.experiments) {
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

// Limits that the robot keeps.
void set_limits(Case& c) {
  for (std::size_t j = 0; j < c.visible(); ++j) {
    Joint& joint = c.robot.joints[j];
    double low = joint.centre - joint.range, high = joint.centre + joint.range, speed = 0.0, torque = 0.0;
    for (const Recording& log : c.logs)
      for (std::size_t row = 0; row < log.state.size(); ++row) {
        low = std::min(low, log.state[row].q[j]);
        high = std::max(high, log.state[row].q[j]);
        speed = std::max(speed, std::fabs(log.state[row].v[j]));
        torque = std::max(torque, std::fabs(log.torque_nm[row][j]));
        if (!c.lab.position_law) torque = std::max(torque, std::fabs(log.input[row][j]));
      }
    const double beside = joint.prismatic ? 0.1 : 0.6;
    joint.lower = low - beside;
    joint.upper = high + beside;
    joint.velocity = std::ceil(2 * speed);
    joint.effort = std::ceil(2000 * torque) / 1000;
  }
}

}  // namespace

std::string_view name(Tier tier) {
  switch (tier) {
    case Tier::clean:
      return "clean";
    case Tier::small:
      return "small";
    case Tier::medium:
      return "medium";
    case Tier::large:
      return "large";
    case Tier::tied:
      return "tied";
    case Tier::pairs:
      return "pairs";
    case Tier::triple:
      return "triple";
    case Tier::outside:
      break;
  }
  return "outside";
}

const std::vector<std::string>& catalogue() {
  static const std::vector<std::string> kEffects = {"coulomb_friction",
                                                    "stribeck_friction",
                                                    "asymmetric_friction",
                                                    "damping_error",
                                                    "quadratic_drag",
                                                    "binding_spot",
                                                    "load_friction",
                                                    "force_offset",
                                                    "rotor_inertia_error",
                                                    "torque_gain_error",
                                                    "actuator_delay",
                                                    "actuator_lag",
                                                    "torque_saturation",
                                                    "position_gain_error",
                                                    "joint_elasticity",
                                                    "torque_ripple",
                                                    "encoder_offset",
                                                    "mass_error",
                                                    "com_error",
                                                    "payload",
                                                    "base_tilt"};
  return kEffects;
}

const std::vector<std::string>& outside_causes() {
  static const std::vector<std::string> kCauses = {"cable_spring",     "growing_friction", "coupled_friction",
                                                   "torque_crosstalk", "periodic_torque",  "resonator"};
  return kCauses;
}

std::string family(const std::string& effect) {
  if (effect.find("friction") != std::string::npos || effect == "binding_spot") return "friction";
  if (effect == "damping_error" || effect == "quadratic_drag") return "viscous";
  if (effect == "actuator_delay" || effect == "actuator_lag") return "timing";
  if (effect == "mass_error" || effect == "com_error" || effect == "payload") return "mass";
  if (effect == "force_offset" || effect == "encoder_offset" || effect == "base_tilt") return "offset";
  return effect;
}

Restarts::Restarts(const Case& of_case) : c(of_case), truth(of_case.truth()) {
  const auto length = static_cast<std::size_t>(kWindow_s * c.lab.rate_hz);
  for (std::size_t i = c.logs.size() - c.held_out; i < c.logs.size(); ++i) {
    const Recording& log = c.logs[i];
    const std::size_t rows = log.time_s.size() - 1, stride = std::max(length, rows / kWindowsOfALog);
    // The first rows have no past that a delay could reach for.
    for (std::size_t begin = length / 2; begin + length <= rows; begin += stride) {
      windows.push_back({i, begin, begin + length});
      std::vector<Values> seen;
      for (std::size_t row = begin + 1; row <= begin + length; ++row) {
        Values q = log.state[row].q;
        for (std::size_t j = 0; j < c.visible(); ++j) q[j] += truth.act(j).encoder_rad;
        seen.push_back(q);
      }
      happened.push_back(seen);
    }
  }
}

std::vector<std::vector<Values>> Restarts::of(const Machine& machine) const {
  std::vector<std::vector<Values>> out;
  for (const Window& w : windows) out.push_back(restarted(machine, truth, c.logs[w.log], w.begin, w.end));
  return out;
}

Values rms_difference(const std::vector<std::vector<Values>>& a, const std::vector<std::vector<Values>>& b) {
  std::vector<Values> differences;
  for (std::size_t w = 0; w < a.size(); ++w)
    for (std::size_t row = 0; row < a[w].size(); ++row) {
      Values d{};
      for (std::size_t j = 0; j < kMost; ++j) d[j] = a[w][row][j] - b[w][row][j];
      differences.push_back(d);
    }
  return rms_of(differences);
}

Case draw_case(const Question& question) {
  for (std::uint64_t attempt = 0; attempt < 60; ++attempt) {
    Random random(question.seed * 0x9E3779B97F4A7C15U + attempt * 0x632BE59BD9B4E019U +
                  static_cast<std::uint64_t>(question.tier));
    auto stage = draw_stage(question, random);
    if (!stage) continue;
    const auto [least, most] = shares(question.tier);
    const double must_show = question.tier == Tier::small ? 0.5 : 2.0;
    // Other seats and larger shares, until each cause shows.
    double boost = 1.0;
    for (int tries = 0; tries < 6; ++tries) {
      stage->c.planted.clear();
      Planter planter(*stage, random);
      bool complete = true;
      for (const std::string& effect : question.effects) {
        const double share = std::min(boost * random.log_uniform(least, most), most);
        auto cause = planter.propose(effect, share, question.tier == Tier::tied, stage->c.planted);
        complete = complete && cause.has_value();
        if (cause) stage->c.planted.push_back(*cause);
      }
      if (!complete || !record_all(*stage, random)) continue;
      Case& c = stage->c;
      c.shows = shown(c);
      boost *= 1.6;
      if (std::any_of(c.shows.begin(), c.shows.end(), [&](double x) { return x < must_show; })) continue;
      set_limits(c);
      c.model = c.drives;
      if (c.free_damping)
        for (DriveData& d : c.model) d.damping_nmspr *= random.uniform(0.5, 1.5);
      return c;
    }
  }
  throw std::runtime_error("no robot on which this shows");
}

std::vector<std::string> write_case(const Case& c, const std::string& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/robot.urdf") << urdf_of(c.robot, c.visible());

  char line[200];
  std::string toml =
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\nbase = \"fixed\"\njoints = [";
  for (std::size_t j = 0; j < c.visible(); ++j)
    toml += (j > 0 ? ", \"" : "\"") + c.robot.joints[j].name + "\"";
  toml += "]\ngravity_mps2 = [0.0, 0.0, -9.81]\n\n[drive]\nlaw = \"";
  toml += c.lab.position_law ? "position\"\n" : "torque\"\n";
  const auto key = [&](const std::string& label, double value) {
    std::snprintf(line, sizeof line, "%s = %#.10g\n", label.c_str(), value);
    toml += line;
  };
  for (std::size_t j = 0; j < c.visible(); ++j) {
    const DriveData& d = c.model[j];
    toml += "\n[drive." + c.robot.joints[j].name + "]\n";
    if (c.lab.position_law) {
      key("kp_nmprad", d.kp_nmprad);
      key("kd_nmsprad", d.kd_nmsprad);
    }
    key("rotor_inertia_kgm2", d.rotor_kgm2);
    key("damping_nmspr", d.damping_nmspr);
  }
  if (c.free_damping) {
    toml += "\n[free]\n";
    for (std::size_t j = 0; j < c.visible(); ++j) {
      std::snprintf(line, sizeof line, "\"damping_nmspr.%s\" = [0.0, %#.4g]\n",
                    c.robot.joints[j].name.c_str(), 5 * c.model[j].damping_nmspr);
      toml += line;
    }
  }
  for (std::size_t j = 0; j < c.visible(); ++j)
    if (c.model[j].friction_nm > 0) {
      toml += "\n[effect.coulomb_friction." + c.robot.joints[j].name + "]\n";
      key("torque_nm", c.model[j].friction_nm);
    }
  std::ofstream(folder + "/model.toml") << toml;

  const Machine truth = c.truth();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < c.logs.size(); ++i) {
    std::snprintf(line, sizeof line, "log_%02zu.csv", i);
    names.emplace_back(line);
    std::ofstream(folder + "/" + line)
        << log_of(truth, c.lab, c.logs[i], c.visible(), Random(c.question.seed * 1000 + i));
  }

  nlohmann::ordered_json json;
  json["tier"] = name(c.question.tier);
  json["seed"] = c.question.seed;
  json["form"] = c.robot.form;
  json["law"] = c.lab.position_law ? "position" : "torque";
  json["rate_hz"] = c.lab.rate_hz;
  json["jitter"] = c.lab.jitter;
  json["free_damping"] = c.free_damping;
  json["held_out"] =
      std::vector<std::string>(names.end() - static_cast<std::ptrdiff_t>(c.held_out), names.end());
  json["planted"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < c.planted.size(); ++i)
    json["planted"].push_back({{"effect", c.planted[i].effect},
                               {"at", c.planted[i].at},
                               {"parameters", c.planted[i].parameters},
                               {"shows", c.shows[i]}});
  for (std::size_t j = 0; j < c.visible(); ++j) {
    json["true_damping_nmspr"][c.robot.joints[j].name] = c.drives[j].damping_nmspr;
    json["rms_torque_nm"][c.robot.joints[j].name] = c.lab.rms_nm[j];
    json["disturbance_nm"][c.robot.joints[j].name] = c.lab.disturbance_nm[j];
  }
  std::ofstream(folder + "/truth.json") << json.dump(2) << "\n";
  return names;
}

}  // namespace furcula::hidden::trees
