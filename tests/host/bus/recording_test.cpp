// Recordings of a bus: what is read, what is passed over and named, and what is refused.
#include "host/bus/recording.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Contains;

namespace {

struct Recording {
  std::vector<LogFrame> frames;
  std::string remarks, error;
};

Recording read(core::ByteSource& source) {
  Recording out;
  RecordingReader reader(source, "can.log");
  out.error = test::error_message([&] {
    LogFrame frame;
    while (reader.next(frame)) out.frames.push_back(frame);
  });
  CHECK(reader.frames() == out.frames.size());
  out.remarks = reader.remarks();
  return out;
}
Recording read(std::string_view text) {
  core::TextSource source(text);
  return read(source);
}

/// One byte at a time, so that lines end anywhere in what is read.
class Drops final : public core::ByteSource {
 public:
  explicit Drops(std::string_view text) : text_(text) {}
  std::size_t read(char* to, std::size_t size) override {
    if (text_.empty() || size == 0) return 0;
    *to = text_.front();
    text_.remove_prefix(1);
    return 1;
  }

 private:
  std::string_view text_;
};

std::string good_lines(int n, int first = 0) {
  std::string text;
  for (int i = first; i < first + n; ++i)
    text +=
        format_candump({1000LL * i, "can0", {static_cast<std::uint32_t>(i % 0x800), 1, false, false, {1}}});
  return text;
}

std::vector<std::int64_t> times_us(const Recording& r) {
  std::vector<std::int64_t> out;
  for (const LogFrame& f : r.frames) out.push_back(f.time_ns / 1000);
  return out;
}

}  // namespace

TEST_CASE("a long recording is read line by line, the last one without a line end too") {
  std::string text = good_lines(3000);
  text.pop_back();
  Drops source(text);
  const Recording r = read(source);
  REQUIRE(r.frames.size() == 3000);
  for (std::size_t i = 0; i < r.frames.size(); ++i)
    REQUIRE(r.frames[i].time_ns == 1000 * static_cast<std::int64_t>(i));
  CHECK(r.remarks.empty());
}

TEST_CASE(
    "line ends of other systems, a byte order mark, empty lines and comments are passed over without a word") {
  const Recording r =
      read("\xef\xbb\xbf# bench 3\r\n" + good_lines(1) + "\r\n\n; a note\n" + good_lines(1, 1));
  CHECK(r.frames.size() == 2);
  CHECK(r.remarks.empty());
  CHECK(r.error.empty());
}

TEST_CASE("an odd line costs itself alone and is named") {
  const Recording r = read(good_lines(3) + "what\n" + good_lines(3, 3));
  CHECK(r.error.empty());
  CHECK(r.frames.size() == 6);
  CHECK(r.remarks ==
        "1 line that is no frame was left out: line 4: 'what'; expected (SECONDS) INTERFACE ID#DATA\n");
  // candump's own words, where the screen went into a file with its errors.
  CHECK_THAT(read(good_lines(3) + "read: Network is down\n" + good_lines(3)).remarks,
             Contains("line 4: 'read: Network is down' is a program's message, not a frame") &&
                 Contains("ip -details -statistics link show"));
  CHECK_THAT(read(good_lines(3) + "can0: interface down\n" + good_lines(3)).remarks,
             Contains("is a program's message"));
  CHECK_THAT(read(good_lines(3) + "[ 12.3] bus is off\n" + good_lines(3)).remarks,
             Contains("line 4: '[ 12.3] bus is off'; expected (SECONDS) INTERFACE ID#DATA"));
  // The first of a recording that was cut, and two that were written into each other.
  CHECK(read("00123) can0 123#00\n" + good_lines(3)).frames.size() == 3);
  CHECK(read(good_lines(2) + "(0.00(0.000002) can0 123#00\n" + good_lines(2)).frames.size() == 4);
  const Recording many = read(good_lines(60) + "a\nb\nc\nd\ne\n" + good_lines(60));
  CHECK(many.frames.size() == 120);
  CHECK_THAT(many.remarks, Contains("5 lines that are no frames") && Contains("line 61: 'a'") &&
                               Contains("line 63: 'c'") && !Contains("line 64") && Contains("; ...\n"));
}

TEST_CASE("an overlong line is one odd line, in bounded memory") {
  const Recording r = read(good_lines(3) + std::string(300000, 'x') + "\n" + good_lines(3));
  CHECK(r.frames.size() == 6);
  CHECK_THAT(r.remarks, Contains("1 line that is no frame") && Contains("line 4"));
  // What a file system leaves of a file at a power cut.
  const Recording zeros = read(good_lines(3) + std::string(300000, '\0'));
  CHECK(zeros.frames.size() == 3);
  CHECK_THAT(zeros.remarks, Contains("the last line") && Contains("torn"));
}

TEST_CASE("a torn last line is said, and the frames before it are kept") {
  const Recording r = read(good_lines(2) + "(17326720");
  CHECK(r.error.empty());
  CHECK(r.frames.size() == 2);
  CHECK(r.remarks == "the last line, '(17326720', is torn and was left out\n");
  CHECK(read(" (1.5)  can0  123   [2]  00 01\n (1.6)  can0  123   [2]  00").frames.size() == 1);
}

TEST_CASE("a file of which too much is no frame is refused with what was expected and how to record") {
  const Recording r = read(good_lines(40) + "a\nb\nc\nd\ne\nf\n");
  CHECK_THAT(r.error,
             Contains("can.log:41: 'a'; expected (SECONDS) INTERFACE ID#DATA (6 of 46 lines are no frames") &&
                 Contains("record with: candump -L can0 > can.log"));
  CHECK_THAT(read(good_lines(1) + "what\n").error, Contains("can.log:2: 'what'"));
  CHECK_THAT(read("what").error, Contains("can.log:1: 'what'"));
  // A file of something else is known before its end.
  std::string other;
  for (int i = 0; i < 5000; ++i) other += "Nov 27 04:18:00 host kernel: message\n";
  CHECK_THAT(read(other).error, Contains("1000 of 1000 lines"));
  CHECK_THAT(read("  can0  421   [2]  10 00\n  can0  421   [2]  10 01\n").error,
             Contains("has no time stamp") && Contains("record with: candump -L"));
}

TEST_CASE("files of other programs are named, with the way to convert them") {
  const auto refused = [](const std::string& start) { return read(start + std::string(100, ' ')).error; };
  CHECK_THAT(refused("LOGG"), Contains("(.blf)") && Contains("can.logconvert"));
  CHECK_THAT(refused("MDF "), Contains("can.logconvert"));
  CHECK_THAT(refused(";$FILEVERSION=2.1"), Contains(".trc"));
  CHECK_THAT(refused("timestamp,arbitration_id,extended"), Contains("python-can's CSV"));
  CHECK_THAT(refused("\x1f\x8b"), Contains("gunzip"));
  CHECK_THAT(refused(std::string("\xff\xfe(\0", 4)), Contains("iconv"));
  CHECK_THAT(refused("\x0a\x0d\x0d\x0a"), Contains("pcapng") && Contains("candump -L"));
  CHECK_THAT(refused("time_s,interface,message,signal,value,unit\n"), Contains("decoded already"));
}

TEST_CASE("colours, dropped frames and errors in words of a screen are understood") {
  const Recording r = read(
      " \x1b[31m(1732672000.000123)  can0  421   [1]  10\x1b[0m\n"
      "DROPCOUNT: dropped 12 CAN frames on 'can0' socket (total drops 12)\n"
      " (1732672000.000323)  can0  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME\n"
      "\tcontroller-problem{rx-error-warning}\n"
      " (1732672000.000423)  can0  421   [1]  11\n");
  CHECK(r.frames.size() == 3);
  CHECK(r.remarks == "candump lost 12 frames itself (DROPCOUNT)\n");
}

TEST_CASE("time stamps of a screen count from the start, or are differences and summed") {
  std::string since_start, differences;
  std::vector<std::int64_t> expected;
  std::int64_t now_us = 0;
  for (int i = 0; i < 200; ++i) {
    const int step_us = i == 0 ? 0 : 100 + 37 * (i * 5 % 7);
    now_us += step_us;
    expected.push_back(now_us);
    char line[80];
    std::snprintf(line, sizeof line, " (%03d.%06d)  can0  123   [1]  00\n", 0, static_cast<int>(now_us));
    since_start += line;
    std::snprintf(line, sizeof line, " (%03d.%06d)  can0  123   [1]  00\n", 0, step_us);
    differences += line;
  }
  const Recording z = read(since_start), d = read(differences);
  CHECK(times_us(z) == expected);
  CHECK_THAT(z.remarks, Contains("candump -tz"));
  CHECK(times_us(d) == expected);
  CHECK_THAT(d.remarks, Contains("candump -td"));
  // At equal intervals.
  std::string equal = " (000.000000)  can0  123   [1]  00\n";
  for (int i = 0; i < 10; ++i) equal += " (000.001000)  can0  123   [1]  00\n";
  CHECK(read(equal).frames.back().time_ns == 10'000'000);
}

TEST_CASE("time that goes back is said, with the line") {
  const Recording r = read(
      "(10.000000) can0 123#00\n(10.500000) can0 123#00\n(8.250000) can1 123#00\n(8.250000) can0 123#00\n");
  CHECK(r.frames.size() == 4);
  CHECK(
      r.remarks ==
      "time goes back 1 time, by 2.25 s at most, first in line 3 (was the clock set, or are these two recordings?)\n");
  CHECK_THAT(read("(1.000300) can0 123#00\n(1.000100) can1 123#00\n").remarks, Contains("two interfaces"));
}

TEST_CASE("Vector's text format is read: ids, remote frames, errors, CAN FD and events between them") {
  const std::string header =
      "date Wed Nov 27 01:46:40.123 am 2024\nbase hex  timestamps absolute\ninternal events logged\n// version 9.0.0\n";
  const Recording r = read(
      header +
      "Begin Triggerblock Wed Nov 27 01:46:40.123 am 2024\n"
      "   0.000000 Start of measurement\n"
      "   0.012345 1  123             Rx   d 8 01 02 03 04 05 06 07 08  Length = 242000 BitCount = 124 ID = 291\n"
      "   0.012500 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%\n"
      "   0.013000 2  18FF1234x       Tx   d 2 aa BB\n"
      "   0.014000 1  123             Rx   r 4\n"
      "   0.014500 1  123             Rx   r\n"
      "   0.015000 1  ErrorFrame\n"
      "   0.016000 CANFD   1 Rx        123                                   1 0 9 12 37 73 0E DF AF BD 67 F9 61 96 99 CF   130000  130     3000 0 0 0 0 0\n"
      "   0.017000 CANFD   1 Rx        123  Name                             0 0 2  2 37 73   130000  130        0 0 0 0 0 0\n"
      "End TriggerBlock\n");
  REQUIRE(r.error.empty());
  REQUIRE(r.frames.size() == 7);
  CHECK(r.frames[0].time_ns == 12'345'000);
  CHECK(r.frames[0].interface == "1");
  CHECK(r.frames[0].frame == Frame{0x123, 8, false, false, {1, 2, 3, 4, 5, 6, 7, 8}});
  CHECK(r.frames[1].frame == Frame{0x18ff1234, 2, true, false, {0xaa, 0xbb}});
  CHECK(r.frames[2].frame == Frame{0x123, 4, false, true, {}});
  CHECK(r.frames[3].frame.remote);
  CHECK(r.frames[4].error);
  CHECK(r.frames[5].longer);
  CHECK_FALSE(r.frames[6].longer);
  CHECK(r.frames[6].frame == Frame{0x123, 2, false, false, {0x37, 0x73}});
  CHECK(r.remarks == "2 lines of other events\n");

  const Recording decimal = read(
      "date x\nbase dec timestamps relative\n 0,5 1 291 Rx d 2 17 255\n 0.25 1 Statistic: D 0\n 0.25 1 291 Rx d 0\n");
  REQUIRE(decimal.frames.size() == 2);
  CHECK(decimal.frames[0].frame == Frame{0x123, 2, false, false, {17, 255}});
  CHECK(decimal.frames[1].time_ns == 1'000'000'000);

  const Recording torn = read(header + " 0.1 1 123 Rx d 2 00 01\n 0.2 1 123 Rx d 8 00 01");
  CHECK(torn.frames.size() == 1);
  CHECK_THAT(torn.remarks, Contains("torn"));
}
