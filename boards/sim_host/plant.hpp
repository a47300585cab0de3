// The body and leg of the simulated rig: the linear hopper, or the non-linear one.
#pragma once

#include <span>
#include <variant>

#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"

namespace furcula::sim_host {

/// One interface to both. The non-linear hopper's leg is free in flight where nothing but drive and sensors
/// is wrong with it and its links have a weight that steps can follow; laws of mechanism and contact are
/// known to dynamics::Hopper alone, whose leg rests on its stop in flight.
class Plant {
 public:
  explicit Plant(const dynamics::HopperLinearParameters<double>& p,
                 const dynamics::Effects<double>& effects = {})
      : machine_(dynamics::Hopper<double>(p, effects)) {}
  explicit Plant(const dynamics::HopperNonlinearParameters<double>& p,
                 const dynamics::Effects<double>& effects = {})
      : machine_(changes_motion(effects) || !dynamics::NonlinearHopper<double>::resolves(p)
                     ? Machine(dynamics::Hopper<double>(p, effects))
                     : Machine(dynamics::NonlinearHopper<double>(p))) {}

  void reset(double height_m, double velocity_mps) {
    std::visit([&](auto& m) { m.reset(height_m, velocity_mps); }, machine_);
  }
  void advance(double torque_nm, double dt_s) {
    std::visit([&](auto& m) { m.advance(torque_nm, dt_s); }, machine_);
  }
  double height_m() const {
    return std::visit([](const auto& m) { return m.height_m(); }, machine_);
  }
  double velocity_mps() const {
    return std::visit([](const auto& m) { return m.velocity_mps(); }, machine_);
  }
  double leg_angle_rad() const {
    return std::visit([](const auto& m) { return double(m.leg_angle_rad()); }, machine_);
  }
  bool in_stance() const {
    return std::visit([](const auto& m) { return m.in_stance(); }, machine_);
  }
  double touchdown_height_m() const {
    return std::visit([](const auto& m) { return m.touchdown_height_m(); }, machine_);
  }
  /// Of the toe above the ground, m, and m/s upwards.
  double toe_height_m() const {
    if (const auto* m = std::get_if<dynamics::NonlinearHopper<double>>(&machine_)) return m->toe_height_m();
    return in_stance() ? 0.0 : height_m() - touchdown_height_m();
  }
  double toe_velocity_mps() const {
    if (const auto* m = std::get_if<dynamics::NonlinearHopper<double>>(&machine_))
      return m->toe_velocity_mps();
    return in_stance() ? 0.0 : velocity_mps();
  }
  std::span<const dynamics::ContactEvent<double>> events() const {
    return std::visit([](const auto& m) { return m.events(); }, machine_);
  }

 private:
  using Machine = std::variant<dynamics::Hopper<double>, dynamics::NonlinearHopper<double>>;

  /// Whether a law is on that sits in the mechanism, in a contact, or between the motor and the leg.
  static bool changes_motion(const dynamics::Effects<double>& effects) {
    using dynamics::Effect;
    using dynamics::Stage;
    for (const auto& e : dynamics::kCatalogue) {
      if (!effects.has(e.effect)) continue;
      if (e.stage == Stage::mechanism || e.stage == Stage::contact || e.effect == Effect::torque_ripple ||
          e.effect == Effect::backlash)
        return true;
    }
    return false;
  }

  Machine machine_;
};

}  // namespace furcula::sim_host
