// `furcula convert`: writes what the other commands read, a ROS 2 bag or a CSV file with other columns, as a log.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/message.hpp"
#include "host/log/reader.hpp"
#include "host/log/writer.hpp"

namespace furcula::cli {
namespace {

struct ConvertOptions {
  std::string log, out, rig, map, topic;
  CommentsOption comments;
};

void convert(const ConvertOptions& options) {
  require_other_file("--out", options.out, {options.log, options.map});
  if (!options.rig.empty()) require_rig(options.rig);
  log::ColumnMap map;
  map.all_topics = options.map.empty();
  if (!options.map.empty()) map = log::read_column_map(options.map);
  if (!options.topic.empty()) map.topic = options.topic;
  const log::Log log = log::read_log(options.log, options.rig, &map);
  log::write_log(log, options.out, options.comments.of_log());
  for (const std::string& note : log.notes) std::cerr << core::printable(note) << "\n";
  if (!log.refused.empty())
    std::cerr << core::printable(log::in_words(log.refused, log.refused.size())) << "\n";
  std::cout << core::printable(options.out) << ": " << log.rows() << " rows, "
            << core::rounded(log.time_s().back() - log.time_s().front()) << " s, columns ";
  std::string columns;
  for (const auto& [name, values] : log.columns) columns += (columns.empty() ? "" : ", ") + name;
  std::cout << core::printable(columns) << "\n";
}

}  // namespace

void add_convert_command(CLI::App& app) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* command =
      app.add_subcommand("convert", "Write a ROS 2 bag, or a CSV file with other columns, as a log");
  command->add_option("LOG", options->log, "MCAP file, file or directory of rosbag2, or CSV file")
      ->required();
  command->add_option("--out", options->out, "The log (CSV)")->required();
  command->add_option("--map", options->map,
                      "Map file; without it all topics of a bag that have numbers become columns");
  command->add_option(
      "--topic", options->topic,
      "Topic of a bag whose messages are the rows, and whose joints, where it has joint states");
  command->add_option(
      "--machine,--rig", options->rig,
      "Machine type of the log; without it that of the map or of the log, tree of a bag with joint states");
  options->comments.add_to(*command);
  command->callback([options] { convert(*options); });
}

}  // namespace furcula::cli
