// Document 000, "Semi-Passive Walk and Active Walk by One Bipedal Robot", sections II and III: its figures computed anew with walks that a
// search finds, and section IV's energies beside simulated ones and its Figs. 7 and 8 beside loops that were run.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/reproduce/comparison.hpp"
#include "host/reproduce/loops_000.hpp"
#include "host/reproduce/omissions.hpp"
#include "host/walk/energy_study.hpp"
#include "host/walk/return_map.hpp"

namespace furcula::reproduce {

struct WalkStudyOptions {
  std::uint64_t seed = 1;
  std::uint64_t steps = 300'000'000;      ///< of simulation, of each mode's search
  std::uint64_t case_steps = 30'000'000;  ///< of each case's of the energy study
  unsigned threads = 1;
  std::string model;  ///< the robot's file
  /// Walks that are there already, active and semi-passive, in place of searches.
  std::vector<walk::Walk> walks;
  std::vector<std::string> loops;  ///< folders of `furcula walk loop`
  std::function<void(double fraction, std::string_view doing)> progress;
};

/// Of one mode, active or semi-passive.
struct StudiedWalk {
  walk::WalkMode mode;
  bool found = false;
  walk::Parameters walk;
  std::optional<walk::SearchState> search;  ///< none: the walk was given
  walk::EnergyBalance energy;
  walk::Rollout six_s;  ///< its first 6 s
  walk::ReturnMap map;
  std::vector<walk::EnergyCase> cases;
};

/// The hip's clutch, section II: a pin that goes in while the motor follows the swinging link, and what a swing keeps.
struct PinIn {
  double time_s = 0.0;     ///< from the servo's start to the pin all the way in
  double apart_rad = 0.0;  ///< most between motor and link meanwhile
  /// The angle at which a link let go at 0.5 rad turns round, over 0.5 rad: clutch open; motor joined, without current.
  double back_open = 0.0, back_joined = 0.0;
};

struct WalkReproduction {
  WalkStudyOptions options;
  walk::Model model;
  std::vector<StudiedWalk> walks;
  PinIn pin;
  LoopStudy loops;
  std::vector<Row> rows;
  std::vector<Row> times;  ///< what hangs on this machine, not in the JSON
  std::vector<Omission> omissions;
  double seconds = 0.0;
};

/// The same for any number of threads, but for the times. @throws core::DataError, and what walk::read_model throws.
WalkReproduction reproduce_000(const WalkStudyOptions& options);

/// `furcula-reproduction/1`, and the page.
std::string to_json_text(const WalkReproduction& r);
std::string render_walk_reproduction_report(const WalkReproduction& r, const std::string& command);

}  // namespace furcula::reproduce
