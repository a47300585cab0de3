// `furcula demo`: a virtual hopper with one hidden cause hops, its logs are diagnosed, the truth is told.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "host/cli/commands.hpp"
#include "host/cli/diagnose_command.hpp"
#include "host/core/message.hpp"
#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "host/sim/hidden_case.hpp"

namespace furcula::cli {
namespace {

struct DemoOptions {
  std::string out;
  std::optional<std::uint64_t> seed;
  unsigned threads = 0;
};

std::uint64_t seed_from_clock() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
          .count());
}

/// "coulomb_friction (force_n 1.583)".
std::string truth_in_words(const sim::HiddenCase& hidden_case) {
  const dynamics::EffectInfo& effect = dynamics::info(hidden_case.cause);
  std::string values;
  for (std::size_t i = 0; i < effect.parameter_count; ++i)
    values += (i == 0 ? "" : ", ") +
              std::string(dynamics::name_on(effect.parameter_table[i], hidden_case.model.kind)) + " " +
              core::rounded(hidden_case.truth.effects.at(hidden_case.cause)[i]);
  return std::string(effect.name) + " (" + values + ")";
}

std::string how_it_went(const diagnose::Diagnosis& d, dynamics::Effect cause) {
  for (std::size_t i = 0; i < d.findings.size(); ++i) {
    if (d.findings[i].effect == cause)
      return i == 0 ? "It was named first."
                    : "It was named, behind " + std::string(info(d.findings[0].effect).name) + ".";
    for (const diagnose::Rival& rival : d.findings[i].indistinguishable_from)
      for (const std::string& name : rival.names)
        if (name == info(cause).name)
          return "It stands among what these logs cannot tell from " +
                 std::string(info(d.findings[i].effect).name) + ".";
  }
  return "It was missed.";
}

void run(const DemoOptions& options) {
  const std::uint64_t seed = options.seed ? *options.seed : seed_from_clock();
  const sim::HiddenCase hidden_case = sim::draw_hidden_case(seed);
  const OutFolder folder(options.out);
  RecordingOptions recordings;
  recordings.model = options.out + "/model.toml";
  recordings.out = options.out + "/diagnosis";
  recordings.threads = options.threads;
  model::write_model(hidden_case.model, recordings.model);
  for (const log::Log& log : hidden_case.logs) {
    const std::string path = options.out + "/" + log.metadata.at("experiment") + ".csv";
    log::write_log(log, path);
    // The last two are driven like the ones before them: fit to judge by.
    const bool last_two = recordings.logs.size() + 2 >= hidden_case.logs.size();
    (last_two ? recordings.held_out : recordings.logs).push_back(path);
  }
  std::cout << "A virtual hopper with one hidden cause, drawn from seed " << seed
            << ", has hopped: " << hidden_case.logs.size() << " logs and the model without the cause are in "
            << core::printable(options.out) << ".\n\n"
            << "What the logs say\n"
            << std::flush;
  const diagnose::Diagnosis d = run_diagnose(recordings);
  // Written only now: nothing that the diagnosis could have read held the truth.
  model::write_model(hidden_case.truth, options.out + "/truth.toml");
  std::cout << "\nThe truth (" << core::printable(options.out) << "/truth.toml)\n"
            << truth_in_words(hidden_case) << ". " << how_it_went(d, hidden_case.cause) << "\n";
}

}  // namespace

void add_demo_command(CLI::App& app) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command =
      app.add_subcommand("demo", "Let a virtual hopper with a hidden cause hop, and diagnose its logs");
  command->add_option("--out", options->out, "Folder for the logs, the model and the results")->required();
  command->add_option("--seed", options->seed,
                      "Seed of the machine and its cause; without it the clock's seconds");
  command->add_option("--threads", options->threads, "Threads; the result is the same for any number");
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
