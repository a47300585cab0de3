// `furcula sim`: a model and a scenario in, a log out.
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "furcula/control/fault.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/gait/machine_file.hpp"
#include "host/log/writer.hpp"
#include "host/model/reader.hpp"
#include "host/sim/expectation.hpp"
#include "host/sim/simulate.hpp"
#include "host/trees/simulate.hpp"

namespace furcula::cli {
namespace {

struct SimOptions {
  std::string model;
  std::string scenario;
  std::string out;
  std::uint64_t seed = 0;
  bool check = false;
  CommentsOption comments;
  bool accept_inertias = false;
};

/// One line on stderr where the controller went to its safe state, and what to do about it.
void tell_fault(const log::Log& log) {
  if (!log.has("fault")) return;
  for (std::size_t row = 0; row < log.rows(); ++row) {
    const double number = log.at("fault")[row];
    if (number == 0.0) continue;
    const auto& fault = control::info(static_cast<control::Fault>(static_cast<int>(number)));
    std::cerr << "furcula: safe state at " << core::shortest(log.time_s()[row]) << " s, fault "
              << static_cast<int>(number) << " " << fault.name << ": " << fault.meaning << " " << fault.remedy
              << "\n";
    return;
  }
}

void check_expectation(const std::string& path, const model::Model& model, const sim::Scenario& scenario,
                       const log::Log& log) {
  const auto found = sim::violations(sim::read_expectation(path), log, sim::first_fault_s(scenario),
                                     model.clutch ? model.clutch->tooth_pitch_m : 0.0);
  if (!found.empty()) throw Refusal(path + ": " + found.front());
}

void run(const SimOptions& options, PlayGait play) {
  require_other_file("--out", options.out, {options.model, options.scenario});
  const std::string text =
      core::read_small_file(options.model, "a model file (TOML) or a robot (URDF, MJCF)");
  if (gait::is_planar_leg(text)) {
    if (play == nullptr)
      throw UsageError("--model " + options.model +
                       " is a planar leg; expected the program `furcula`, which has gaits");
    if (options.check || options.scenario.empty())
      throw UsageError(
          "--model " + options.model +
          " is a planar leg; expected --scenario with a gait that it plays (gait.toml), and no --check");
    log::write_log(play(options.model, options.scenario, options.seed), options.out,
                   options.comments.of_log());
    return;
  }
  if (const auto tree = tree_model(options.model, {{}, {}, options.accept_inertias})) {
    if (options.check)
      throw UsageError("--check: a scenario of a tree has no [expect]; expected none with kind tree");
    require_other_file("--out", options.out, {tree->urdf.file});
    print_notes(*tree);
    const trees::Scenario scenario = options.scenario.empty() ? trees::default_scenario(*tree)
                                                              : trees::read_scenario(options.scenario, *tree);
    log::write_log(trees::simulate(*tree, scenario, options.seed), options.out, options.comments.of_log());
    return;
  }
  const model::Model model = model::read_model(options.model);
  if (options.check && (options.scenario.empty() || !dynamics::has(model.kind, dynamics::LocationType::leg)))
    throw UsageError("--check needs a --scenario for a hopper");
  const sim::Scenario scenario =
      options.scenario.empty() ? sim::default_scenario(model) : sim::read_scenario(options.scenario, model);
  log::Log log = sim::simulate(model, scenario, options.seed);
  if (log.rows() == 0)
    throw core::DataError(options.scenario +
                          ": the height is not homed from the start, so that the log has no row; " +
                          "expected a [[fault]] of kind height_nan later than time_s = 0");
  log::write_log(log, options.out, options.comments.of_log());
  tell_fault(log);
  if (options.check) check_expectation(options.scenario, model, scenario, log);
  const auto& solenoid = log.columns["solenoid"];
  if (scenario.release_in_flight && std::find(solenoid.begin(), solenoid.end(), 1.0) == solenoid.end())
    std::cerr
        << "furcula: the spring was never released: no flight was long enough for release, contraction and catch "
        << core::shortest(scenario.catch_before_touchdown_s) << " s before touch-down\n";
}

}  // namespace

void add_sim_command(CLI::App& app, PlayGait play) {
  auto options = std::make_shared<SimOptions>();
  CLI::App* command = app.add_subcommand("sim", "Simulate a model under a scenario and write its log");
  command->add_option("--model", options->model, "Model file (TOML), or a robot (URDF, MJCF)")->required();
  command->add_option(
      "--scenario", options->scenario,
      "Scenario file (TOML); without it what is usual for the kind: hops, a sine drive, throws. Of a planar leg: a gait (gait.toml)");
  command->add_option("--out", options->out, "The log to write (furcula-log/1, CSV)")->required();
  command->add_option("--seed", options->seed, "Seed of the sensors' errors")->capture_default_str();
  command->add_flag(
      "--check", options->check,
      "End with status 4 where what the scenario expects ([expect]) does not hold; on a hopper");
  options->comments.add_to(*command);
  command->add_flag("--accept-inertias", options->accept_inertias, kAcceptInertias);
  command->callback([options, play] { run(*options, play); });
}

}  // namespace furcula::cli
