// The page of a loop and the errors on it: which models, which trials, what is marked.
#include "host/loop/loop_report.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/loop/sample_loop.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

/// What is between a section's id and the next section.
std::string section(const std::string& page, const std::string& id) {
  const std::size_t at = page.find("<section id=\"" + id + "\"");
  REQUIRE(at != std::string::npos);
  return page.substr(at, page.find("</section>", at) - at);
}

loop::LoopOptions options() {
  loop::LoopOptions out;
  out.model = "it's here.toml";
  out.walk = "walk.toml";
  out.robot = "./try {walk} {log} && echo <b>";
  out.out = "loop";
  return out;
}

}  // namespace

TEST_CASE("the error of a model is that of twelve joints and three turns together") {
  floating::WindowErrors e;
  e.angle_rad = 4e-3;
  CHECK(loop::model_error_rad(e) == Approx(4e-3 * std::sqrt(0.8)));
  e.attitude_rad = 4e-3;
  CHECK(loop::model_error_rad(e) == Approx(4e-3));
  e.angle_rad = 0.0;
  CHECK(loop::model_error_rad(e) == Approx(4e-3 * std::sqrt(0.2)));
}

TEST_CASE("a model's training trials are those up to the round that it was identified after") {
  CHECK_FALSE(loop::Cell{loop::kGiven, 1, 1}.training());
  CHECK_FALSE(loop::Cell{0, 1, 1}.training());
  CHECK(loop::Cell{1, 1, 2}.training());
  CHECK_FALSE(loop::Cell{1, 2, 1}.training());
  CHECK(loop::Cell{2, 1, 1}.training());
}

TEST_CASE("the last trial is drawn beside its simulation, and how far they are apart") {
  loop::LoopResult r = test::sample_loop();
  const std::string without = loop::render_loop_report("b", options(), r);
  CHECK_THAT(without, !Contains("id=\"last-trial\""));
  loop::BesideSimulation& b = r.last_trial.emplace();
  b.time_s = {0.0, 0.01, 0.02};
  for (auto* of : {&b.measured_rad, &b.simulated_rad})
    for (auto& line : *of) line = {0.0, 0.0, 0.0};
  b.measured_rad[4] = {0.0, 0.03, 0.06};
  const std::string part = section(loop::render_loop_report("b", options(), r), "last-trial");
  CHECK(count(part, "<figure") == 4);
  CHECK_THAT(part, Contains("left, robot") && Contains("left, simulation") && Contains("round_3/log_2.csv"));
  // Of 12 joints one is off by 60 mrad: the axis ends at 60 / sqrt(12) mrad, 214 units above zero at 226.
  const double y = 226.0 - 214.0 * 15.0 / (60.0 / std::sqrt(12.0));
  CHECK_THAT(part, Contains("y1=\"" + std::to_string(y).substr(0, 5)));
}

TEST_CASE("a triangle is read from loop.json as it was written, however large") {
  loop::LoopResult loop = test::sample_loop();
  for (int model = 3; model <= 100; ++model)
    for (unsigned round = 1; round <= static_cast<unsigned>(model) + 1; ++round)
      loop.triangle[{model, round, 1}].windows.angle_rad = 1.0 / (model + round);
  loop.triangle.at({loop::kGiven, 1, 1}).windows.gyro_radps = std::nan("");
  const test::TemporaryFolder folder;
  const std::string text = loop::to_json_text({}, options(), loop);
  CHECK(text.size() > 1 << 20);  // what other files of settings may have
  const loop::Triangle read = loop::triangle_in(folder.file("loop.json", text));
  REQUIRE(read.size() == loop.triangle.size());
  for (const auto& [cell, errors] : loop.triangle) {
    CHECK(read.at(cell).windows.angle_rad == errors.windows.angle_rad);
    CHECK(read.at(cell).windows.windows == errors.windows.windows);
    CHECK(read.at(cell).whole_run_rad == errors.whole_run_rad);
  }
  CHECK(std::isnan(read.at({loop::kGiven, 1, 1}).windows.gyro_radps));
  CHECK(loop::triangle_in(folder.file("old.json", "{\"schema\": \"furcula-walk-loop/2\"}")).empty());
  // Of a file without errors over whole walks they are computed again.
  CHECK(
      loop::triangle_in(folder.file("windows.json",
                                    R"({"schema": "furcula-walk-loop/2", "triangle": [{"model": 0, "round": 1,
          "repetition": 1, "windows": 3, "rms_angle_rad": 1, "rms_attitude_rad": 1, "rms_gyro_radps": 1}]})"))
          .empty());
  // Version 1 has other meanings under the same keys.
  for (const auto& read_it : {std::function([](const std::string& f) { loop::triangle_in(f); }),
                              std::function([](const std::string& f) { loop::settings_in(f); }),
                              std::function([](const std::string& f) { loop::loop_in(f); })})
    for (const char* text_of :
         {R"({"schema": "furcula-walk-loop/1", "triangle": [], "settings": {}})", "{}", "[]"})
      CHECK_THAT(test::error_message([&] { read_it(folder.file("before.json", text_of)); }),
                 Contains("before.json: schema ") && Contains("expected \"furcula-walk-loop/2\""));
  CHECK_THAT(test::error_message([&] { loop::triangle_in(folder.file("not.json", "{")); }),
             Contains("not.json: no JSON") && Contains("expected a loop.json of furcula walk loop"));
}

TEST_CASE("the page of a loop has each model and each trial once, with their marks and causes") {
  const std::string page = loop::render_loop_report("robot<b>", options(), test::sample_loop());
  const std::string triangle = section(page, "triangle"), rounds = section(page, "rounds");
  const std::string first = triangle.substr(0, triangle.find("</table>"));
  CHECK(count(first, "As given") == 1);
  CHECK(count(first, "Identified after round") == 2);
  CHECK(count(first, "Identified from the exercise") == 1);
  for (const char* name : {"round_0/", "round_1/", "round_2/"})
    CHECK(count(page, "href=\"" + std::string(name) + "identified_model.toml\"") == 1);
  CHECK(count(rounds, "href=\"round_0/log_1.csv\"") == 1);
  CHECK(count(page, "round_3/identified_model.toml") == 0);
  CHECK(count(page, "round_3/identification.html") == 0);
  for (unsigned r = 1; r <= 3; ++r)
    for (unsigned k = 1; k <= 2; ++k) {
      CHECK(count(first, ">Round " + std::to_string(r) + ", trial " + std::to_string(k) + "<") == 1);
      CHECK(count(page, "href=\"round_" + std::to_string(r) + "/log_" + std::to_string(k) + ".csv\"") == 1);
    }
  // Trials by model: 6 as given, 2 from the exercise, 2 + 2 of the first, 2 + 2 + 2 of the second.
  CHECK(count(first, "class=\"cell") == 18);
  CHECK(count(first, " training") == 2 + 4);
  // Trials that stood: 3 of all six, 1 of the first four, 3 of all six.
  CHECK(count(first, " stood") == 3 + 1 + 3);
  CHECK_THAT(first, Contains("cell\">111<") && Contains("cell training\">211<") &&
                        Contains("cell stood\">222<") && Contains("cell training stood\">322<") &&
                        Contains("cell stood\">331<") && Contains("cell\">512<"));
  const std::string whole = triangle.substr(triangle.find("Whole walks"));
  CHECK_THAT(whole, Contains("cell training\">2110<") && Contains("cell stood\">3310<"));
  CHECK(count(first, ">231<") == 0);  // the model of round 1 on a walk that comes later
  CHECK_THAT(section(page, "answer"), Contains("132 <span") && Contains("332&#8239;<small>mrad"));
  CHECK_THAT(rounds, Contains("coulomb_friction@left_knee") && Contains("6.3 N m") &&
                         Contains("falls after 2.60 s") && Contains("cost of transport 1.75") &&
                         Contains("cost of transport 3.75") && Contains("Causes: none beyond the tables"));
  CHECK(count(rounds, "deviate all together") == 1);
  const std::string before = rounds.substr(rounds.find("Before them"));
  CHECK_THAT(before, Contains("command_delay@drives") && Contains("0.012 s") &&
                         Contains("round_0/identification.html"));
  CHECK_THAT(rounds, Contains("In simulation of the model identified from the exercise: stands") &&
                         Contains("In simulation of the model identified after round 2: stands"));
  CHECK_THAT(page, Contains("The robot walks with the walk of round 3."));
  CHECK(count(page, "<svg") == 2);
  CHECK(count(page, "<b>") == 0);
  CHECK_THAT(page, Contains("--model &#39;it&#39;\\&#39;&#39;s here.toml&#39;"));
}

TEST_CASE("the page of a loop's first trial says what is there already") {
  loop::LoopResult begun = test::sample_loop();
  begun.rounds.resize(1);
  begun.rounds[0].trials.resize(1);
  begun.rounds[0].identification.reset();
  begun.of_exercise.reset();
  begun.walks = false;
  begun.triangle = {{{loop::kGiven, 1, 1}, begun.triangle.at({loop::kGiven, 1, 1})}};
  const std::string page = loop::render_loop_report("robot", options(), begun);
  CHECK_THAT(page, Contains("0 of 1 trials of round 1 stand and get at least 0.625 m"));
  CHECK(count(page, "class=\"cell") == 1 + 1 + 3);
  // Of a model that a loop of more rounds has left, nothing is on the page of a shorter one.
  loop::LoopResult more = begun;
  more.triangle[{1, 1, 1}].windows.angle_rad = 7.77e-3;
  CHECK(loop::render_loop_report("robot", options(), more) == page);
  CHECK(count(page, "Identified after") == 0);
  CHECK_THAT(page,
             Contains("In simulation of the model as given: stands") && !Contains("round_1/report.html"));
  begun.triangle.clear();
  CHECK(count(loop::render_loop_report("robot", options(), begun), "id=\"triangle\"") == 0);
}
