// `furcula bus`: the DBC file and the pages of the tables of both buses, and recordings decoded.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host/bus/bus_log.hpp"
#include "host/bus/columns.hpp"
#include "host/bus/dbc.hpp"
#include "host/bus/decoder.hpp"
#include "host/bus/document.hpp"
#include "host/bus/modbus_document.hpp"
#include "host/bus/recording.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/byte_source.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::cli {
namespace {

struct BusOptions {
  std::vector<std::string> nodes;
  std::string log;
  std::string page = "can";
  std::string out, rig = "hopper";
  std::vector<std::string> joints, columns;
  CommentsOption comments;
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

/// The files of a recording's runs: PATH, then PATH-2 and so on before its ending. Each is written beside its place and moved there.
class RunFiles {
 public:
  // docs/contracts.md, section 1: of a tree's log. A run of 0.05 s is none.
  static constexpr std::size_t kFewestRows = 50;
  struct File {
    std::string path;
    std::string target;  ///< what a link names
    std::string part;    ///< until it is whole; empty: written as it is
    std::size_t rows = 0;
    double seconds = 0.0;
  };

  RunFiles(std::string path, std::string header) : path_(std::move(path)), header_(std::move(header)) {}
  ~RunFiles() {
    for (const File& f : files_) remove(f);
  }
  RunFiles(const RunFiles&) = delete;
  RunFiles& operator=(const RunFiles&) = delete;

  void write(std::size_t run, const std::vector<double>& row) {
    if (run != run_) {
      close();
      run_ = run;
      begin_s_ = row.front();
      namespace fs = std::filesystem;
      const std::string path = of_run(files_.size() + 1);
      std::error_code ignored;
      const bool exists = fs::exists(path, ignored);
      if (exists && fs::is_directory(path, ignored))
        throw core::OutputError(path + ": cannot be written: it is a directory");
      File file{path, path, ""};
      // A link's target is replaced, not the link (/dev/stdout is one); a device or a pipe is written to as it is.
      if (exists) file.target = fs::canonical(path, ignored).string();
      if (!exists || (!file.target.empty() && fs::is_regular_file(file.target, ignored)))
        file.part = file.target + ".part-" + std::to_string(::getpid());
      stream_.open(file.part.empty() ? path : file.part, std::ios::binary | std::ios::trunc);
      files_.push_back(std::move(file));
      stream_ << header_;
    }
    text_.clear();
    char number[40];
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i != 0) text_ += ',';
      // A stamp has its nanoseconds, a value of 16 bits no more than 9 digits.
      const int n = std::snprintf(number, sizeof number, i == 0 ? "%.9f" : "%.9g", row[i]);
      text_.append(number, static_cast<std::size_t>(n));
    }
    stream_ << text_ << '\n';
    ++files_.back().rows;
    files_.back().seconds = row.front() - begin_s_;
  }

  /// Moves them to their places. @returns those that stay.
  std::vector<File> finish() {
    close();
    for (File& f : files_) {
      if (f.part.empty()) continue;
      std::error_code error;
      std::filesystem::rename(f.part, f.target, error);
      if (error) throw core::OutputError(f.path + ": cannot be written: " + error.message());
      f.part.clear();
    }
    return std::move(files_);
  }
  std::size_t short_runs() const { return short_; }

 private:
  std::string of_run(std::size_t n) const {
    if (n == 1) return path_;
    const std::filesystem::path path(path_);
    return (path.parent_path() / (path.stem().string() + "-" + std::to_string(n) + path.extension().string()))
        .string();
  }
  static void remove(const File& f) {
    std::error_code ignored;
    if (!f.part.empty()) std::filesystem::remove(f.part, ignored);
  }
  void close() {
    if (run_ == 0) return;
    run_ = 0;
    stream_.close();
    if (!stream_) throw core::OutputError(files_.back().path + ": cannot be written");
    if (files_.back().rows >= kFewestRows) return;
    ++short_;
    remove(files_.back());
    files_.pop_back();
  }

  std::string path_, header_, text_;
  std::vector<File> files_;
  std::ofstream stream_;
  std::size_t run_ = 0, short_ = 0;
  double begin_s_ = 0.0;
};

/// Hands each frame of the recording on. @returns the reader's remarks.
std::string read_frames(const std::string& path, const std::function<void(const bus::LogFrame&)>& take) {
  core::FileSource source(path, "a recording of candump -L");
  bus::RecordingReader reader(source, path);
  bus::LogFrame frame;
  while (reader.next(frame)) take(frame);
  if (reader.frames() == 0)
    throw core::DataError(path + ": no frame in it; " + std::string(bus::kRecordWith));
  return reader.remarks();
}

/// Lines as one remark behind a message; nothing where there are none.
std::string in_brackets(std::string lines) {
  if (lines.empty()) return lines;
  lines.pop_back();
  for (std::size_t i = 0; (i = lines.find('\n', i)) != lines.npos; i += 2) lines.replace(i, 1, "; ");
  return " (" + lines + ")";
}

void make_log(const BusOptions& options) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::exists(options.log, ignored) && !fs::is_regular_file(options.log, ignored) &&
      !fs::is_directory(options.log, ignored))
    throw core::DataError(options.log +
                          ": it is read twice, which a pipe cannot be; save the recording in a file");
  if (fs::equivalent(options.log, options.out, ignored))
    throw UsageError("--out: " + options.out + " is the recording itself; expected another file");
  const bus::MessageFinder finder(nodes_of(options));
  bus::ChannelPermutation permutation;
  try {
    std::vector<bus::JointDrive> joints;
    for (const std::string& text : options.joints) joints.push_back(bus::parse_joint(text));
    std::vector<bus::Column> columns;
    for (const std::string& text : options.columns)
      columns.push_back(bus::parse_column(text, finder.messages()));
    permutation = bus::arrange(options.rig, nodes_of(options), joints, columns);
  } catch (const core::DataError& e) {
    throw UsageError(e.what());
  }
  std::vector<std::string> notes;
  bus::Survey survey(finder, permutation);
  bus::Undecoded undecoded;
  const std::string remarks = read_frames(options.log, [&](const bus::LogFrame& f) {
    survey.add(f);
    if (finder.find(f) == nullptr) undecoded.count(f, finder.messages());
  });
  try {
    permutation = survey.finish(notes);
  } catch (const core::DataError& e) {
    throw core::DataError(options.log + ": " + e.what() + in_brackets(undecoded.remarks()));
  }
  std::string header =
      (options.comments.none ? "" : "# format: furcula-log/1\n# machine_type: " + permutation.rig + "\n") +
      "time_s";
  for (const bus::Column& c : permutation.columns) header += "," + c.name;
  RunFiles files(options.out, header + "\n");
  bus::RowMaker rows(finder, permutation,
                     [&](std::size_t run, const std::vector<double>& row) { files.write(run, row); });
  read_frames(options.log, [&](const bus::LogFrame& f) { rows.add(f); });
  rows.finish();
  const std::vector<RunFiles::File> written = files.finish();
  for (const std::string& note : rows.notes()) notes.push_back(note);
  if (files.short_runs() != 0)
    notes.push_back(std::to_string(files.short_runs()) + " run(s) of fewer than " +
                    std::to_string(RunFiles::kFewestRows) + " rows are left out");
  std::string all = remarks + undecoded.remarks();
  for (const std::string& note : notes) all += note + "\n";
  if (written.empty())
    throw core::DataError(
        options.log + ": no rows come of it; expected a robot that runs while all of its bus is recorded\n" +
        all);
  for (const RunFiles::File& f : written)
    std::cout << core::printable(f.path) << ": " << f.rows << " rows, " << core::rounded(f.seconds) << " s\n";
  std::cerr << core::printable_lines(all);
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
  CLI::App* logging = group->add_subcommand(
      "log", "Make a log of a recording, a row a tick, for check, identify and diagnose");
  for (CLI::App* command : {dbc, decoding, logging})
    command
        ->add_option("--node", options->nodes,
                     "A node, NAME=PROTOCOL:ID or NAME=mini_cheetah:ID:MOTOR; one option for each")
        ->allow_extra_args(false);
  decoding->add_option("LOG", options->log, "Recording of candump (-L, or its screen), or Vector's .asc")
      ->required();
  logging->add_option("LOG", options->log, "Recording, as of decode")->required();
  logging
      ->add_option("--out", options->out,
                   "The log; of a recording of several runs the first, then NAME-2 and so on")
      ->required();
  logging
      ->add_option("--machine,--rig", options->rig,
                   "Machine type of the log: hopper, rotary_joint, tree, motor_axis, ...")
      ->capture_default_str();
  logging
      ->add_option(
          "--joint", options->joints,
          "The drive at a joint, JOINT=NODE or JOINT=NODE:RATIO (turns of the motor to one of the joint)")
      ->allow_extra_args(false);
  logging
      ->add_option("--column", options->columns,
                   "A column, NAME=NODE.MESSAGE.SIGNAL, then perhaps *SCALE and +OFFSET; one option for each")
      ->allow_extra_args(false);
  dbc->callback([options] { std::cout << bus::to_dbc(nodes_of(*options)); });
  docs->add_option("PAGE", options->page, "can or modbus")->check(CLI::IsMember({"can", "modbus"}));
  docs->callback(
      [options] { std::cout << (options->page == "can" ? bus::to_markdown() : bus::modbus_to_markdown()); });
  options->comments.add_to(*logging);
  logging->callback([options] { make_log(*options); });
  decoding->callback([options] { decode(*options); });
}

}  // namespace furcula::cli
