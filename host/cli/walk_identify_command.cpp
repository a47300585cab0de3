// `furcula walk identify`: all numbers of a walking robot from its recordings, as a model that walks are searched on.
#include "host/cli/walk_identify_command.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/floating/identification_report.hpp"
#include "host/floating/identify.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::cli {
namespace {

void say(const char* which, const floating::WindowErrors& given, const floating::WindowErrors& identified) {
  std::printf(
      "%s, %zu windows, RMS as given and identified: joints %.3g to %.3g mrad, attitude %.3g to %.3g mrad, "
      "gyro %.3g to %.3g rad/s\n",
      which, given.windows, 1e3 * given.angle_rad, 1e3 * identified.angle_rad, 1e3 * given.attitude_rad,
      1e3 * identified.attitude_rad, given.gyro_radps, identified.gyro_radps);
}

/// Beyond the model: what all windows agree on.
void say_causes(const floating::Identified& found) {
  if (found.causes.empty() && !found.all_numbers_deviate)
    std::printf("causes: none; no number is likelier to differ from the model than not\n");
  if (found.all_numbers_deviate)
    std::printf(
        "the numbers of document 000's tables deviate all together, none by itself: causes are laws beyond them\n");
  for (const floating::Cause& c : found.causes) {
    const floating::Unknown& u = found.unknowns[c.unknown];
    std::string others;
    for (const std::size_t i : c.correlated_with)
      others += (others.empty() ? "" : ", ") + found.unknowns[i].name();
    std::printf("cause: %s, about %+.3g %s, confidence %.2f%s%s\n", u.name().c_str(), c.theta * u.prior_sd,
                u.unit.c_str(), c.confidence, others.empty() ? "" : "; correlated with ", others.c_str());
  }
}

void identify(const RecordingOptions& o) {
  const walk::Model model = walk::read_model(o.model);
  const Logs logs = read_logs(o, "tree");
  const OutFolder folder(o.out);
  floating::IdentifyOptions options;
  options.window_s = o.window(true);
  options.settings.threads = o.thread_count();
  std::vector<floating::Recording> training, held_out;
  floating::Identified found;
  std::optional<floating::WindowErrors> before, after;
  {
    Progress progress("walk identify");
    options.progress = [&](double fraction, const std::string& doing) {
      progress.update(0.9 * fraction, doing);
    };
    for (const auto& [from, to] :
         {std::pair(&logs.training, &training), std::pair(&logs.held_out, &held_out)})
      for (const log::Log& log : *from) {
        floating::Recording recording = floating::recording_of(log);
        const auto whole = std::find_if(training.begin(), training.end(), [&](const floating::Recording& r) {
          return r.file == recording.file;  // of which it is the last quarter
        });
        if (whole != training.end() && floating::windows_of(recording, 0, options.window_s).empty()) {
          whole->notes.push_back(
              recording.file +
              ": its last quarter has no window, as after a fall: nothing of it is held out");
          continue;
        }
        recording.passive_hips = whole != training.end()
                                     ? whole->passive_hips
                                     : floating::passive_hips(model.machine, recording, options);
        to->push_back(std::move(recording));
      }
    found = floating::identify(model.machine, training, options);
    if (!held_out.empty()) {
      before = floating::window_errors(model.machine, held_out, options);
      after = floating::window_errors(found.machine, held_out, options);
    }
  }
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/identification.json",
       floating::to_json_text(found, before ? &*before : nullptr, after ? &*after : nullptr)},
      {o.out + "/identification.html",
       floating::render_identification_report({model.name, &found, &training, &held_out,
                                               before ? &*before : nullptr, after ? &*after : nullptr,
                                               options.window_s, o.command_line("walk identify", true)})},
      {o.out + "/identified_model.toml", walk::format_model(model, found.machine, o.out)}});
  for (const floating::Recording& r : training)
    for (const std::string& note : r.notes) std::printf("%s\n", core::printable(note).c_str());
  for (const floating::Recording& r : training)
    std::printf("%s: hips' pitch on their %s\n", core::printable(r.file).c_str(),
                r.passive_hips ? "springs" : "drives");
  say_causes(found);
  std::size_t told = 0;
  for (Eigen::Index k = 0; k < found.sd.size(); ++k) told += found.sd[k] < 0.5;
  std::printf(
      "%zu numbers, of which the recordings narrow %zu to less than half of their prior's deviation\n",
      found.unknowns.size(), told);
  say("training", found.before, found.after);
  if (before) say("held out", *before, *after);
  std::printf(
      "a single number is no finding: what the model lacks, the real ground too, is spread over them; judge by the held-out windows\n"
      "%s/identified_model.toml is a model for `furcula walk search`, identification.json has every number\n"
      "report: %s/identification.html\n",
      core::printable(o.out).c_str(), core::printable(o.out).c_str());
}

}  // namespace

void add_walk_identify_command(CLI::App& walk) {
  auto o = std::make_shared<RecordingOptions>();
  o->least_logs = 5;  // an exercise and a walk tell of different things
  CLI::App* command = walk.add_subcommand(
      "identify", "All numbers of a walking robot from its recordings, as a model to search walks on");
  command->add_option("logs", o->logs, "Logs or ROS 2 bags, at least one")->required();
  command->add_option("--model", o->model, "Model file of kind biped")->required();
  command->add_option("--map", o->map, "Map file (TOML) for logs with other column names");
  command->add_option(
      "--hold-out", o->held_out,
      "Logs that the fit does not see (put another option or -- after them); without it a seeded fifth, of fewer than "
      "five logs the last quarter of each");
  command->add_option("--window-s", o->window_s, "Length of a window, s; without it 0.3");
  command->add_option("--threads", o->threads, "Threads; the result is the same for any number");
  command->add_option("--seed", o->seed, "Seed of the choice of held-out logs")->capture_default_str();
  command
      ->add_option("--out", o->out,
                   "Folder for identified_model.toml, identification.json and identification.html")
      ->required();
  command->callback([o] { identify(*o); });
}

}  // namespace furcula::cli
