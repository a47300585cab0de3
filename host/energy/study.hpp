// When the clutch pays: the leg folds in flight against a caught spring, with the spring let go, or has none
// and stands on its motor, at the same apex (002 section 5.2).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/energy/energy.hpp"
#include "host/model/model.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::energy {

struct Options {
  Motor motor;
  double apex_m = 0.34;
  double clutch_mass_kg = 1.0;  ///< that the robot with the clutch carries more than the model
  double most_contraction_m = 0.10;
  std::size_t points = 21;
  double period_s = 0.3;  ///< of the harmonic torque
  unsigned threads = 1;
  std::function<void(double fraction, std::string_view doing)> progress;
};

/// The three robots at one contraction; absent where one cannot reach the apex.
struct Point {
  double contraction_m = 0.0;
  std::optional<Settled> caught;      ///< without the clutch and its mass, folding against the spring
  std::optional<Settled> clutched;    ///< with both
  std::optional<Settled> springless;  ///< of the mass of `caught`; in stance the motor is the spring
};

/// The robot of a model with a clutch, without spring and clutch: of the same mass, its plant without
/// stiffness. To its controller it is one whose cable hangs loose: in stance the motor pushes with
/// k (z0 - z) from the measured leg angle, as it does when the leg lands on a spring that was not caught.
Robot springless_robot(const model::Model& model, const sim::Scenario& scenario);

/// What counts as the energy of a hop.
enum class Measure { mechanical, electrical };  ///< motor's positive work and coil; copper losses too
double cost_j(const HopEnergy& energy, Measure measure);

/// The contraction from which on one robot costs less than another and goes on to, by straight lines between
/// the points; absent if nowhere.
std::optional<double> break_even_m(const std::vector<Point>& points, Measure measure,
                                   std::optional<Settled> Point::*one = &Point::clutched,
                                   std::optional<Settled> Point::*other = &Point::caught);

/// The accounting of 002 section 5.2: work k A^2 / 2 against the spring on the one side; on the other a coil
/// that takes its full power for the whole flight, and what the clutch's mass costs.
struct Published {
  double coil_j = 0.0, mass_j = 0.0;
  double break_even_m = 0.0;            ///< k A^2 / 2 = coil
  double break_even_with_mass_m = 0.0;  ///< k A^2 / 2 = coil + mass
};

/// The break-even of a robot with one thing changed.
struct Variant {
  std::string what;
  std::optional<double> mechanical_m, electrical_m;
};

struct Study {
  Options options;
  std::vector<Point> points;
  Published published;
  std::optional<double> mechanical_m, electrical_m;                        ///< break-even
  std::optional<double> springless_mechanical_m, springless_electrical_m;  ///< without one against caught
  std::vector<Variant> variants;
};

/// The model is a hopper_nonlinear with a clutch. The same for any number of threads. @throws core::DataError
/// for another.
Study run_study(const model::Model& model, const Options& options);

}  // namespace furcula::energy
