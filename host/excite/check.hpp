// What recordings will tell, before they are made, or do tell: intervals, and causes that cannot be told apart.
#pragma once

#include <string>
#include <vector>

#include "host/excite/design.hpp"

namespace furcula::excite {

struct Check {
  /// Of a free parameter as `furcula identify` would report it, all free ones fitted together.
  struct Parameter {
    std::string name, unit;
    double given = 0.0, half_width = 0.0;  ///< of the 95 % interval
    std::string verdict, with;             ///< identified, correlated (with), not_excited
  };
  /// Of a cause, fitted alone beside the free parameters.
  struct Number {
    std::string name, unit;
    double size = 0.0;        ///< that is looked at
    double half_width = 0.0;  ///< infinite: nothing is told
  };
  struct OfCause {
    trees::Cause cause;
    std::string name;
    std::vector<Number> numbers;
    bool seen = false;  ///< at that size it passes the score test's threshold
    bool ever = true;   ///< some motion of this robot shows it
  };
  /// The first is explained by the others together; of those that no motion tells apart each is by each.
  struct Confused {
    std::vector<std::string> names;
    double correlation = 0.0;
    bool ever = true;  ///< some motion of this robot tells them apart
  };
  std::vector<Parameter> parameters;
  std::vector<OfCause> causes;
  std::vector<Confused> confused;
  std::vector<std::string> combinations;  ///< of inertial parameters on which torques depend at all
  std::size_t windows = 0;
};

/// Of recordings, simulated or made.
Check check(const trees::TreeModel& model, const std::vector<Subject>& subjects,
            const std::vector<trees::Recording>& recordings, double window_s, unsigned threads);

/// Of designed recordings, which are simulated with the noise of their scenarios.
Check check_of(const trees::TreeModel& model, const Design& design, const Options& options);

/// As sentences: "With these recordings a and b cannot be told apart (correlation 0.99)."
std::string sentence(const Check::Confused& confused);

}  // namespace furcula::excite
