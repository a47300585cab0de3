// `furcula check` at the program's edge: what it prints, and each kind of bad input.
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;
using Catch::Contains;
using Catch::StartsWith;
using test::run_furcula;

namespace {

const std::string kHeader = "time_s,height_m,contact,torque_cmd_nm\n";

struct BadLog {
  std::string what, content, place, value, expected;
};

// Exactly one line, from the program.
void check_one_message(const test::Ran& ran) {
  CHECK_THAT(ran.err, StartsWith("furcula: "));
  CHECK(ran.err.find('\n') == ran.err.size() - 1);
}

}  // namespace

TEST_CASE("a good log is told of in figures") {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.csv", kHeader + "0,1,0,0\n0.001,1,0,0\n0.003,1,1,0\n");
  const test::Ran ran = run_furcula({"check", "--machine", "hopper", path});
  CHECK(ran.status == 0);
  CHECK(ran.out == path + ": 3 rows, 0.003 s, interval min 1, median 1, mean 1.5, max 2 ms\n");
  CHECK(ran.err.empty());
}

TEST_CASE("the model's kind tells the machine type, and a map reads a foreign log") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("m.toml", test::kJointModel);
  const std::string map =
      folder.file("map.toml",
                  "machine_type = \"rotary_joint\"\ntime_s = { column = \"t\" }\nangle_rad = { "
                  "column = \"q\" }\ntorque_nm = { column = \"tau\" }\n");
  const std::string log = folder.file("a.csv", "t,q,tau\n0,1,0\n1,1,0\n");
  CHECK(run_furcula({"check", "--model", model, "--map", map, log}).status == 0);
  const test::Ran ran = run_furcula({"check", "--model", model, log});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("a.csv:1: no column 'time_s'"));
}

TEST_CASE("without --machine and --model the map tells the machine type, or each log's own line") {
  test::TemporaryFolder folder;
  const std::string joint =
      folder.file("joint.csv", "# machine_type: rotary_joint\ntime_s,angle_rad,torque_nm\n0,1,0\n");
  const std::string hopper =
      folder.file("hopper.csv", "# made: by hand\n# machine_type: hopper\n" + kHeader + "0,1,0,0\n");
  const test::Ran ran = run_furcula({"check", joint, hopper});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, StartsWith(joint + ": 1 rows") && Contains(hopper + ": 1 rows"));

  const std::string map =
      folder.file("map.toml",
                  "machine_type = \"rotary_joint\"\ntime_s = { column = \"t\" }\nangle_rad = { "
                  "column = \"q\" }\ntorque_nm = { column = \"tau\" }\n");
  CHECK(run_furcula({"check", "--map", map, folder.file("foreign.csv", "t,q,tau\n0,1,0\n")}).status == 0);

  // One that does not tell it is no reason to leave the others.
  const std::string silent = folder.file("silent.csv", kHeader + "0,1,0,0\n");
  const test::Ran mixed = run_furcula({"check", silent, hopper});
  CHECK(mixed.status == 3);
  check_one_message(mixed);
  CHECK_THAT(
      mixed.err,
      Contains(silent +
               ":1: no line '# machine_type: ...' tells the machine type; expected one, or --machine"));
  CHECK_THAT(mixed.out, StartsWith(hopper + ": 1 rows"));

  const std::string odd = folder.file("odd.csv", "# machine_type: hoper\n" + kHeader + "0,1,0,0\n");
  CHECK_THAT(run_furcula({"check", odd}).err,
             Contains(odd + ":1: machine_type is 'hoper'; expected one of hopper") &&
                 Contains("did you mean 'hopper'?"));
}

TEST_CASE("bad logs end with status 3 and one message: file, line, value, what was expected") {
  const std::vector<BadLog> cases{
      {"a torn row", kHeader + "0,1,0,0\n0.001,1", ":3:", "'0.001,1'", "expected 4 fields"},
      {"a ragged row", kHeader + "0,1,0\n1,1,0,0\n", ":2:", "'0,1,0'", "expected 4 fields"},
      {"a missing column", "time_s,height_m,contact\n0,1,0\n", ":1:", "'torque_cmd_nm'", "must have"},
      {"time running backwards", kHeader + "0,1,0,0\n2,1,0,0\n1,1,0,0\n", ":4:", "1 s after 2 s",
       "expected time to increase"},
      {"a NaN", kHeader + "0,1,0,0\n1,nan,0,0\n", ":3:", "'nan'", "expected a finite decimal number"},
      {"an infinity", kHeader + "0,-inf,0,0\n", ":2:", "'-inf'", "expected a finite decimal number"},
      {"a non-number", kHeader + "0,1,0,ten\n", ":2:", "'ten'", "expected a finite decimal number"},
      {"a wrong unit suffix", "time_s,height_mm,contact,torque_cmd_nm\n0,1,0,0\n", ":1:", "'height_mm'",
       "expected 'height_m'"},
      {"a contact that is no flag", kHeader + "0,1,2,0\n", ":2:", "2", "expected 0 or 1"},
      {"a column twice that is asked for", "time_s,height_m,contact,contact,torque_cmd_nm\n0,1,0,0,0\n",
       ":1:", "'contact'", "expected each column once"},
      {"an empty file", "", ":1:", "the file is empty", "expected a CSV log"},
      {"a header alone", kHeader, ":2:", "no rows", "expected at least one"},
      {"a file of zero bytes", std::string(100000, '\0'), ":1:", "NUL", "expected the text of a CSV log"},
      {"a file of zero numbers", kHeader + "0,0,0,0\n0,0,0,0\n", ":3:", "0 s after 0 s",
       "expected time to increase"},
      {"a log of another rig", "# machine_type: motor_axis\ntime_s,position_m,force_n\n0,0,0\n",
       ":1:", "'motor_axis'", "expected hopper"},
  };
  test::TemporaryFolder folder;
  const std::string path = folder.path() + "/a.csv";
  for (const BadLog& c : cases) {
    INFO(c.what);
    folder.file("a.csv", c.content);
    const test::Ran ran = run_furcula({"check", "--machine", "hopper", path});
    CHECK(ran.status == 3);
    CHECK(ran.out.empty());
    check_one_message(ran);
    CHECK_THAT(ran.err, Contains(path + c.place) && Contains(c.value) && Contains(c.expected));
  }
}

TEST_CASE("odd rows of a long log are told of, and its status is 0") {
  test::TemporaryFolder folder;
  std::string text = kHeader;
  for (int i = 0; i < 100; ++i) text += std::to_string(0.001 * i) + (i == 50 ? ",nan" : ",1") + ",0,0\n";
  const test::Ran ran = run_furcula({"check", "--machine", "hopper", folder.file("a.csv", text + "0.1,1")});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Contains("99 rows") && Contains("2 rows refused: ") &&
                          Contains("(line 52) height_m: 'nan' is not finite") &&
                          Contains("the last row is torn"));
}

TEST_CASE("stamps from which nothing can be learnt end with status 3 and no figures") {
  test::TemporaryFolder folder;
  std::string in_ms = kHeader, bursts = kHeader;
  for (int i = 0; i < 400; ++i) {
    const std::string rest = "," + std::to_string(0.3 + 0.1 * std::sin(0.01 * i)) + ",0,0\n";
    in_ms += std::to_string(i) + rest;
    const int burst = i / 8, in_burst = i % 8;
    bursts += std::to_string(0.008 * burst + 2e-5 * in_burst) + rest;
  }
  for (const auto& [text, expected] :
       {std::pair{in_ms, "time_s in ms"}, std::pair{bursts, "come in bursts: about 8 rows"}}) {
    const test::Ran ran = run_furcula({"check", "--machine", "hopper", folder.file("a.csv", text)});
    CHECK(ran.status == 3);
    CHECK(ran.out.empty());
    check_one_message(ran);
    CHECK_THAT(ran.err, Contains(expected));
  }
}

TEST_CASE("a map that does not name a rig leaves that to the option or the log") {
  test::TemporaryFolder folder;
  const std::string map = folder.file("map.toml", "separator = \";\"\n");
  const std::string log = folder.file("a.csv", "time_s;angle_rad;torque_nm\n0;1;0\n");
  CHECK(run_furcula({"check", "--machine", "rotary_joint", "--map", map, log}).status == 0);
  CHECK_THAT(run_furcula({"check", "--map", map, log}).err, Contains("tells the machine type"));
}

TEST_CASE("a directory, and a file that is not there, end with status 3") {
  test::TemporaryFolder folder;
  for (const std::string& path : {folder.path(), folder.path() + "/none.csv"}) {
    const test::Ran ran = run_furcula({"check", "--machine", "hopper", path});
    CHECK(ran.status == 3);
    check_one_message(ran);
    CHECK_THAT(ran.err, Contains(path + ": ") && Contains("expected a log"));
  }
}

TEST_CASE("each bad log of several has its message, and the good ones their figures") {
  test::TemporaryFolder folder;
  const std::string bad = folder.file("bad.csv", kHeader),
                    good = folder.file("good.csv", kHeader + "0,1,0,0\n");
  const test::Ran ran = run_furcula({"check", "--machine", "hopper", bad, good, bad});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.out, StartsWith(good + ": 1 rows"));
  CHECK(ran.err == "furcula: " + bad + ":2: no rows after the header row; expected at least one\nfurcula: " +
                       bad + ":2: no rows after the header row; expected at least one\n");
}

TEST_CASE("bad model and map files end with status 3 and one message") {
  test::TemporaryFolder folder;
  const std::string log = folder.file("a.csv", kHeader + "0,1,0,0\n");
  const auto check_model = [&](const std::string& from, const std::string& to) {
    const std::string model = folder.file("m.toml", test::with(test::kHopperModel, from, to));
    const test::Ran ran = run_furcula({"check", "--model", model, log});
    CHECK(ran.status == 3);
    check_one_message(ran);
    return ran.err;
  };
  const std::string path = folder.path() + "/m.toml";
  CHECK_THAT(check_model("mass_kg", "mas_kg"),
             Contains(path + ":6: unknown key 'mas_kg'") && Contains("expected one of mass_kg"));
  CHECK_THAT(check_model("coulomb", "columb"),
             Contains(path + ":20: unknown effect 'columb_friction'; expected one of"));
  CHECK_THAT(check_model("[1.2, 2.0]", "[2.0, 1.2]"),
             Contains(path + ":18: [free] mass_kg = [2, 1.2]") && Contains("expected lower < upper"));
  CHECK_THAT(check_model("1.554", "nan"), Contains(path + ":6: mass_kg = nan; expected a number"));

  const std::string map =
      folder.file("map.toml", "machine_type = \"hopper\"\nheight_mm = { column = \"z\" }\n");
  const test::Ran ran = run_furcula({"check", "--machine", "hopper", "--map", map, log});
  CHECK(ran.status == 3);
  check_one_message(ran);
  CHECK_THAT(ran.err,
             Contains("map.toml:2: unknown key 'height_mm'") && Contains("did you mean 'height_m'?"));
}
