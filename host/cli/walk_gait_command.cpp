// `furcula walk gait`: a step of the biped by gradients, and the walk's targets that come nearest to it.
#include "host/cli/walk_gait_command.hpp"

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/walk/gait_json.hpp"
#include "host/walk/search.hpp"

namespace furcula::cli {
namespace {

struct GaitOfWalkOptions {
  std::string model, out, mode{walk::kModeNames.front()};
  std::optional<double> speed_mps;
  double double_support_s = 0.0;
  bool hip_yaw = false;
};

void find(const GaitOfWalkOptions& o) {
  if (o.speed_mps && !(*o.speed_mps >= 0.01 && *o.speed_mps <= 5.0))
    throw UsageError("--speed-mps " + core::shortest(*o.speed_mps) + ": expected from 0.01 to 5");
  if (!(o.double_support_s == 0.0 || (o.double_support_s >= 0.02 && o.double_support_s <= 2.0)))
    throw UsageError("--double-support-s " + core::shortest(o.double_support_s) +
                     ": expected 0, or from 0.02 to 2");
  const walk::Model model = walk::read_model(o.model);
  walk::GaitTask task;
  task.mode = o.mode == walk::kModeNames.front() ? walk::WalkMode::active : walk::WalkMode::semi_passive;
  task.limits = model.limits;
  task.speed_mps = o.speed_mps;
  task.double_support_s = o.double_support_s;
  task.yaw_held = !o.hip_yaw;
  const OutFolder folder(o.out);
  walk::GaitResult found;
  {
    Progress progress("walk gait");
    task.progress = [&](int iteration, double cost, double violation) {
      // How many iterations it takes is not known before.
      const double n = iteration;
      progress.update(n / (n + 60.0), "cost of transport " + core::rounded(cost, 4) +
                                          ", constraints off by " + core::rounded(violation, 2));
    };
    found = walk::find_gait(model.robot, task);
  }
  if (!found.found) {
    core::write_files_together(std::vector<core::NewFile>{
        {o.out + "/gait.json", walk::to_json_text(found, task, model, nullptr, nullptr)}});
    throw Refusal(walk::against_gait(found, task) + ". Expected: another --speed-mps, or wider [limits]");
  }
  const walk::GaitWalk walk = walk::walk_of(model.robot, task.mode, found.gait);
  walk::RolloutOptions rollout;
  rollout.mode = task.mode;
  rollout.limits = model.limits;
  const walk::Rollout r = walk::run_walk(model.robot, rollout, walk.walk);
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/gait.json", walk::to_json_text(found, task, model, &walk, &r)},
      {o.out + "/walk.toml", walk::format_walk({model.name, task.mode, rollout.walk_until_s, walk.walk})}});
  const walk::GaitFigures& f = found.figures;
  const walk::WalkLimits& m = model.limits;
  std::printf("cost of transport %.3f at %.3f m/s: steps of %.3f m in %.3f s, %.3f m between the ankles\n",
              f.cot, found.gait.step_m / found.gait.duration_s(), found.gait.step_m, found.gait.duration_s(),
              found.gait.step_width_m);
  std::printf("%.1f J a step: copper %.1f, work %.1f (its positive parts %.1f), constant %.1f\n", f.energy_j,
              f.copper_j, f.work_j, f.positive_work_j, f.constant_j);
  std::printf("at most %.1f N m of %.4g, %.3f rad/s of %.4g, a foot's moment %.1f N m of %.4g\n", f.torque_nm,
              m.torque_nm, f.speed_radps, m.speed_radps, f.moment_nm, m.moment_nm);
  std::printf("%s after %d iterations, %.1f s of one processor\n", found.status.c_str(), found.iterations,
              found.cpu_s);
  std::printf("walk.toml: targets off by %.3f rad; ", walk.error_rad);
  if (r.ending == walk::Ending::stands)
    std::printf("it stands after %.3g s, %.3f m ahead", r.time_s, r.distance_m);
  else
    std::printf("%s after %.2f s",
                std::string(walk::kEndingNames[static_cast<std::size_t>(r.ending)]).c_str(), r.time_s);
  std::printf("\na search goes on from it with: furcula walk search --from %s/walk.toml\n",
              core::printable(o.out).c_str());
}

}  // namespace

void add_walk_gait_command(CLI::App& walk) {
  auto o = std::make_shared<GaitOfWalkOptions>();
  CLI::App* command =
      walk.add_subcommand("gait", "One step of a periodic walk by gradients, as a start for a search");
  command->add_option("--model", o->model, "Model file of kind biped")->required();
  command->add_option("--mode", o->mode, "active, or semi_passive: both hips' pitch on their springs")
      ->check(CLI::IsMember({"active", "semi_passive"}))
      ->capture_default_str();
  command->add_option("--speed-mps", o->speed_mps, "How fast; without it what costs least");
  command
      ->add_option("--double-support-s", o->double_support_s,
                   "Both feet stand at least that long; 0: the load changes feet at an instant")
      ->capture_default_str();
  command->add_flag(
      "--hip-yaw", o->hip_yaw,
      "The hips turn about the vertical too; walk.toml, whose controller holds them at 0, leaves that out");
  command->add_option("--out", o->out, "Folder for gait.json and walk.toml")->required();
  command->callback([o] { find(*o); });
}

}  // namespace furcula::cli
