// `furcula hil-rig`: a board's own program against a mocked robot, on SocketCAN and simulated GPIO lines.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/cli/rig_options.hpp"
#include "host/log/writer.hpp"
#include "host/model/reader.hpp"
#include "host/rig/rig.hpp"
#include "host/sim/expectation.hpp"

namespace furcula::cli {
namespace {

struct RigOptions {
  std::string model, scenario, out;
  std::uint64_t seed = 0;
  rig::RigOptions rig;
  CommentsOption comments;
};

void run(RigOptions& options) {
  const model::Model model = model::read_model(options.model);
  if (!dynamics::has(model.kind, dynamics::LocationType::leg))
    throw UsageError("hil-rig simulates a hopper; expected a model of one");
  const sim::Scenario scenario = sim::read_scenario(options.scenario, model);
  const sim::Expectation expected = sim::read_expectation(options.scenario);
  if (options.rig.configuration_path.empty()) options.rig.configuration_path = options.out + ".furculad.toml";
  rig::RigResult result;
  try {
    result = rig::run(model, scenario, options.seed, options.rig);
  } catch (const std::runtime_error& e) {
    throw Refusal(options.scenario + ": " + e.what());
  }
  result.log.rig = std::string(dynamics::info(model.kind).rig);
  result.log.metadata = {
      {"sample_rate_hz", "1000"}, {"seed", std::to_string(options.seed)}, {"test_level", "hil"}};
  log::write_log(result.log, options.out, options.comments.of_log());
  std::cerr << "furcula: " << result.log.rows() << " ticks, " << result.silent_ticks << " without a command, "
            << result.late_ticks << " on which the rig was late\n";
  auto found = sim::violations(expected, result.log, sim::first_fault_s(scenario),
                               model.clutch ? model.clutch->tooth_pitch_m : 0.0);
  if (!result.complaint.empty()) found.push_back(result.complaint);
  if (!found.empty()) throw Refusal(options.scenario + ": " + found.front());
}

}  // namespace

void add_rig_command(CLI::App& app) {
  auto options = std::make_shared<RigOptions>();
  CLI::App* command = app.add_subcommand(
      "hil-rig",
      "Run a board's own program against a mocked robot on a CAN bus and simulated GPIO lines (docs/hil.md)");
  command->add_option("--model", options->model, "Model file (TOML) of a hopper")->required();
  command->add_option("--scenario", options->scenario, "Scenario file (TOML); its [expect] must hold")
      ->required();
  command->add_option("--out", options->out, "The log to write (furcula-log/1, CSV)")->required();
  command->add_option("--seed", options->seed, "Seed of the sensors' errors")->capture_default_str();
  options->comments.add_to(*command);
  add_rig_options(*command, options->rig);
  command->add_option("--configuration", options->rig.configuration_path,
                      "Where the program's configuration file is written; without it beside the log");
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
