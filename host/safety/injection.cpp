// Drawing and running random experiments, see injection.hpp.
#include "host/safety/injection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "boards/sim_host/random.hpp"
#include "host/identify/parallel.hpp"

namespace furcula::safety {
namespace {

using sim_host::Random;
using sim_host::RigFault;

/// One of 0 to count - 1.
std::size_t pick(Random& random, std::size_t count) {
  const auto n = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(count)));
  return std::min(n, count - 1);
}

sim_host::PlannedFault draw_fault(Random& random, Rig rig, double latest_s) {
  sim_host::PlannedFault fault;
  do {
    fault.kind = sim_host::kRigFaults[pick(random, sim_host::kRigFaults.size())].fault;
  } while (rig == Rig::local && sim_host::info(fault.kind).part == sim_host::RigPart::bus);
  // Whole milliseconds, as ticks are.
  fault.time_s = 1e-3 * std::floor(random.uniform(1.0, 1e3 * latest_s));
  // From one tick to longer than the run, every order of magnitude alike.
  fault.duration_s = 1e-3 * std::ceil(std::pow(10.0, random.uniform(0.0, 3.3)));
  if (fault.kind == RigFault::late_tick) fault.duration_s = 1e-3 * std::ceil(random.uniform(0.0, 20.0));
  // Nobody swaps a motor's wires, or a drive, while the robot hops.
  if (fault.kind == RigFault::drive_reversed || fault.kind == RigFault::drive_of_other_motor)
    fault.time_s = 1e-3, fault.duration_s = 1e3;
  if (fault.kind == RigFault::brown_out) fault.duration_s = 1e-3 * std::ceil(random.uniform(10.0, 500.0));
  if (fault.kind == RigFault::task_stuck) fault.duration_s = 1e-3 * std::ceil(random.uniform(6.0, 200.0));
  return fault;
}

bool chance(Random& random, double share) { return random.uniform(0.0, 1.0) < share; }

void add(Tally& tally, const Injection& injection, std::uint64_t number, const Trial& trial) {
  ++tally.runs;
  const bool found = trial.fault != control::Fault::none;
  ++(found ? tally.found : tally.borne);
  if (trial.false_alarm) ++tally.false_alarms;
  ++tally.by_fault[static_cast<std::size_t>(trial.fault)];
  Tally::Kind& kind = tally.kinds[static_cast<std::size_t>(injection.scenario.faults.front().kind)];
  ++kind.runs;
  if (found) ++kind.found;
  tally.longest_coil_in_stance_ticks =
      std::max(tally.longest_coil_in_stance_ticks, trial.longest_coil_in_stance_ticks);
  tally.longest_torque_off_ticks = std::max(tally.longest_torque_off_ticks, trial.torque_off_ticks);
  tally.lowest_m = std::min(tally.lowest_m, trial.lowest_m);
  tally.highest_m = std::max(tally.highest_m, trial.highest_m);
  tally.hardest_mps = std::max(tally.hardest_mps, trial.hardest_mps);
  tally.fastest_toe_mps = std::max(tally.fastest_toe_mps, trial.fastest_toe_mps);
  if (trial.unsafe == 0 && !trial.false_alarm) return;
  if (trial.unsafe != 0) ++kind.unsafe;
  for (const UnsafeInfo& u : kUnsafe)
    if (trial.is(u.outcome)) ++tally.by_outcome[static_cast<std::size_t>(u.outcome)];
  tally.unsafe.push_back({number, trial});
}

}  // namespace

Injection draw_injection(std::uint64_t seed, std::uint64_t number) {
  Random random(seed, 100 + number);
  Injection injection;
  injection.seed = seed ^ number;
  injection.rig = chance(random, 0.75) ? Rig::on_bus : Rig::local;
  sim::Scenario& s = injection.scenario;
  s = hopping(random.uniform(0.5, 1.5));
  s.start_position = random.uniform(0.29, 0.42);
  s.amplitude = random.uniform(0.0, 3.5);
  s.period_s = random.uniform(0.25, 0.35);
  s.release_in_flight = chance(random, 0.85);
  s.contraction_m = random.uniform(0.0, 0.09);
  s.ground_steps_m = chance(random, 0.5) ? random.uniform(0.0, 0.03) : 0.0;
  s.sensors = {chance(random, 0.7), chance(random, 0.7), chance(random, 0.7), chance(random, 0.7)};
  const std::size_t count = 1 + pick(random, 3);
  for (std::size_t i = 0; i < count; ++i) s.faults.push_back(draw_fault(random, injection.rig, s.duration_s));
  return injection;
}

Tally inject(std::uint64_t seed, std::uint64_t count, unsigned threads) {
  Tally tally;
  std::mutex guard;
  const model::Model model = robot();
  identify::parallel_for(count, threads, [&](std::size_t number) {
    const Injection injection = draw_injection(seed, number);
    const Trial trial = run_trial(model, injection.scenario, injection.seed, injection.rig);
    const std::lock_guard lock(guard);
    add(tally, injection, number, trial);
  });
  std::sort(tally.unsafe.begin(), tally.unsafe.end(),
            [](const UnsafeRun& a, const UnsafeRun& b) { return a.number < b.number; });
  return tally;
}

std::string format_run(const Injection& injection, const Trial& trial) {
  const sim::Scenario& s = injection.scenario;
  std::string text;
  char line[200];
  const auto put = [&](const auto&... values) {
    std::snprintf(line, sizeof line, values...);
    text += line;
  };
  put("%s, %.3f s from %.3f m, torque %.2f N m for %.3f s, contraction %.3f m, ground within %.3f m\n",
      injection.rig == Rig::on_bus ? "on a bus" : "without a bus", s.duration_s, s.start_position,
      s.amplitude, s.period_s, s.release_in_flight ? s.contraction_m : 0.0, s.ground_steps_m);
  for (const sim_host::PlannedFault& f : s.faults)
    put("%s at %.3f s, for %.3f s\n", std::string(sim_host::info(f.kind).name).c_str(), f.time_s,
        f.duration_s);
  text += "found: " + std::string(control::info(trial.fault).name);
  if (trial.false_alarm)
    text += ", before anything was broken: a false alarm";
  else if (trial.fault != control::Fault::none)
    put(", %u ms after the first", trial.found_tick);
  text += trial.unsafe == 0 ? "\nunsafe: nothing" : "\nunsafe:";
  for (const UnsafeInfo& u : kUnsafe)
    if (trial.is(u.outcome)) text += " " + std::string(u.name);
  return text + "\n";
}

std::string format_tally(const Tally& t) {
  std::string text;
  char line[200];
  const auto put = [&](const auto&... values) {
    std::snprintf(line, sizeof line, values...);
    text += line;
  };
  const auto n = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
  put("%llu runs: a fault found in %llu, borne in %llu; %llu false alarms; %zu unsafe\n", n(t.runs),
      n(t.found), n(t.borne), n(t.false_alarms), t.unsafe.size());
  put("\n%-22s%10s%10s%10s\n", "broken first", "runs", "found", "unsafe");
  for (const auto& kind : sim_host::kRigFaults) {
    const Tally::Kind& k = t.kinds[static_cast<std::size_t>(kind.fault)];
    put("%-22s%10llu%10llu%10llu\n", std::string(kind.name).c_str(), n(k.runs), n(k.found), n(k.unsafe));
  }
  put("\n%-22s%10s\n", "found first", "runs");
  for (const auto& fault : control::kFaults)
    if (t.by_fault[static_cast<std::size_t>(fault.fault)] != 0)
      put("%-22s%10llu\n", std::string(fault.name).c_str(),
          n(t.by_fault[static_cast<std::size_t>(fault.fault)]));
  put("\n%-22s%10s\n", "unsafe outcome", "runs");
  for (const UnsafeInfo& u : kUnsafe)
    put("%-22s%10llu\n", std::string(u.name).c_str(), n(t.by_outcome[static_cast<std::size_t>(u.outcome)]));
  put("\ntorque off after %u ticks at most; coil on for %u ticks of a stance at most; hip from %.3f to %.3f "
      "m; "
      "impact of the body %.2f m/s, of the toe %.2f m/s at most\n",
      t.longest_torque_off_ticks, t.longest_coil_in_stance_ticks, t.lowest_m, t.highest_m, t.hardest_mps,
      t.fastest_toe_mps);
  return text;
}

}  // namespace furcula::safety
