// Vector's text format, see asc.hpp.
#include "host/bus/asc.hpp"

#include <charconv>

#include "host/bus/candump_text.hpp"

namespace furcula::bus {
namespace {

using core::DataError;
using core::quoted;

// Flags at the end of a CANFD line, as log2asc has them.
constexpr std::uint32_t kFlagRemote = 0x10, kFlagFd = 0x1000;

bool parse_number(std::string_view word, int base, std::uint32_t& number) {
  const auto read = std::from_chars(word.data(), word.data() + word.size(), number, base);
  return !word.empty() && read.ec == std::errc() && read.ptr == word.data() + word.size();
}

bool is_any(std::string_view word, std::initializer_list<std::string_view> of) {
  return std::find(of.begin(), of.end(), word) != of.end();
}

/// What the controller reports is not written: an error frame as candump has it, without a class.
AscParser::Line error_frame(LogFrame& out) {
  out.error = out.frame.extended = true;
  return AscParser::Line::frame;
}

std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

/// Seconds with a point, or a comma as some countries' programs write it.
bool take_time(std::string_view word, std::int64_t& ns) {
  if (const std::size_t comma = word.find(','); comma != word.npos) {
    std::string with_point(word);
    with_point[comma] = '.';
    return text::seconds_to_ns(with_point, ns);
  }
  return text::seconds_to_ns(word, ns);
}

}  // namespace

bool AscParser::parse_header(std::string_view line) {
  std::string_view rest = line;
  const std::string first = lower(text::take_word(rest)), second = lower(text::take_word(rest));
  if (first == "base" && (second == "hex" || second == "dec")) {
    decimal_ = second == "dec";
    std::string_view word = text::take_word(rest);
    if (lower(word) == "timestamps") relative_ = lower(text::take_word(rest)) == "relative";
    return begun_ = true;
  }
  if (first == "date" || (first == "begin" && second == "triggerblock")) return begun_ = true;
  if (!begun_) return first == "//" && second == "version";
  return first.starts_with("//") || is_any(first, {"begin", "end", "no", "internal", "previous"});
}

bool AscParser::take_id(std::string_view word, LogFrame& out) const {
  out.frame.extended = word.ends_with('x') || word.ends_with('X');
  if (out.frame.extended) word.remove_suffix(1);
  return parse_number(word, decimal_ ? 10 : 16, out.frame.id) &&
         out.frame.id <= (out.frame.extended ? text::kLargestExtended : text::kLargestStandard);
}

std::uint8_t AscParser::take_byte(std::string_view word) const {
  std::uint32_t byte = 0;
  if (word.size() > 3 || !parse_number(word, decimal_ ? 10 : 16, byte) || byte > 255)
    throw DataError("data " + quoted(word) + "; expected as many bytes as the frame's length says");
  return static_cast<std::uint8_t>(byte);
}

void AscParser::take_data(std::string_view& rest, std::uint32_t size, LogFrame& out) const {
  for (std::uint32_t i = 0; i < size; ++i) {
    const std::uint8_t byte = take_byte(text::take_word(rest));
    if (i < out.frame.data.size()) out.frame.data[i] = byte;
  }
  out.frame.size = static_cast<std::uint8_t>(std::min<std::uint32_t>(size, 8));
}

AscParser::Line AscParser::parse_event(std::string_view rest, LogFrame& out) const {
  out.frame = Frame{};
  out.error = out.longer = false;
  std::string_view word = text::take_word(rest);
  const bool fd = word == "CANFD";
  if (word == "CANXL") {
    text::parse_interface(text::take_word(rest), out);
    out.longer = true;
    return Line::frame;
  }
  if (fd) word = text::take_word(rest);
  std::uint32_t channel = 0;
  if (!parse_number(word, 10, channel)) return Line::event;
  out.interface = word;
  if (fd) {
    if (!is_any(text::take_word(rest), {"Rx", "Tx", "TxRq"})) return Line::event;
    word = text::take_word(rest);
    if (word.starts_with("ErrorFrame")) return error_frame(out);
    if (!take_id(word, out)) return Line::event;
    word = text::take_word(rest);
    if (word != "0" && word != "1")
      word = text::take_word(rest);  // the id's name stands before the two flags
    text::take_word(rest);
    std::uint32_t code = 0, size = 0, flags = kFlagFd;
    if (!parse_number(text::take_word(rest), 16, code) || !parse_number(text::take_word(rest), 10, size) ||
        size > 64)
      throw DataError("expected a length of data after the id and its flags");
    take_data(rest, size, out);
    text::take_word(rest);  // duration
    text::take_word(rest);  // bits
    if (word = text::take_word(rest); !word.empty() && !parse_number(word, 16, flags)) flags = kFlagFd;
    out.longer = (flags & kFlagFd) != 0 || size > 8;
    out.frame.remote = !out.longer && (flags & kFlagRemote) != 0;
    if (out.longer || out.frame.remote) out.frame.data = {};
    if (out.longer) out.frame.size = 0;
    if (out.frame.remote) out.frame.size = static_cast<std::uint8_t>(std::min<std::uint32_t>(code, 8));
    return Line::frame;
  }
  word = text::take_word(rest);
  if (word.starts_with("ErrorFrame")) return error_frame(out);
  if (!is_any(text::take_word(rest), {"Rx", "Tx", "TxRq"})) return Line::event;
  if (!take_id(word, out)) return Line::event;
  const std::string_view kind = text::take_word(rest);
  std::uint32_t size = 0;
  if (kind == "r") {
    out.frame.remote = true;
    if (parse_number(text::take_word(rest), 16, size))
      out.frame.size = static_cast<std::uint8_t>(std::min<std::uint32_t>(size, 8));
    return Line::frame;
  }
  if (kind != "d" || !parse_number(text::take_word(rest), 16, size) || size > 15)
    throw DataError(quoted(kind) + " after the direction; expected d or r and a length from 0 to 8");
  // A length code of 9 to 15 is of 8 bytes.
  take_data(rest, std::min<std::uint32_t>(size, 8), out);
  return Line::frame;
}

AscParser::Line AscParser::parse(std::string_view line, LogFrame& out) {
  std::string_view rest = line;
  const std::string_view time = text::take_word(rest);
  std::int64_t ns = 0;
  if (!take_time(time, ns)) return parse_header(line) ? Line::header : Line::other;
  if (relative_ && ns > text::kLatestNs - time_ns_)
    throw DataError("time " + quoted(time) + "; expected less");
  time_ns_ = relative_ ? time_ns_ + ns : ns;
  out.time_ns = time_ns_;
  return parse_event(rest, out);
}

}  // namespace furcula::bus
