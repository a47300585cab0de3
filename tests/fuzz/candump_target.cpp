// The reader of recordings of a bus, and what is made of what it reads: signals, and rows of a log.
#include <string>
#include <vector>

#include "furcula/bus/codec.hpp"
#include "host/bus/bus_log.hpp"
#include "host/bus/columns.hpp"
#include "host/bus/decoder.hpp"
#include "host/bus/recording.hpp"
#include "host/core/error.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

/// Every raw number that is got from a frame makes the same bits again.
void check_signals(const bus::Frame& frame, const std::vector<bus::NodeMessage>& messages) {
  for (const bus::NodeMessage& m : messages)
    for (const bus::Signal& s : m.signals) {
      const Result<std::uint32_t> raw = bus::get_raw(frame, s);
      require(raw.ok() == (!frame.remote && bus::bytes_to_end(s) <= frame.size), "what fits is got");
      if (!raw.ok()) continue;
      bus::Frame again = frame;
      require(bus::put_raw(again, s, raw.value()) == Status::ok && again == frame,
              "what was got is put again");
    }
}

/// A hopper's columns whose counts are known.
bus::ChannelPermutation hopper(const bus::MessageFinder& finder) {
  return bus::arrange("hopper", bus::usual_nodes(), {},
                      {bus::parse_column("height_m=Rail.Sample.Count*0.0001+0.1", finder.messages())});
}

/// Rows of a robot's two drives, by what the recording tells of them.
void make_joints(const std::vector<bus::LogFrame>& frames, const bus::MessageFinder& finder) {
  bus::ChannelPermutation wanted =
      bus::arrange("tree", bus::usual_nodes(), {{"knee", "Knee"}, {"hip", "Axis", -6.0}},
                   {bus::parse_column("mode=Axis.Set_Controller_Mode.Control_Mode", finder.messages())});
  for (bus::Column& c : wanted.columns) c.required = false;
  bus::Survey survey(finder, wanted);
  for (const bus::LogFrame& f : frames) survey.add(f);
  std::vector<std::string> notes;
  try {
    const bus::ChannelPermutation found = survey.finish(notes);
    double last_s = -1.0;
    bus::RowMaker maker(finder, found, [&](std::size_t, const std::vector<double>& row) {
      for (const double value : row) require(value - value == 0.0, "a row holds numbers");
      require(row.front() > last_s, "time goes on");
      last_s = row.front();
    });
    for (const bus::LogFrame& f : frames) maker.add(f);
    maker.finish();
    maker.notes();
  } catch (const core::DataError&) {  // no such robot's
  }
}

}  // namespace

bool accepts(std::string_view input) {
  static const std::vector<bus::Node> nodes = bus::usual_nodes();
  static const std::vector<bus::NodeMessage> messages = bus::messages_of(nodes);
  static const bus::MessageFinder finder(nodes);
  static const bus::ChannelPermutation permutation = hopper(finder);
  bus::Decoder decoder(nodes);
  bus::Survey survey(finder, permutation);
  double last_s = -1.0;
  std::size_t last_run = 1;
  bus::RowMaker maker(finder, permutation, [&](std::size_t run, const std::vector<double>& row) {
    require(row.size() == permutation.columns.size() + 1, "a row has a value for each column");
    for (const double value : row) require(value - value == 0.0, "a row holds numbers");
    require(row.front() > last_s && run >= last_run, "time goes on");
    last_s = row.front();
    last_run = run;
  });
  core::TextSource source(input);
  bus::RecordingReader reader(source, "input");
  std::string rows;
  std::vector<bus::LogFrame> frames;
  try {
    bus::LogFrame frame;
    while (reader.next(frame)) {
      std::string line = bus::format_candump(frame);
      line.pop_back();
      require(frame.longer || bus::parse_candump(line) == frame, "a written frame reads back the same");
      check_signals(frame.frame, messages);
      survey.add(frame);
      maker.add(frame);
      frames.push_back(frame);
      rows.clear();
      decoder.decode(frame, rows);
    }
  } catch (const core::DataError&) {
    return false;
  }
  maker.finish();
  maker.notes();
  std::vector<std::string> notes;
  try {
    survey.finish(notes);
  } catch (const core::DataError&) {  // no hopper's
  }
  decoder.remarks();
  reader.remarks();
  make_joints(frames, finder);
  return true;
}

}  // namespace furcula::fuzz
