// Faults on a board's own program, see fault_trials.hpp.
#include "host/rig/fault_trials.hpp"

#include <cmath>

namespace furcula::rig {
namespace {

using safety::Moment;
using sim_host::SimBoard;

constexpr double kHopsOnS = 1.5;     ///< so long a fault is to be borne
constexpr double kLatestS = 4.0;     ///< by then each moment has come
constexpr double kInStanceS = 0.04;  ///< the middle of a stance

/// Whether the robot is there; what the controller knows the rig sees in body, leg, key and coil.
std::function<bool(const SimBoard&)> at(Moment moment) {
  double stands_since_s = -1.0;
  return [moment, stands_since_s](const SimBoard& rig) mutable {
    const auto& plant = rig.plant();
    const bool stands = plant.in_stance(), coil = rig.command().coil_duty > 0.0f;
    const bool caught = plant.clutched() == nullptr || plant.clutched()->caught();
    if (!stands)
      stands_since_s = -1.0;
    else if (stands_since_s < 0.0)
      stands_since_s = rig.time_s();
    switch (moment) {
      case Moment::flight:
        return !stands && caught && !coil && plant.velocity_mps() > 0.0;
      case Moment::stance:
        return stands && rig.time_s() > stands_since_s + kInStanceS;
      case Moment::released:
        return !stands && !caught && coil &&
               plant.toe_height_m() > plant.height_m() - plant.touchdown_height_m() + 0.02;
      case Moment::catching:
        return !stands && !caught && !coil;
    }
    return false;
  };
}

std::string judge(const safety::RigRow& row, const RigResult& result, std::optional<std::uint32_t> ticks) {
  const auto fault = static_cast<control::Fault>(result.fault);
  const std::string name = std::string(
      result.fault < control::kFaultCount ? control::info(fault).name : "a fault that the table has not");
  if (!result.complaint.empty()) return result.complaint;
  if (result.late_ticks != 0)
    return "the rig was late on " + std::to_string(result.late_ticks) +
           " ticks, and what it saw does not count";
  if (result.fault_before) return "a fault was found before anything broke";
  if (row.is_borne()) {
    if (ticks || fault != control::Fault::none) return "found " + name + ", which should be borne";
    return result.landings >= 2 ? "" : "it does not hop on";
  }
  if (!ticks) return row.may_come_to_rest ? "" : "not found";
  if (!row.may_find(fault)) return "found as " + name;
  if (*ticks > row.found_within_ticks + kSeenLaterTicks)
    return "found after " + std::to_string(*ticks) + " ticks";
  const std::uint32_t off_ticks =
      sim_host::silences_bus(row.breaks) ? safety::kDeafDriveTicks : safety::kTorqueOffTicks;
  if (result.last_torque_s > result.told_off_s + 1e-3 * off_ticks + 1e-9)
    return "torque " + std::to_string(std::lround(1e3 * (result.last_torque_s - result.told_off_s))) +
           " ms after the drive was told to be off";
  return {};
}

}  // namespace

std::vector<FaultTrial> try_on_board(const safety::RigRow& row, std::span<const Moment> moments,
                                     RigOptions options) {
  options.watched_s = row.is_borne() ? kHopsOnS : 1e-3 * row.found_within_ticks + 0.5;
  std::vector<FaultTrial> trials;
  for (const Moment moment : moments) {
    FaultTrial trial{moment, {}, {}};
    options.moment = at(moment);
    sim::Scenario scenario = safety::hopping(kLatestS + options.watched_s);
    scenario.faults = {{0.0, row.breaks, row.duration_s}};
    const RigResult result = run(safety::robot(), scenario, 1, options);
    if (result.told_off_s < RigResult::kNever)
      trial.told_off_ticks =
          static_cast<std::uint32_t>(std::lround(1e3 * (result.told_off_s - result.onset_s)));
    trial.broken_limit = judge(row, result, trial.told_off_ticks);
    trials.push_back(trial);
  }
  return trials;
}

}  // namespace furcula::rig
