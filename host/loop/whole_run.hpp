// Whole walks simulated beside recorded ones: document 000's model error (Eq. 3), and its identification by an evolutionary search for the least.
//
// Unlike a window, a whole simulated walk is driven by the walking controller: its targets differ from the robot's, and when its feet land.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/floating/identify.hpp"
#include "host/walk/method.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::loop {

/// A recording and the walk that the robot was given.
struct WholeRun {
  const floating::Recording* recording = nullptr;
  walk::Walk walk;
};

/// Eq. 3 of each run, rad: root mean square of measured less simulated over joint angles, joint targets, roll, pitch and yaw, in the rows of the
/// recording (before a fall). Both begin where the first target leaves its place; a simulated robot that has fallen stays as it is. Yaw counts from there on.
/// @param model whose controller the robot has
std::vector<double> whole_run_errors_rad(const walk::Model& model, const floating::Machine& machine,
                                         const std::vector<WholeRun>& runs, unsigned threads);

/// A recording and the simulated walk beside it, row by row, as Eq. 3 compares them.
struct BesideSimulation {
  static constexpr std::size_t kNumbers =
      2 * biped::kJoints + 3;  ///< joint angles, joint targets, roll, pitch, yaw
  std::vector<double> time_s;  ///< from where both begin
  std::array<std::vector<double>, kNumbers> measured_rad, simulated_rad;
};
BesideSimulation beside_simulation(const walk::Model& model, const floating::Machine& machine,
                                   const WholeRun& run);

struct WholeRunOptions {
  walk::MethodKind method = walk::MethodKind::mutation;  ///< named by document 000
  std::uint64_t steps = 200'000'000;                     ///< of simulation, of all runs together
  std::uint64_t seed = 1;
  unsigned threads = 1;
  floating::Machine start;  ///< a robot that the search begins with
  std::function<void(double fraction, const std::string& doing)> progress;
};

struct WholeRunFit {
  std::vector<biped::Unknown> unknowns;  ///< that were sought
  floating::Machine machine;
  double start_rad = 0.0, error_rad = 0.0;  ///< Eq. 3 over all runs, of the start and of the result
  std::uint64_t simulations = 0;            ///< of a run each
};

/// The numbers of document 000, Tables I and II, within their ranges about the model, with which Eq. 3 over all runs is least. The same for any
/// number of threads.
WholeRunFit fit_whole_runs(const walk::Model& model, const std::vector<WholeRun>& runs,
                           const WholeRunOptions& options);

/// identification.json without posterior and causes, and with Eq. 3 (docs/biped.md); windows' errors of the model as given and of the result.
std::string to_json_text(const WholeRunFit& found, const floating::Machine& given,
                         const floating::WindowErrors& before, const floating::WindowErrors& after);

}  // namespace furcula::loop
