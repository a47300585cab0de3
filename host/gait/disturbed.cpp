#include "host/gait/disturbed.hpp"

#include <algorithm>
#include <cmath>

#include "boards/sim_host/leg_rig.hpp"
#include "host/gait/gait_table.hpp"

namespace furcula::gait {

Disturbed run_disturbed(const Gait& gait, const StanceGains& gains, const DisturbedOptions& options) {
  const control::GaitConfig config = controller_config(gait, gains);
  sim_host::LegRig rig({gait.machine.leg, gait.machine.spring, gait.task.lift_off, options.ground_m,
                        options.switch_late_s, true, options.seed});
  const Apex<double> apex = apex_of(gait);
  const Joints2<double> heat = gait.machine.motors.heat();
  Disturbed out;
  double cost = 0.0, sum = 0.0, squares = 0.0;
  unsigned whole = 0;
  while (out.strides < options.strides) {
    control::GaitState state = control::begin_gait(config);
    rig.drop(apex.height, apex.speed, apex.angle);
    double stride_j = 0.0, highest = 0.0;
    unsigned counted = 0;
    for (double begin_s = rig.time_s(); out.strides < options.strides;) {
      const control::GaitOutputs told = control::step_gait(config, state, rig.sense(), 1e-3f);
      // A stride that does not end is a fall, too.
      if (told.fault != control::Fault::none || rig.time_s() - begin_s > 3.0) {
        ++out.falls;
        ++out.strides;
        break;
      }
      rig.advance(told.torque_nm);
      const auto rate = rig.plant().rate_radps();
      stride_j += 1e-3 * (std::max(electric_power(heat.hip, double(told.torque_nm.hip), rate.hip), 0.0) +
                          std::max(electric_power(heat.knee, double(told.torque_nm.knee), rate.knee), 0.0));
      highest = std::max(highest, rig.plant().hip_m().y);
      if (rig.strides() == counted) continue;
      counted = rig.strides();
      begin_s = rig.time_s();
      ++out.strides;
      ++whole;
      cost += stride_j;
      sum += highest;
      squares += highest * highest;
      stride_j = highest = 0.0;
    }
  }
  if (whole > 0) {
    const double mean = sum / whole;
    out.cost_j = cost / whole;
    out.apex_spread_m = std::sqrt(std::max(squares / whole - mean * mean, 0.0));
  }
  return out;
}

}  // namespace furcula::gait
