// `furcula diagnose`: logs and a model in; the verdict, the extended model and the report out.
#include "host/cli/diagnose_command.hpp"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/progress.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/model/writer.hpp"
#include "host/report/diagnosis_report.hpp"
#include "host/report/robot_picture.hpp"
#include "host/result/diagnosis_json.hpp"
#include "host/traces/of_axis.hpp"
#include "host/traces/of_tree.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/exports.hpp"
#include "host/trees/next_experiment.hpp"
#include "host/trees/result.hpp"

namespace furcula::cli {
namespace {

/// A line each, with what limits its confidence, and what it cannot be told from.
void print_findings(const result::Diagnosis& d) {
  for (const result::Finding& f : d.findings) {
    std::cout << "  " << core::printable(result::label(f.cause));
    for (const result::Estimate& e : f.cause.parameters)
      std::cout << "  " << e.name << " = " << core::rounded(e.value) << " " << e.unit << " (95 % "
                << core::rounded(e.lower) << " to " << core::rounded(e.upper) << ")";
    std::cout << "  confidence " << core::rounded(f.confidence, 2);
    if (!f.confidence_lowered_by.empty())
      std::cout << ": " << core::printable(f.confidence_lowered_by.front());
    std::cout << "\n";
    for (const result::Rival& r : f.indistinguishable_from)
      std::cout << "    cannot be distinguished from " << core::printable(result::label(r.causes)) << "\n";
  }
}

}  // namespace

diagnose::Diagnosis run_diagnose(const RecordingOptions& o) {
  const Recordings r = read_recordings(o);
  const OutFolder folder(o.out), traces_folder(o.traces_folder());
  diagnose::Diagnosis d;
  {
    Progress progress("diagnosing");
    diagnose::Options options;
    options.window_s = o.window(false);
    options.threads = o.thread_count();
    options.trust_columns = o.trust_columns;
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    d = diagnose::diagnose(r.model, r.training, r.held_out, options);
  }
  const result::Diagnosis found = diagnose::result_of(d);
  std::vector<core::NewFile> files{
      {o.out + "/diagnosis.json", result::to_json_text(found)},
      {o.out + "/extended_model.toml", model::format_model(d.extended_model)},
      {o.out + "/report.html", report::render_report(found, o.command_line("diagnose"))}};
  const std::string scenario = o.out + "/next_experiment.toml";
  std::vector<std::string> obsolete;
  if (d.experiments.empty())
    obsolete.push_back(scenario);
  else
    files.push_back({scenario, "# " + d.experiments.front().what + "\n\n" +
                                   sim::format_scenario(d.experiments.front().scenario, d.kind)});
  const traces::Traces traces =
      traces::of_axis({{"given", r.model}, {"refitted", d.refitted_model}, {"extended", d.extended_model}},
                      d.refitted_model, r.training, r.held_out, o.window(false));
  for (core::NewFile& file : traces::files(traces, o.traces_folder())) files.push_back(std::move(file));
  core::write_files_together(files, obsolete);
  std::cout << "fitted on " << r.training.size() << ", held out " << r.held_out.size() << " recordings\n"
            << name(d.verdict) << ": " << core::printable_lines(d.summary) << "\n";
  print_findings(found);
  print_data_quality(d.data_quality);
  for (const std::string& note : d.notes) std::cout << core::printable(note) << "\n";
  for (const identify::Excluded& l : d.excluded) std::cout << core::printable(identify::sentence(l)) << "\n";
  std::cout << (d.experiments.empty() ? "" : "next: " + core::printable_lines(d.next_experiment) + "\n")
            << "report: " << core::printable(o.out) << "/report.html\n";
  return d;
}

namespace {

void run_on_tree(const RecordingOptions& o) {
  const Logs logs = read_logs(o, "tree");
  const trees::TreeModel model = tree_of(o, logs);
  const OutFolder folder(o.out), traces_folder(o.traces_folder());
  trees::Diagnosis d;
  with_notes(model, [&] {
    Progress progress("diagnosing");
    trees::Options options;
    options.window_s = o.window(true);
    options.threads = o.thread_count();
    options.trust_columns = o.trust_columns;
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    d = trees::diagnose(model, logs.training, logs.held_out, options);
  });
  d.notes.insert(d.notes.begin(), model.notes.begin(), model.notes.end());
  trees::TreeModel extended = model;
  extended.drives = d.extended.drives;
  extended.causes = d.extended.causes;
  // Fitted bodies are in a URDF of their own, which the model file then names.
  const bool bodies = !d.extended.bodies.empty();
  const std::string urdf = "fitted_bodies.urdf";
  const result::Diagnosis found = trees::result_of(d);
  std::vector<core::NewFile> files{
      {o.out + "/diagnosis.json", result::to_json_text(found)},
      {o.out + "/extended_model.toml",
       trees::format_tree_model(extended, bodies ? urdf : trees::urdf_seen_from(model, o.out))},
      {o.out + "/extended.urdf", trees::extended_urdf(d)},
      {o.out + "/extended.mjcf.xml", trees::extended_mjcf(d)},
      {o.out + "/report.html",
       report::render_report(found, o.command_line("diagnose", true), report::robot_picture(d))}};
  if (!model.urdf_text.empty()) files.push_back({o.out + "/" + model.urdf_path, model.urdf_text});
  if (bodies) files.push_back({o.out + "/" + urdf, trees::urdf_with_bodies(model, d.extended.bodies)});
  const std::string scenario = o.out + "/next_experiment.toml";
  std::vector<std::string> obsolete;
  if (d.experiments.empty() || d.experiments.front().paths.empty())
    obsolete.push_back(scenario);
  else
    files.push_back({scenario, "# " + d.experiments.front().what + "\n\n" +
                                   trees::scenario_of(model, d.experiments.front())});
  const traces::Traces traces = traces::of_tree(
      model, {{"given", {model.drives, model.causes}}, {"refitted", d.refitted}, {"extended", d.extended}},
      logs.training, logs.held_out, o.window(true));
  for (core::NewFile& file : traces::files(traces, o.traces_folder())) files.push_back(std::move(file));
  core::write_files_together(files, obsolete);
  std::cout << "fitted on " << logs.training.size() << ", held out " << logs.held_out.size()
            << " recordings\n"
            << name(d.verdict) << ": " << core::printable_lines(d.summary) << "\n";
  print_findings(found);
  std::cout << "held-out error, RMS, as given and extended:";
  for (std::size_t j = 0; j < model.joints(); ++j)
    std::cout << (j == 0 ? " " : ", ") << core::printable(model.robot.joints[j].name) << " "
              << core::rounded(d.as_given_error[j].rmse, 3) << " to "
              << core::rounded(d.extended_error[j].rmse, 3) << " " << trees::channel_unit(model, j);
  std::cout << "\n";
  print_data_quality(d.data_quality);
  for (const std::string& note : d.notes) std::cout << core::printable(note) << "\n";
  if (!d.experiments.empty()) std::cout << "next: " << core::printable(d.next_experiment) << "\n";
  std::cout << "report: " << core::printable(o.out) << "/report.html\n";
}

}  // namespace

void add_diagnose_command(CLI::App& app) {
  auto options = std::make_shared<RecordingOptions>();
  CLI::App* command = app.add_subcommand("diagnose", "Name what a model gets wrong about measured logs");
  options->add_to(*command);
  command->callback([options] {
    if (is_tree_model(options->model))
      run_on_tree(*options);
    else
      run_diagnose(*options);
  });
}

}  // namespace furcula::cli
