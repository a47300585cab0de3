// The reader of candump's logs, and the decoder of what it reads.
#include <string>
#include <vector>

#include "furcula/bus/codec.hpp"
#include "host/bus/candump.hpp"
#include "host/bus/decoder.hpp"
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

}  // namespace

bool accepts(std::string_view input) {
  static const std::vector<bus::Node> nodes = bus::usual_nodes();
  static const std::vector<bus::NodeMessage> messages = bus::messages_of(nodes);
  bus::Decoder decoder(nodes);
  core::TextSource source(input);
  bus::CandumpReader reader(source, "input");
  std::string rows;
  try {
    bus::LogFrame frame;
    while (reader.next(frame)) {
      std::string line = bus::format_candump(frame);
      line.pop_back();
      require(bus::parse_candump(line) == frame, "a written frame reads back the same");
      check_signals(frame.frame, messages);
      rows.clear();
      decoder.decode(frame, rows);
    }
  } catch (const core::DataError&) {
    return false;
  }
  decoder.remarks();
  return true;
}

}  // namespace furcula::fuzz
