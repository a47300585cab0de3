// `furcula bus`: the DBC file and the pages of the tables of both buses, and recordings decoded.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host/bus/dbc.hpp"
#include "host/bus/decoder.hpp"
#include "host/bus/document.hpp"
#include "host/bus/modbus_document.hpp"
#include "host/bus/recording.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/core/byte_source.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::cli {
namespace {

struct BusOptions {
  std::vector<std::string> nodes;
  std::string log;
  std::string page = "can";
};

std::vector<bus::Node> nodes_of(const BusOptions& options) {
  if (options.nodes.empty()) return bus::usual_nodes();
  try {
    std::vector<bus::Node> nodes;
    for (const std::string& text : options.nodes) nodes.push_back(bus::parse_node(text));
    bus::check_nodes(nodes);
    return nodes;
  } catch (const core::DataError& e) {
    throw UsageError(std::string("--node: ") + e.what());
  }
}

void decode(const BusOptions& options) {
  bus::Decoder decoder(nodes_of(options));
  core::FileSource source(options.log, "a recording of candump -L");
  bus::RecordingReader reader(source, options.log);
  bus::LogFrame frame;
  std::string rows(bus::kDecodedHeader);
  while (reader.next(frame)) {
    decoder.decode(frame, rows);
    if (rows.size() < 60000) continue;
    std::cout << rows;
    rows.clear();
  }
  if (reader.frames() == 0)
    throw core::DataError(options.log + ": no frame in it; " + std::string(bus::kRecordWith));
  std::cout << rows;
  std::cerr << core::printable(options.log) << ": " << reader.frames() << " frames, " << decoder.decoded()
            << " decoded\n"
            << decoder.remarks() << core::printable_lines(reader.remarks());
}

}  // namespace

void add_bus_command(CLI::App& app) {
  const auto options = std::make_shared<BusOptions>();
  CLI::App* group =
      app.add_subcommand("bus", "The buses: DBC file and pages of the tables, CAN recordings decoded");
  group->require_subcommand(1);
  CLI::App* dbc = group->add_subcommand("dbc", "Print the DBC file of a bus");
  CLI::App* docs = group->add_subcommand("docs", "Print docs/bus.md, or docs/modbus.md");
  CLI::App* decoding = group->add_subcommand("decode", "Print the signals of a recording as CSV");
  for (CLI::App* command : {dbc, decoding})
    command
        ->add_option("--node", options->nodes,
                     "A node, NAME=PROTOCOL:ID or NAME=mini_cheetah:ID:MOTOR; one option for each")
        ->allow_extra_args(false);
  decoding->add_option("LOG", options->log, "Recording of candump (-L, or its screen), or Vector's .asc")->required();
  dbc->callback([options] { std::cout << bus::to_dbc(nodes_of(*options)); });
  docs->add_option("PAGE", options->page, "can or modbus")->check(CLI::IsMember({"can", "modbus"}));
  docs->callback(
      [options] { std::cout << (options->page == "can" ? bus::to_markdown() : bus::modbus_to_markdown()); });
  decoding->callback([options] { decode(*options); });
}

}  // namespace furcula::cli
