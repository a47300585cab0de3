// Walk on the robot, identify, search the walk again on the identified robot and others about it, and so on (document 000, section IV).
//
// With IdentifyBy::windows the robot moves its legs on its stand first. All identifications have this recording; from it alone the model is identified about
// which the first walk is searched.
//
// Files in `out` are what a loop goes on from: round_0/walk.toml and log_1.csv of this exercise, round_0/identified_model.toml with identification.json
// and .html, round_1/walk.toml with walk.json and report.html, round_1/log_1.csv ..., round_1/identified_model.toml ... A file that is there is
// whole, and its step is done. loop.json and, from the first trial on, report.html are written after each step; of loop.json the errors of the triangle are read again.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/floating/identify.hpp"
#include "host/loop/trial.hpp"
#include "host/loop/triangle.hpp"
#include "host/loop/whole_run.hpp"
#include "host/walk/checkpoint.hpp"
#include "host/walk/ensemble.hpp"

namespace furcula::loop {

/// What a round's model is identified by.
enum class IdentifyBy : std::uint8_t {
  windows,  ///< all numbers with priors, causes named (host/floating/identify.hpp)
  whole_run,  ///< document 000's way: an evolutionary search for the least Eq. 3 over whole walks (whole_run.hpp)
  none        ///< it is not: each walk is searched about the model as given
};
inline constexpr std::array<std::string_view, 3> kIdentifyByNames{"windows", "whole_run", "none"};

/// A round walks where this share of its trials does.
inline constexpr double kShare = 0.8;
/// Of the way that the walk gets in simulation, which a trial must get at least, and the least that is asked, m.
inline constexpr double kWayShare = 0.5, kLeastWay_m = 0.1;

struct LoopOptions {
  std::string model, walk, robot, out;
  unsigned rounds = 3, repetitions = 1;
  std::optional<walk::WalkMode> mode;  ///< of searches; without it the walk's
  /// On the stand, before the first walk, with IdentifyBy::windows; 0: none, and the first walk is `walk`.
  double exercise_s = 10.0;
  std::uint64_t steps = 200'000'000;  ///< of a search
  walk::EnsembleOptions ensemble;     ///< other robots of a search, with a seed of each round's
  IdentifyBy identify_by = IdentifyBy::windows;
  std::uint64_t seed = 1;  ///< of the first search; each later one has the next
  unsigned threads = 1;
  floating::IdentifyOptions identify;
  std::function<void(const std::string& line)> say;
  /// Of a step that takes a while.
  std::function<void(double fraction, const std::string& doing)> progress;
};

struct TrialResult {
  std::string log;  ///< its file in `out`
  Outcome outcome;
  bool walks = false;  ///< stands, and has got far enough
};

/// What an identification names (host/floating/causes.hpp).
struct NamedCause {
  std::string name, unit;
  double deviation = 0.0, confidence = 0.0;
};

struct Identification {
  /// Of the model as given and as identified, on what it was identified from.
  floating::WindowErrors given, identified;
  std::vector<NamedCause> causes;
  bool all_numbers_deviate = false;  ///< as of floating::Causes
  /// Eq. 3 over all trials so far, before and after a search over whole walks, rad.
  std::optional<std::pair<double, double>> whole_run_rad;
};

struct Round {
  std::string walk;         ///< its file in `out`
  walk::Rollout simulated;  ///< of the walk on the model that it was searched on
  double asked_m = 0.0;     ///< the least way of a trial that walks
  std::vector<TrialResult> trials;
  bool walks = false;
  std::optional<Identification> identification;  ///< from all recordings so far
};

struct LoopResult {
  std::string exercise;                       ///< its log in `out`; empty: none
  std::optional<Identification> of_exercise;  ///< from its log alone
  std::vector<Round> rounds;                  ///< the last one has trials alone
  Triangle triangle;
  bool walks = false;  ///< the last walk does
  std::string ended;   ///< where no walk to try was found, why
  /// The last trial beside the simulation that its walk was searched in; none where nothing was simulated.
  std::optional<BesideSimulation> last_trial;
};

/// Does what is not done yet. @throws core::DataError: `out` has another loop, with what differs; a trial that cannot be used.
LoopResult run_loop(const LoopOptions& options);

/// loop.json, `furcula-walk-loop/2` (docs/biped.md).
std::string to_json_text(const walk::Settings& settings, const LoopOptions& options,
                         const LoopResult& result);
/// @throws core::DataError: not a loop.json.
walk::Settings settings_in(const std::string& path);
/// Of a loop.json without a triangle, none. @throws core::DataError: not a loop.json.
Triangle triangle_in(const std::string& path);
/// Walks, trials, identifications' errors and triangle of a loop.json: no causes and simulations. @throws core::DataError: not a loop.json.
LoopResult loop_in(const std::string& path);
/// Of an identification.json. @throws core::DataError
Identification read_identification(const std::string& path);

}  // namespace furcula::loop
