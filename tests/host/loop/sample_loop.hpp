// A loop of three rounds with two trials each, as if it had been run: for tests of its page.
#pragma once

#include "host/loop/loop_report.hpp"

namespace furcula::test {

/// Of all channels alike, so that it is the error of angles and attitude together too.
inline double sample_error_rad(int model, unsigned round, unsigned repetition) {
  const int hundreds = model == loop::kGiven ? 1 : model == 0 ? 5 : model + 1;
  return 1e-3 * (100.0 * hundreds + 10.0 * round + repetition);
}

/// The robot falls in round 1, stands in the second trial of round 2, and in both of round 3.
inline loop::LoopResult sample_loop() {
  loop::LoopResult out;
  out.exercise = "round_0/log_1.csv";
  out.of_exercise.emplace().causes = {{"command_delay@drives", "s", 0.0121, 0.75}};
  for (unsigned round = 1; round <= 3; ++round) {
    loop::Round r;
    const std::string folder = "round_" + std::to_string(round);
    r.walk = folder + "/walk.toml";
    r.simulated.ending = walk::Ending::stands;
    r.simulated.distance_m = 1.25;
    r.simulated.cot = 0.75 + round;
    r.asked_m = 0.625;
    for (unsigned k = 1; k <= 2; ++k) {
      loop::TrialResult t;
      t.log = folder + "/log_" + std::to_string(k) + ".csv";
      t.outcome.stands = round + k > 3;
      if (!t.outcome.stands) t.outcome.fall_s = 2.5 + 0.1 * k;
      t.outcome.time_s = t.outcome.stands ? 10.0 : 2.35 + 0.1 * k;
      t.outcome.way_m = 0.3 * round;
      t.walks = round == 3;
      r.trials.push_back(t);
      for (int model = loop::kGiven; model <= 2; ++model) {
        if (model != loop::kGiven && static_cast<int>(round) > model + 1) continue;
        const double e = sample_error_rad(model, round, k);
        floating::WindowErrors errors;
        errors.windows = 20;
        errors.angle_rad = errors.attitude_rad = errors.gyro_radps = e;
        out.triangle[{model, round, k}] = {errors, 10.0 * e};
      }
    }
    r.walks = round == 3;
    if (round < 3) {
      loop::Identification& i = r.identification.emplace();
      i.all_numbers_deviate = round == 2;
      if (round == 1) i.causes = {{"coulomb_friction@left_knee", "N m", 6.28, 0.875}};
    }
    out.rounds.push_back(r);
  }
  out.walks = true;
  return out;
}

}  // namespace furcula::test
