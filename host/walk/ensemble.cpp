#include "host/walk/ensemble.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/random.hpp"

namespace furcula::walk {
namespace {

using core::Random;
using furcula::biped::Machine;
using furcula::biped::Unknown;

constexpr double kSimulator = 0.5;
constexpr double kPush_n = 10.0,
                 kPush_s = 0.1;            // standard deviation of each horizontal direction; once a second
constexpr double kFootThreshold_n = 15.0;  // document 000, Table II

void push(Random& r, double mass_kg, Member& m) {
  double end_s = 0.0;
  for (Push& p : m.pushes) {
    p.begin_s = std::max(end_s, end_s - std::log(1.0 - r.uniform(0.0, 1.0)) - kPush_s);
    p.end_s = end_s = p.begin_s + kPush_s;
    p.x_mps2 = kPush_n / mass_kg * r.gaussian();
    p.y_mps2 = kPush_n / mass_kg * r.gaussian();
  }
}

}  // namespace

SensorOffsets sensors_of(const Machine& machine) {
  return {machine.encoder_offset_rad, machine.imu_turn_rad, machine.gyro_bias_radps};
}

Member member_of(const Machine& machine) { return {machine.robot, sensors_of(machine), 0.0, {}}; }

std::vector<Member> drawn_robots(const Machine& machine, WalkMode mode, const EnsembleOptions& options) {
  const bool passive = mode == WalkMode::semi_passive;
  const std::vector<Unknown> unknowns = furcula::biped::unknowns(machine.robot, !passive, passive);
  std::vector<Member> out;
  for (std::size_t i = 0; i < options.robots; ++i) {
    Random r(options.seed, 300 + i);
    Machine m = machine;
    for (const Unknown& u : unknowns) {
      if (!u.of_tables) continue;
      const double share = u.location == "simulator" ? kSimulator : options.deviations;
      // A uniform distribution's range is the root of three of its standard deviations.
      u.add(m, share * u.prior_sd * std::sqrt(3.0) * r.uniform(-1.0, 1.0));
    }
    make_possible(machine, m);
    Member member = member_of(m);
    member.foot_change_n = options.deviations * r.uniform(-kFootThreshold_n, kFootThreshold_n);
    push(r, machine.robot.mass_kg(), member);
    out.push_back(member);
  }
  return out;
}

}  // namespace furcula::walk
