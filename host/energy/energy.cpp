// Energy a hop, see energy.hpp.
#include "host/energy/energy.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/app/app.hpp"
#include "host/log/error.hpp"

namespace furcula::energy {
namespace {

/// Sums of the whole run up to an instant.
struct Account {
  double motor_work = 0.0, guide = 0.0, leg = 0.0, touchdown = 0.0, stop = 0.0, liftoff = 0.0, coil = 0.0,
         clutch_friction = 0.0, clutch_impacts = 0.0, coil_heat = 0.0;
};

Account account_of(const sim_host::Plant& plant) {
  Account a;
  const auto take = [&](const auto& e) {
    a.motor_work = e.motor;
    a.guide = e.guide_damping;
    a.leg = e.leg_damping;
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
    throw log::DataError(
        "energy: expected a hopper_nonlinear without effects of mechanism or contact, and links that weigh "
        "something");
  }
  return a;
}

}  // namespace

HopEnergy energy_per_hop(Robot robot, const Motor& motor, int settle, int count) {
  robot.rig.duration_s = 0.7 * (settle + count + 2);
  sim_host::SimBoard board(robot.rig);
  firmware::App app(board, robot.config);
  HopEnergy out;
  Account before;
  double pushed = 0.0, copper = 0.0, highest_m = 0.0, last_angle = board.plant().leg_angle_rad(),
         last_torque_nm = 0.0;
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
      pushed += std::max(0.0, work);
      copper += motor.resistance_ohm * current_a * current_a * 1e-3;
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
  const Account after = account_of(board.plant());
  const double hops = out.hops;
  out.motor_work = (after.motor_work - before.motor_work) / hops;
  out.motor_pushed = pushed / hops;
  out.motor_copper = copper / hops;
  out.coil = (after.coil - before.coil) / hops;
  out.guide_damping = (after.guide - before.guide) / hops;
  out.leg_damping = (after.leg - before.leg) / hops;
  out.touchdown = (after.touchdown - before.touchdown) / hops;
  out.stop = (after.stop - before.stop) / hops;
  out.liftoff = (after.liftoff - before.liftoff) / hops;
  out.clutch_friction = (after.clutch_friction - before.clutch_friction) / hops;
  out.clutch_impacts = (after.clutch_impacts - before.clutch_impacts) / hops;
  out.coil_heat = (after.coil_heat - before.coil_heat) / hops;
  out.apex_m /= hops;
  out.flight_s /= hops;
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
