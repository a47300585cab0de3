// `furcula map`: proposes the map file of a log with other column names.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/mapping/propose.hpp"
#include "host/model/reader.hpp"

namespace furcula::cli {
namespace {

struct MapOptions {
  std::string log, model, out;
  bool accept_inertias = false;
};

void run(const MapOptions& o) {
  require_other_file("--out", o.out, {o.log, o.model});
  mapping::Proposal proposal;
  if (is_tree_model(o.model))
    proposal = mapping::propose(o.log, [&](const std::vector<std::string>& columns) {
      return tree_model(o.model, {{}, columns, o.accept_inertias}).value();
    });
  else
    proposal = mapping::propose(o.log, model::read_model(o.model));
  const std::string text = mapping::map_text(proposal);
  static_cast<void>(log::parse_column_map(text, o.out.empty() ? "the proposed map" : o.out));
  if (o.out.empty()) {
    std::cout << text;
    return;
  }
  core::write_file_atomically(o.out, text);
  std::size_t unsure = 0;
  for (const mapping::Line& line : proposal.lines) unsure += line.sureness == mapping::Sureness::sure ? 0 : 1;
  std::cout << core::printable(o.out) << ": " << proposal.lines.size() << " columns, " << unsure
            << " to confirm, " << proposal.expected.size() << " not found, " << proposal.left.size()
            << " not used\n";
  for (const std::string& sentence : proposal.confirm) std::cout << core::printable(sentence) << "\n";
}

}  // namespace

void add_map_command(CLI::App& app) {
  const auto options = std::make_shared<MapOptions>();
  CLI::App* command = app.add_subcommand(
      "map", "Propose the map file of a log with other column names; a person confirms it");
  command->add_option("LOG", options->log, "Log (CSV, or a ROS 2 bag)")->required();
  command->add_option("--model", options->model, "Model file (TOML), or a robot (URDF, MJCF)")->required();
  command->add_option("-o,--out", options->out, "The map file (TOML); without it standard output");
  command->add_flag("--accept-inertias", options->accept_inertias, kAcceptInertias);
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
