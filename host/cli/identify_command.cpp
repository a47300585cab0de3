// `furcula identify`: logs and a model in; parameters with intervals, identified model and report out.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/identify/identification.hpp"
#include "host/model/writer.hpp"
#include "host/report/identification_json.hpp"
#include "host/report/identification_report.hpp"
#include "host/traces/of_axis.hpp"
#include "host/traces/of_tree.hpp"
#include "host/trees/exports.hpp"
#include "host/trees/identify.hpp"

namespace furcula::cli {
namespace {

struct IdentifyOptions : RecordingOptions {
  std::string method = "simulation";
  std::size_t folds = 0;
};

void run_on_tree(const IdentifyOptions& o) {
  const Logs logs = read_logs(o, "tree");
  const trees::TreeModel model = tree_of(o, logs);
  const OutFolder folder(o.out), traces_folder(o.traces_folder());
  trees::Identification found;
  with_notes(model, [&] {
    Progress progress("identifying");
    trees::Options options;
    options.window_s = o.window(true);
    options.threads = o.thread_count();
    options.trust_columns = o.trust_columns;
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    found = trees::identify(model, logs.training, logs.held_out, options);
  });
  found.notes = model.notes;
  // Fitted bodies are in a URDF of their own, which the model file then names.
  const bool bodies = !found.bodies.empty();
  const std::string urdf = "identified.urdf";
  std::vector<core::NewFile> files{
      {o.out + "/identification.json", trees::to_json_text(found)},
      {o.out + "/identified_model.toml",
       trees::format_tree_model(found.model, bodies ? urdf : trees::urdf_seen_from(model, o.out))}};
  if (bodies) files.push_back({o.out + "/" + urdf, trees::urdf_with_bodies(model, found.bodies)});
  const trees::Hypothesis refitted{found.model.drives, found.model.causes, found.bodies};
  const traces::Traces traces =
      traces::of_tree(model, {{"given", {model.drives, model.causes}}, {"refitted", refitted}}, logs.training,
                      logs.held_out, o.window(true));
  for (core::NewFile& file : traces::files(traces, o.traces_folder())) files.push_back(std::move(file));
  core::write_files_together(files);
  for (const auto& p : found.parameters)
    std::printf("  %-32s %12.6g %-9s 95 %% %.6g to %.6g  %s%s\n", core::printable(p.name).c_str(), p.value,
                p.unit.c_str(), p.lower, p.upper, p.verdict.c_str(),
                p.with.empty() ? "" : (" (" + core::printable(p.with) + ")").c_str());
  std::printf("held-out error, RMS, as given and identified:");
  for (std::size_t j = 0; j < model.joints(); ++j)
    std::printf("%s %s %.3g to %.3g %s", j == 0 ? "" : ",",
                core::printable(model.robot.joints[j].name).c_str(), found.as_given_error[j].rmse,
                found.identified_error[j].rmse, std::string(trees::channel_unit(model, j)).c_str());
  std::printf("\n");
  for (const std::string& note : found.notes) std::printf("%s\n", core::printable(note).c_str());
  std::fflush(stdout);
  print_data_quality(found.data_quality);
}

void run(const IdentifyOptions& o) {
  if (is_tree_model(o.model)) {
    if (o.method != "simulation")
      throw UsageError("--method " + o.method + ": a tree is identified by simulation");
    if (o.folds != 0)
      throw UsageError("--folds " + std::to_string(o.folds) + ": on a tree nothing is cross-validated");
    return run_on_tree(o);
  }
  const Recordings r = read_recordings(o);
  if (r.model.free.empty())
    throw core::DataError(
        o.model + ": no parameter in [free], so there is nothing to identify; expected at least one, as in " +
        "[free] " + std::string(dynamics::info(r.model.kind).parameters.front().name) + " = [lower, upper]");
  const OutFolder folder(o.out), traces_folder(o.traces_folder());
  identify::Identification found;
  {
    Progress progress("identifying");
    identify::IdentifyOptions options;
    options.by_equation = o.method != "simulation";
    options.by_simulation = o.method != "equation";
    options.folds = o.folds;
    options.window_s = o.window(false);
    options.threads = o.thread_count();
    options.trust_columns = o.trust_columns;
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    found = identify::identify(r.model, r.training, r.held_out, options);
  }
  const std::string command =
      "identify --method " + o.method + (o.folds == 0 ? "" : " --folds " + std::to_string(o.folds));
  const model::Model& refitted = found.estimations.front().model;
  std::vector<core::NewFile> files{
      {o.out + "/identification.json", report::to_json_text(found)},
      {o.out + "/identified_model.toml", model::format_model(refitted)},
      {o.out + "/report.html", report::render_identification_report(found, o.command_line(command))}};
  const traces::Traces traces = traces::of_axis({{"given", r.model}, {"refitted", refitted}}, refitted,
                                                r.training, r.held_out, o.window(false));
  for (core::NewFile& file : traces::files(traces, o.traces_folder())) files.push_back(std::move(file));
  core::write_files_together(files);
  for (const auto& e : found.estimations) {
    std::printf("%s error, %zu windows, %zu folds\n", std::string(identify::name(e.method)).c_str(),
                found.windows, found.folds);
    for (const auto& p : e.parameters)
      std::printf("  %-24s %12.6g %-8s 95 %% %.6g to %.6g  %s%s\n", p.name.c_str(), p.value, p.unit.c_str(),
                  p.lower, p.upper, p.verdict.c_str(), p.with.empty() ? "" : (" (" + p.with + ")").c_str());
  }
  std::fflush(stdout);
  print_data_quality(found.data_quality);
  for (const identify::Excluded& l : found.excluded)
    std::printf("%s\n", core::printable(identify::sentence(l)).c_str());
  std::printf("report: %s/report.html\n", core::printable(o.out).c_str());
}

}  // namespace

void add_identify_command(CLI::App& app) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = app.add_subcommand("identify", "Estimate a model's free parameters from measured logs");
  options->add_to(*command);
  command->add_option("--method", options->method, "equation, simulation or both; on a tree simulation alone")
      ->check(CLI::IsMember({"equation", "simulation", "both"}))
      ->capture_default_str();
  command
      ->add_option("--folds", options->folds,
                   "Folds of the cross-validation, not on a tree; without it ten, or one a log if fewer")
      ->check(CLI::Range(std::size_t{2}, std::size_t{1000}));
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
