// Random faults in random experiments, many of them, and what of it was unsafe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "boards/sim_host/faults.hpp"
#include "furcula/control/fault.hpp"
#include "host/safety/trial.hpp"

namespace furcula::safety {

/// A random experiment: one to three faults of random kind, instant and duration, in a robot that hops with
/// random torque, contraction, ground and sensors, three quarters of them on a bus. In three of four, parameters
/// of the table are drawn over all of their bounds: one, two to four, or all.
struct Injection {
  std::uint64_t seed = 0;
  sim::Scenario scenario;
  Rig rig = Rig::on_bus;
  std::vector<DrawnParameter> parameters;
};

/// How many of the table's parameters are drawn.
enum class Drawn : std::uint8_t { none, one, few, all };
inline constexpr std::array<std::string_view, 4> kDrawn{"none", "one", "two to four", "all"};
Drawn drawn(const Injection& injection);

Trial run(const model::Model& model, const Injection& injection);

/// The experiment of a number; the same seed and number give the same one.
Injection draw_injection(std::uint64_t seed, std::uint64_t number);

struct UnsafeRun {
  std::uint64_t number = 0;
  Trial trial;
};

struct Tally {
  /// Of `runs`, those whose configuration was refused ran not at all. Early: a fault was found before anything
  /// was broken, in a robot with other parameters than its own; with its own it is a false alarm.
  std::uint64_t runs = 0, refused = 0, found = 0, borne = 0, early = 0, false_alarms = 0;
  /// By kind of the fault that was planted first: runs, those in which the controller found a fault, and
  /// unsafe ones.
  struct Kind {
    std::uint64_t runs = 0, found = 0, unsafe = 0;
  };
  std::array<Kind, sim_host::kRigFaults.size()> kinds{};
  /// By how many parameters were drawn, and by the parameter where it was one.
  struct Parameters {
    std::uint64_t runs = 0, refused = 0, early = 0, unsafe = 0;
  };
  std::array<Parameters, kDrawn.size()> by_drawn{};
  std::array<Parameters, bus::kParameters.size()> by_parameter{};
  std::array<std::uint64_t, control::kFaultCount> by_fault{};
  std::array<std::uint64_t, kUnsafe.size()> by_outcome{};
  std::uint32_t longest_coil_in_stance_ticks = 0, longest_torque_off_ticks = 0;
  double lowest_m = 1e9, highest_m = 0.0, hardest_mps = 0.0, fastest_toe_mps = 0.0;
  std::vector<UnsafeRun> unsafe;  ///< by number
};

/// One experiment in words and figures, for a person: what was drawn, what broke, and what came of it.
std::string format_run(const Injection& injection, const Trial& trial);

/// Experiments 0 to `count` - 1. The result does not depend on `threads`.
Tally inject(std::uint64_t seed, std::uint64_t count, unsigned threads);

/// The tally in words and figures, for a person.
std::string format_tally(const Tally& tally);

}  // namespace furcula::safety
