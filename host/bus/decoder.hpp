// Frames of a recording as rows of signals.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/bus/candump.hpp"
#include "host/bus/nodes.hpp"

namespace furcula::bus {

/// Counts the frames that are none of the messages of the nodes, by the reason.
class Undecoded {
 public:
  void count(const LogFrame& frame, const std::vector<NodeMessage>& messages);
  /// One line for each reason; empty: there was none.
  std::string remarks() const;

 private:
  // A bus in good order has few ids that nobody knows; a file of noise must not fill the memory.
  static constexpr std::size_t kMostIds = 1000;
  using Counts = std::map<std::string, std::uint64_t>;
  static void count_id(Counts& counts, const LogFrame& frame);

  std::uint64_t remote_ = 0, error_ = 0, longer_ = 0;
  Counts unknown_, wrong_length_;
};

/// Appended by decode(): a CSV row for each signal, one with an empty signal for a message that has none.
inline constexpr std::string_view kDecodedHeader = "time_s,interface,message,signal,value,unit\n";

class Decoder {
 public:
  /// @throws core::DataError as check_nodes().
  explicit Decoder(std::vector<Node> nodes);

  /// Appends the rows of a frame.
  void decode(const LogFrame& frame, std::string& rows);

  std::uint64_t decoded() const { return decoded_; }
  /// What was not decoded, one line for each reason; empty: all was.
  std::string remarks() const { return undecoded_.remarks(); }

 private:
  std::vector<Node> nodes_;
  std::vector<NodeMessage> messages_;
  std::uint64_t decoded_ = 0;
  Undecoded undecoded_;
};

}  // namespace furcula::bus
