// The planter's rules for a leg: laws of its spring and links, and shares of torques of which the ground bears
// a part.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/hidden/trees/planter.hpp"

namespace furcula::hidden::trees {
namespace {

struct Range {
  double least, most;
};

// Sizes of the laws that are no torque, by the effect that they have.
struct Law {
  const char* effect;
  const char* parameter;
  Range small, medium, large, pairs;
};
constexpr Law kLaws[] = {
    {"spring_rate_error", "stiffness_nmprad", {0.02, 0.04}, {0.06, 0.12}, {0.15, 0.30}, {0.08, 0.25}},
    {"latch_delay", "delay_s", {0.002, 0.004}, {0.006, 0.012}, {0.015, 0.025}, {0.008, 0.022}},
    {"latch_offset", "offset_rad", {0.02, 0.04}, {0.05, 0.1}, {0.12, 0.2}, {0.07, 0.17}},
    {"length_error", "extension_m", {0.002, 0.004}, {0.006, 0.012}, {0.015, 0.025}, {0.008, 0.022}},
    // Where the toe stands, an angle that is wrong shows long before its torque does.
    {"encoder_offset", "offset_rad", {0.003, 0.008}, {0.015, 0.03}, {0.04, 0.1}, {0.02, 0.07}},
};

// At the place in the law's range that the share has in the tier's.
double size_of(const Law& law, Tier tier, double share) {
  const Range range = tier == Tier::small    ? law.small
                      : tier == Tier::medium ? law.medium
                      : tier == Tier::pairs  ? law.pairs
                                             : law.large;
  const auto [least, most] = shares(tier);
  return range.least * std::pow(range.most / range.least, std::log(share / least) / std::log(most / least));
}

}  // namespace

std::optional<Cause> Planter::in_a_leg(const std::string& effect, double share,
                                       const std::vector<Cause>& others) {
  const Leg& leg = *c_.robot.leg;
  Cause cause{effect, {}, {}};
  if (family(effect) == "mass") return on_a_legs_link(cause, share, others);
  if (family(effect) == "spring" || family(effect) == "latch" || effect == "second_spring" ||
      effect == "length_error")
    return law_of_a_leg(cause, share);

  const bool on_boom =
      effect == "coulomb_friction" || effect == "damping_error" || effect == "rotor_inertia_error";
  std::vector<std::size_t> joints;
  for (std::size_t j = on_boom ? 0 : leg.hip; j <= leg.knee; ++j)
    if (base_.high[j] - base_.low[j] > 0.05 && !taken(effect, c_.robot.joints[j].name, others))
      joints.push_back(j);
  if (joints.empty()) return std::nullopt;
  const std::size_t j = joints[static_cast<std::size_t>(r_.uniform(0, static_cast<double>(joints.size())))];
  const Joint& joint = c_.robot.joints[j];
  cause.at = {joint.name};
  if (effect == "encoder_offset") return sized(cause, share);
  if (!at_joints(cause, {j}, share)) return std::nullopt;
  if (joint.prismatic) {
    std::map<std::string, double> linear;
    for (const auto& [key, value] : cause.parameters) linear[linear_name(key)] = value;
    cause.parameters = linear;
  }
  return cause;
}

Cause Planter::sized(Cause cause, double share) {
  const Law& law = *std::find_if(std::begin(kLaws), std::end(kLaws),
                                 [&](const Law& l) { return cause.effect == l.effect; });
  double size = size_of(law, c_.question.tier, share);
  if (cause.effect != "latch_delay") size *= r_.sign();
  if (cause.effect == "spring_rate_error") size = c_.robot.leg->spring_nmprad * (1.0 + size);
  cause.parameters = {{law.parameter, size}};
  return cause;
}

std::optional<Cause> Planter::law_of_a_leg(Cause cause, double share) {
  const Leg& leg = *c_.robot.leg;
  const bool of_switch = cause.effect != "spring_rate_error" && cause.effect != "length_error";
  if (of_switch && !leg.switched) return std::nullopt;
  cause.at = {c_.robot.joints[leg.knee].name};
  if (cause.effect == "length_error") cause.at = {r_.chance(0.5) ? leg.link : c_.robot.bodies[leg.hip].name};
  if (cause.effect != "second_spring") return sized(cause, share);
  cause.parameters = {{"torque_nm", share * base_.rms_torque[leg.knee]}};
  return cause;
}

std::optional<Cause> Planter::on_a_legs_link(Cause cause, double share, const std::vector<Cause>& others) {
  const Leg& leg = *c_.robot.leg;
  std::vector<const Body*> links;
  for (const Body& b : c_.robot.bodies)
    if (b.joint >= static_cast<int>(leg.hip) && !taken(cause.effect, b.name, others)) links.push_back(&b);
  if (links.empty()) return std::nullopt;
  const Body& b = *links[static_cast<std::size_t>(r_.uniform(0, static_cast<double>(links.size())))];
  cause.at = {b.name};
  const double sign = r_.sign(), angle = r_.uniform(0, 2 * std::numbers::pi);
  const double reach_m = b.name == leg.link ? length(leg.toe_m) : length(c_.robot.joints[leg.knee].at);
  const double at_x_m = reach_m * r_.uniform(-0.15, 0.15), at_z_m = -reach_m * r_.uniform(0.3, 1.0);
  const auto with = [cause](std::map<std::string, double> parameters) {
    Cause out = cause;
    out.parameters = std::move(parameters);
    return out;
  };
  if (cause.effect == "mass_error")
    return scaled(share, sign > 0 ? 1.5 : 0.6, [&](double x) {
      return with({{"mass_kg", b.mass_kg * (1 + sign * x)}});
    });
  if (cause.effect == "inertia_error")
    return scaled(share, sign > 0 ? 3.0 : 0.7, [&](double x) { return with({{"scale", 1 + sign * x}}); });
  if (cause.effect == "com_error")
    return scaled(share, 0.5 * reach_m, [&](double x) {
      return with({{"offset_x_m", x * std::cos(angle)}, {"offset_z_m", x * std::sin(angle)}});
    });
  return scaled(share, 1.5 * b.mass_kg, [&](double x) {
    return with({{"mass_kg", x}, {"x_m", at_x_m}, {"z_m", at_z_m}});
  });
}

// Torques at hip and knee that the same motion takes: what the boom would have to give the ground gives in
// stance, and in flight the body's own acceleration.
double Planter::share_in_a_leg(const Machine& changed, const Machine& plain) const {
  const Leg& leg = *c_.robot.leg;
  const auto takes = [&](const Machine& m, std::size_t row) {
    State s = base_.state[row];
    for (std::size_t j = 0; j <= leg.knee; ++j) s.q[j] += m.act(j).encoder_rad;
    Values out = m.dynamics().torque(s.q, s.v, base_.a[row]);
    if (s.stance) {
      const Point toe = m.toe(s);
      for (std::size_t j = leg.hip; j <= leg.knee; ++j)
        out[j] -= toe.move[j].x * out[0] + toe.move[j].z * out[1];
    } else {
      Matrix mass;
      Values bias{};
      m.dynamics().evaluate(s.q, s.v, mass, bias);
      for (std::size_t j = leg.hip; j <= leg.knee; ++j)
        out[j] -= mass[j][0] / mass[0][0] * out[0] + mass[j][1] / mass[1][1] * out[1];
    }
    if (!leg.switched) out[leg.knee] += leg.spring_nmprad * std::max(s.q[leg.knee] - leg.rest_rad, 0.0);
    return out;
  };
  std::vector<Values> differences;
  for (std::size_t row = 0; row < base_.q.size(); row += 5) {
    Values d = takes(changed, row);
    const Values was = takes(plain, row);
    for (std::size_t j = 0; j <= leg.knee; ++j) d[j] -= was[j];
    differences.push_back(d);
  }
  const Values rms = rms_of(differences);
  return std::max(rms[leg.hip] / base_.rms_torque[leg.hip], rms[leg.knee] / base_.rms_torque[leg.knee]);
}

double Planter::leg_timing_s(std::size_t joint, bool lag, double torque_nm) const {
  constexpr double kFine_s = 0.25e-3;
  // The command as it is held from row to row, on a fine grid.
  std::vector<std::vector<double>> held;
  for (const Recording& r : stage_.some) {
    std::vector<double> h;
    std::size_t row = 0;
    for (double t = 0.0; t < r.time_s.back(); t += kFine_s) {
      while (row + 1 < r.time_s.size() && r.time_s[row + 1] <= t) ++row;
      h.push_back(r.input[row][joint]);
    }
    held.push_back(h);
  }
  const auto changes = [&](double seconds) {
    double sum = 0.0, count = 0.0;
    for (const auto& h : held) {
      const auto late = static_cast<std::size_t>(std::lround(seconds / kFine_s));
      double behind = h.front();
      for (std::size_t i = late; i < h.size(); ++i) {
        behind = lag ? h[i] + (behind - h[i]) * std::exp(-kFine_s / seconds) : h[i - late];
        sum += (h[i] - behind) * (h[i] - behind);
        count += 1.0;
      }
    }
    return std::sqrt(sum / count);
  };
  double low = 0.5e-3, high = 0.06;
  if (changes(low) > torque_nm) return low * r_.uniform(1.5, 3.0);  // no drive is faster
  for (int i = 0; i < 20; ++i) {
    const double middle = std::sqrt(low * high);
    (changes(middle) < torque_nm ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace furcula::hidden::trees
