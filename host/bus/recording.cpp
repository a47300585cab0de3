// Reading recordings, see recording.hpp.
#include "host/bus/recording.hpp"

#include <algorithm>
#include <cstring>

#include "host/bus/candump_text.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::DataError;
using core::quoted;

constexpr std::string_view kConvert = "convert it with python-can: python3 -m can.logconvert FILE can.log";

/// How a file begins that is a recording, but not one of lines that are read here, and what to do.
struct OtherFile {
  std::string_view start, what, next;
};
constexpr OtherFile kOtherFiles[] = {
    {"LOGG", "Vector's binary format (.blf)", kConvert},
    {"MDF ", "an ASAM MDF file (.mf4)", kConvert},
    {";$FILEVERSION", "a PEAK trace (.trc)", kConvert},
    {"SQLite format 3", "an SQLite file", kConvert},
    {"timestamp,arbitration_id", "python-can's CSV", kConvert},
    {"Time Stamp,ID,", "SavvyCAN's CSV", "save it there as candump's log"},
    {"\x1f\x8b", "compressed", "unpack it with gunzip"},
    {"\x28\xb5\x2f\xfd", "compressed", "unpack it with unzstd"},
    {"PK\x03\x04", "a zip archive", "unpack it"},
    {"\xff\xfe", "UTF-16", "convert it: iconv -f UTF-16 -t UTF-8 FILE > can.log"},
    {"\xfe\xff", "UTF-16", "convert it: iconv -f UTF-16 -t UTF-8 FILE > can.log"},
    {"\x0a\x0d\x0d\x0a", "a capture of packets (.pcapng)", kRecordWith},
    {"\xd4\xc3\xb2\xa1", "a capture of packets (.pcap)", kRecordWith},
    {"\x4d\x3c\xb2\xa1", "a capture of packets (.pcap)", kRecordWith},
    {"time_s,interface,message,signal", "decoded already, by furcula bus decode",
     "give the recording that it was made of"},
    {"# format: furcula-log/1", "a log of furcula, not one of a bus", "see furcula check"},
};

/// Colours (`candump -c`): ESC [ digits m.
void strip_colours(std::string_view line, std::string& out) {
  out.clear();
  for (std::size_t i = 0; i < line.size();) {
    if (line[i] == '\x1b' && i + 1 < line.size() && line[i + 1] == '[') {
      i += 2;
      while (i < line.size() && !(line[i] >= '@' && line[i] <= '~')) ++i;
      ++i;
    } else {
      out += line[i++];
    }
  }
}

std::string seconds(std::int64_t ns) { return core::rounded(static_cast<double>(ns) * 1e-9, 6) + " s"; }

std::string counted(std::uint64_t n, std::string_view one, std::string_view many) {
  return std::to_string(n) + " " + std::string(n == 1 ? one : many);
}

}  // namespace

/// `whole`: it has a line end. Of a line longer than the buffer the beginning is given.
bool RecordingReader::next_line(std::string_view& line, bool& whole) {
  for (;;) {
    const char* const from = buffer_.data() + begin_;
    const auto* const newline = static_cast<const char*>(std::memchr(from, '\n', end_ - begin_));
    if (newline != nullptr || (at_end_ && begin_ < end_)) {
      ++line_;
      const std::size_t size = newline != nullptr ? static_cast<std::size_t>(newline - from) : end_ - begin_;
      line = {from, size};
      whole = newline != nullptr;
      begin_ += whole ? size + 1 : size;
      if (line.ends_with('\r')) line.remove_suffix(1);
      return true;
    }
    if (at_end_) return false;
    std::memmove(buffer_.data(), from, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    // A line that is longer than any of candump's is passed over but for its first part.
    constexpr std::size_t kLongest = 16384;
    const bool overlong = end_ > kLongest;
    if (overlong) end_ = kLongest;
    const std::size_t n = source_.read(buffer_.data() + end_, buffer_.size() - end_);
    at_end_ = n == 0;
    if (overlong) {
      const auto* const end_of_it = static_cast<const char*>(std::memchr(buffer_.data() + end_, '\n', n));
      const std::size_t kept = end_of_it != nullptr
                                   ? n - static_cast<std::size_t>(end_of_it - (buffer_.data() + end_))
                                   : std::size_t{0};
      if (kept != 0) std::memmove(buffer_.data() + end_, end_of_it, kept);
      // One byte more than the longest: it stays an overlong one.
      end_ += kept;
      if (kept == 0 && n != 0) buffer_[end_++] = '?';
    } else {
      end_ += n;
    }
    if (!started_ && (end_ >= 32 || at_end_)) {
      started_ = true;
      if (std::string_view(buffer_.data(), end_).starts_with("\xef\xbb\xbf")) begin_ = 3;
      refuse_other_files({buffer_.data() + begin_, end_ - begin_});
    }
  }
}

void RecordingReader::refuse_other_files(std::string_view start) const {
  for (const OtherFile& f : kOtherFiles)
    if (start.starts_with(f.start))
      throw DataError(name_ + ": it is " + std::string(f.what) + ", which is not read; " +
                      std::string(f.next));
}

void RecordingReader::note_odd(std::string why) {
  ++odd_;
  if (named_.size() < kNamed) named_.push_back({line_, std::move(why)});
}

void RecordingReader::judge(bool at_end) const {
  const std::uint64_t lines = frames_ + ahead_.size() + odd_ + events_;
  if (odd_ == 0 || (!at_end && (odd_ < kFewestToJudge || odd_ < frames_))) return;
  // A twentieth, as of a log's rows (host/log/data_quality.hpp).
  if (odd_ <= kAlwaysBorne + lines / 20 && odd_ < frames_ + ahead_.size()) return;
  throw DataError(name_ + ":" + std::to_string(named_.front().line) + ": " + named_.front().why + " (" +
                  std::to_string(odd_) + " of " + counted(lines, "line is", "lines are") + " no " +
                  (odd_ == 1 ? "frame" : "frames") + ": too many to pass over; " + std::string(kRecordWith) +
                  ")");
}

bool RecordingReader::next_frame(LogFrame& frame, TimeFrom& stamp) {
  std::string_view line;
  bool whole = true;
  while (next_line(line, whole)) {
    if (std::memchr(line.data(), '\x1b', line.size()) != nullptr) {
      strip_colours(line, without_colours_);
      line = without_colours_;
    }
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == line.npos || line[first] == '#' || line[first] == ';') continue;
    // `candump -e`: an error frame in words, on lines of their own behind it.
    if (after_error_ && line.front() == '\t') continue;
    try {
      const char c = line[first];
      if (c != '(' &&
          (asc_.begun() || c == '/' || (c >= '0' && c <= '9') || c == 'd' || c == 'b' || c == 'B')) {
        const AscParser::Line kind = asc_.parse(line, frame);
        stamp = TimeFrom::absolute;
        if (kind == AscParser::Line::frame) {
          after_error_ = false;
          return true;
        }
        if (kind == AscParser::Line::event && asc_.begun()) ++events_;
        if (kind == AscParser::Line::header || (kind == AscParser::Line::event && asc_.begun())) continue;
      }
      if (line.substr(first).starts_with("DROPCOUNT: dropped ")) {
        std::uint64_t n = 0;
        for (const char digit : line.substr(first + 19)) {
          if (digit < '0' || digit > '9' || n > 1'000'000'000'000) break;
          n = 10 * n + static_cast<std::uint64_t>(digit - '0');
        }
        dropped_ += n;
        continue;
      }
      stamp = parse_candump(line, frame);
      if (stamp == TimeFrom::none) throw DataError(quoted(line) + " has no time stamp");
      after_error_ = frame.error;
      return true;
    } catch (const DataError& e) {
      after_error_ = false;
      if (whole || frames_ + ahead_.size() == 0)
        note_odd(e.what());
      else
        torn_ = quoted(line);
    }
    judge(false);
  }
  judge(true);
  return false;
}

/// Whether time stamps of a screen are those since the start, or differences: the former pass all before them but where two
/// interfaces cross, the latter seldom.
void RecordingReader::look_ahead() {
  looked_ahead_ = true;
  Ahead a;
  while (ahead_.size() < kAhead && next_frame(a.frame, a.stamp)) {
    a.line = line_;
    ahead_.push_back(a);
    if (a.stamp != TimeFrom::relative) break;
  }
  std::int64_t furthest_ns = -1;
  std::size_t behind = 0, rises = 0, n = 0;
  for (const Ahead& one : ahead_) {
    if (one.stamp != TimeFrom::relative) break;
    // The first one is 0 either way.
    if (n++ == 0) continue;
    behind += one.frame.time_ns < furthest_ns ? 1 : 0;
    rises += one.frame.time_ns > furthest_ns ? 1 : 0;
    furthest_ns = std::max(furthest_ns, one.frame.time_ns);
  }
  // All the same: frames at equal intervals.
  differences_ = n > 2 && (2 * behind > n || (rises == 1 && behind == 0 && furthest_ns > 0));
}

void RecordingReader::take_time(LogFrame& frame, TimeFrom stamp) {
  if (stamp == TimeFrom::relative) {
    relative_ = true;
    if (differences_) {
      if (frame.time_ns > text::kLatestNs - sum_ns_)
        throw DataError(name_ + ": its time stamps, taken as differences, make a century; " +
                        std::string(kRecordWith));
      frame.time_ns = sum_ns_ += frame.time_ns;
    }
  }
  if (frames_ != 0 && frame.time_ns < last_ns_) {
    if (back_++ == 0) first_back_line_ = line_;
    furthest_back_ns_ = std::max(furthest_back_ns_, last_ns_ - frame.time_ns);
  }
  last_ns_ = frame.time_ns;
  ++frames_;
}

bool RecordingReader::next(LogFrame& frame) {
  if (!looked_ahead_) look_ahead();
  if (!ahead_.empty()) {
    const std::uint64_t line = line_;
    const Ahead a = std::move(ahead_.front());
    ahead_.pop_front();
    frame = a.frame;
    line_ = a.line;
    take_time(frame, a.stamp);
    line_ = line;
    return true;
  }
  TimeFrom stamp = TimeFrom::none;
  if (!next_frame(frame, stamp)) return false;
  take_time(frame, stamp);
  return true;
}

std::string RecordingReader::remarks() const {
  std::string out;
  if (odd_ != 0) {
    out += counted(odd_, "line that is no frame was left out: ", "lines that are no frames were left out: ");
    for (std::size_t i = 0; i < named_.size(); ++i)
      out += (i == 0 ? "line " : "; line ") + std::to_string(named_[i].line) + ": " + named_[i].why;
    out += odd_ > named_.size() ? "; ...\n" : "\n";
  }
  if (!torn_.empty()) out += "the last line, " + torn_ + ", is torn and was left out\n";
  if (events_ != 0) out += counted(events_, "line of another event", "lines of other events") + "\n";
  if (dropped_ != 0) out += "candump lost " + counted(dropped_, "frame", "frames") + " itself (DROPCOUNT)\n";
  if (relative_)
    out += differences_ ? "time stamps are taken as differences (candump -td) and summed\n"
                        : "time stamps are taken as those since the start (candump -tz)\n";
  if (back_ != 0)
    out += "time goes back " + counted(back_, "time", "times") + ", by " + seconds(furthest_back_ns_) +
           " at most, first in line " + std::to_string(first_back_line_) +
           (furthest_back_ns_ < 100'000'000 ? " (two interfaces in one recording do that)\n"
                                            : " (was the clock set, or are these two recordings?)\n");
  return out;
}

}  // namespace furcula::bus
