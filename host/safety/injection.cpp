// Drawing and running random experiments, see injection.hpp.
#include "host/safety/injection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "host/core/parallel.hpp"
#include "host/core/random.hpp"

namespace furcula::safety {
namespace {

using core::Random;
using sim_host::RigFault;

/// One of 0 to count - 1.
std::size_t pick(Random& random, std::size_t count) {
  const auto n = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(count)));
  return std::min(n, count - 1);
}

bool chance(Random& random, double share) { return random.uniform(0.0, 1.0) < share; }

/// Nobody swaps a motor's wires, or a drive, while the robot hops.
bool is_of_mounting(const sim_host::PlannedFault& fault) {
  return fault.kind == RigFault::drive_reversed || fault.kind == RigFault::drive_of_other_motor;
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
  if (is_of_mounting(fault)) fault.time_s = 1e-3, fault.duration_s = 1e3;
  if (fault.kind == RigFault::brown_out) fault.duration_s = 1e-3 * std::ceil(random.uniform(10.0, 500.0));
  if (fault.kind == RigFault::task_stuck) fault.duration_s = 1e-3 * std::ceil(random.uniform(6.0, 200.0));
  return fault;
}

constexpr std::size_t kTorqueToSupervisor = 25;
static_assert(bus::kParameters[kTorqueToSupervisor - 1].name == "missed_catches_max");

/// Over all that the table allows; where that is orders of magnitude, each alike, and now and then a bound.
float draw_value(Random& random, const bus::Parameter& p) {
  const double least = static_cast<double>(p.least), most = static_cast<double>(p.most);
  const double where = random.uniform(0.0, 1.0), at = random.uniform(0.0, 1.0);
  if (where < 0.05) return p.least;
  if (where < 0.1) return p.most;
  if (p.whole) return static_cast<float>(std::floor(random.uniform(least, most + 1.0)));
  const bool wide = least > 0.0 && most > 20.0 * least;
  const double value = wide && where < 0.7 ? least * std::pow(most / least, at) : least + (most - least) * at;
  return std::clamp(static_cast<float>(value), p.least, p.most);
}

std::vector<DrawnParameter> draw_parameters(Random& random) {
  constexpr std::size_t kAll = bus::kParameters.size();
  const double share = random.uniform(0.0, 1.0);
  const std::size_t count = share < 0.25 ? 0 : share < 0.6 ? 1 : share < 0.85 ? 2 + pick(random, 3) : kAll;
  std::array<bool, kAll> chosen{};
  if (count == kAll)
    chosen.fill(true);
  else
    for (std::size_t left = count; left > 0;) {
      bool& one = chosen[pick(random, kAll)];
      if (!one) --left;
      one = true;
    }
  // All of them: every second time close to the robot's own, as of another robot of the kind; a bench is none.
  const control::Config own;
  const bool like_own = count == kAll && chance(random, 0.5);
  std::vector<DrawnParameter> drawn;
  for (std::size_t i = 0; i < kAll; ++i) {
    if (!chosen[i]) continue;
    const bus::Parameter& p = bus::kParameters[i];
    float value = draw_value(random, p);
    const float near = p.get(own) * static_cast<float>(random.uniform(0.75, 1.3));
    if (like_own && !p.whole) value = std::clamp(near, p.least, p.most);
    if (count == kAll && p.name == "on_bench" && chance(random, 0.8)) value = 0.0f;
    drawn.push_back({&p, value});
  }
  return drawn;
}

void add(Tally& tally, const Injection& injection, std::uint64_t number, const Trial& trial) {
  ++tally.runs;
  Tally::Parameters nothing;
  Tally::Parameters& among = tally.by_drawn[static_cast<std::size_t>(drawn(injection))];
  Tally::Parameters& alone = drawn(injection) == Drawn::one
                                 ? tally.by_parameter[injection.parameters.front().parameter->number - 1u]
                                 : nothing;
  for (Tally::Parameters* p : {&among, &alone}) {
    ++p->runs;
    if (trial.refused) ++p->refused;
    if (trial.early) ++p->early;
    if (trial.unsafe != 0) ++p->unsafe;
  }
  if (trial.refused) {
    ++tally.refused;
    return;
  }
  if (trial.early && !trial.false_alarm) ++tally.early;
  const bool found = trial.fault != control::Fault::none;
  ++(found ? tally.found : tally.borne);
  if (trial.false_alarm) ++tally.false_alarms;
  ++tally.by_fault[static_cast<std::size_t>(trial.fault)];
  Tally::Kind none;
  const auto& faults = injection.scenario.faults;
  Tally::Kind& kind = faults.empty() ? none : tally.kinds[static_cast<std::size_t>(faults.front().kind)];
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
  // A robot that was put together wrongly is that alone: it is tried before anything else can break.
  const auto wrong = std::find_if(s.faults.begin(), s.faults.end(), is_of_mounting);
  if (wrong != s.faults.end()) s.faults = {*wrong};
  // Of a stream of their own: what else is drawn does not depend on them.
  Random for_parameters(seed, (std::uint64_t{1} << 40) + number);
  injection.parameters = draw_parameters(for_parameters);
  if (injection.parameters.empty()) return injection;
  // Wrong parameters show in what the robot does for long; nothing else is broken in a third.
  s.duration_s += for_parameters.uniform(0.0, 5.0);
  if (chance(for_parameters, 0.33)) s.faults.clear();
  return injection;
}

Drawn drawn(const Injection& injection) {
  const std::size_t count = injection.parameters.size();
  return count == 0                        ? Drawn::none
         : count == 1                      ? Drawn::one
         : count < bus::kParameters.size() ? Drawn::few
                                           : Drawn::all;
}

Trial run(const model::Model& model, const Injection& injection) {
  return run_trial(model, injection.scenario, injection.seed, injection.rig, injection.parameters);
}

Tally inject(std::uint64_t seed, std::uint64_t count, unsigned threads) {
  Tally tally;
  std::mutex guard;
  const model::Model model = robot();
  core::parallel_for(count, threads, [&](std::size_t number) {
    const Injection injection = draw_injection(seed, number);
    const Trial trial = run(model, injection);
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
  for (const DrawnParameter& d : injection.parameters)
    put("%s = %g %s\n", std::string(d.parameter->name).c_str(), static_cast<double>(d.value),
        std::string(d.parameter->unit).c_str());
  if (trial.refused) return text + "refused\n";
  text += "found: " + std::string(control::info(trial.fault).name);
  if (trial.early && !trial.false_alarm)
    text += ", before anything was broken";
  else if (trial.false_alarm)
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
  const auto unsafe = static_cast<std::uint64_t>(std::count_if(
      t.unsafe.begin(), t.unsafe.end(), [](const UnsafeRun& r) { return r.trial.unsafe != 0; }));
  put("%llu runs: %llu refused, a fault found in %llu, borne in %llu; %llu false alarms; %llu unsafe\n",
      n(t.runs), n(t.refused), n(t.found), n(t.borne), n(t.false_alarms), n(unsafe));
  put("\n%-24s%10s%10s%10s%10s\n", "parameters drawn", "runs", "refused", "early", "unsafe");
  const auto put_parameters = [&](std::string_view name, const Tally::Parameters& p) {
    put("%-24s%10llu%10llu%10llu%10llu\n", std::string(name).c_str(), n(p.runs), n(p.refused), n(p.early),
        n(p.unsafe));
  };
  for (std::size_t i = 0; i < kDrawn.size(); ++i) put_parameters(kDrawn[i], t.by_drawn[i]);
  put("\n%-24s%10s%10s%10s%10s\n", "drawn alone", "runs", "refused", "early", "unsafe");
  for (const bus::Parameter& p : bus::kParameters) put_parameters(p.name, t.by_parameter[p.number - 1u]);
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
  put("\ntorque off after %u ticks at most; coil on for %u ticks of a stance at most; hip from %.3f to %.3f m; "
      "impact of the body %.2f m/s, of the toe %.2f m/s at most\n",
      t.longest_torque_off_ticks, t.longest_coil_in_stance_ticks, t.lowest_m, t.highest_m, t.hardest_mps,
      t.fastest_toe_mps);
  return text;
}

}  // namespace furcula::safety
