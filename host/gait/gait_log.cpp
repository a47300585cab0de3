#include "host/gait/gait_log.hpp"

#include <cmath>

#include "boards/sim_host/leg_rig.hpp"
#include "furcula/control/fault.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/gait/gait_table.hpp"
#include "host/gait/stability.hpp"

namespace furcula::gait {

log::Log log_of_gait(const Gait& gait, const Machine& machine, const GaitLogOptions& options) {
  const control::GaitConfig config = controller_config(gait, kStanceGains);
  sim_host::LegRig rig({.leg = machine.leg,
                        .spring = machine.spring,
                        .lift_off = gait.task.lift_off,
                        .ground_m = options.ground_m,
                        .seed = options.seed});
  control::GaitState state = control::begin_gait(config);
  const Apex<double> apex = apex_of(gait);
  rig.drop(apex.height, apex.speed, apex.angle);
  log::Log out;
  out.rig = "tree";
  const auto ticks = static_cast<std::size_t>(std::lround(options.duration_s / sim_host::LegRig::kTick_s));
  for (std::size_t k = 0; k < ticks; ++k) {
    const control::GaitInputs in = rig.sense();
    const control::GaitOutputs told = control::step_gait(config, state, in, 1e-3f);
    if (told.fault != control::Fault::none) {
      const auto& fault = control::info(told.fault);
      throw core::DataError(gait.machine.file + ": the robot falls at " + core::rounded(rig.time_s()) +
                            " s (" + std::string(fault.name) + "); expected a gait that its feedback keeps");
    }
    constexpr double kCount_m = 1e-4;  // of the boom
    out.columns["time_s"].push_back(rig.time_s());
    out.columns["position_boom_travel_m"].push_back(kCount_m * std::round(rig.plant().hip_m().x / kCount_m));
    out.columns["position_boom_height_m"].push_back(in.sample.height_m);
    out.columns["angle_hip_rad"].push_back(in.sample.angle_rad.hip);
    out.columns["angle_knee_rad"].push_back(in.sample.angle_rad.knee);
    out.columns["torque_cmd_hip_nm"].push_back(told.torque_nm.hip);
    out.columns["torque_cmd_knee_nm"].push_back(told.torque_nm.knee);
    out.columns["contact_toe"].push_back(in.sample.contact);
    rig.advance(told.torque_nm);
  }
  return out;
}

}  // namespace furcula::gait
