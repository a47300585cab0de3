// The page of a robot of several joints: what stands on it, in which order, and that names cannot become markup.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/report/force_plot.hpp"
#include "tests/host/report/tree_sample.hpp"

namespace furcula {
namespace {

using Catch::Contains;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

nlohmann::json robot_of(const std::string& page) {
  const std::string open = "id=\"robot-data\">";
  const std::size_t at = page.find(open);
  REQUIRE(at != std::string::npos);
  return nlohmann::json::parse(page.substr(at + open.size(), page.find("</script>", at) - at - open.size()));
}

TEST_CASE("the page of a tree has its parts in their order") {
  const std::string page = test::page_of(test::sample_tree_diagnosis(), "furcula diagnose arm.toml");
  std::size_t last = page.find("<h1>The model lacks dry friction at elbow, and 1 more</h1>");
  REQUIRE(last != std::string::npos);
  for (const char* id : {"robot", "findings", "next", "traces", "missing", "remains", "candidates",
                         "parameters", "base-parameters", "data", "reading"}) {
    INFO(id);
    const std::size_t at = page.find("<section id=\"" + std::string(id) + "\">");
    REQUIRE(at != std::string::npos);
    CHECK(at > last);
    last = at;
  }
  CHECK_THAT(page, Contains("<span class=\"badge good\">Explained</span>"));
  CHECK_THAT(page, Contains("<code>furcula diagnose arm.toml</code>"));
  CHECK_THAT(page,
             Contains("<code>coulomb_friction@elbow</code>") && Contains("<code>payload@forearm</code>"));
  CHECK_THAT(page, Contains("Coulomb friction, joint elbow") && Contains("Payload, link forearm"));
  CHECK_THAT(page, Contains("0.310 <small>(0.295 to 0.325)</small>") && Contains(">N m<"));
  // Of the joint that suffers most without the finding: 30 mrad against 2.
  CHECK_THAT(page, Contains("the mean absolute error (MAE) of angle_elbow on the held-out recordings is 30 "
                            "mrad; with it 2.0 mrad."));
  CHECK_THAT(page, Contains("These recordings cannot distinguish it from") &&
                       Contains("<code>mass_error@forearm</code> + <code>com_error@forearm</code>"));
  CHECK_THAT(page, Contains("Slow strokes of elbow alone."));
  CHECK_THAT(page, Contains("8 recordings, 2 of them held out; 16000 samples; 240 windows of 0.300 s."));
}

TEST_CASE("experiments are listed with what they tell apart, and a scenario only where there is one") {
  trees::Diagnosis d = test::sample_tree_diagnosis();
  d.experiments = {{"Record more like log-00.csv", {}, 0.0123}};
  const std::string in_words = test::page_of(d);
  CHECK_THAT(in_words, Contains("Record more like log-00.csv") && Contains("12.3 mrad") &&
                           !Contains("next_experiment.toml"));
  d.experiments[0].paths.resize(2);
  CHECK_THAT(test::page_of(d), Contains("is in next_experiment.toml as a scenario for furcula sim.</p>"));
}

TEST_CASE("base parameters are listed, many of them folded away") {
  trees::Diagnosis d = test::sample_tree_diagnosis();
  const auto table = [](const std::string& page) {
    const std::size_t at = page.find("<section id=\"base-parameters\">");
    REQUIRE(at != std::string::npos);
    return page.substr(at, page.find("</section>", at) - at);
  };
  const std::string few = table(test::page_of(d));
  CHECK_THAT(few, Contains("<code>mz(upper arm) - 0.3 m(forearm)</code>") && Contains(">-0.360<") &&
                      Contains(">-0.420<") && Contains(">yes<") && Contains(">no<") &&
                      !Contains("<details>"));
  d.base_parameters[0].combination = test::kHostileJoint;
  d.base_parameters.resize(36, d.base_parameters[0]);
  const std::string many = table(test::page_of(d));
  CHECK_THAT(many, Contains("<details><summary>36 combinations</summary>") && Contains("&lt;b&gt;") &&
                       !Contains("<b>"));
  d.base_parameters.clear();
  CHECK_THAT(test::page_of(d), !Contains("id=\"base-parameters\""));
}

TEST_CASE("a joint's name is text wherever it stands") {
  trees::Diagnosis d = test::sample_tree_diagnosis();
  d.notes = {"</script><script>alert(1)</script>"};
  d.motions[0].log = "</script><!--";
  d.missing[0].correlated_with = test::kHostileJoint;
  d.findings[0].explanation = test::kHostileJoint;
  d.findings[0].cause.sites = {0};
  d.findings[0].at = {test::kHostileJoint};
  const std::string page = test::page_of(d, "furcula <b>");
  CHECK(count(page.substr(0, page.find("id=\"trace-data\"")), "<b>") ==
        0);  // after it the library has its own
  CHECK(count(page, "alert(1)</script>") == 0);
  // Three of data, and four of code: no name opened another or closed one.
  CHECK(count(page, "</script>") == count(page, "<script"));
  CHECK_THAT(page, Contains("joint &lt;b&gt;&amp;&quot;x"));
  const nlohmann::json robot = robot_of(page);
  CHECK(robot["joints"][0]["name"] == test::kHostileJoint);
  CHECK(robot["joints"][0]["guilty"] == "<b>&\"x: 1 Coulomb friction");
  CHECK(robot["motions"][0]["log"] == "</script><!--");
}

TEST_CASE("the robot is on the page as its URDF has it") {
  const nlohmann::json robot = robot_of(test::page_of(test::sample_tree_diagnosis()));
  REQUIRE(robot["joints"].size() == 2);
  const auto& shoulder = robot["joints"][0];
  CHECK(shoulder["parent"] == -1);
  CHECK(shoulder["at"][2].get<double>() == Approx(0.6));
  // Yaw of 0.4: the frame's x axis is (cos, sin, 0) in the base, the first column.
  CHECK(shoulder["turn"][0].get<double>() == Approx(std::cos(0.4)));
  CHECK(shoulder["turn"][3].get<double>() == Approx(std::sin(0.4)));
  CHECK(shoulder["guilty"] == "");
  CHECK(robot["joints"][1]["parent"] == 0);
  CHECK(robot["joints"][1]["guilty"] == "elbow: 1 Coulomb friction");

  // A box of mass 0.6 kg with 12 I / m = b^2 + c^2: edges of 0.337, 0.0775 and 0.0447 m.
  REQUIRE(robot["boxes"].size() == 2);
  const auto& forearm = robot["boxes"][1];
  CHECK(forearm["guilty"] == "forearm: 2 Payload");
  std::vector<double> half = forearm["half"].get<std::vector<double>>();
  std::sort(half.begin(), half.end());
  const double ixx = 0.0004, iyy = 0.0031, izz = 0.003;
  CHECK(2.0 * half[0] == Approx(std::sqrt(6.0 * (ixx + izz - iyy) / 0.6)));
  CHECK(2.0 * half[1] == Approx(std::sqrt(6.0 * (ixx + iyy - izz) / 0.6)));
  CHECK(2.0 * half[2] == Approx(std::sqrt(6.0 * (iyy + izz - ixx) / 0.6)));
  CHECK(forearm["at"][0].get<double>() == Approx(0.1));

  // From the base to the shoulder, on to the elbow, on to the tool that is fixed.
  REQUIRE(robot["bones"].size() == 3);
  CHECK(robot["bones"][2]["to"][0].get<double>() == Approx(0.25));
  CHECK(robot["bones"][2]["guilty"] == true);
  REQUIRE(robot["loads"].size() == 1);
  CHECK(robot["loads"][0]["at"][0].get<double>() == Approx(0.22));
  CHECK(robot["loads"][0]["joint"] == 1);
}

TEST_CASE("causes of a drive and of the base have their place in the picture") {
  trees::Diagnosis d = test::sample_tree_diagnosis();
  d.findings[0].cause = {trees::Effect::actuator_delay, {0}, {0.01}};
  d.findings[1].cause = {trees::Effect::base_tilt, {0}, {0.1, 0.0}};
  const nlohmann::json robot = robot_of(test::page_of(d));
  CHECK(robot["joints"][0]["guilty"] == "<b>&\"x: 1 Actuator delay");
  CHECK(robot["joints"][1]["guilty"] == "");
  CHECK(robot["base"] == "base: 2 Base tilt");
  CHECK(robot["boxes"][0]["guilty"] == "");
}

TEST_CASE("long motions and clouds are thinned, and the page stays small") {
  trees::Diagnosis d = test::sample_tree_diagnosis();
  for (int twice = 0; twice < 5; ++twice) {
    for (trees::Motion& m : d.motions) {
      const double end = m.time_s.back() + 0.004;
      for (std::size_t i = 0, n = m.time_s.size(); i < n; ++i) {
        m.time_s.push_back(end + m.time_s[i]);
        for (auto* columns : {&m.measured, &m.simulated})
          for (auto& column : *columns) column.push_back(column[i]);
      }
    }
    for (trees::MissingTorque& m : d.missing)
      for (auto* column : {&m.time_s, &m.angle_rad, &m.velocity_radps, &m.before_nm, &m.after_nm})
        column->insert(column->end(), column->begin(), column->end());
  }
  const std::string page = test::page_of(d);
  CHECK(page.size() < 2'500'000);
  std::size_t numbers = 0;
  const nlohmann::json robot = robot_of(page);
  for (const auto& m : robot["motions"])
    for (const char* columns : {"measured", "simulated"})
      for (const auto& column : m[columns]) numbers += column.size();
  CHECK(numbers > 40'000);
  CHECK(numbers < 90'000);
}

TEST_CASE("a page of nothing but the robot renders") {
  const trees::Diagnosis full = test::sample_tree_diagnosis();
  trees::Diagnosis d;
  d.model = full.model;
  d.refitted = d.extended = full.refitted;
  const std::string page = test::page_of(d);
  CHECK(count(page, "<article class=\"finding\">") == 0);
  CHECK(count(page, "id=\"robot-slider\"") == 0);
  CHECK(count(page, "id=\"robot-canvas\"") == 1);
  CHECK(count(page, "<section id=\"missing\">") == 0);
}

TEST_CASE("missing torque before and after stand in the same axes") {
  std::vector<double> t, v, q, before, after;
  for (int i = 0; i < 200; ++i) {
    t.push_back(0.01 * i);
    v.push_back(std::sin(0.1 * i));
    q.push_back(std::cos(0.1 * i));
    before.push_back(std::copysign(1.0, v.back()));
    after.push_back(0.0);
  }
  before[3] = std::nan("");
  const std::string plots = report::missing_force_plots({t, v, q, before, after, "N m", "rad/s", "rad"});
  CHECK(count(plots, "<svg") == 3);
  CHECK(count(plots, "class=\"cloud before\"") == 3);
  CHECK(count(plots, "class=\"cloud after\"") == 3);
  CHECK_THAT(plots, Contains("missing torque (N m)") && Contains("velocity (rad/s)"));
  CHECK(count(plots, "nan") == 0);
  after.pop_back();
  CHECK(report::missing_force_plots({t, v, q, before, after, "N m", "rad/s", "rad"}).empty());
}

}  // namespace
}  // namespace furcula
