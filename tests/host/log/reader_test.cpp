// Logs that are read, and logs that are refused: each with file, line, column, value and what was expected.
#include "host/log/reader.hpp"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <random>

#include "host/log/time_order.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

const std::string kHeader = "time_s,height_m,contact,torque_cmd_nm\n";

log::Log hopper(const std::string& text) { return log::parse_log(text, "a.csv", "hopper"); }

// The message, which must be one line that begins with file and line.
std::string refused(const std::string& text, const std::string& rig = "hopper") {
  const std::string message = test::error_message([&] { log::parse_log(text, "a.csv", rig); });
  CHECK(message.find('\n') == std::string::npos);
  return message;
}

}  // namespace

TEST_CASE("a log gives its columns and metadata") {
  const log::Log log = hopper(
      "# format: furcula-log/1\n# machine_type: hopper\n# experiment: harmonic-T2.0: 03\n"
      "time_s,height_m,velocity_mps,contact,torque_cmd_nm\n"
      "0.000,0.28210,-1.5e-3,1,0\n0.001,0.2822,.5,0,-0.25\n");
  CHECK(log.rig == "hopper");
  CHECK(log.path == "a.csv");
  CHECK(log.metadata.at("experiment") == "harmonic-T2.0: 03");
  CHECK(log.rows() == 2);
  CHECK(log.time_s() == std::vector<double>{0.0, 0.001});
  CHECK(log.at("height_m") == std::vector<double>{0.2821, 0.2822});
  CHECK(log.at("velocity_mps") == std::vector<double>{-0.0015, 0.5});
  CHECK(log.at("contact") == std::vector<double>{1.0, 0.0});
  CHECK(log.at("torque_cmd_nm") == std::vector<double>{0.0, -0.25});
}

TEST_CASE("a quote in a comment is a character like any other, and the comment one line") {
  const log::Log log = hopper("# rail: 40\" long\n# machine_type: hopper\n" + kHeader + "0,0.3,1,0\n");
  CHECK(log.metadata.at("rail") == "40\" long");
  CHECK(log.rows() == 1);
}

TEST_CASE("columns come in any order, and unknown ones are kept") {
  const log::Log log = hopper("contact,knee_c,torque_cmd_nm,height_m,time_s\n1,41.5,0.1,0.3,7\n");
  CHECK(log.at("knee_c") == std::vector<double>{41.5});
  CHECK(log.at("height_m") == std::vector<double>{0.3});
  CHECK(log.time_s() == std::vector<double>{7.0});
}

TEST_CASE("an unknown column that is not numeric is left out and told of") {
  test::TemporaryFolder folder;
  const std::string path =
      folder.file("a.csv", "time_s,state,height_m\n0,idle,1\n1,\"fall, free\",2\n2,7,3\n");
  const log::Log log = log::read_log(path, "rail_carriage");
  CHECK_FALSE(log.has("state"));
  CHECK(log.at("height_m") == std::vector<double>{1.0, 2.0, 3.0});
  CHECK(log::check_log(path, "rail_carriage").ignored_columns == std::vector<std::string>{"state"});
}

TEST_CASE("RFC 4180: quotes, CRLF, a byte order mark, and no line end after the last row") {
  const log::Log log = hopper(
      "\xEF\xBB\xBF\"time_s\",\"height_m\",contact,torque_cmd_nm,\"a \"\"note\"\", long\"\r\n"
      "\"0\", 0.25 ,1,+0.5,\"two\r\nlines, \"\"quoted\"\"\"\r\n1,\"0.5\",0,-0.5,3");
  CHECK(log.rows() == 2);
  CHECK(log.at("height_m") == std::vector<double>{0.25, 0.5});
  CHECK(log.at("torque_cmd_nm") == std::vector<double>{0.5, -0.5});
  CHECK_FALSE(log.has("a \"note\", long"));
}

TEST_CASE("a line is counted where it stands in the file, line ends within quotes included") {
  CHECK_THAT(refused("time_s,height_m,contact,torque_cmd_nm,note\n0,1,1,0,\"a\nb\nc\"\n1,x,1,0,d\n"),
             Contains("a.csv:5: column 'height_m': 'x'"));
}

TEST_CASE("numbers at the ends of a double's range are read or refused, never changed in silence") {
  CHECK(hopper(kHeader + "0,4.9406564584124654e-324,0,1e-999\n").at("height_m").front() ==
        4.9406564584124654e-324);
  CHECK(hopper(kHeader + "0,1,0,1e-999\n").at("torque_cmd_nm").front() == 0.0);
  CHECK_THAT(refused(kHeader + "0,1e999,0,0\n"),
             Contains("a.csv:2: column 'height_m': '1e999' is not finite"));
}

TEST_CASE("a file with nothing in it is refused") {
  CHECK_THAT(refused(""), Contains("a.csv:1: the file is empty; expected a CSV log"));
  CHECK_THAT(refused("# machine_type: hopper\n\n"), Contains("a.csv:1: there is no header row; expected"));
  CHECK_THAT(refused(kHeader), Contains("a.csv:2: no rows after the header row; expected at least one"));
  CHECK_THAT(refused(kHeader + "\n\n"), Contains("no rows after the header row"));
}

TEST_CASE("a file of zeros is refused, be they bytes or numbers") {
  CHECK_THAT(refused(std::string(4096, '\0')),
             Contains("a.csv:1: a NUL byte; expected the text of a CSV log"));
  CHECK_THAT(refused(std::string(5 << 20, '\0')), Contains("a.csv:1: a line of NUL bytes; expected text"));
  CHECK_THAT(refused(kHeader + "0,1,0,0\n" + std::string(512, '\0')),
             Contains("a.csv:3: NUL bytes, '\\x00'; expected 4 fields"));
  CHECK_THAT(refused(kHeader + "0,0,0,0\n0,0,0,0\n"), Contains("a.csv:3: column 'time_s': 0 s after 0 s"));
}

TEST_CASE("a directory or a file that cannot be read is refused") {
  test::TemporaryFolder folder;
  const auto message = [](const std::string& path) {
    return test::error_message([&] { log::check_log(path, "hopper"); });
  };
  CHECK(message(folder.path()) ==
        folder.path() +
            ": is a directory without a bag; expected a log (CSV), or a directory with .mcap or .db3 "
            "files, as ros2 bag record writes");
  CHECK_THAT(message(folder.path() + "/none.csv"),
             Contains("/none.csv: cannot be read: No such file or directory"));
}

TEST_CASE("a missing required column is refused, and the nearest name shown") {
  CHECK_THAT(
      refused("time_s,contact,torque_cmd_nm\n0,1,0\n"),
      Contains(
          "a.csv:1: no column 'height_m', which a log of machine type hopper must have; the file has time_s, contact"));
  CHECK_THAT(refused("time_s,hieght_m,contact,torque_cmd_nm\n0,1,1,0\n"),
             Contains("did you mean 'hieght_m'?"));
  CHECK_THAT(refused("time_s|height_m|contact\n0|1|1\n"),
             Contains("the file has time_s, height_m, contact") &&
                 Contains("torque_cmd_nm = { column = \"theirs\" }"));
}

TEST_CASE("each rig asks for the columns of its table in the contract") {
  CHECK_THAT(refused("time_s,position_m\n0,1\n", "motor_axis"), Contains("no column 'force_n'"));
  CHECK_THAT(refused("time_s,angle_rad\n0,1\n", "rotary_joint"), Contains("no column 'torque_nm'"));
  CHECK_THAT(refused("time_s,pulley_angle_rad\n0,1\n", "clutch_bench"), Contains("no column 'solenoid'"));
  CHECK_THAT(refused("time_s\n0\n", "rail_carriage"), Contains("no column 'height_m'"));
}

TEST_CASE("a unit suffix that is not the expected one is refused, of optional columns too") {
  CHECK_THAT(refused("time_s,height_mm,contact,torque_cmd_nm\n0,1,1,0\n"),
             Contains("a.csv:1: column 'height_mm' has the unit 'mm'; expected 'height_m'"));
  CHECK_THAT(refused("time_ms,height_m,contact,torque_cmd_nm\n0,1,1,0\n"),
             Contains("'time_ms' has the unit 'ms'; expected 'time_s'"));
  CHECK_THAT(refused("time_s,height_m,leg_angle_deg,contact,torque_cmd_nm\n0,1,1,1,0\n"),
             Contains("'leg_angle_deg' has the unit 'deg'; expected 'leg_angle_rad'"));
  // Not a torque in another unit, and a second reading beside the right one.
  CHECK_NOTHROW(hopper("time_s,height_m,contact,torque_cmd_nm,torque_enable,height_mm\n0,1,1,0,1,1000\n"));
}

TEST_CASE("a column that is asked for and stands twice is refused, any other is kept once") {
  CHECK_THAT(
      refused("time_s,height_m,contact,height_m,torque_cmd_nm\n0,1,1,1,0\n"),
      Contains(
          "a.csv:1: column 'height_m' stands twice; expected each column once (give one of them another name)"));
  const log::Log log = hopper("time_s,x,height_m,x,contact,x,torque_cmd_nm\n0,7,1,8,1,9,0\n");
  CHECK(log.at("x") == std::vector<double>{7.0});
  REQUIRE(log.notes.size() == 1);
  CHECK_THAT(log.notes[0], Contains("'x' stands more than once"));
}

TEST_CASE("a ragged row is refused") {
  CHECK_THAT(refused(kHeader + "0,1,0,0\n1,1,0\n2,1,0,0\n"),
             Contains("a.csv:3: the row has 3 fields, '1,1,0'; expected 4 fields as in the header row"));
  CHECK_THAT(refused(kHeader + "0,1,0,0,0\n"), Contains("a.csv:2: the row has 5 fields"));
}

TEST_CASE("blank lines and comments among the rows are left out, comments with a note") {
  const log::Log log = hopper(kHeader + "\n0,1,0,0\n\n1,1,0,0\n# two frames lost\n \n2,1,0,0\n");
  CHECK(log.time_s() == std::vector<double>{0.0, 1.0, 2.0});
  CHECK(log.refused.empty());
  REQUIRE(log.notes.size() == 1);
  CHECK_THAT(log.notes[0], Contains("1 comment line among the rows, from line 6 on"));
}

TEST_CASE("a row that the file's end cuts is called torn") {
  CHECK_THAT(refused(kHeader + "0,1,0,0\n1,1"),
             Contains("a.csv:3: the file ends in the middle of a row: the last row is torn, it has 2 fields, "
                      "'1,1'; expected 4"));
  CHECK_THAT(refused(kHeader + "0,1,0,0\n1,1,0,"),
             Contains("a.csv:3: column 'torque_cmd_nm': '' is where the file ends: the last row is torn"));
  CHECK_THAT(refused(kHeader + "0,1,0,0\n1,1,0,-"),
             Contains("'-' is where the file ends: the last row is torn"));
  CHECK_THAT(refused("time_s,note,height_m\n0,a,\"1\n", "rail_carriage"),
             Contains("a.csv:2: a quote is not closed"));
}

TEST_CASE("a field that is no finite number is refused") {
  CHECK_THAT(
      refused(kHeader + "0,high,0,0\n"),
      Contains("a.csv:2: column 'height_m': 'high' is not a number; expected a finite decimal number"));
  CHECK_THAT(refused(kHeader + "0,,0,0\n"), Contains("a.csv:2: column 'height_m': no value ('')"));
  CHECK_THAT(refused(kHeader + "0,\"0,25\",0,0\n"),
             Contains("'0,25' is not a number; expected a finite decimal number with '.'"));
  for (const std::string bad : {"nan", "NaN", "-nan", "inf", "-Inf", "infinity"})
    CHECK_THAT(refused(kHeader + "0," + bad + ",0,0\n"),
               Contains("a.csv:2: column 'height_m': '" + bad + "' is not finite"));
  for (const std::string bad : {"0x1p3", "1 2", "1e", "--1", "+-1", "1.2.3", "\xC2\xB2"})
    CHECK_THAT(refused(kHeader + "0," + bad + ",0,0\n"), Contains("is not a number"));
}

TEST_CASE("a contact that is not 0 or 1 is refused") {
  CHECK_THAT(refused(kHeader + "0,1,0.5,0\n"), Contains("a.csv:2: column 'contact': 0.5; expected 0 or 1"));
  CHECK_THAT(refused("time_s,height_m,contact,torque_cmd_nm,solenoid\n0,1,1,0,2\n"),
             Contains("column 'solenoid': 2; expected 0 or 1"));
}

TEST_CASE("time that stands still or runs backwards is refused") {
  CHECK_THAT(
      refused(kHeader + "0,1,0,0\n0.5,1,0,0\n0.25,1,0,0\n"),
      Contains("a.csv:4: column 'time_s': 0.25 s after 0.5 s in the row before; expected time to increase"));
  CHECK_THAT(refused(kHeader + "0.5,1,0,0\n0.5,1,0,0\n"), Contains("a.csv:3: column 'time_s'"));
}

TEST_CASE("metadata that contradicts the reader is refused") {
  CHECK_THAT(refused("# format: furcula-log/2\n" + kHeader + "0,1,0,0\n"),
             Contains("a.csv:1: format is 'furcula-log/2'; expected furcula-log/1"));
  CHECK_THAT(refused("# x\n# machine_type: motor_axis\n" + kHeader + "0,1,0,0\n"),
             Contains("a.csv:2: machine_type is 'motor_axis'; expected hopper"));
  // Its name in earlier logs.
  CHECK_THAT(refused("# x\n# rig: motor_axis\n" + kHeader + "0,1,0,0\n"),
             Contains("a.csv:2: machine_type is 'motor_axis'; expected hopper"));
}

TEST_CASE("a header that is not UTF-8 is read as Latin-1 where it names the columns, else refused") {
  const log::Log log = hopper(
      "time_s,height_m,contact,torque_cmd_nm,gr\xF6\xDF"
      "e\n0,1,0,0,1\n");
  CHECK(log.at("gr\xC3\xB6\xC3\x9F"
               "e") == std::vector<double>{1.0});
  CHECK_THAT(log.notes.at(0), Contains("read as Latin-1"));
  CHECK_THAT(refused("\x89QNG\r\n\x1a\n"), Contains("a.csv:1: byte 1 of the line, '\\x89', is not UTF-8"));
}

TEST_CASE("a line longer than 1 MiB is refused, a quote that is never closed too") {
  CHECK_THAT(refused(kHeader + "0,1,0," + std::string(2 << 20, '1') + "\n"),
             Contains("a.csv:2: the line is longer than 1 MiB"));
  CHECK_THAT(refused(kHeader + "0,1,0,\"" + std::string(2 << 20, '\n')),
             Contains("a.csv:2: a quote is not closed"));
}

TEST_CASE("a check counts rows and measures the sample intervals") {
  test::TemporaryFolder folder;
  // 1 ms, 1 ms, 2 ms, 5 ms: the lower median is 1 ms.
  const std::string path =
      folder.file("a.csv", kHeader + "2,1,0,0\n2.001,1,0,0\n2.002,1,0,0\n2.004,1,0,0\n2.009,1,0,0\n");
  const log::LogSummary s = log::check_log(path, "hopper");
  CHECK(s.rows == 5);
  CHECK(s.duration_s == Approx(0.009));
  CHECK(s.interval_min_s == Approx(0.001));
  CHECK(s.interval_median_s == Approx(0.001).epsilon(1e-3));
  CHECK(s.interval_max_s == Approx(0.005));
  CHECK(s.last_row_ends);
  CHECK_FALSE(log::check_log(folder.file("b.csv", kHeader + "2,1,0,0"), "hopper").last_row_ends);
}

TEST_CASE("a log larger than any buffer reads back as it was drawn") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> height(0.2, 0.4);
  std::vector<double> heights;
  std::string text = kHeader;
  for (int i = 0; i < 40000; ++i) {
    heights.push_back(height(random));
    char row[100];
    std::snprintf(row, sizeof row, "%.3f,%.17g,%d,%.17g\n", 0.001 * i, heights.back(), i % 2,
                  -heights.back());
    text += row;
  }
  const log::Log log = hopper(text);
  CHECK(log.at("height_m") == heights);
  CHECK(log.time_s()[39999] == 39.999);
}

TEST_CASE("checking a log takes memory that does not grow with it") {
  test::TemporaryFolder folder;
  std::string block;
  const std::string path = folder.path() + "/long.csv";
  {
    std::ofstream out(path);
    out << kHeader;
    for (int i = 0; i < 2'000'000; ++i) {
      block += std::to_string(i) + ",0.28210,1,0.000\n";
      if (block.size() > 100000) {
        out << block;
        block.clear();
      }
    }
    out << block;
  }
  const auto peak_kib = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before = peak_kib();
  CHECK(log::check_log(path, "hopper").rows == 2'000'000);
  // The file has 48 MB, and its columns would take 64 MB.
  CHECK(peak_kib() - before < 8 * 1024);
}

namespace {

/// Rows a millisecond apart; `row` i stands in line i + 2.
std::string rows_of(int count, const std::string& rest = ",0.3,0,1") {
  std::string text;
  for (int i = 0; i < count; ++i) text += std::to_string(0.001 * i) + rest + "\n";
  return text;
}

void replace_line(std::string& text, int line, const std::string& row) {
  std::size_t at = 0;
  for (int i = 1; i < line; ++i) at = text.find('\n', at) + 1;
  text.replace(at, text.find('\n', at) - at, row);
}

}  // namespace

TEST_CASE("odd rows are left out, each with line, column and reason, up to a twentieth") {
  std::string text = kHeader + rows_of(200);
  replace_line(text, 12, "0.010000,,0,1");
  replace_line(text, 40, "0.038000,0.3,0");
  replace_line(text, 60, "0.057000,0.3,0,1");  // the time of the row before
  replace_line(text, 80, "0.078000,nan,0,1");
  replace_line(text, 100, "0.098000,0.3,2,1");
  replace_line(text, 110, "WARNING: overrun");
  const log::Log log = hopper(text);
  CHECK(log.rows() == 194);
  REQUIRE(log.refused.size() == 6);
  CHECK(log.refused[0].line == 12);
  CHECK(log.refused[0].row == 11);
  CHECK(log.refused[0].column == "height_m");
  CHECK_THAT(log.refused[1].why, Contains("expected 4 fields"));
  CHECK(log.refused[2].line == 60);
  CHECK(log.refused[2].column == "time_s");
  CHECK(log.refused[4].column == "contact");
  CHECK(log.refused[5].line == 110);
  CHECK(log.lines[10] == 13);

  for (int line = 120; line < 130; ++line) replace_line(text, line, "x,0.3,0,1");
  CHECK_THAT(refused(text), Contains("a.csv:12: column 'height_m': no value ('')") &&
                                Contains("16 of 200 rows are bad, and at most a twentieth is left out"));
}

TEST_CASE("a torn last row, zeros at the end and a line of a megabyte cost no more than themselves") {
  const std::string text = kHeader + rows_of(100);
  for (const std::string& tail : {std::string("0.1,0.3"), std::string(700, '\0'), std::string(2 << 20, '1'),
                                  std::string("0.1,\"0.3")}) {
    const log::Log log = hopper(text + tail);
    CHECK(log.rows() == 100);
    REQUIRE(log.refused.size() == 1);
    CHECK(log.refused[0].line == 102);
  }
}

TEST_CASE("a quote that is closed rows later costs its own row, not those between") {
  std::string text = kHeader + rows_of(100);
  replace_line(text, 20, "0.018000,\"0.3,0,1");
  replace_line(text, 50, "0.048000,0.\"3,0,1");
  const log::Log log = hopper(text);
  CHECK(log.rows() == 98);
  REQUIRE(log.refused.size() == 2);
  CHECK(log.refused[0].line == 20);
  CHECK(log.refused[1].line == 50);
}

TEST_CASE(
    "an optional column with many holes is left out in place of its rows, one with few costs those rows") {
  std::string text = "time_s,height_m,contact,torque_cmd_nm,motor_temp_c\n" + rows_of(100, ",0.3,0,1,25");
  replace_line(text, 30, "0.028000,0.3,0,1,");
  log::Log log = hopper(text);
  CHECK(log.rows() == 99);
  CHECK(log.refused.at(0).line == 30);
  CHECK(log.at("motor_temp_c") == std::vector<double>(99, 25.0));

  for (int line = 2; line < 102; ++line)
    if (line % 10 != 0) replace_line(text, line, std::to_string(0.001 * (line - 2)) + ",0.3,0,1,");
  log = hopper(text);
  CHECK(log.rows() == 100);
  CHECK(log.refused.empty());
  CHECK_FALSE(log.has("motor_temp_c"));
  CHECK_THAT(log.notes.at(0),
             Contains("column 'motor_temp_c' was not used: no finite number in 91 of 100 rows"));
}

TEST_CASE("time that goes back by a counter's span is said to wrap, and goes on") {
  std::string text = kHeader;
  for (int i = 0; i < 100; ++i) {
    const double time_s = std::fmod(65.5 + 0.001 * i, 65.536);
    text += std::to_string(time_s) + ",0.3,0,1\n";
  }
  const log::Log log = hopper(text);
  REQUIRE(log.rows() == 100);
  CHECK(log.time_s().back() == Approx(65.599));
  REQUIRE(log.notes.size() == 1);
  CHECK_THAT(log.notes[0], Contains("a.csv line 38: time goes back by 65.535 s"));
}

TEST_CASE("a clock that is set costs an interval, whichever way it is set") {
  // Back by 0.2 s, back by 3.3 ms (which is no multiple of the interval), and from a start's seconds to those of an epoch.
  for (const double step_s : {-0.2, -0.0033, 1.7e9}) {
    std::string text = kHeader;
    for (int i = 0; i < 400; ++i) {
      char row[60];
      std::snprintf(row, sizeof row, "%.6f,%d,0,1\n", 5.0 + 0.001 * i + (i < 200 ? 0.0 : step_s), i);
      text += row;
    }
    const log::Log log = hopper(text);
    REQUIRE(log.rows() == 400);
    CHECK(log.refused.empty());
    REQUIRE(log.notes.size() == 1);
    CHECK_THAT(log.notes[0],
               Contains("a.csv line 202: time steps " + std::string(step_s < 0.0 ? "back" : "forward")));
    for (std::size_t i = 1; i < 400; ++i)
      CHECK(log.time_s()[i] - log.time_s()[i - 1] ==
            Approx(i == 200 ? log::kUnknownInterval_s : 0.001).epsilon(1e-6));
  }
}

TEST_CASE("a controller that has run for a quarter of a year goes on over 2^53 ns") {
  std::string text = kHeader;
  for (int i = 0; i < 100; ++i) text += std::to_string(9007199.2 + 0.001 * i) + ",0.3,0,1\n";
  const log::Log log = hopper(text);
  CHECK(log.rows() == 100);
  CHECK(log.notes.empty());
  CHECK(log.time_s().back() == Approx(9007199.299).epsilon(1e-15));
}

TEST_CASE("one wrong stamp costs its row") {
  // Far ahead, far behind, and twice.
  for (const char* stamp : {"99999.0", "0.0001", "0.049"}) {
    std::string text = kHeader + rows_of(100);
    replace_line(text, 52, std::string(stamp) + ",0.3,0,1");
    const log::Log log = hopper(text);
    CHECK(log.rows() == 99);
    CHECK(log.refused.at(0).line == 52);
    CHECK(log.refused.at(0).column == "time_s");
    CHECK(log.notes.empty());
  }
}

TEST_CASE("a time that is written with too few digits is refused with what to do") {
  std::string text = kHeader;
  for (int i = 0; i < 300; ++i) {
    char row[60];
    std::snprintf(row, sizeof row, "%.2f,0.3,0,1\n", 0.001 * i);
    text += row;
  }
  CHECK_THAT(refused(text), Contains("a.csv:3: column 'time_s': 0 s after 0 s") &&
                                Contains("269 of 300 rows are bad") && Contains("write more digits") &&
                                Contains("given to all rows of a buffer"));
}

TEST_CASE("epoch seconds keep their nanoseconds") {
  // 1.7e9 s and 1 ns need 61 bits, a double has 53.
  const auto check = [](const std::string& text, const std::string& map_text) {
    const log::ColumnMap map = log::parse_column_map(map_text, "map.toml");
    const log::Log log = log::parse_log(text, "a.csv", "rail_carriage", &map);
    REQUIRE(log.rows() == 4);
    CHECK(log.time_s()[0] == 0.0);
    CHECK(log.time_s()[1] == Approx(1e-9).epsilon(1e-6));
    CHECK(log.time_s()[2] == Approx(0.001000003).epsilon(1e-10));
    CHECK(log.time_s()[3] == Approx(0.876543212).epsilon(1e-12));
    REQUIRE(log.notes.size() == 1);
    CHECK_THAT(log.notes[0], Contains("time_s counts from the first row"));
  };
  check(
      "t,height_m\n1732672000.123456789,1\n1732672000.123456790,1\n1732672000.124456792,1\n1732672001.000000001,1\n",
      "time_s = { column = \"t\" }\n");
  check(
      "t,height_m\n1732672000123456789,1\n1732672000123456790,1\n1732672000124456792,1\n1732672001000000001,1\n",
      "time_s = { column = \"t\", scale = 1e-9 }\n");
  check(
      "t,height_m\n1732672000123456.789,1\n1732672000123456.790,1\n1732672000124456.792,1\n1732672001000000.001,1\n",
      "time_s = { column = \"t\", scale = 1e-6 }\n");
  check(
      "s,ns,height_m\n1732672000,123456789,1\n1732672000,123456790,1\n\"1732672000\", 124456792,1\n1732672001,1,1\n",
      "time_s = { columns = [\"s\", \"ns\"], scales = [1, 1e-9] }\n");
}

namespace {

const std::string kRail = "time_s,height_m\n0,1\n0.001,2\n0.002,3\n";

log::Log rail(const std::string& text) { return log::parse_log(text, "a.csv", "rail_carriage"); }

std::string utf16(const std::string& text, bool little) {
  std::string out;
  for (const char c : text) {
    if (!little) out += '\0';
    out += c;
    if (little) out += '\0';
  }
  return out;
}

void check_rail(const log::Log& log) {
  CHECK(log.time_s() == std::vector<double>{0.0, 0.001, 0.002});
  CHECK(log.at("height_m") == std::vector<double>{1.0, 2.0, 3.0});
  CHECK(log.refused.empty());
}

std::string with_ends(const std::string& end) {
  std::string out;
  for (const char c : kRail) out += c == '\n' ? end : std::string(1, c);
  return out;
}

std::string with_separator(const std::string& separator) {
  std::string out;
  for (const char c : kRail) out += c == ',' ? separator : std::string(1, c);
  return out;
}

}  // namespace

TEST_CASE("UTF-16 is read, with and without its mark") {
  check_rail(rail("\xFF\xFE" + utf16(kRail, true)));
  check_rail(rail("\xFE\xFF" + utf16(kRail, false)));
  check_rail(rail(utf16(kRail, true)));
  check_rail(rail(utf16(kRail, false)));
  // U+00E9 and, in two units, U+1F98E.
  const log::Log log = rail(std::string("\xFF\xFE") + utf16("time_s,height_m,", true) + "\xE9" +
                            std::string(1, '\0') + "\x3E\xD8\x8E\xDD" + utf16("\n0,1,2\n", true));
  CHECK(log.has("\xC3\xA9\xF0\x9F\xA6\x8E"));
}

TEST_CASE("lines end in LF, CRLF, CR, LF CR or CR CR LF") {
  for (const std::string end : {"\n", "\r\n", "\r", "\n\r", "\r\r\n"}) check_rail(rail(with_ends(end)));
}

TEST_CASE("what separates the columns is seen in the header row, or said by a first line sep=") {
  for (const std::string separator : {";", "|", "\t", " ", "   ", " \t "})
    check_rail(rail(with_separator(separator)));
  check_rail(rail("sep=:\n" + with_separator(":")));
  check_rail(rail("\"sep=;\"\r\n# machine_type: rail_carriage\n" + with_separator(";")));
  const log::ColumnMap map = log::parse_column_map("separator = \"\\t\"\n", "map.toml");
  const log::Log log = log::parse_log("sep=;\n" + with_separator("\t"), "a.csv", "rail_carriage", &map);
  check_rail(log);
  CHECK_THAT(log.notes.at(0),
             Contains("';' separates the columns, map.toml says a tab: the map was followed"));
}

TEST_CASE("decimal commas are refused with the two lines of a map that read them") {
  const std::string text = "time_s;height_m\n0,000;1,5\n0,001;2,5\n";
  CHECK_THAT(refused(text, "rail_carriage"),
             Contains("a.csv:1: the numbers below this header row have a decimal comma, '1,5'") &&
                 Contains("the two lines separator = \";\" and decimal = \",\""));
  const log::ColumnMap map = log::parse_column_map("decimal = \",\"\n", "map.toml");
  CHECK(log::parse_log(text, "a.csv", "rail_carriage", &map).at("height_m") == std::vector<double>{1.5, 2.5});
  // As pandas writes them: commas between the columns, and numbers in quotes.
  CHECK(log::parse_log("time_s,height_m\n0,\"1,5\"\n\"0,001\",\"2,5\"\n", "a.csv", "rail_carriage", &map)
            .at("height_m") == std::vector<double>{1.5, 2.5});
}

TEST_CASE("a header row in a comment is taken, with a note") {
  for (const std::string head : {"# time_s,height_m\n", "# machine_type: rail_carriage\n#time_s, height_m\n",
                                 "# time_s,height_m\n# s,m\n"}) {
    const log::Log log = rail(head + "0,1\n0.001,2\n0.002,3\n");
    check_rail(log);
    CHECK_THAT(log.notes.at(0), Contains("was taken as the header row"));
  }
  check_rail(rail("# time_s height_m\n0 1\n0.001 2\n0.002 3\n"));
}

TEST_CASE("rows without a header row are refused with what is expected above them") {
  CHECK_THAT(refused("0,1\n0.001,2\n", "rail_carriage"),
             Contains("a.csv:1: there is no header row: the first row holds numbers, '0,1'") &&
                 Contains("as in 'time_s,height_m'"));
  CHECK_THAT(refused("# made today\n0,1\n", "rail_carriage"),
             Contains("the last comment above, '# made today', has 1 field"));
}

TEST_CASE("columns without a name and separators at the ends of rows are ignored with one note") {
  for (const std::string text :
       {",time_s,,height_m,\n0,0,7,1,\n1,0.001,7,2,\n2,0.002,7,3,\n",
        "time_s,height_m\n0,1,\n0.001,2,\n0.002,3,\n", "time_s,height_m,\n0,1\n0.001,2\n0.002,3\n",
        "time_s,height_m\n1,0,1\n2,0.001,2\n3,0.002,3\n"}) {
    INFO(text);
    const log::Log log = rail(text);
    check_rail(log);
    CHECK(log.columns.size() == 2);
    CHECK(log.notes.size() == 1);
  }
}

TEST_CASE("a row of units below the header row is left out, and one that says another unit refused") {
  const log::Log log = rail("time_s,height_m\n[s],[m]\n0,1\n0.001,2\n0.002,3\n");
  check_rail(log);
  CHECK_THAT(log.notes.at(0), Contains("line 2, '[s],[m]', holds units and was left out"));
  CHECK_THAT(refused("time_s,height_m\ns,mm\n0,1\n", "rail_carriage"),
             Contains("says 'mm' of column 'height_m'; expected 'm'") &&
                 Contains("height_m = { column = \"height_m\", scale = 1e-3 }"));
}

TEST_CASE("a number in quotes may have blanks about it") {
  check_rail(rail("\"time_s\" , \" height_m \"\n\" 0\",\"1 \"\n 0.001,\" 2 \"\n0.002 ,3\n"));
}

TEST_CASE("rows with other numbers of fields than the header row are refused with what that may be") {
  std::string text = "time_s,height_m\n";
  for (int i = 0; i < 30; ++i) text += "0," + std::to_string(1000 + i) + ",1,5\n";
  CHECK_THAT(refused(text, "rail_carriage"),
             Contains("most rows have 4 fields, the header row 2") && Contains("decimals behind commas"));
}

TEST_CASE("a header row in a comment of MATLAB or of C++ is taken, and so are comments among the rows") {
  for (const std::string head : {"% time_s, height_m\n", "%% made by a script\n% time_s,height_m\n% s,m\n",
                                 "// test 12\n// time_s,height_m\n"}) {
    INFO(head);
    const log::Log log = rail(head + "0,1\n% pause\n0.001,2\n// end\n0.002,3\n");
    check_rail(log);
    CHECK_THAT(log.notes.at(0), Contains("was taken as the header row"));
    CHECK_THAT(log.notes.at(1), Contains("2 comment lines among the rows"));
  }
  check_rail(rail("% time_s height_m\n0 1\n0.001 2\n0.002 3\n"));
  // Other signs before the first name, in quotes, or alone between blanks.
  for (const std::string text :
       {"! time_s height_m\n0 1\n0.001 2\n0.002 3\n", "; time_s, height_m\n0,1\n0.001,2\n0.002,3\n",
        "\"# time_s\",\"height_m\"\n0,1\n0.001,2\n0.002,3\n"}) {
    INFO(text);
    const log::Log log = rail(text);
    check_rail(log);
    CHECK_THAT(log.notes.at(0), Contains("which was read as 'time_s'"));
  }
}

TEST_CASE("a column whose name begins as a comment is a column where the map names it") {
  const log::ColumnMap map = log::parse_column_map("height_m = { column = \"%h\" }\n", "map.toml");
  const log::Log log = log::parse_log("%h,time_s\n1,0\n2,0.001\n3,0.002\n", "a.csv", "rail_carriage", &map);
  check_rail(log);
  CHECK(log.notes.empty());
}

TEST_CASE(
    "title lines above the header row are left out with a note, and what they say of the machine_type is heeded") {
  for (const std::string titles :
       {"Logger v2.1\n", "Test: fall 3\nOperator: me\n\n", "rst:0x1 (POWERON),boot:0x13\nentry 0x400805e4\n",
        "Rail: 40\" long\nDate: today\n", "Test,\nfall,3\n,\n", "[Header]\nrate=1000\n", "\x80\xff boot\n"}) {
    INFO(titles);
    const log::Log log = rail(titles + kRail);
    check_rail(log);
    CHECK_THAT(log.notes.at(0), Contains("above the header row") && Contains("left out"));
    CHECK(log.lines.at(0) == static_cast<std::size_t>(std::count(titles.begin(), titles.end(), '\n')) + 2);
  }
  check_rail(rail("Logger\n# time_s,height_m\n0,1\n0.001,2\n0.002,3\n"));
  check_rail(rail(std::string(2, '\0') + " boot\n" + kRail));
  const std::string with_rig = "Logger\n# machine_type: hopper\n" + kRail;
  CHECK_THAT(refused(with_rig, "rail_carriage"),
             Contains("a.csv:2: machine_type is 'hopper'; expected rail_carriage"));
  test::TemporaryFolder folder;
  CHECK(log::rig_line(folder.file("a.csv", with_rig)) == "hopper");
}

TEST_CASE(
    "names above the rows of numbers are the header row, also below titles and without one that is asked for") {
  CHECK_THAT(refused("Logger\nTest 3\nt,h\n0,1\n0.001,2\n", "rail_carriage"),
             Contains("a.csv:3: no column 'time_s'") && Contains("the file has t, h (a --map file"));
  CHECK_THAT(
      refused("Logger\nTest 3\n0,1\n0.001,2\n", "rail_carriage"),
      Contains("a.csv:3: there is no header row: the first row holds numbers, '0,1', below 'Logger'") &&
          Contains("as in 'time_s,height_m'"));
  // As ros2 topic echo --csv prints them.
  CHECK_THAT(refused("17,0,,joint1,0.4\n17,2000000,,joint1,0.4\n", "rail_carriage"),
             Contains("a.csv:1: there is no header row") && Contains("the 5 columns"));
}

TEST_CASE(
    "rows of other signals in a merged table are left out with a note if they are many, and named if few") {
  std::string text = "time_s,height_m,imu/x\n";
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(0.001 * i) + "," + std::to_string(i) + ",\n";
    text += std::to_string(0.001 * i + 0.0004) + (i % 2 == 0 ? ",,9.8\n" : ",NaN,9.8\n");
  }
  log::Log log = rail(text);
  CHECK(log.rows() == 100);
  CHECK(log.at("height_m")[99] == 99.0);
  CHECK(log.refused.empty());
  CHECK_THAT(log.notes.at(0), Contains("100 of 200 rows, from line 3 on, have values of other columns only"));

  // A robot's columns are optional to the reader.
  text = "time_s,angle_knee_rad,torque_knee_nm,imu/x\n";
  for (int i = 0; i < 100; ++i)
    text += std::to_string(0.001 * i) + ",1,2,\n" + std::to_string(0.001 * i + 0.0004) + ",,,9.8\n";
  log = log::parse_log(text, "a.csv", "tree");
  CHECK(log.rows() == 100);
  CHECK(log.has("angle_knee_rad"));

  text = "time_s,height_m,imu/x\n" + rows_of(100, ",0.3,1");
  replace_line(text, 12, "0.010000,,1");
  log = rail(text);
  CHECK(log.rows() == 99);
  REQUIRE(log.refused.size() == 1);
  CHECK(log.refused[0].line == 12);
  CHECK(log.refused[0].column == "height_m");

  CHECK_THAT(refused("time_s,height_m,imu\n0,,1\n1,,1\n", "rail_carriage"),
             Contains("a.csv:2: column 'height_m': no value") &&
                 Contains("all 2 rows hold values of other columns only"));
}

TEST_CASE("signals that are logged at different times are refused with the command that interpolates them") {
  std::string text = "time_s;angle_rad;torque_nm\n";
  for (int i = 0; i < 40; ++i)
    text += std::to_string(0.002 * i) + ";1;\n" + std::to_string(0.002 * i + 0.001) + ";;2\n";
  CHECK_THAT(
      refused(text, "rotary_joint"),
      Contains("a.csv:2: column 'torque_nm': no value ('')") && Contains("80 of 80 rows are bad") &&
          Contains(
              "python3 -c 'import pandas as pd; d = pd.read_csv(\"a.csv\", index_col=\"time_s\", sep=\";\")") &&
          Contains("d.interpolate(\"index\")[d[\"angle_rad\"].notna()].to_csv(\"a_even.csv\")"));
}

TEST_CASE("separators of thousands are called that") {
  const std::string text = "time_s;height_m\n1,200,000;1\n1,201,000;2\n1,202,000;3\n";
  const std::string message = refused(text, "rail_carriage");
  CHECK_THAT(message, Contains("'1,200,000' is not a number") && Contains("without separators of thousands"));
  CHECK_THAT(message, !Contains("a time that repeats"));
}
