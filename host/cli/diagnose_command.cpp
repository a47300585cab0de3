// `furcula diagnose`: logs and a model in; the verdict, the extended model and the report out.
#include "host/cli/diagnose_command.hpp"

#include <filesystem>
#include <iostream>
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/progress.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/diagnosis_json.hpp"
#include "host/log/atomic_file.hpp"
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
  log::write_file_atomically(o.out + "/diagnosis.json", diagnose::to_json_text(d));
  log::write_file_atomically(o.out + "/extended_model.toml", model::format_model(d.extended_model));
  log::write_file_atomically(o.out + "/report.html", report::render_report(d, o.command_line("diagnose")));
  // Of an earlier run into the same folder.
  const std::string scenario = o.out + "/next_experiment.toml";
  std::filesystem::remove(scenario);
  if (!d.experiments.empty())
    log::write_file_atomically(scenario, "# " + d.experiments.front().what + "\n\n" +
                                             sim::format_scenario(d.experiments.front().scenario, d.kind));
  std::cout << "fitted on " << r.training.size() << ", held out " << r.held_out.size() << " recordings\n"
            << diagnose::name(d.verdict) << ": " << d.summary << "\n"
            << (d.experiments.empty() ? "" : "next: " + d.next_experiment + "\n") << "report: " << o.out
            << "/report.html\n";
  return d;
}

void add_diagnose_command(CLI::App& app) {
  auto options = std::make_shared<RecordingOptions>();
  CLI::App* command = app.add_subcommand("diagnose", "Name what a model gets wrong about measured logs");
  options->add_to(*command);
  command->callback([options] { run_diagnose(*options); });
}

}  // namespace furcula::cli
