// The body and leg of the simulated rig: the linear hopper, the non-linear one, or that with a clutch.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <variant>

#include "furcula/dynamics/clutch_designs.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"

namespace furcula::sim_host {

/// One interface to all. The non-linear hopper's leg is free in flight where nothing but drive and sensors
/// is wrong with it and its links have a weight that steps can follow; laws of mechanism and contact are
/// known to dynamics::Hopper alone, whose leg rests on its stop in flight.
class Plant {
 public:
  explicit Plant(const dynamics::HopperLinearParameters<double>& p,
                 const dynamics::Effects<double>& effects = {})
      : machine_(dynamics::Hopper<double>(p, effects)) {}
  /// With a clutch of two delays (dynamics::Hopper), which energise() moves.
  Plant(const dynamics::HopperLinearParameters<double>& p, const dynamics::Effects<double>& effects,
        const dynamics::HopperClutchParameters<double>& clutch)
      : machine_(dynamics::Hopper<double>(p, effects)) {
    std::get<dynamics::Hopper<double>>(machine_).fit_clutch(clutch);
  }
  explicit Plant(const dynamics::HopperNonlinearParameters<double>& p,
                 const dynamics::Effects<double>& effects = {})
      : machine_(changes_motion(effects) || !dynamics::NonlinearHopper<double>::resolves(p)
                     ? Machine(dynamics::Hopper<double>(p, effects))
                     : Machine(dynamics::NonlinearHopper<double>(p))) {}
  /// With a clutch; no effect of mechanism or contact.
  Plant(const dynamics::HopperNonlinearParameters<double>& p,
        const dynamics::ClutchParameters<double>& clutch)
      : machine_(dynamics::ClutchedHopper<double>(p, dynamics::Clutch<double>(clutch))) {}

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
    return std::visit(
        [](const auto& m) {
          if constexpr (requires { m.toe_height_m(); })
            return m.toe_height_m();
          else
            return m.in_stance() ? 0.0 : m.height_m() - m.touchdown_height_m();
        },
        machine_);
  }
  double toe_velocity_mps() const {
    return std::visit(
        [](const auto& m) {
          if constexpr (requires { m.toe_velocity_mps(); })
            return m.toe_velocity_mps();
          else
            return m.in_stance() ? 0.0 : m.velocity_mps();
        },
        machine_);
  }
  std::span<const dynamics::ContactEvent<double>> events() const {
    return std::visit([](const auto& m) { return m.events(); }, machine_);
  }

  /// Where the robot has one, else null.
  const dynamics::ClutchedHopper<double>* clutched() const {
    return std::get_if<dynamics::ClutchedHopper<double>>(&machine_);
  }
  /// The non-linear one without a clutch, else null.
  const dynamics::NonlinearHopper<double>* nonlinear() const {
    return std::get_if<dynamics::NonlinearHopper<double>>(&machine_);
  }
  /// Volts across the coil, 0 off. Has no effect without a clutch.
  void set_voltage(double volts) {
    if (auto* m = std::get_if<dynamics::ClutchedHopper<double>>(&machine_)) m->set_voltage(volts);
  }
  /// The coil on or off, of a clutch of two delays. Has no effect without one.
  void energise(bool on) {
    if (auto* m = std::get_if<dynamics::Hopper<double>>(&machine_)) m->energise(on);
  }
  /// Of the clutch's cable along the leg, m; 0 without one.
  double cable_travel_m() const {
    if (const auto* m = std::get_if<dynamics::Hopper<double>>(&machine_))
      return m->has_clutch() ? m->cable_travel_m() : 0.0;
    return clutched() != nullptr ? clutched()->cable_travel_m() : 0.0;
  }
  /// Moves the ground. Only where the toe is above it, and where the leg is free in flight.
  void set_ground(double height_m) {
    std::visit(
        [&](auto& m) {
          if constexpr (requires { m.set_ground(height_m); })
            if (!m.in_stance() && m.toe_height_m() > height_m) m.set_ground(height_m);
        },
        machine_);
  }

  /// Whether a law is on that sits in the mechanism, in a contact, or between the motor and the leg.
  static bool changes_motion(const dynamics::Effects<double>& effects) {
    using dynamics::EffectsOf;
    using dynamics::Stage;
    return EffectsOf<double, Stage::mechanism>(effects).any() ||
           EffectsOf<double, Stage::contact>(effects).any() || !dynamics::Rotor<double>(effects).ideal();
  }

 private:
  using Machine = std::variant<dynamics::Hopper<double>, dynamics::NonlinearHopper<double>,
                               dynamics::ClutchedHopper<double>>;
  Machine machine_;
};

}  // namespace furcula::sim_host
