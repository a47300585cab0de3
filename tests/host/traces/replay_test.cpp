// `furcula replay`, the traces of `furcula diagnose` and `furcula identify`, and logs without comments, at the program's edge.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "host/log/reader.hpp"
#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/identify/synthetic.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
using Catch::StartsWith;
using test::run_furcula;

namespace {

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string first_line(const std::string& path) {
  const std::string text = text_of(path);
  return text.substr(0, text.find('\n'));
}

/// The number behind `what`.
double number_after(const std::string& text, const std::string& what) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return std::stod(text.substr(at + what.size()));
}

/// An axis of 95 kg with 203.5 N s/m; the model file has other values.
struct Axis {
  test::TemporaryFolder folder;
  std::string given = folder.file("given.toml", model::format_model(test::axis_model(60.0, 90.0)));
  std::string right = folder.file("right.toml", model::format_model(test::axis_model(95.0, 203.5)));
  std::vector<std::string> logs;

  Axis() {
    for (unsigned i = 0; i < 4; ++i)
      logs.push_back(folder.file("log" + std::to_string(i) + ".csv",
                                 log::format_log(test::axis_log(95.0, 203.5, 1e-4, i, 2.0))));
  }
};

}  // namespace

TEST_CASE(
    "replay prints the error in the channel's unit, small for the right model, and writes both traces") {
  const Axis a;
  const std::string out = a.folder.path() + "/out.csv", layout = a.folder.path() + "/out.xml";
  const test::Ran right = run_furcula({"replay", a.right, a.logs[0], "-o", out, "--layout", layout});
  INFO(right.err);
  REQUIRE(right.status == 0);
  CHECK_THAT(right.out, Contains("position_m: RMSE ") && Contains(" m, NMSE "));
  // Noise of 0.1 mm. A parabola through 25 rows of 50 ms makes 0.1 mm sqrt(192 / 25) / 50 ms = 5.5 mm/s of it, 1.6 mm RMS over 0.5 s.
  CHECK(number_after(right.out, "RMSE ") < 2.5e-3);
  const test::Ran wrong = run_furcula({"replay", a.given, a.logs[0]});
  CHECK(number_after(wrong.out, "RMSE ") > 5e-3);
  CHECK(first_line(out) == "time_s,window,position_m_measured,position_m_predicted");
  CHECK_THAT(text_of(layout), Contains("filename=\"out.csv\"") && Contains("out/position_m_predicted"));
}

TEST_CASE("replay of the extended model makes the traces that diagnose has written") {
  const Axis a;
  const std::string out = a.folder.path() + "/out";
  const test::Ran ran = run_furcula({"diagnose", "--model", a.given, "--out", out, a.logs[0], a.logs[1],
                                     a.logs[2], "--hold-out", a.logs[3]},
                                    240);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  CHECK(test::run_program("/bin/ls", {out + "/traces"}).out ==
        "log0.csv\nlog1.csv\nlog2.csv\nlog3.csv\nplotjuggler.xml\n");
  CHECK(
      first_line(out + "/traces/log3.csv") ==
      "time_s,window,held_out,position_m_measured,position_m_given,position_m_refitted,position_m_extended");
  const std::string again = a.folder.path() + "/again.csv";
  REQUIRE(run_furcula({"replay", out + "/extended_model.toml", a.logs[3], "-o", again}).status == 0);
  std::istringstream written(text_of(out + "/traces/log3.csv")), replayed(text_of(again));
  std::size_t rows = 0;
  std::string one, other;
  std::getline(written, one);
  std::getline(replayed, other);
  while (std::getline(written, one) && std::getline(replayed, other)) {
    const std::string extended = one.substr(one.rfind(',') + 1),
                      predicted = other.substr(other.rfind(',') + 1);
    REQUIRE(extended.empty() == predicted.empty());
    if (extended.empty()) continue;
    // The starts are estimated beside the re-fitted model there.
    REQUIRE(std::stod(extended) == Approx(std::stod(predicted)).margin(1e-4));
    ++rows;
  }
  CHECK(rows > 500);
}

TEST_CASE("identify writes the traces of the model as given and re-fitted") {
  const Axis a;
  const std::string out = a.folder.path() + "/out";
  const test::Ran ran =
      run_furcula({"identify", "--model", a.given, "--out", out, a.logs[0], a.logs[1]}, 120);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  CHECK(first_line(out + "/traces/log1.csv") ==
        "time_s,window,held_out,position_m_measured,position_m_given,position_m_refitted");
  CHECK_THAT(text_of(out + "/traces/plotjuggler.xml"), Contains("log0/position_m_refitted"));
}

TEST_CASE("a robot is replayed joint by joint, by its own model and by one with a hidden cause") {
  test::TemporaryFolder folder;
  const std::string urdf = text_of(test::source("tests/host/model/robots/double_pendulum.urdf"));
  folder.file("double_pendulum.urdf", urdf);
  const std::string lines = "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"double_pendulum.urdf\"\n";
  const std::string given = folder.file("given.toml", lines);
  const std::string truth =
      folder.file("truth.toml", lines + "[effect.coulomb_friction.elbow]\ntorque_nm = 0.5\n");
  const std::string log = folder.path() + "/log.csv", out = folder.path() + "/out.csv";
  const test::Ran made = run_furcula({"sim", "--model", truth, "--out", log, "--no-comments"});
  INFO(made.err);
  REQUIRE(made.status == 0);
  const test::Ran right = run_furcula({"replay", truth, log, "-o", out});
  INFO(right.err);
  REQUIRE(right.status == 0);
  const test::Ran wrong = run_furcula({"replay", given, log});
  REQUIRE(wrong.status == 0);
  const std::string elbow = "angle_elbow_rad: RMSE ";
  CHECK_THAT(right.out, Contains("angle_shoulder_rad: RMSE "));
  CHECK(number_after(wrong.out, elbow) > 3.0 * number_after(right.out, elbow));
  CHECK_THAT(first_line(out), Contains("angle_elbow_rad_measured,angle_elbow_rad_predicted"));
}

TEST_CASE(
    "a log without comments begins with its header row and is read back where the machine_type is said") {
  const Axis a;
  const std::string out = a.folder.path() + "/plain.csv";
  REQUIRE(run_furcula({"sim", "--model", a.right, "--out", out, "--no-comments"}).status == 0);
  CHECK(first_line(out).starts_with("time_s,position_m"));
  CHECK(text_of(out).find('#') == std::string::npos);
  CHECK(run_furcula({"check", "--machine", "motor_axis", out}).status == 0);
  CHECK(run_furcula({"check", "--model", a.right, out}).status == 0);
  const test::Ran untold = run_furcula({"check", out});
  CHECK(untold.status == 3);
  CHECK_THAT(untold.err, Contains("--machine"));
  const std::string with = a.folder.path() + "/with.csv", without = a.folder.path() + "/without.csv";
  REQUIRE(run_furcula({"convert", out, "--machine", "motor_axis", "--out", with}).status == 0);
  CHECK_THAT(text_of(with), StartsWith("# format: furcula-log/1\n# machine_type: motor_axis\n"));
  REQUIRE(run_furcula({"convert", with, "--out", without, "--no-comments"}).status == 0);
  CHECK(text_of(without) == text_of(out));
}

TEST_CASE("bad input to replay ends with one message and no output") {
  const Axis a;
  const std::string out = a.folder.path() + "/out.csv";
  struct Case {
    std::vector<std::string> arguments;
    int status;
    std::string message;
  };
  const std::string short_log =
      a.folder.file("short.csv", "time_s,position_m,force_n\n0,0,0\n0.002,0,0\n0.004,0,0\n");
  const std::vector<Case> cases{
      {{a.given}, 2, "LOG is required"},
      {{a.given, "none.csv", "-o", out}, 3, "none.csv"},
      {{"none.toml", a.logs[0], "-o", out}, 3, "none.toml"},
      {{a.given, short_log, "-o", out}, 3, "short.csv"},
      {{a.given, a.logs[0], "-o", a.logs[0]}, 2, "is what is read; expected another file"},
      {{a.given, a.logs[0], "--layout", a.folder.path() + "/out.xml"}, 2, "expected --out"},
      {{a.given, a.logs[0], "--window-s", "99", "-o", out}, 2, "--window-s"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> arguments{"replay"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const test::Ran ran = run_furcula(arguments);
    INFO(c.message);
    CHECK(ran.status == c.status);
    CHECK(ran.out.empty());
    CHECK_THAT(ran.err, Contains(c.message));
    CHECK(ran.err.find('\n') == ran.err.size() - 1);
  }
  CHECK(a.folder.names() == std::vector<std::string>{"given.toml", "log0.csv", "log1.csv", "log2.csv",
                                                     "log3.csv", "right.toml", "short.csv"});
}
