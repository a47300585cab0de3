// The blind suite's cases of robots: which causes, how large, and what the diagnosis gets to see.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/hidden/trees/recording.hpp"

namespace furcula::hidden::trees {

enum class Tier { clean, small, medium, large, tied, pairs, triple, outside };
inline constexpr Tier kTiers[] = {Tier::clean, Tier::small, Tier::medium, Tier::large,
                                  Tier::tied,  Tier::pairs, Tier::triple, Tier::outside};
std::string_view name(Tier tier);

/// The effects of the catalogue that can be planted, in a fixed order.
const std::vector<std::string>& catalogue();
const std::vector<std::string>& leg_catalogue();
/// The causes that no catalogue knows.
const std::vector<std::string>& outside_causes();
const std::vector<std::string>& leg_outside_causes();

/// Causes of one family hide each other at one seat: none is planted beside another there.
std::string family(const std::string& effect);

struct Question {
  std::uint64_t seed = 1;
  Tier tier = Tier::medium;
  std::size_t joints = 0;            ///< 0: 2 to 7
  std::vector<std::string> effects;  ///< as many as the tier plants; empty: clean
  bool brief = false;                ///< four logs of 4 s at 200 Hz; of a leg of 5 s at 500 Hz
  bool leg = false;                  ///< the hopping monopod in place of a robot
};

struct Case {
  Question question;
  Robot robot;                    ///< as the model has it
  std::vector<DriveData> drives;  ///< as they are, but for what is planted
  std::vector<DriveData> model;   ///< as the model says
  bool free_damping = false;
  Lab lab;
  std::vector<Cause> planted;
  std::vector<Recording> logs;  ///< the last `held_out` are
  std::size_t held_out = 0;
  std::size_t redrawn_logs = 0;  ///< of a leg: experiments in which it fell
  std::size_t redrawn = 0;       ///< robots and plantings that were drawn in vain before
  /// Of each cause: what it changes in a restart of 0.3 s, over what the disturbance does there, or a step of
  /// the encoder if that is more, at the joint where that is most.
  std::vector<double> shows;

  Machine truth() const { return {robot, drives, lab.position_control, planted}; }
  Machine with(const std::vector<Cause>& causes) const {
    return {robot, drives, lab.position_control, causes};
  }
  std::size_t visible() const { return robot.size(); }
};

/// Restarts of 0.3 s in the held-out recordings; of a leg of 0.15 s, each within one flight or stance: rms
/// difference of each joint between two predictions, or between a prediction and what was measured without
/// noise.
struct Restarts {
  explicit Restarts(const Case& c);
  std::vector<std::vector<Values>> of(const Machine& machine) const;
  const Case& c;
  Machine truth;
  std::vector<std::vector<Values>> happened;
  struct Window {
    std::size_t log, begin, end;
  };
  std::vector<Window> windows;

 private:
  void add(const Window& window);
  void windows_of_a_leg(std::size_t log);
};
Values rms_difference(const std::vector<std::vector<Values>>& a, const std::vector<std::vector<Values>>& b);

/// Draws robot, laboratory, causes and recordings. Throws std::runtime_error if after many draws nothing
/// shows.
Case draw_case(const Question& question);

/// Writes robot.urdf, model.toml, log_NN.csv and truth.json; returns the logs' names, the held-out ones last.
std::vector<std::string> write_case(const Case& c, const std::string& folder);

}  // namespace furcula::hidden::trees
