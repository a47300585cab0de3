// Hypotheses and their unknowns, see hypothesis.hpp.
#include "host/trees/hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace furcula::trees {
namespace {

/// Of a body's coordinates, a change that matters: a fifth of its mass, a tenth of a length.
constexpr double kOfBody = 0.1;

}  // namespace

bool inputs_may_be_late(const TreeModel& model, const Hypothesis& h) {
  for (std::size_t j = 0; j < model.joints(); ++j) {
    if (!model.driven(j)) continue;
    const bool delayed = std::any_of(
        h.causes.begin() + static_cast<std::ptrdiff_t>(std::min(model.causes.size(), h.causes.size())),
        h.causes.end(), [&](const Cause& c) {
          return c.effect == Effect::time_skew ||
                 (c.effect == Effect::actuator_delay &&
                  std::find(c.sites.begin(), c.sites.end(), j) != c.sites.end());
        });
    if (!delayed) return true;
  }
  return false;
}

double value_of(const Hypothesis& h, const Unknown& u) {
  if (u.of_inputs) return h.inputs_late_rows;
  if (u.of_body) {
    const auto body =
        std::find_if(h.bodies.begin(), h.bodies.end(), [&](const FittedBody& b) { return b.link == u.link; });
    return body == h.bodies.end() ? 0.0 : body->at[u.parameter];
  }
  return u.of_cause ? h.causes[u.cause].values[u.parameter] : h.drives[u.joint].*kDriveMembers[u.parameter];
}
void set_value(Hypothesis& h, const Unknown& u, double value) {
  if (u.of_inputs) {
    h.inputs_late_rows = value;
    return;
  }
  if (u.of_body) {
    auto body =
        std::find_if(h.bodies.begin(), h.bodies.end(), [&](const FittedBody& b) { return b.link == u.link; });
    if (body == h.bodies.end()) body = h.bodies.insert(body, {u.link, {}});
    body->at[u.parameter] = value;
    return;
  }
  (u.of_cause ? h.causes[u.cause].values[u.parameter] : h.drives[u.joint].*kDriveMembers[u.parameter]) =
      value;
}

double stiffest_nmprad(const Drive& drive) {
  constexpr double kRings_radps = 800.0;
  return drive.rotor_inertia_kgm2 * kRings_radps * kRings_radps;
}

std::vector<Unknown> unknowns_of(const TreeModel& model, const Scales& scales, const Hypothesis& h) {
  std::vector<Unknown> out;
  if (inputs_may_be_late(model, h)) {
    Unknown u{.lower = -kMostLate_rows, .upper = kMostLate_rows, .scale = 0.5 * kMostLate_rows};
    u.of_inputs = true;
    u.prior_sd = kMostLate_rows / std::sqrt(3.0);
    out.push_back(u);
  }
  const auto torque_scale = [&](std::size_t parameter, std::size_t j) {
    const double torque = scales.torque_nm[j];
    if (parameter == 0) return torque / std::max(1e-3, scales.highest_rad[j] - scales.lowest_rad[j]);
    if (parameter == 2) return torque / scales.acceleration_radps2[j];
    return torque / scales.velocity_radps[j];
  };
  for (const FreeParameter& f : model.free) {
    const bool replaced = std::any_of(h.causes.begin(), h.causes.end(), [&](const Cause& c) {
      const bool same = (c.effect == Effect::damping_error && f.parameter == 3) ||
                        (c.effect == Effect::rotor_inertia_error && f.parameter == 2) ||
                        (c.effect == Effect::position_gain_error && f.parameter < 2);
      return same && std::find(c.sites.begin(), c.sites.end(), f.joint) != c.sites.end();
    });
    if (!replaced)
      out.push_back({false, 0, f.joint, f.parameter, f.lower, f.upper, torque_scale(f.parameter, f.joint)});
  }
  for (const FreeBody& f : model.free_bodies)
    for (std::size_t k = 0; k < BodyCoordinates{}.size(); ++k) {
      constexpr double kAny = std::numeric_limits<double>::infinity();
      Unknown u{false, 0, static_cast<std::size_t>(model.robot.links[f.link].joint), k, -kAny, kAny, kOfBody};
      if (k == 0) u.lower = 0.5 * std::log(f.lower), u.upper = 0.5 * std::log(f.upper);
      u.of_body = true;
      u.link = f.link;
      u.prior_sd = kBodyPrior;
      out.push_back(u);
    }
  // What the model has of its own is held, as in every model file.
  for (std::size_t c = model.causes.size(); c < h.causes.size(); ++c) {
    const Cause& cause = h.causes[c];
    const EffectInfo& e = info(cause.effect);
    const std::size_t site = cause.sites.front();
    const std::size_t j = e.location_type == LocationType::link
                              ? static_cast<std::size_t>(model.robot.links[site].joint)
                          : is_of_joints(e.location_type) ? site
                                                          : 0;
    const double torque = scales.torque_nm[j], speed = scales.velocity_radps[j],
                 range = scales.highest_rad[j] - scales.lowest_rad[j];
    for (std::size_t k = 0; k < e.parameter_count; ++k) {
      Unknown u{true, c, j, k, e.parameters()[k].lower, e.parameters()[k].upper, 1.0};
      switch (cause.effect) {
        case Effect::coulomb_friction:
        case Effect::asymmetric_friction:
        case Effect::force_offset:
          u.scale = 0.1 * torque;
          u.upper = 5.0 * torque;
          if (u.lower < 0.0) u.lower = -u.upper;
          break;
        case Effect::stribeck_friction:
          u.scale = k == 2 ? 0.1 * speed : 0.1 * torque;
          u.upper = k == 2 ? 2.0 * speed : 5.0 * torque;
          if (k == 2) u.lower = 0.03 * speed;
          break;
        case Effect::binding_spot:
          u.scale = k == 0 ? 0.1 * torque : 0.05 * range;
          if (k == 0) u.upper = 5.0 * torque;
          if (k == 1) u.lower = scales.lowest_rad[j], u.upper = scales.highest_rad[j];
          if (k == 2) u.lower = 0.01 * range, u.upper = 0.6 * range;
          break;
        case Effect::quadratic_drag:
          u.scale = 0.1 * torque / (speed * speed);
          break;
        case Effect::damping_error:
          u.scale = 0.1 * torque / speed;
          break;
        case Effect::rotor_inertia_error:
          u.scale = 0.1 * torque / scales.acceleration_radps2[j];
          break;
        case Effect::position_gain_error:
          u.scale = 0.1 * std::max(1e-3, k == 0 ? model.drives[j].kp_nmprad : model.drives[j].kd_nmsprad);
          break;
        case Effect::mass_error:
          u.scale = 0.1 * model.urdf.links[site].inertia->mass_kg;
          break;
        case Effect::payload:
          u.scale = k == 0 ? 0.1 * model.urdf.links[site].inertia->mass_kg : 0.02;
          if (k > 0) u.lower = -1.0, u.upper = 1.0;
          break;
        case Effect::com_error:
          u.scale = 0.01;
          u.lower = -0.5, u.upper = 0.5;
          break;
        case Effect::torque_saturation:
          u.scale = 0.1 * torque;
          u.lower = 0.01 * torque;
          u.upper = 10.0 * torque;
          break;
        case Effect::torque_ripple:
          u.scale = k == 0 ? 0.1 * torque : k == 1 ? 0.1 : 0.3;
          break;
        case Effect::joint_elasticity:
          u.scale = 0.2 * cause.values[0];
          u.upper = stiffest_nmprad(model.drives[j]);
          u.lower = std::min(10.0 * torque, 0.5 * u.upper);
          break;
        case Effect::actuator_delay:
        case Effect::actuator_lag:
          u.scale = 5e-3;
          u.upper = 0.1;
          break;
        case Effect::time_skew:
          u.scale = 5e-3;
          break;
        case Effect::load_friction:
        case Effect::inertia_error:
        case Effect::torque_gain_error:
          u.scale = 0.1;
          break;
        case Effect::spring_rate_error:
          u.scale = 0.1 * model.springs[site].stiffness_nmprad;
          break;
        case Effect::latch_delay:
          u.scale = 3e-3;
          break;
        case Effect::latch_offset:
          u.scale = 0.02;
          break;
        case Effect::second_spring:
          u.scale = 0.1 * torque;
          u.upper = 5.0 * torque;
          u.lower = -u.upper;
          break;
        case Effect::length_error:
          u.scale = 5e-3;
          u.lower = -0.1, u.upper = 0.1;
          break;
        case Effect::base_tilt:
        case Effect::encoder_offset:
          u.scale = 0.02;
          u.lower = -0.7, u.upper = 0.7;
          break;
      }
      out.push_back(u);
    }
  }
  return out;
}

}  // namespace furcula::trees
