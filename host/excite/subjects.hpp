// What recordings are to tell: the model's free parameters, and the causes that the score test looks for, each with a size.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "host/trees/fit.hpp"
#include "host/trees/simulate.hpp"

namespace furcula::excite {

/// A free parameter, a free body (ten numbers) or a cause, as changes of the model as given.
struct Subject {
  std::string name;                   ///< "damping_nmspr.elbow", "inertial.fore", "coulomb_friction@elbow"
  bool free = false;                  ///< of [free]
  std::optional<trees::Cause> cause;  ///< at the size that is looked at
  struct Number {
    std::string name, unit;
    double size;                ///< typical, in the unit
    trees::Hypothesis changed;  ///< the model with a change of `change`
    double change;
  };
  std::vector<Number> numbers;
  Eigen::Index first = 0;  ///< of its columns
  Eigen::Index columns() const { return static_cast<Eigen::Index>(numbers.size()); }
};

/// Free parameters in units of the standard deviation of a number that is anywhere between the bounds, bodies in units of what is known of them
/// beforehand, causes in units of what the score test probes them with on `reference`. Left out are causes at several locations, which
/// are sums of others, and those whose size decides whether they show at all: saturation, binding, ripple, elasticity.
std::vector<Subject> subjects(const trees::Problem& reference);

/// The models of all numbers of the subjects, and sizes over changes: what makes a column by a change one by the number's size.
struct Probes {
  std::vector<trees::Hypothesis> changed;
  Eigen::VectorXd scale;
};
Probes probes_of(const std::vector<Subject>& subjects);

/// What a recording of the scenario tells: columns of all subjects in units of their sizes, weighed as `furcula identify` does, times
/// themselves. The recording is simulated, with the usual noise of `furcula sim`. Every `every`-th window is looked at, from
/// `first` on; the others are taken as like them.
Eigen::MatrixXd information(const trees::TreeModel& model, const std::vector<Subject>& subjects,
                            const trees::Scenario& scenario, std::uint64_t seed, double window_s,
                            std::size_t every, std::size_t first = 0);

}  // namespace furcula::excite
