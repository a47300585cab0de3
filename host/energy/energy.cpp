// Energy a hop, see energy.hpp.
#include "host/energy/energy.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/app/app.hpp"
#include "host/core/error.hpp"

namespace furcula::energy {
namespace {

/// What the plant keeps account of.
constexpr double HopEnergy::*kAccounts[] = {
    &HopEnergy::motor_work,     &HopEnergy::coil,     &HopEnergy::guide_damping, &HopEnergy::leg_damping,
    &HopEnergy::touchdown,      &HopEnergy::stop,     &HopEnergy::liftoff,       &HopEnergy::clutch_friction,
    &HopEnergy::clutch_impacts, &HopEnergy::coil_heat};

/// Sums of the whole run up to now.
HopEnergy account_of(const sim_host::Plant& plant) {
  HopEnergy a;
  const auto take = [&](const auto& e) {
    a.motor_work = e.motor;
    a.guide_damping = e.guide_damping;
    a.leg_damping = e.leg_damping;
    a.touchdown = e.touchdown;
    a.stop = e.stop;
    a.liftoff = e.liftoff;
  };
  if (const auto* robot = plant.clutched()) {
    take(robot->energy());
    const auto c = robot->clutch_energy();
    a.coil = c.electrical;
    a.clutch_friction = c.friction + c.key_damping + c.cable_damping;
    a.clutch_impacts = c.impacts;
    a.coil_heat = c.copper + c.flyback;
  } else if (const auto* bare = plant.nonlinear()) {
    take(bare->energy());
  } else {
    throw core::DataError(
        "energy: expected a hopper_nonlinear without effects of mechanism or contact, and links that weigh something");
  }
  return a;
}

/// That holds nothing back: asked is what a hop costs, not whether the controller would allow it.
control::EnvelopeConfig open_envelope(control::EnvelopeConfig e) {
  constexpr float kAny = 1e3f;
  e.apex_max_m = e.apex_fault_m = e.touchdown_speed_max_mps = e.speed_fault_mps = kAny;
  e.unproven_work_j = e.torque_max_nm = e.unsupported_torque_max_nm = kAny;
  e.leg_rate_max_radps = e.toe_speed_max_mps = e.flight_tolerance = e.spring_factor = e.straight_tolerance_m =
      kAny;
  e.leg_angle_max_rad = 1.57f;
  return e;
}

}  // namespace

HopEnergy energy_per_hop(Robot robot, const Motor& motor, int settle, int count) {
  robot.rig.duration_s = 0.7 * (settle + count + 2);
  robot.config.envelope = open_envelope(robot.config.envelope);
  sim_host::SimBoard board(robot.rig);
  firmware::App app(board, robot.config);
  HopEnergy out, before;
  double highest_m = 0.0, last_angle = board.plant().leg_angle_rad(), last_torque_nm = 0.0;
  int touchdowns = 0;
  bool counting = false, commanded_in_flight = true;
  while (board.wait_for_tick()) {
    app.tick();
    const auto& o = board.telemetry().outputs;
    if (o.fault != control::Fault::none) break;
    const double angle = board.plant().leg_angle_rad();
    const double work = last_torque_nm * (angle - last_angle);
    last_angle = angle;
    const bool flight = o.phase.phase == control::Phase::flight;
    if (counting) {
      const double size_nm = std::abs(last_torque_nm),
                   current_a = last_torque_nm / motor.torque_constant_nmpa;
      out.motor_pushed += std::max(0.0, work);
      out.motor_copper += motor.resistance_ohm * current_a * current_a * 1e-3;
      double& peak_nm = commanded_in_flight ? out.peak_torque_flight_nm : out.peak_torque_stance_nm;
      peak_nm = std::max(peak_nm, size_nm);
      const double leg_m = 2.0 * static_cast<double>(robot.config.link_length_m) * std::cos(angle);
      double& shorter_m = flight ? out.fold_m : out.compression_m;
      shorter_m = std::max(shorter_m, board.plant().touchdown_height_m() - leg_m);
      if (flight) out.flight_s += 1e-3;
      highest_m = std::max(highest_m, board.plant().height_m());
    }
    last_torque_nm = static_cast<double>(board.command().torque_nm);
    commanded_in_flight = flight;
    if (!o.phase.touchdown) continue;
    ++touchdowns;
    if (counting) {
      out.apex_m += highest_m;
      highest_m = 0.0;
      ++out.hops;
    }
    if (touchdowns == settle) {
      counting = true;
      before = account_of(board.plant());
    }
    if (touchdowns == settle + count) break;
  }
  if (out.hops < count) {
    out.fell = true;
    return out;
  }
  const HopEnergy after = account_of(board.plant());
  for (const auto account : kAccounts) out.*account = (after.*account - before.*account) / out.hops;
  for (const auto sum :
       {&HopEnergy::motor_pushed, &HopEnergy::motor_copper, &HopEnergy::apex_m, &HopEnergy::flight_s})
    out.*sum /= out.hops;
  return out;
}

std::optional<Settled> energy_at_apex(Robot robot, const Motor& motor, double apex_m) {
  constexpr double kWithin_m = 1e-4, kNearEnough_m = 5e-4;
  const auto at = [&](double amplitude_nm) {
    robot.config.torque.amplitude_nm = static_cast<float>(amplitude_nm);
    return Settled{amplitude_nm, energy_per_hop(robot, motor)};
  };
  // The apex grows with the amplitude, where the robot hops at all. Bisection until the secant is safe.
  double low = 0.0, high = 20.0;
  Settled best = at(2.0);
  std::optional<Settled> nearest;
  for (int round = 0; round < 40; ++round) {
    const double miss = best.energy.fell ? -1.0 : best.energy.apex_m - apex_m;
    if (!best.energy.fell && std::abs(miss) < kWithin_m) return best;
    if (!best.energy.fell && std::abs(miss) < kNearEnough_m &&
        (!nearest || std::abs(miss) < std::abs(nearest->energy.apex_m - apex_m)))
      nearest = best;
    (miss < 0.0 ? low : high) = best.amplitude_nm;
    if (high - low < 1e-6) break;
    // Some 5 cm of height a newton metre, near enough to begin with.
    double next = best.amplitude_nm - miss / 0.05;
    if (best.energy.fell || next <= low || next >= high || round > 6) next = 0.5 * (low + high);
    best = at(next);
  }
  return nearest;
}

}  // namespace furcula::energy
