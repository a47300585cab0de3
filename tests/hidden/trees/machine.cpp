#include "tests/hidden/trees/machine.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace furcula::hidden::trees {
namespace {

double value_of(const Cause& c, const std::string& name) {
  const auto found = c.parameters.find(name);
  if (found == c.parameters.end()) throw std::invalid_argument(c.effect + ": no parameter " + name);
  return found->second;
}

double value_or_zero(const Cause& c, const std::string& name) {
  const auto found = c.parameters.find(name);
  return found == c.parameters.end() ? 0.0 : found->second;
}

Body* body_named(Robot& robot, const std::string& name) {
  for (Body& b : robot.bodies)
    if (b.name == name) return &b;
  return nullptr;
}

}  // namespace

std::string linear_name(const std::string& rotary) {
  static const std::map<std::string, std::string> kNames = {{"torque_nm", "force_n"},
                                                            {"static_torque_nm", "static_force_n"},
                                                            {"velocity_radps", "velocity_mps"},
                                                            {"torque_up_nm", "force_up_n"},
                                                            {"torque_down_nm", "force_down_n"},
                                                            {"damping_nmspr", "damping_nspm"},
                                                            {"drag_nms2prad2", "drag_ns2pm2"},
                                                            {"centre_rad", "centre_m"},
                                                            {"width_rad", "width_m"},
                                                            {"inertia_kgm2", "mass_kg"},
                                                            {"limit_nm", "limit_n"},
                                                            {"offset_rad", "offset_m"}};
  const auto found = kNames.find(rotary);
  return found == kNames.end() ? rotary : found->second;
}

Machine::Machine(const Robot& robot, const std::vector<DriveData>& drives, bool position_control,
                 const std::vector<Cause>& causes)
    : robot_(robot), position_law_(position_control), dynamics_(robot, gravity_) {
  for (std::size_t j = 0; j < robot.size(); ++j) {
    Act a;
    if (j < drives.size()) a.drive = drives[j];
    a.up_nm = a.down_nm = a.drive.friction_nm;
    acts_.push_back(a);
  }
  for (const Cause& c : causes) plant(c);
  dynamics_ = Dynamics(robot_, gravity_);
  any_dry_ = std::any_of(acts_.begin(), acts_.end(), [](const Act& a) { return a.dry(); });
}

std::size_t Machine::joint_named(const std::string& name) const {
  for (std::size_t j = 0; j < robot_.size(); ++j)
    if (robot_.joints[j].name == name) return j;
  throw std::invalid_argument("no joint " + name);
}

// False: of a law that is no leg's.
bool Machine::plant_in_leg(const Cause& c, const std::string& at) {
  const bool on_length = c.effect == "length_error";
  const bool on_switch =
      c.effect == "latch_delay" || c.effect == "latch_offset" || c.effect == "second_spring";
  if (!on_length && !on_switch && c.effect != "spring_rate_error") return false;
  if (!robot_.leg) throw std::invalid_argument(c.effect + ": no leg");
  Leg& leg = *robot_.leg;
  Joint& knee = robot_.joints[leg.knee];
  if (on_length) {
    const auto longer = [&](Vec3 x) { return (1.0 + value_of(c, "extension_m") / length(x)) * x; };
    const Body* b = body_named(robot_, at);
    if (b != nullptr && b->name == leg.link)
      leg.toe_m = longer(leg.toe_m);
    else if (b != nullptr && b->joint == knee.parent)
      knee.at = longer(knee.at);
    else
      throw std::invalid_argument(c.effect + ": not at " + at);
    return true;
  }
  if (at != knee.name) throw std::invalid_argument(c.effect + ": not at " + at);
  if (on_switch && !leg.switched) throw std::invalid_argument(c.effect + ": a spring without a switch");
  if (c.effect == "spring_rate_error")
    leg.spring_nmprad = value_of(c, "stiffness_nmprad");
  else if (c.effect == "latch_delay")
    switch_.delay_s = value_of(c, "delay_s");
  else if (c.effect == "latch_offset")
    switch_.offset_rad = value_of(c, "offset_rad");
  else
    switch_.second_nm = value_of(c, "torque_nm");
  return true;
}

void Machine::plant(const Cause& c) {
  bool sliding = false;
  const auto p = [&](const char* name) { return value_of(c, sliding ? linear_name(name) : name); };
  if (c.effect == "base_tilt") {
    gravity_ = transposed(turn_of({p("roll_rad"), p("pitch_rad"), 0})) * gravity_;
    return;
  }
  for (const std::string& at : c.at) {
    if (plant_in_leg(c, at)) continue;
    if (c.effect == "mass_error" || c.effect == "inertia_error" || c.effect == "com_error" ||
        c.effect == "payload") {
      Body* b = body_named(robot_, at);
      if (b == nullptr) throw std::invalid_argument("no link " + at);
      if (c.effect == "mass_error") {
        b->moments = (p("mass_kg") / b->mass_kg) * b->moments;
        b->mass_kg = p("mass_kg");
      } else if (c.effect == "inertia_error") {
        b->moments = p("scale") * b->moments;
      } else if (c.effect == "com_error") {
        b->centre_m = b->centre_m + Vec3{value_or_zero(c, "offset_x_m"), value_or_zero(c, "offset_y_m"),
                                         value_or_zero(c, "offset_z_m")};
      } else {
        b->point_kg = p("mass_kg");
        b->point_m = {value_or_zero(c, "x_m"), value_or_zero(c, "y_m"), value_or_zero(c, "z_m")};
      }
      continue;
    }
    if (c.effect == "resonator") {
      // A mass that the link gives away slides on it, along an axis of the link, on a spring.
      Body* b = body_named(robot_, at);
      if (b == nullptr) throw std::invalid_argument("no link " + at);
      b->mass_kg -= p("mass_kg");
      Joint slide;
      slide.name = "resonator";
      slide.parent = b->joint;
      slide.at = {p("x_m"), p("y_m"), p("z_m")};
      slide.axis = {p("axis_x"), p("axis_y"), p("axis_z")};
      slide.prismatic = true;
      Body mass;
      mass.name = "resonator";
      mass.joint = static_cast<int>(robot_.size());
      mass.mass_kg = p("mass_kg");
      mass.moments = {1e-7, 1e-7, 1e-7};
      robot_.joints.push_back(slide);
      robot_.bodies.push_back(mass);
      Act a;
      a.linear_npm = p("stiffness_npm");
      a.linear_nspm = p("damping_nspm");
      acts_.push_back(a);
      continue;
    }
    const std::size_t joint = joint_named(at);
    sliding = robot_.joints[joint].prismatic;
    Act& a = acts_[joint];
    if (c.effect == "coulomb_friction") {
      // The model's own friction, where there is one, has this value then.
      a.up_nm = a.down_nm = p("torque_nm");
    } else if (c.effect == "stribeck_friction") {
      a.up_nm += p("torque_nm");
      a.down_nm += p("torque_nm");
      a.static_extra_nm = p("static_torque_nm") - p("torque_nm");
      a.stribeck_radps = p("velocity_radps");
    } else if (c.effect == "asymmetric_friction") {
      a.up_nm += p("torque_up_nm");
      a.down_nm += p("torque_down_nm");
    } else if (c.effect == "damping_error") {
      a.drive.damping_nmspr = p("damping_nmspr");
    } else if (c.effect == "quadratic_drag") {
      a.drag = p("drag_nms2prad2");
    } else if (c.effect == "binding_spot") {
      a.binding_nm = p("torque_nm");
      a.binding_centre_rad = p("centre_rad");
      a.binding_width_rad = p("width_rad");
    } else if (c.effect == "load_friction") {
      a.load_ratio = p("ratio");
    } else if (c.effect == "force_offset") {
      a.offset_nm = p("torque_nm");
    } else if (c.effect == "rotor_inertia_error") {
      a.drive.rotor_kgm2 = p("inertia_kgm2");
    } else if (c.effect == "torque_gain_error") {
      a.gain = p("gain");
    } else if (c.effect == "actuator_delay") {
      a.delay_s = p("delay_s");
    } else if (c.effect == "actuator_lag") {
      a.lag_s = p("time_constant_s");
    } else if (c.effect == "torque_saturation") {
      a.limit_nm = p("limit_nm");
    } else if (c.effect == "position_gain_error") {
      a.drive.kp_nmprad = p("kp_nmprad");
      a.drive.kd_nmsprad = p("kd_nmsprad");
    } else if (c.effect == "joint_elasticity") {
      a.spring_nmprad = p("stiffness_nmprad");
    } else if (c.effect == "torque_ripple") {
      a.ripple_nm = p("amplitude_nm");
      a.cycles = p("cycles_per_rev");
      a.phase_rad = p("phase_rad");
    } else if (c.effect == "encoder_offset") {
      a.encoder_rad = p("offset_rad");
    } else if (c.effect == "cable_spring") {
      a.cubic_nmprad3 = p("stiffness_nmprad3");
      a.cubic_centre_rad = p("centre_rad");
    } else if (c.effect == "growing_friction") {
      a.growth_nmps = p("growth_nmps");
    } else if (c.effect == "coupled_friction") {
      a.other_nm = p("torque_nm");
      a.other = static_cast<std::size_t>(p("other"));
    } else if (c.effect == "torque_crosstalk") {
      a.crosstalk = p("share");
      a.talker = static_cast<std::size_t>(p("talker"));
    } else if (c.effect == "periodic_torque") {
      a.periodic_nm = p("torque_nm");
      a.periodic_hz = p("frequency_hz");
    } else {
      throw std::invalid_argument("no effect " + c.effect);
    }
    if (a.spring_nmprad > 0 && a.drive.rotor_kgm2 <= 0)
      throw std::invalid_argument(at + ": a spring before a rotor of no inertia");
  }
}

double Machine::raw_torque(std::size_t j, const State& s, double input) const {
  const Act& a = acts_[j];
  const double raw = position_law_
                         ? a.drive.kp_nmprad * (input - s.q[j] - a.encoder_rad) - a.drive.kd_nmsprad * s.v[j]
                         : input;
  return a.limit_nm > 0 ? std::clamp(raw, -a.limit_nm, a.limit_nm) : raw;
}

double Machine::motor_torque(std::size_t j, const State& s, double input) const {
  return acts_[j].lag_s > 0 ? s.lag[j] : raw_torque(j, s, input);
}

Values Machine::drive_torque(const State& s, const Values& input) const {
  Values out{};
  for (std::size_t j = 0; j < size(); ++j) out[j] = motor_torque(j, s, input[j]);
  return out;
}

Values Machine::delivered(const State& s, const Values& input) const {
  Values out{};
  for (std::size_t j = 0; j < size(); ++j) {
    const Act& a = acts_[j];
    out[j] = a.gain * motor_torque(j, s, input[j]);
    if (a.ripple_nm != 0) out[j] += a.ripple_nm * std::sin(a.cycles * s.q[j] + a.phase_rad);
  }
  return out;
}

double Machine::level(std::size_t j, const State& s, double t, double torque, int direction) const {
  const Act& a = acts_[j];
  double sum = direction > 0 ? a.up_nm : a.down_nm;
  if (a.static_extra_nm != 0) {
    const double x = s.v[j] / a.stribeck_radps;
    sum += a.static_extra_nm * std::exp(-x * x);
  }
  // The joint's bearing carries what reaches it: of a drive behind a spring, the spring's torque.
  const double load = a.spring_nmprad > 0 ? a.spring_nmprad * (s.rotor[j] - s.q[j]) : torque;
  sum += a.load_ratio * std::fabs(load);
  if (a.binding_nm > 0 && 2 * std::fabs(s.q[j] - a.binding_centre_rad) <= a.binding_width_rad)
    sum += a.binding_nm;
  sum += a.growth_nmps * t;
  if (a.other_nm > 0) sum += a.other_nm * (1.0 + std::sin(3.0 * s.q[a.other]));
  return sum;
}

Values Machine::smooth_torque(const State& s, double t, const Values& torque,
                              const Values& disturbance) const {
  Values out{};
  for (std::size_t j = 0; j < size(); ++j) {
    const Act& a = acts_[j];
    double sum = a.spring_nmprad > 0 ? a.spring_nmprad * (s.rotor[j] - s.q[j])
                                     : torque[j] - a.drive.damping_nmspr * s.v[j];
    sum += a.offset_nm + disturbance[j] - a.drag * s.v[j] * std::fabs(s.v[j]);
    sum -= a.linear_npm * s.q[j] + a.linear_nspm * s.v[j];
    if (a.cubic_nmprad3 != 0) {
      const double x = s.q[j] - a.cubic_centre_rad;
      sum -= a.cubic_nmprad3 * x * x * x;
    }
    if (a.crosstalk != 0) sum += a.crosstalk * torque[a.talker];
    if (a.periodic_nm != 0) sum += a.periodic_nm * std::sin(2 * std::numbers::pi * a.periodic_hz * t);
    if (robot_.leg && robot_.leg->knee == j) sum += knee_torque(s);
    out[j] = sum;
  }
  return out;
}

void Machine::mass_and_bias(const State& s, Matrix& mass, Values& bias) const {
  dynamics_.evaluate(s.q, s.v, mass, bias);
  for (std::size_t j = 0; j < size(); ++j)
    if (acts_[j].spring_nmprad <= 0) mass[j][j] += acts_[j].drive.rotor_kgm2;
}

Machine::Rates Machine::rates(const State& s, double t, const Values& input, const Values& disturbance,
                              const Modes& modes) const {
  Rates out;
  const Values torque = delivered(s, input);
  Values rhs = smooth_torque(s, t, torque, disturbance);
  Matrix mass;
  Values bias{};
  mass_and_bias(s, mass, bias);
  for (std::size_t j = 0; j < size(); ++j) {
    const Act& a = acts_[j];
    if (a.lag_s > 0) out.lag[j] = (raw_torque(j, s, input[j]) - s.lag[j]) / a.lag_s;
    if (a.spring_nmprad > 0)
      out.rotor[j] =
          (torque[j] - a.drive.damping_nmspr * s.rotor_v[j] - a.spring_nmprad * (s.rotor[j] - s.q[j])) /
          a.drive.rotor_kgm2;
    rhs[j] -= bias[j];
    if (modes[j] == Mode::forth) rhs[j] -= level(j, s, t, torque[j], 1);
    if (modes[j] == Mode::back) rhs[j] += level(j, s, t, torque[j], -1);
  }
  for (std::size_t j = 0; j < size(); ++j) {
    if (modes[j] != Mode::held) continue;
    for (std::size_t k = 0; k < size(); ++k) mass[j][k] = mass[k][j] = 0.0;
    mass[j][j] = 1.0;
    rhs[j] = 0.0;
  }
  Pair drift;
  const Pinned::Solution solution = pinned(mass, s, modes, drift).solve(rhs, drift);
  out.a = solution.a;
  out.force = solution.force;
  return out;
}

Machine::Modes Machine::modes(const State& s, double t, const Values& input,
                              const Values& disturbance) const {
  Modes out{};
  out.fill(Mode::free);
  if (!any_dry_) return out;
  std::vector<std::size_t> resting;
  for (std::size_t j = 0; j < size(); ++j) {
    if (!acts_[j].dry()) continue;
    if (s.v[j] != 0.0)
      out[j] = s.v[j] > 0 ? Mode::forth : Mode::back;
    else
      resting.push_back(j);
  }
  if (resting.empty()) return out;

  // Accelerations without friction at the resting joints, and what friction there adds to them.
  const Values torque = delivered(s, input);
  Values rhs = smooth_torque(s, t, torque, disturbance);
  Matrix mass;
  Values bias{};
  mass_and_bias(s, mass, bias);
  for (std::size_t j = 0; j < size(); ++j) {
    rhs[j] -= bias[j];
    if (out[j] == Mode::forth) rhs[j] -= level(j, s, t, torque[j], 1);
    if (out[j] == Mode::back) rhs[j] += level(j, s, t, torque[j], -1);
  }
  // Beside a binding spot there may be none at all: such a joint is free to go either way.
  std::erase_if(resting, [&](std::size_t j) {
    return level(j, s, t, torque[j], 1) <= 0.0 && level(j, s, t, torque[j], -1) <= 0.0;
  });
  Pair drift;
  const Pinned solver = pinned(mass, s, out, drift);
  Values a = solver.solve(rhs, drift).a;
  Matrix response{};
  for (std::size_t j : resting) {
    Values unit{};
    unit[j] = 1.0;
    response[j] = solver.solve(unit, {}).a;
  }
  // A joint that the toe's stand leaves no way to move takes no friction.
  std::erase_if(resting, [&](std::size_t j) { return response[j][j] < 1e-9; });
  Values friction{};
  for (int sweep = 0; sweep < 1000; ++sweep) {
    double moved = 0.0;
    for (std::size_t j : resting) {
      const double next = std::clamp(friction[j] - a[j] / response[j][j], -level(j, s, t, torque[j], 1),
                                     level(j, s, t, torque[j], -1));
      const double change = next - friction[j];
      friction[j] = next;
      for (std::size_t k = 0; k < size(); ++k) a[k] += change * response[j][k];
      moved = std::max(moved, std::fabs(change * response[j][j]));
    }
    if (moved < 1e-11) break;
  }
  for (std::size_t j : resting) {
    if (friction[j] <= -level(j, s, t, torque[j], 1))
      out[j] = Mode::forth;
    else if (friction[j] >= level(j, s, t, torque[j], -1))
      out[j] = Mode::back;
    else
      out[j] = Mode::held;
  }
  return out;
}

State Machine::stepped(const State& s, double t, double h, const Values& input, const Values& disturbance,
                       const Modes& modes) const {
  const std::size_t n = size();
  const auto moved = [&](const State& speed, const Rates& r, double by) {
    State out = s;
    for (std::size_t j = 0; j < n; ++j) {
      out.q[j] += by * speed.v[j];
      out.v[j] += by * r.a[j];
      out.lag[j] += by * r.lag[j];
      out.rotor[j] += by * speed.rotor_v[j];
      out.rotor_v[j] += by * r.rotor[j];
    }
    return out;
  };
  const Rates r1 = rates(s, t, input, disturbance, modes);
  const State s2 = moved(s, r1, h / 2);
  const Rates r2 = rates(s2, t + h / 2, input, disturbance, modes);
  const State s3 = moved(s2, r2, h / 2);
  const Rates r3 = rates(s3, t + h / 2, input, disturbance, modes);
  const State s4 = moved(s3, r3, h);
  const Rates r4 = rates(s4, t + h, input, disturbance, modes);
  State out = s;
  const auto mean = [h](double a, double b, double c, double d) { return h / 6 * (a + 2 * b + 2 * c + d); };
  for (std::size_t j = 0; j < n; ++j) {
    out.q[j] += mean(s.v[j], s2.v[j], s3.v[j], s4.v[j]);
    out.v[j] += mean(r1.a[j], r2.a[j], r3.a[j], r4.a[j]);
    out.lag[j] += mean(r1.lag[j], r2.lag[j], r3.lag[j], r4.lag[j]);
    out.rotor[j] += mean(s.rotor_v[j], s2.rotor_v[j], s3.rotor_v[j], s4.rotor_v[j]);
    out.rotor_v[j] += mean(r1.rotor[j], r2.rotor[j], r3.rotor[j], r4.rotor[j]);
    if (modes[j] == Mode::held) {
      out.q[j] = s.q[j];
      out.v[j] = 0.0;
    }
  }
  return out;
}

double Machine::step(State& s, double t, double h, const Values& input, const Values& disturbance) const {
  const Modes m = modes(s, t, input, disturbance);
  State next = stepped(s, t, h, input, disturbance, m);
  if (!any_dry_) {
    const double passed = robot_.leg ? with_contact(s, next, t, h, input, disturbance, m) : h;
    s = next;
    return passed;
  }
  // The first joint that comes to rest ends the step.
  double share = 1.0;
  std::size_t first = size();
  for (std::size_t j = 0; j < size(); ++j) {
    if (m[j] != Mode::forth && m[j] != Mode::back) continue;
    const double direction = m[j] == Mode::forth ? 1.0 : -1.0;
    if (direction * next.v[j] > 0.0) continue;
    if (s.v[j] == 0.0) continue;
    const double at = s.v[j] / (s.v[j] - next.v[j]);
    if (at < share || first == size()) {
      share = at;
      first = j;
    }
  }
  if (first < size()) {
    next = stepped(s, t, share * h, input, disturbance, m);
    next.v[first] = 0.0;
  }
  // A joint that is at a bound of its friction at rest does not move against it.
  for (std::size_t j = 0; j < size(); ++j)
    if ((m[j] == Mode::forth && next.v[j] < 0.0) || (m[j] == Mode::back && next.v[j] > 0.0)) next.v[j] = 0.0;
  const double passed = robot_.leg ? with_contact(s, next, t, share * h, input, disturbance, m) : share * h;
  s = next;
  return passed;
}

void Machine::run(State& s, double t, double h, double longest, const Values& input,
                  const Values& disturbance) const {
  const double end = t + h;
  while (end - t > 1e-9) {
    double left = end - t;
    if (robot_.leg) {
      const double wait = next_catch_s(s) - t;
      if (wait <= 1e-9)
        catch_spring(s);
      else
        left = std::min(left, wait);
    }
    const double whole = left / std::ceil(left / longest - 1e-6);
    t += std::max(step(s, t, std::min(whole, left), input, disturbance), 1e-9);
  }
}

Values Machine::acceleration(const State& s, double t, const Values& input, const Values& disturbance) const {
  return rates(s, t, input, disturbance, modes(s, t, input, disturbance)).a;
}

void Machine::settle(State& s, const Values& input) const {
  for (std::size_t j = 0; j < size(); ++j) {
    s.lag[j] = raw_torque(j, s, input[j]);
    s.rotor[j] = s.q[j];
    s.rotor_v[j] = s.v[j];
    if (acts_[j].spring_nmprad > 0) s.rotor[j] += s.lag[j] / acts_[j].spring_nmprad;
  }
}

}  // namespace furcula::hidden::trees
