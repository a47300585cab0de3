// `furcula diagnose`: logs and a model in; the verdict, the extended model and the report out.
#include "host/cli/diagnose_command.hpp"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/progress.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/diagnosis_json.hpp"
#include "host/log/atomic_file.hpp"
#include "host/log/message.hpp"
#include "host/model/writer.hpp"
#include "host/report/diagnosis_report.hpp"

namespace furcula::cli {

diagnose::Diagnosis run_diagnose(const RecordingOptions& o) {
  const Recordings r = read_recordings(o);
  const OutFolder folder(o.out);
  diagnose::Diagnosis d;
  {
    Progress progress("diagnosing");
    diagnose::Options options;
    options.window_s = o.window_s;
    options.threads = o.thread_count();
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    d = diagnose::diagnose(r.model, r.training, r.held_out, options);
  }
  std::vector<log::NewFile> files{
      {o.out + "/diagnosis.json", diagnose::to_json_text(d)},
      {o.out + "/extended_model.toml", model::format_model(d.extended_model)},
      {o.out + "/report.html", report::render_report(d, o.command_line("diagnose"))}};
  const std::string scenario = o.out + "/next_experiment.toml";
  std::vector<std::string> obsolete;
  if (d.experiments.empty())
    obsolete.push_back(scenario);
  else
    files.push_back({scenario, "# " + d.experiments.front().what + "\n\n" +
                                   sim::format_scenario(d.experiments.front().scenario, d.kind)});
  log::write_files_together(files, obsolete);
  std::cout << "fitted on " << r.training.size() << ", held out " << r.held_out.size() << " recordings\n"
            << diagnose::name(d.verdict) << ": " << log::printable_lines(d.summary) << "\n"
            << (d.experiments.empty() ? "" : "next: " + log::printable_lines(d.next_experiment) + "\n")
            << "report: " << log::printable(o.out) << "/report.html\n";
  return d;
}

void add_diagnose_command(CLI::App& app) {
  auto options = std::make_shared<RecordingOptions>();
  CLI::App* command = app.add_subcommand("diagnose", "Name what a model gets wrong about measured logs");
  options->add_to(*command);
  command->callback([options] { run_diagnose(*options); });
}

}  // namespace furcula::cli
