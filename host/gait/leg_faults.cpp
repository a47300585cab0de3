#include "host/gait/leg_faults.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/gait/gait_table.hpp"
#include "host/gait/search.hpp"
#include "host/gait/stability.hpp"

namespace furcula::gait {
namespace {

using control::Fault;
using sim_host::LegFault;

constexpr double kTriedFor_s = 3.0;

constexpr Fault kNoNumber[] = {Fault::non_finite_input};
constexpr Fault kJump[] = {Fault::encoder_jump};
constexpr Fault kStale[] = {Fault::stale_input};
constexpr Fault kLost[] = {Fault::peer_lost};
constexpr Fault kGround[] = {Fault::encoder_implausible, Fault::contact_implausible};
constexpr Fault kKnee[] = {Fault::encoder_implausible, Fault::leg_astray, Fault::height_out_of_range,
                           Fault::contact_implausible, Fault::leg_angle_out_of_range};
constexpr Fault kDrive[] = {
    Fault::leg_astray,          Fault::height_out_of_range, Fault::leg_angle_out_of_range,
    Fault::encoder_implausible, Fault::encoder_jump,        Fault::contact_implausible};

constexpr LegFaultRow kRows[] = {
    {LegFault::height_nan, "height_nan", "the boom's reference is lost", kNoNumber, 0},
    {LegFault::height_jumps, "height_jumps", "the boom's counter jumps by 5 cm", kJump, 0},
    {LegFault::sample_stale, "sample_stale", "the same old sample, whose age grows", kStale, 2},
    {LegFault::sample_missing, "sample_missing", "no answer; one lost sample is bridged", kLost, 2},
    {LegFault::height_stuck, "height_stuck", "the boom's counter stands still", kGround, 600},
    {LegFault::switch_stuck_closed, "switch_stuck_closed", "the contact switch reads closed", kGround, 600},
    {LegFault::knee_stuck, "knee_stuck", "the knee's encoder stands still", kKnee, 1500},
    {LegFault::knee_drive_off, "knee_drive_off", "the knee's drive gives no torque", kDrive, 3000},
};

}  // namespace

std::span<const LegFaultRow> leg_fault_rows() { return kRows; }

LegTrial try_leg_fault(const Gait& gait, LegFault breaks, double at_s) {
  const control::GaitConfig config = controller_config(gait, kStanceGains);
  sim_host::LegRig rig(
      {gait.machine.leg, gait.machine.spring, gait.task.lift_off, 0.01, 5e-3, true, 1, breaks, at_s});
  const auto apex = apex_of(gait);
  rig.drop(apex.height, apex.speed, apex.angle);
  control::GaitState state = control::begin_gait(config);
  LegTrial out;
  double found_s = -1.0;
  std::uint32_t ticks = 0;  // before this one, that had the fault
  while (rig.time_s() < at_s + kTriedFor_s) {
    const bool broken = rig.time_s() >= at_s;
    const control::GaitOutputs told = control::step_gait(config, state, rig.sense(), 1e-3f);
    if (told.fault != Fault::none && found_s < 0.0) {
      found_s = rig.time_s();
      out.found = told.fault;
      out.after_ticks = ticks;
    }
    ticks += broken ? 1 : 0;
    if (found_s >= 0.0) {
      out.torque_after_nm = std::max<double>(
          out.torque_after_nm, std::max(std::abs(told.torque_nm.hip), std::abs(told.torque_nm.knee)));
      if (rig.time_s() > found_s + 0.2) break;
    }
    rig.advance(told.torque_nm);
  }
  return out;
}

std::string leg_fault_section() {
  Query query;
  query.machine = spear(LegSpring::switched);
  query.task.clearance_m = 0.075;
  query.starts = 1;
  const Search found = find_gait(query);
  if (!found.gait) throw core::DataError("the leg of document 001: no gait was found to try its faults on");
  std::string out = R"(
## A planar leg that plays a gait

Ticks of 1 ms ([conditions](fault_handling.md#a-planar-leg-that-plays-a-gait)).

| what breaks | what it is | found as | allowed | SIL |
|---|---|---|---|---|
)";
  for (const LegFaultRow& row : leg_fault_rows()) {
    std::uint32_t most = 0;
    std::string as;
    for (const Fault fault : row.finds)
      as += (as.empty() ? "`" : ", `") + std::string(control::info(fault).name) + "`";
    for (const double at_s : kLegFaultTimes_s)
      most = std::max(most, try_leg_fault(*found.gait, row.breaks, at_s).after_ticks);
    out += "| `" + std::string(row.name) + "` | " + std::string(row.meaning) + " | " + as + " | " +
           std::to_string(row.within_ticks) + " | " + std::to_string(most) + " |\n";
  }
  return out;
}

}  // namespace furcula::gait
