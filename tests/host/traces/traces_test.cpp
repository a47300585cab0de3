// The files that traces are written to, and the errors over their rows.
#include "host/traces/traces.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

traces::Traces example() {
  traces::LogTraces log{"logs/run.csv",
                        {0.0, 0.1, 0.2, 0.3, 0.4},
                        {1, 1, 0, 2, 2},
                        {},
                        {{"angle_rad", "rad", {1.0, 3.0, 9.0, 4.0, 4.0}, {{1.5, 2.5, kNone, 4.0, 5.0}}}}};
  return {{"given"}, {log}};
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("a row without a prediction has an empty cell, and columns name their unit and model") {
  const traces::Traces t = example();
  CHECK(traces::csv_text(t, t.logs[0]) ==
        "time_s,window,angle_rad_measured,angle_rad_given\n"
        "0,1,1,1.5\n0.1,1,3,2.5\n0.2,,9,\n0.3,2,4,4\n0.4,2,4,5\n");
}

TEST_CASE("errors are over the rows with a prediction, NMSE about each window's mean") {
  const traces::Traces t = example();
  const traces::Error e = traces::error_of(t.logs[0], t.logs[0].quantities[0], 0);
  // Squared errors 0.25 + 0.25 + 0 + 1; about the windows' means 1 + 1 + 0 + 0.
  CHECK(e.rows == 4);
  CHECK(e.rmse == Approx(std::sqrt(1.5 / 4.0)));
  CHECK(e.nmse == Approx(1.5 / 2.0));
}

TEST_CASE("a prediction that diverges is an empty cell and a large error") {
  traces::Traces t = example();
  t.logs[0].quantities[0].predicted[0][4] = std::numeric_limits<double>::infinity();
  CHECK_THAT(traces::csv_text(t, t.logs[0]), Contains("0.4,2,4,\n"));
  CHECK(traces::error_of(t.logs[0], t.logs[0].quantities[0], 0).rmse > 100.0);
}

TEST_CASE("the end of a log that is held out goes on in the file of its beginning") {
  traces::Traces first = example(), second = example();
  for (double& time : second.logs[0].time_s) time += 0.5;
  const traces::Traces whole = traces::joined(first, second);
  REQUIRE(whole.logs.size() == 1);
  CHECK(whole.logs[0].window == std::vector<std::size_t>{1, 1, 0, 2, 2, 3, 3, 0, 4, 4});
  const std::string csv = traces::csv_text(whole, whole.logs[0]);
  CHECK_THAT(csv, Contains("time_s,window,held_out,angle_rad_measured") && Contains("\n0.4,2,0,4,5\n") &&
                      Contains("\n0.9,4,1,4,5\n"));
}

TEST_CASE("logs of one name in two folders are two files") {
  traces::Traces t = example();
  t.logs.push_back(t.logs[0]);
  t.logs[1].log = "other/run.csv";
  t.logs.push_back(t.logs[0]);
  t.logs[2].log = "bags/run/";
  CHECK(traces::file_names(t) == std::vector<std::string>{"run.csv", "run_2.csv", "run_3.csv"});
}

TEST_CASE("the traces of a log with an odd name are in a file that the layout can name") {
  traces::Traces t = example();
  t.logs[0].log = "runs/a&b <\"x\"> \x01\x1b \xff\xc3 \n'c'.csv";
  const std::vector<std::string> names = traces::file_names(t);
  CHECK(names[0].find_first_of("\x01\x1b\xff\n\\") == std::string::npos);
  test::TemporaryFolder folder;
  const test::Ran parsed = test::run_program(
      "/usr/bin/python3",
      {"-c",
       "import sys, xml.etree.ElementTree as e; print(e.parse(sys.argv[1]).find('.//fileInfo').get('filename'), end='')",
       folder.file("layout.xml", traces::layout_text(t, names))});
  INFO(parsed.err);
  CHECK(parsed.status == 0);
  CHECK(parsed.out == names[0]);
}

TEST_CASE("the layout loads the files and shows measured and predicted of a quantity in one plot") {
  traces::Traces t = example();
  t.models = {"given", "extended"};
  for (int joint = 0; joint < 7; ++joint) {
    traces::Quantity q = example().logs[0].quantities[0];
    q.column = "angle_<j" + std::to_string(joint) + ">_rad";
    q.predicted.push_back(q.predicted[0]);
    t.logs[0].quantities.push_back(q);
  }
  t.logs[0].quantities.erase(t.logs[0].quantities.begin());
  test::TemporaryFolder folder;
  const std::string layout = traces::layout_text(t, {"run.csv"});
  // Seven quantities, six to a tab.
  CHECK(count(layout, "<Tab ") == 2);
  CHECK(count(layout, "<plot ") == 7);
  CHECK(count(layout, "<curve ") == 7 * 3);
  CHECK_THAT(layout, Contains("<fileInfo filename=\"run.csv\" prefix=\"run\">") &&
                         Contains("time_axis=\"time_s\"") &&
                         Contains("<curve name=\"run/angle_&lt;j0&gt;_rad_measured\"") &&
                         Contains("<curve name=\"run/angle_&lt;j6&gt;_rad_extended\""));
  const test::Ran parsed = test::run_program(
      "/usr/bin/python3", {"-c", "import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])",
                           folder.file("layout.xml", layout)});
  INFO(parsed.err);
  CHECK(parsed.status == 0);
}
