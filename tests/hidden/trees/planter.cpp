#include "tests/hidden/trees/planter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace furcula::hidden::trees {
namespace {

constexpr double kPi = std::numbers::pi;

bool on_link(const std::string& effect) { return family(effect) == "mass" || effect == "resonator"; }

}  // namespace

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

std::optional<Cause> Planter::propose(const std::string& effect, double share, bool tied,
                                      const std::vector<Cause>& others) {
  if (c_.robot.leg) return in_a_leg(effect, share, others);
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
    if (!own_friction && !taken(effect, c_.robot.joints[j].name, others)) joints.push_back(j);
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

bool Planter::taken(const std::string& effect, const std::string& at,
                    const std::vector<Cause>& others) const {
  return std::any_of(others.begin(), others.end(),
                     [&](const Cause& o) { return in(o.at, at) && family(o.effect) == family(effect); });
}

double Planter::mean(const std::vector<std::size_t>& joints, const Values& of) const {
  double sum = 0.0;
  for (std::size_t j : joints) sum += std::log(std::max(of[j], 1e-9));
  return std::exp(sum / static_cast<double>(joints.size()));
}

bool Planter::at_joints(Cause& cause, const std::vector<std::size_t>& joints, double share) {
  const std::size_t j = joints.front();
  const std::string& e = cause.effect;
  const double torque = share * mean(joints, base_.rms_torque);
  const double v = mean(joints, base_.rms_v);
  const bool position = c_.lab.position_control;
  const auto& leg = c_.robot.leg;
  const std::size_t beside = leg ? (j == leg->hip ? leg->knee : leg->hip) : (j + 1) % c_.robot.size();
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
    const double seconds = leg ? leg_timing_s(j, e == "actuator_lag", torque) : torque / rate;
    if (seconds < (leg ? 0.0007 : 0.0015) || seconds > 0.08) return false;
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
    p["other"] = static_cast<double>(beside);
    p["torque_nm"] = torque;
  } else if (e == "torque_crosstalk") {
    p["talker"] = static_cast<double>(beside);
    p["share"] = torque / base_.rms_torque[beside];
    if (p["share"] > 0.7) return false;
  } else if (e == "periodic_torque") {
    p["torque_nm"] = 1.4 * torque;
    p["frequency_hz"] = r_.uniform(1.5, 9.0);
  } else {
    throw std::invalid_argument("no effect " + e);
  }
  return true;
}

Values Planter::dampings() const {
  Values out{};
  for (std::size_t j = 0; j < c_.robot.size(); ++j) out[j] = c_.drives[j].damping_nmspr;
  return out;
}

double Planter::share_of(const Cause& cause) const {
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

std::optional<Cause> Planter::scaled(double share, double most,
                                     const std::function<Cause(double)>& make) const {
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

std::optional<Cause> Planter::on_a_link(Cause cause, double share, const std::vector<Cause>& others) {
  std::vector<const Body*> links;
  for (const Body& b : c_.robot.bodies) {
    const bool carries = std::any_of(c_.robot.bodies.begin(), c_.robot.bodies.end(),
                                     [&](const Body& t) { return t.tool && t.joint == b.joint; });
    if (!carries && !taken(cause.effect, b.name, others)) links.push_back(&b);
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
      out.parameters = {
          {"offset_x_m", x * direction.x}, {"offset_y_m", x * direction.y}, {"offset_z_m", x * direction.z}};
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

}  // namespace furcula::hidden::trees
