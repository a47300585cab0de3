// What a search tries, see candidates.hpp.
#include "host/trees/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace furcula::trees {
namespace {

/// At one of the sites at least.
bool has(const Hypothesis& h, Effect e, const std::vector<std::size_t>& at) {
  return std::any_of(h.causes.begin(), h.causes.end(), [&](const Cause& c) {
    if (c.effect != e) return false;
    return std::any_of(at.begin(), at.end(), [&](std::size_t s) {
      return std::find(c.sites.begin(), c.sites.end(), s) != c.sites.end();
    });
  });
}

class Lister {
 public:
  Lister(const Problem& problem, const Hypothesis& h, const Guesses& guesses)
      : model_(problem.model()), scales_(problem.scales()), h_(h), guesses_(guesses) {}

  std::vector<Candidate> list() {
    for (std::size_t j = 0; j < model_.joints(); ++j) at_joint(j);
    for (const std::size_t link : sites(model_, LocationType::link)) at_link(link);
    if (dot(model_.gravity_mps2, model_.gravity_mps2) > 0.0)
      add(Effect::base_tilt, {0}, {{0.02, 0.0, 0.0, 0.0}, {0.0, 0.02, 0.0, 0.0}}, false);
    for (const auto& group : groups()) at_group(group);
    for (const double skew : {4e-3, 18e-3}) add(Effect::time_skew, {0}, {{skew, 0, 0, 0}}, false);
    for (const Candidate& spring : guesses_.springs)
      if (!has(spring.effect, spring.sites)) out_.push_back(spring);
    return std::move(out_);
  }

 private:
  using Values = std::array<double, kMostParameters>;

  bool has(Effect e, const std::vector<std::size_t>& at) const { return trees::has(h_, e, at); }
  void add(Effect e, const std::vector<std::size_t>& at, const std::vector<Values>& columns,
           bool only_forward = true, std::ptrdiff_t replaces = -1) {
    if (has(e, at)) return;
    Candidate c{e, at, {}, only_forward, replaces};
    for (const Values& v : columns) c.columns.push_back({e, at, v});
    out_.push_back(std::move(c));
  }
  /// Of those that were found; what the model has of its own stays.
  std::ptrdiff_t cause_at(Effect e, std::size_t joint) const {
    for (std::size_t i = model_.causes.size(); i < h_.causes.size(); ++i)
      if (h_.causes[i].effect == e && h_.causes[i].sites == std::vector<std::size_t>{joint})
        return static_cast<std::ptrdiff_t>(i);
    return -1;
  }

  void at_joint(std::size_t j) {
    const double torque = 0.05 * scales_.torque_nm[j], speed = scales_.velocity_radps[j],
                 acceleration = scales_.acceleration_radps2[j];
    const double low = scales_.lowest_rad[j], range = scales_.highest_rad[j] - low;
    const Drive& d = model_.drives[j];
    const std::vector<std::size_t> at{j};
    const std::ptrdiff_t dry = cause_at(Effect::coulomb_friction, j);
    const bool full = has(Effect::stribeck_friction, at) || has(Effect::asymmetric_friction, at);
    if (!full) add(Effect::coulomb_friction, at, {{torque, 0, 0, 0}});
    // The fuller laws of dry friction have it in them: they are asked about once it is there.
    if (!full && dry >= 0) {
      const double f = h_.causes[static_cast<std::size_t>(dry)].values[0];
      for (const double part : {0.05, 0.2, 0.6})
        add(Effect::stribeck_friction, at, {{f, f + torque, part * speed, 0}}, true, dry);
      add(Effect::asymmetric_friction, at, {{f + 0.3 * torque, f - 0.3 * torque, 0, 0}}, false, dry);
    }
    add(Effect::quadratic_drag, at, {{torque / (speed * speed), 0, 0, 0}});
    if (range > 0.1)
      for (int k = 1; k <= 7; ++k)
        add(Effect::binding_spot, at, {{torque, low + range * k / 8.0, 0.15 * range, 0}});
    if (!model_.is_free(j, 3))
      add(Effect::damping_error, at, {{d.damping_nmspr + torque / speed, 0, 0, 0}}, d.damping_nmspr == 0.0);
    if (model_.driven(j)) add(Effect::load_friction, at, {{0.05, 0, 0, 0}});
    add(Effect::force_offset, at, {{torque, 0, 0, 0}}, false);
    add(Effect::encoder_offset, at, {{0.02, 0, 0, 0}}, false);
    at_spring(j);
    if (!model_.is_free(j, 2))
      add(Effect::rotor_inertia_error, at, {{d.rotor_inertia_kgm2 + torque / acceleration, 0, 0, 0}},
          d.rotor_inertia_kgm2 == 0.0);
    if (!model_.driven(j)) return;
    add(Effect::torque_gain_error, at, {{1.05, 0, 0, 0}}, false);
    if (d.law == ControlMode::position && !model_.is_free(j, 0) && !model_.is_free(j, 1))
      add(Effect::position_gain_error, at,
          {{1.05 * d.kp_nmprad, d.kd_nmsprad, 0, 0},
           {d.kp_nmprad, 1.05 * d.kd_nmsprad + 1e-3 * d.kp_nmprad, 0, 0}},
          false);
    for (const double delay : {4e-3, 18e-3}) add(Effect::actuator_delay, at, {{delay, 0, 0, 0}});
    for (const double lag : {4e-3, 18e-3}) add(Effect::actuator_lag, at, {{lag, 0, 0, 0}});
    std::vector<double> limits;
    for (const double limit : {2.0, 1.4, 1.0}) limits.push_back(limit * scales_.torque_nm[j]);
    if (j < guesses_.limits_nm.size())
      limits.insert(limits.end(), guesses_.limits_nm[j].begin(), guesses_.limits_nm[j].end());
    for (const double limit : limits) add(Effect::torque_saturation, at, {{limit, 0, 0, 0}});
    if (j < guesses_.ripple_cycles.size())
      for (const double n : guesses_.ripple_cycles[j]) {
        const std::size_t before = out_.size();
        add(Effect::torque_ripple, at, {{torque, n, 0, 0}, {torque, n, 0.5 * std::numbers::pi, 0}}, false);
        for (std::size_t k = before; k < out_.size(); ++k) out_[k].of_many = kMostCycles;
      }
  }

  void at_spring(std::size_t j) {
    const Spring& spring = model_.springs[j];
    if (spring.stiffness_nmprad == 0.0) return;
    const std::vector<std::size_t> at{j};
    add(Effect::spring_rate_error, at, {{1.05 * spring.stiffness_nmprad, 0, 0, 0}}, false);
    if (!spring.switched) return;
    for (const double delay : {4e-3, 12e-3}) add(Effect::latch_delay, at, {{delay, 0, 0, 0}}, false);
    add(Effect::latch_offset, at, {{0.03, 0, 0, 0}}, false);
    add(Effect::second_spring, at, {{0.05 * scales_.torque_nm[j], 0, 0, 0}}, false);
  }

  void at_link(std::size_t link) {
    // The fit has it whole.
    if (model_.is_free_body(link)) return;
    const model::UrdfInertia& i = *model_.urdf.links[link].inertia;
    const std::vector<std::size_t> at{link};
    add(Effect::mass_error, at, {{1.05 * i.mass_kg, 0, 0, 0}}, false);
    add(Effect::com_error, at, {{0.01, 0, 0, 0}, {0, 0.01, 0, 0}, {0, 0, 0.01, 0}}, false);
    add(Effect::inertia_error, at, {{1.2, 0, 0, 0}}, false);
    if (model_.foot) add(Effect::length_error, at, {{0.005, 0, 0, 0}}, false);
    const auto& c = i.frame.at;
    for (const double out : {1.0, 2.0})
      add(Effect::payload, at, {{0.05 * i.mass_kg, out * c.x, out * c.y, out * c.z}});
  }

  /// Joints that are likely to have one value: all of a kind and a drive law, and those of one name on several legs or sides.
  std::vector<std::vector<std::size_t>> groups() const {
    std::map<std::string, std::vector<std::size_t>> of;
    for (std::size_t j = 0; j < model_.joints(); ++j) {
      if (!model_.driven(j)) continue;
      const std::string sort = std::string(model_.prismatic(j) ? "slides" : "turns") +
                               (model_.drives[j].law == ControlMode::position ? " position" : " torque");
      of[sort].push_back(j);
      const std::string& name = model_.robot.joints[j].name;
      const auto cut = name.find('_');
      if (cut != std::string::npos) of[sort + " " + name.substr(cut)].push_back(j);
    }
    std::vector<std::vector<std::size_t>> out;
    for (const auto& [sort, joints] : of)
      if (joints.size() > 1 && std::find(out.begin(), out.end(), joints) == out.end()) out.push_back(joints);
    return out;
  }
  void at_group(const std::vector<std::size_t>& at) {
    double torque = 0.0, speed = 0.0, acceleration = 0.0, damping = 0.0, rotor = 0.0;
    bool same_damping = true, same_rotor = true, any_free_damping = false, any_free_rotor = false;
    const double share = 1.0 / static_cast<double>(at.size());
    for (const std::size_t j : at) {
      torque += 0.05 * scales_.torque_nm[j] * share;
      speed += scales_.velocity_radps[j] * share;
      acceleration += scales_.acceleration_radps2[j] * share;
      damping = model_.drives[j].damping_nmspr;
      rotor = model_.drives[j].rotor_inertia_kgm2;
      same_damping &= damping == model_.drives[at.front()].damping_nmspr;
      same_rotor &= rotor == model_.drives[at.front()].rotor_inertia_kgm2;
      any_free_damping |= model_.is_free(j, 3);
      any_free_rotor |= model_.is_free(j, 2);
    }
    const bool full = std::any_of(at.begin(), at.end(), [&](std::size_t j) {
      return has(Effect::stribeck_friction, {j}) || has(Effect::asymmetric_friction, {j});
    });
    if (!full) add(Effect::coulomb_friction, at, {{torque, 0, 0, 0}});
    if (same_damping && !any_free_damping)
      add(Effect::damping_error, at, {{damping + torque / speed, 0, 0, 0}}, damping == 0.0);
    if (same_rotor && !any_free_rotor)
      add(Effect::rotor_inertia_error, at, {{rotor + torque / acceleration, 0, 0, 0}}, rotor == 0.0);
    add(Effect::load_friction, at, {{0.05, 0, 0, 0}});
    add(Effect::torque_gain_error, at, {{1.05, 0, 0, 0}}, false);
    for (const double delay : {4e-3, 18e-3}) add(Effect::actuator_delay, at, {{delay, 0, 0, 0}});
    for (const double lag : {4e-3, 18e-3}) add(Effect::actuator_lag, at, {{lag, 0, 0, 0}});
  }

  const TreeModel& model_;
  const Scales& scales_;
  const Hypothesis& h_;
  const Guesses& guesses_;
  std::vector<Candidate> out_;
};

Hypothesis base_of(const Hypothesis& h, const Candidate& c) {
  Hypothesis out = c.replaces >= 0 ? without(h, static_cast<std::size_t>(c.replaces)) : h;
  if (c.damping_nmspr)
    for (const std::size_t site : c.sites) out.drives[site].damping_nmspr = *c.damping_nmspr;
  return out;
}

}  // namespace

std::vector<Candidate> candidates(const Problem& problem, const Hypothesis& h, const Guesses& guesses) {
  return Lister(problem, h, guesses).list();
}

std::vector<Candidate> springs(const Problem& problem, const Hypothesis& h, std::size_t joint) {
  constexpr double kSoftest_rad = 0.1;  // of twist by the drive's torque
  constexpr double kNext = 1.05;
  std::vector<Candidate> out;
  if (!problem.model().driven(joint) || problem.scales().still[joint] ||
      has(h, Effect::joint_elasticity, {joint}))
    return out;
  const Drive& given = problem.model().drives[joint];
  const bool moved =
      std::abs(h.drives[joint].damping_nmspr - given.damping_nmspr) > 0.05 * given.damping_nmspr;
  for (double k = problem.scales().torque_nm[joint] / kSoftest_rad; k < stiffest_nmprad(given); k *= kNext) {
    Candidate c{Effect::joint_elasticity, {joint}, {{Effect::joint_elasticity, {joint}, {k, 0, 0, 0}}}};
    c.of_one_size = true;
    out.push_back(c);
    if (!moved) continue;
    c.damping_nmspr = given.damping_nmspr;
    out.push_back(std::move(c));
  }
  return out;
}

std::vector<Candidate> ripples(const Problem& problem, const Hypothesis& h) {
  Guesses all;
  for (std::size_t j = 0; j < problem.joints(); ++j) {
    all.ripple_cycles.emplace_back();
    const double range = problem.scales().highest_rad[j] - problem.scales().lowest_rad[j];
    for (int n = kFewestCycles; n <= kMostCycles; ++n)
      if (n * range > kTravel_rad) all.ripple_cycles.back().push_back(n);
  }
  std::vector<Candidate> out = candidates(problem, h, all);
  std::erase_if(out, [](const Candidate& c) { return c.effect != Effect::torque_ripple; });
  return out;
}

Hypothesis without(const Hypothesis& h, std::size_t cause) {
  Hypothesis out = h;
  out.causes.erase(out.causes.begin() + static_cast<std::ptrdiff_t>(cause));
  return out;
}

Hypothesis with_column(const Hypothesis& h, const Candidate& c, std::size_t column) {
  Hypothesis out = base_of(h, c);
  out.causes.push_back(c.columns[column]);
  return out;
}

Hypothesis with_candidate(const TreeModel& model, const Hypothesis& h, const Candidate& c,
                          std::span<const double> coefficients) {
  Cause cause = c.columns.front();
  const std::size_t count = info(c.effect).parameter_count;
  switch (c.effect) {
    case Effect::torque_saturation:
    case Effect::joint_elasticity:
      break;
    case Effect::torque_ripple:
      cause.values[0] *= std::hypot(coefficients[0], coefficients[1]);
      cause.values[2] = std::atan2(coefficients[1], coefficients[0]);
      break;
    default:
      for (std::size_t k = 0; k < count; ++k) {
        double neutral = neutral_value(model, c.effect, k, c.sites.front());
        if (c.replaces >= 0 && k < 2) neutral = h.causes[static_cast<std::size_t>(c.replaces)].values[0];
        if (std::isnan(neutral)) continue;
        double value = neutral;
        for (std::size_t i = 0; i < c.columns.size(); ++i)
          value += coefficients[i] * (c.columns[i].values[k] - neutral);
        cause.values[k] = value;
      }
  }
  const EffectInfo& e = info(c.effect);
  for (std::size_t k = 0; k < count; ++k)
    cause.values[k] = std::clamp(cause.values[k], e.parameters()[k].lower, e.parameters()[k].upper);
  Hypothesis out = base_of(h, c);
  out.causes.push_back(cause);
  return out;
}

}  // namespace furcula::trees
