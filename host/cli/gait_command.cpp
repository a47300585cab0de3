// `furcula gait`: the cheapest gait of a planar leg.
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/gait/evidence.hpp"
#include "host/gait/gait_file.hpp"
#include "host/gait/gait_json.hpp"
#include "host/gait/gait_log.hpp"
#include "host/gait/gait_report.hpp"
#include "host/gait/machine_file.hpp"
#include "host/gait/search.hpp"

namespace furcula::cli {
namespace {

struct GaitOptions {
  std::string model, out, torque = "free", lift_off, from;
  std::optional<double> clearance_m, speed_mps, friction, touchdown_knee_rad;
  double landing_speed_mps = 0.0;
  unsigned starts = 3, threads = 0;
  std::uint64_t seed = 1;
};

template <std::size_t N>
std::vector<std::string> names_of(const std::array<std::string_view, N>& names) {
  return {names.begin(), names.end()};
}

gait::Query query_of(const GaitOptions& o) {
  if (o.clearance_m.has_value() == o.speed_mps.has_value())
    throw UsageError("expected one of --clearance-m (in place) and --speed-mps (forward)");
  gait::Query q;
  q.machine = gait::read_machine(o.model);
  const double leg = q.machine.leg.thigh_length_m + q.machine.leg.shank_length_m;
  if (o.clearance_m && !(*o.clearance_m > 0.0 && *o.clearance_m < leg))
    throw UsageError("--clearance-m " + core::shortest(*o.clearance_m) +
                     ": expected more than 0 and less than the leg's length, " + core::shortest(leg) + " m");
  if (o.speed_mps && !(std::abs(*o.speed_mps) >= 0.05 && std::abs(*o.speed_mps) <= 20.0))
    throw UsageError("--speed-mps " + core::shortest(*o.speed_mps) +
                     ": expected a speed from 0.05 to 20 m/s, or below zero with the knee pointing forward");
  if (o.friction && !(*o.friction > 0.0))
    throw UsageError("--friction " + core::shortest(*o.friction) + ": expected more than 0");
  if (o.starts < 1 || o.starts > 1000)
    throw UsageError("--starts " + std::to_string(o.starts) + ": expected from 1 to 1000");
  const double low = q.machine.least.knee, high = q.machine.most.knee;
  if (o.touchdown_knee_rad && !(*o.touchdown_knee_rad >= low && *o.touchdown_knee_rad <= high))
    throw UsageError("--touchdown-knee-rad " + core::shortest(*o.touchdown_knee_rad) + ": expected from " +
                     core::shortest(low) + " to " + core::shortest(high) + ", the knee's range");
  q.task.clearance_m = o.clearance_m;
  q.task.speed_mps = o.speed_mps;
  q.task.friction = o.friction;
  q.task.touchdown_knee_rad = o.touchdown_knee_rad;
  if (!(o.landing_speed_mps >= 0.0 && o.landing_speed_mps <= 10.0))
    throw UsageError("--landing-speed-mps " + core::shortest(o.landing_speed_mps) +
                     ": expected from 0 to 10 m/s, downward");
  q.task.landing_speed_mps = o.landing_speed_mps;
  for (std::size_t i = 0; i < dynamics::kLegLiftOffNames.size(); ++i)
    if (dynamics::kLegLiftOffNames[i] == o.lift_off) q.task.lift_off = static_cast<dynamics::LegLiftOff>(i);
  if (!q.machine.catching.ideal() && q.task.lift_off == dynamics::LegLiftOff::knee)
    throw UsageError(
        "--lift-off knee: the knee's angle of touch-down is not where a spring rests that catches late; expected "
        "force or unguarded with " +
        core::printable(o.model));
  q.fourier = o.torque == "fourier";
  q.starts = o.starts;
  q.seed = o.seed;
  q.processes = o.threads > 0 ? o.threads : std::max(1u, std::thread::hardware_concurrency());
  if (!o.from.empty()) {
    const gait::Gait from = gait::read_gait(o.from);
    gait::require_same_robot(from, q.machine, o.from);
    const auto* free = std::get_if<gait::FreeGait>(&from.motion);
    if (free == nullptr)
      throw UsageError("--from " + core::printable(o.from) +
                       ": its torque is \"fourier\"; expected a gait of free torques");
    q.from = *free;
  }
  return q;
}

std::string command_of(const GaitOptions& o) {
  std::string out = "furcula gait --model " + o.model;
  const auto add = [&](const char* option, const std::optional<double>& value) {
    if (value) out += std::string(" ") + option + " " + core::shortest(*value);
  };
  add("--clearance-m", o.clearance_m);
  add("--speed-mps", o.speed_mps);
  out += " --torque " + o.torque + " --lift-off " + o.lift_off;
  add("--friction", o.friction);
  add("--touchdown-knee-rad", o.touchdown_knee_rad);
  if (o.landing_speed_mps > 0.0) add("--landing-speed-mps", o.landing_speed_mps);
  if (!o.from.empty()) out += " --from " + o.from;
  return out + " --starts " + std::to_string(o.starts) + " --seed " + std::to_string(o.seed) + " --out " +
         o.out;
}

void say_evidence(const gait::Search& found, const gait::Evidence& evidence) {
  const gait::Stability& s = evidence.stability;
  std::printf(
      "with a feedback in stance: largest multiplier %.4g; of %u starts %.3g %% return, %.3g %% without it\n",
      s.multipliers.empty() ? std::nan("") : std::abs(s.multipliers.front()), s.basin.starts,
      100.0 * s.basin.share(), 100.0 * s.open_loop.share());
  const gait::DisturbedOptions ground;
  if (evidence.disturbed.strides > 0)
    std::printf(
        "on the board, ground within %.3g cm, switch %.3g ms late: %u falls of %u strides at %.4g J, %u without the feedback\n",
        100.0 * ground.ground_m, 1e3 * ground.switch_late_s, evidence.disturbed.falls,
        evidence.disturbed.strides, evidence.disturbed.cost_j, evidence.disturbed_open_loop.falls);
  if (!evidence.stable)
    std::printf("cheapest stable gait: none was found\n");
  else if (const gait::StableGait& g = *evidence.stable;
           g.landing_speed_mps == found.gait->task.landing_speed_mps)
    std::printf("cheapest stable gait: this one, with the feedback\n");
  else
    std::printf(
        "cheapest stable gait: the toe lands with %.3g m/s; %.5g J a stride, cost of transport %.5g\n",
        g.landing_speed_mps, g.evaluation.cost_j, g.evaluation.cot.value_or(std::nan("")));
  if (const gait::OpenFigures& open = evidence.open; open.corners > 0) {
    std::printf("open digits: cost %.5g to %.5g J", open.cost_j.low, open.cost_j.high);
    if (found.gait->task.speed_mps) std::printf(", of transport %.5g to %.5g", open.cot.low, open.cot.high);
    std::printf(", eta %.3f to %.3f, knee %.2f to %.2f deg\n", open.eta.low, open.eta.high,
                open.touchdown_knee_rad.low * 57.29577951308232,
                open.touchdown_knee_rad.high * 57.29577951308232);
  }
}

void run(const GaitOptions& o) {
  gait::Query query = query_of(o);
  const OutFolder folder(o.out);
  gait::Search found;
  gait::Evidence evidence;
  {
    Progress progress("gait");
    query.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    found = gait::find_gait(query);
    if (found.gait) evidence = gait::evidence_of(query, found);
  }
  if (!found.gait) throw Refusal(found.refusal);
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/gait.toml", gait::format_gait(*found.gait)},
      {o.out + "/gait.json", gait::to_json_text(found, evidence)},
      {o.out + "/report.html", gait::render_gait_report(found, evidence, command_of(o))}});
  const gait::Evaluation& e = found.evaluation;
  if (e.cot) std::printf("cost of transport %.5f at %.4g m/s, ", *e.cot, e.speed_mps);
  std::printf("%.5f J a stride of %.4f s (%.4f s in stance), eta %.3f, knee %.2f deg at touch-down\n",
              e.cost_j, e.stride_s, e.stride.stance, e.eta, e.stride.touchdown_knee * 57.29577951308232);
  std::printf(
      "closes to %.1e; largest multiplier %.4g; friction %.3g in stance, %.3g at the impact; %.3g V, %.3g A\n",
      e.closure, e.multipliers.empty() ? std::nan("") : std::abs(e.multipliers.front()), e.stride.friction,
      e.stride.impact_friction, e.stride.voltage_v, e.stride.current_a);
  say_evidence(found, evidence);
  for (const gait::Optimum& optimum : found.optima)
    std::printf("  %.5f from %u %s\n", optimum.cost, optimum.starts,
                optimum.starts == 1 ? "start" : "starts");
  for (const std::string& limit : e.limits) std::printf("limit: %s\n", limit.c_str());
  std::printf("%.1f s; report: %s/report.html\n", found.seconds, core::printable(o.out).c_str());
}

}  // namespace

log::Log play_gait(const std::string& model, const std::string& gait, std::uint64_t seed) {
  return gait::log_of_gait(gait::read_gait(gait), gait::read_machine(model), {.seed = seed});
}

void add_gait_command(CLI::App& app) {
  auto options = std::make_shared<GaitOptions>();
  options->lift_off = dynamics::kLegLiftOffNames.front();
  CLI::App* command = app.add_subcommand("gait", "The cheapest gait of a planar leg, in place or forward");
  command->add_option("--model", options->model, "Model file of kind planar_leg")->required();
  command->add_option("--clearance-m", options->clearance_m, "In place: the toe's highest point, m");
  command->add_option("--speed-mps", options->speed_mps,
                      "Forward: the speed, m/s; below zero with the knee pointing forward");
  command->add_option("--torque", options->torque, "free, or fourier: the parametrisation of document 001")
      ->check(CLI::IsMember({"free", "fourier"}))
      ->capture_default_str();
  command
      ->add_option("--lift-off", options->lift_off,
                   "What ends the stance: force, knee or unguarded (docs/gaits.md)")
      ->check(CLI::IsMember(names_of(dynamics::kLegLiftOffNames)))
      ->capture_default_str();
  command->add_option("--friction", options->friction, "Of the ground; without it the toe never slips");
  command->add_option("--touchdown-knee-rad", options->touchdown_knee_rad,
                      "The knee's angle at touch-down, rad; free without it");
  command->add_option(
      "--landing-speed-mps", options->landing_speed_mps,
      "The toe comes down with this speed at least, m/s: a toe that lands slowly makes a fragile gait");
  command->add_option("--from", options->from,
                      "A gait.toml of free torques to start from, of the same robot");
  command->add_option("--starts", options->starts, "How many starts")->capture_default_str();
  command->add_option("--seed", options->seed, "Of the starts")->capture_default_str();
  command->add_option("--threads", options->threads,
                      "Processes; without it as many as processors. Changes nothing but the time");
  command->add_option("--out", options->out, "Folder for gait.toml, gait.json and report.html")->required();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
