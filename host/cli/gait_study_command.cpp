// `furcula gait-study`: what a real clutch, slippery ground and a fixed spring's rest angle do to gaits.
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/gait/machine_file.hpp"
#include "host/gait/study.hpp"
#include "host/gait/study_report.hpp"

namespace furcula::cli {
namespace {

struct GaitStudyOptions {
  std::string model, out, of = "clutch";
  double lever_m = 0.03;
  unsigned threads = 0;
};

std::string command_of(const GaitStudyOptions& o) {
  return "furcula gait-study --model " + o.model + " --of " + o.of + " --lever-m " +
         core::shortest(o.lever_m) + " --out " + o.out;
}

void run(const GaitStudyOptions& o) {
  gait::StudyOptions study;
  for (std::size_t i = 0; i < gait::kStudyNames.size(); ++i)
    if (gait::kStudyNames[i] == o.of) study.kind = static_cast<gait::StudyKind>(i);
  if (!(o.lever_m >= 0.001 && o.lever_m <= 1.0))
    throw UsageError("--lever-m " + core::shortest(o.lever_m) + ": expected from 0.001 to 1 m");
  study.lever_m = o.lever_m;
  study.processes = o.threads > 0 ? o.threads : std::max(1u, std::thread::hardware_concurrency());
  const gait::Machine robot = gait::read_machine(o.model);
  study.rest_rad = robot.leg.rest_angle_rad;
  const OutFolder folder(o.out);
  std::vector<gait::StudyRow> rows;
  {
    Progress progress("gait-study");
    study.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    rows = gait::run_study(robot, study);
  }
  const std::string table = gait::study_csv(rows);
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/study.json", gait::study_json(rows, study)},
      {o.out + "/study.csv", table},
      {o.out + "/report.html", gait::render_study_report(rows, study, command_of(o))}});
  std::printf("%s", table.c_str());
}

}  // namespace

void add_gait_study_command(CLI::App& app) {
  auto options = std::make_shared<GaitStudyOptions>();
  CLI::App* command =
      app.add_subcommand("gait-study", "Gaits with a real clutch, on slippery ground, or with other springs");
  command->add_option("--model", options->model, "Model file of kind planar_leg")->required();
  command
      ->add_option("--of", options->of,
                   "clutch: a spring that catches late or on a tooth; ground: speed and friction; rest: a "
                   "parallel spring's rest angle")
      ->check(CLI::IsMember(std::vector<std::string>(gait::kStudyNames.begin(), gait::kStudyNames.end())))
      ->capture_default_str();
  command->add_option("--lever-m", options->lever_m, "Of the clutch's cable at the knee, m")
      ->capture_default_str();
  command->add_option("--threads", options->threads,
                      "Processes; without it as many as processors. Changes nothing but the time");
  command->add_option("--out", options->out, "Folder for report.html, study.json and study.csv")->required();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
