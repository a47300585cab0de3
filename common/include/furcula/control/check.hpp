// Whether a configuration makes sense: before the first tick, and before a change is taken.
#pragma once

#include <cstdint>
#include <initializer_list>

#include "furcula/control/config.hpp"
#include "furcula/control/parameters.hpp"
#include "furcula/core/sine.hpp"
#include "furcula/core/status.hpp"

namespace furcula::control {

/// The members of a clutch's blocks that are no parameters.
inline bool makes_sense(const ClutchConfig& c, const CoilConfig& coil) {
  for (const float x : {c.shortest_contraction_s, c.most_acceleration_mps2, c.longest_delay_s, c.moved_m,
                        c.hesitation_m, c.still_mps, c.homing_s, c.test_pull_m, c.test_s, c.straight_m,
                        c.onset_m, c.resolution_s, coil.longest_s, coil.heat_time_constant_s})
    if (!is_finite(x) || x <= 0.0f) return false;
  for (const float x : {c.liftoff_confirmed_s, c.touchdown_margin_s, c.creep_s})
    if (!is_finite(x) || x < 0.0f) return false;
  return coil.hold_duty <= 1.0f && c.tooth_pitch_m > 1e-4f && c.tooth_play_m < c.tooth_pitch_m &&
         c.release_delay_s <= c.longest_delay_s && c.catch_wait_s <= c.longest_delay_s;
}

/// Those of the other blocks.
inline bool makes_sense(const PhaseConfig& p, const SupervisorConfig& s) {
  for (const float x : {s.speed_max_mps, s.contact_changes_max, s.contact_changes_per_s, s.toe_clear_m,
                        s.leg_error_m, s.leg_way_m, s.leg_astray_s, s.spring_rests_s})
    if (!is_finite(x) || x <= 0.0f) return false;
  for (const float x : {p.touchdown_velocity_max_mps, p.latest_report_s, s.flexed_leg_m,
                        s.implausible_closed_s, s.implausible_open_s, s.step_margin_m, s.closed_fades,
                        s.fall_share, s.fall_margin_mps, s.cable_travel_min_m})
    if (!is_finite(x)) return false;
  return true;
}

/// Of a parameter's value the sign that its bounds have; a count may be 0. The bounds themselves are a person's
/// (bus::set()): a stand or a study may go beyond them.
inline bool makes_sense(const Parameter& p, float value) {
  if (p.whole) return true;
  return is_finite(value) && (p.least > 0.0f ? value > 0.0f : p.least < 0.0f || value >= 0.0f);
}

/// `invalid`: a number is not finite, or not positive where it must be; two of them contradict each other; or the torque
/// does not fit() the envelope.
inline Status check(const Config& c) {
  for (const Parameter& p : kParameters)
    if (!makes_sense(p, p.get(c))) return Status::invalid;
  if (!makes_sense(c.phase, c.supervisor)) return Status::invalid;
  // A leg that is moved must not be straight: there it has no lever.
  if (moves_leg_in_flight(c.clutch) && !(c.supervisor.leg_angle_min_rad > 0.0f)) return Status::invalid;
  constexpr std::uint32_t kMostTicks = 100000;
  if (c.bench.rest_ticks > kMostTicks || c.bench.window_ticks > kMostTicks ||
      c.bench.watch_ticks > kMostTicks)
    return Status::invalid;
  const bool on_bench = c.bench.on_bench != 0;
  if ((moves_leg_in_flight(c.clutch) || on_bench) && !makes_sense(c.clutch, c.coil)) return Status::invalid;
  // The spring of a straight leg is nearly relaxed: one that is far from it is another robot's, and would be pushed
  // against with all that the motor has.
  constexpr float kMostStretchShare = 0.15f;
  const float stretch_m = c.clutch.spring_rest_m - c.phase.touchdown_height_m;
  const float most_m = kMostStretchShare * c.phase.touchdown_height_m;
  const float weight_n = c.envelope.mass_kg * c.envelope.gravity_mps2;
  if (moves_leg_in_flight(c.clutch) && (!(stretch_m >= -most_m && stretch_m <= most_m) ||
                                        c.clutch.spring_npm * c.envelope.least_sag_m > weight_n))
    return Status::invalid;
  // Shorter than ten ticks it is no profile.
  if (c.torque.period_s < 0.01f || c.supervisor.missed_catches_max == 0) return Status::invalid;
  return fits(c.envelope, c.torque, c.limits.torque_nm) ? Status::ok : Status::invalid;
}

}  // namespace furcula::control
