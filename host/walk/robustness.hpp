// What a walk that was found is worth: simulated again, more finely, with sensors that err, on slopes, with another mass.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/member.hpp"
#include "host/walk/return_map.hpp"
#include "host/walk/rollout.hpp"
#include "host/walk/sensors.hpp"

namespace furcula::walk {

/// A walk in double as it went.
struct Trial {
  std::string what;
  Rollout rollout;
};

struct Robustness {
  std::vector<Trial> steps;    ///< of 1, 0.5, 0.25 and 0.125 ms, all with ticks of 1 ms
  std::vector<Trial> changed;  ///< slopes of a degree, 5 % more and less mass, 10 s more to stand
  unsigned noisy = 0;          ///< walks with sensors that err, each with errors of its own
  unsigned noisy_stand = 0, noisy_keep_limits = 0;
  SensorErrors errors;
  unsigned drawn = 0, drawn_stand = 0;  ///< other robots, in float, and those on which it stands
  ReturnMap map;
};

/// `drawn`: the other robots. `told` from 0 to 1.
Robustness robustness_of(const dynamics::biped::Description& robot, const RolloutOptions& options,
                         const Parameters& walk, const std::vector<Member>& drawn, unsigned threads,
                         const std::function<void(double)>& told = {});

/// The robot with all masses and inertias times `factor`.
dynamics::biped::Description heavier(dynamics::biped::Description robot, double factor);

}  // namespace furcula::walk
