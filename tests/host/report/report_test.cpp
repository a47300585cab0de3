// The report's markup: what it says, that no text from outside can become markup, that it stays small.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/report/force_plot.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"
#include "tests/host/report/sample.hpp"

namespace furcula {
namespace {

using Catch::Contains;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

const std::string& sample_page() {
  static const std::string page = test::page_of(test::sample_diagnosis());
  return page;
}

TEST_CASE("text from outside is escaped in markup and in scripts") {
  CHECK(report::escape("<b a='1' b=\"2\">&") == "&lt;b a=&#39;1&#39; b=&quot;2&quot;&gt;&amp;");
  CHECK(report::escape(std::string("a\0b", 3)) ==
        "a\xEF\xBF\xBD"
        "b");
  CHECK(report::inside_script("\"</script><!--\"") == "\"\\u003c/script\\u003e\\u003c!--\"");
}

TEST_CASE("numbers are written with the digits that a person needs") {
  CHECK(report::number(1.6149) == "1.61");
  CHECK(report::number(605.2) == "605");
  CHECK(report::number(0.0041, 2) == "0.0041");
  CHECK(report::number(0.0) == "0");
  CHECK(report::number(3.2e-6, 2) == "3.2\u00d710\u207b\u2076");
  CHECK(report::number(std::numeric_limits<double>::quiet_NaN()) == "\xE2\x80\x93");
  CHECK(report::percent(0.94) == "94 %");
  CHECK(report::percent(0.0004) == "< 0.1 %");
  CHECK(report::percent(0.052) == "5.2 %");
  CHECK(report::percent(0.998) == "> 99 %");
  CHECK(report::percent(1.0) == "100 %");
}

TEST_CASE("an interval decides how many digits its value shows") {
  CHECK(report::with_interval(1.61234, 1.5214, 1.7032) == "1.612 <small>(1.521 to 1.703)</small>");
  CHECK(report::with_interval(605.123, 590.0, 620.0) == "605 <small>(590 to 620)</small>");
  CHECK(report::with_interval(2.0, 2.0, 2.0) == "2.000");
}

TEST_CASE("a small length is shown in millimetres, a large one in metres") {
  CHECK(report::scale_for({0.0041, 0.0009}, "m").unit == "mm");
  CHECK(report::scale_for({0.0041, 0.0009}, "m").factor == 1e3);
  CHECK(report::scale_for({0.36}, "m").unit == "m");
  CHECK(report::scale_for({0.004}, "N").unit == "N");
}

TEST_CASE(
    "the page of a diagnosis has the verdict, the cause with its place on the machine, and every table") {
  const diagnose::Diagnosis d = test::sample_diagnosis();
  const std::string& page = sample_page();
  CHECK_THAT(page, Contains("<h1>" + report::escape(d.summary) + "</h1>"));
  CHECK_THAT(page, Contains("<span class=\"badge good\">Explained</span>"));
  CHECK_THAT(page, Contains("Coulomb friction <code>coulomb_friction</code>"));
  CHECK_THAT(page, Contains(std::string(dynamics::info(dynamics::Effect::coulomb_friction).where_to_look)));
  CHECK_THAT(page, Contains("These recordings cannot distinguish it from"));
  CHECK_THAT(page, Contains("<h4>Alternatives that do worse</h4>") && Contains("Takes energy once a stride"));
  CHECK_THAT(page, Contains("drop-04.csv"));
  for (const char* id :
       {"findings", "next", "traces", "force", "remains", "candidates", "parameters", "data", "reading"})
    CHECK_THAT(page, Contains("<section id=\"" + std::string(id) + "\">"));
  // The verdict stands before the findings, these before what was tried.
  CHECK(page.find("<h1>") < page.find("id=\"findings\""));
  CHECK(page.find("id=\"findings\"") < page.find("id=\"candidates\""));
}

TEST_CASE("the page is one file of less than 2 MB that refers to no other") {
  const std::string& page = sample_page();
  CHECK(page.size() < 2'000'000);
  for (const char* reference : {" src=", " href=", "url(", "@import", "sourceMappingURL"}) {
    INFO(reference);
    CHECK(count(page, reference) == 0);
  }
  CHECK_THAT(page, Contains("default-src 'none'"));
  CHECK_THAT(page, Contains("Dan Vanderkam"));  // the licence's notice goes with the library
  CHECK_THAT(page, Contains("@license"));
}

TEST_CASE("ten times the recordings do not make the page larger than 2 MB") {
  diagnose::Diagnosis d = test::sample_diagnosis();
  const std::vector<diagnose::Trace> traces = d.traces;
  const result::ResidualForce once = d.residual;
  for (int copy = 1; copy < 10; ++copy) {
    for (diagnose::Trace t : traces) {
      t.log = std::to_string(copy) + t.log;
      d.traces.push_back(t);
    }
    for (auto member :
         {&result::ResidualForce::time_s, &result::ResidualForce::velocity, &result::ResidualForce::position,
          &result::ResidualForce::force, &result::ResidualForce::law})
      (d.residual.*member).insert((d.residual.*member).end(), (once.*member).begin(), (once.*member).end());
  }
  const std::string page = test::page_of(d);
  CHECK(page.size() < 2'000'000);
  CHECK_THAT(page, Contains("of each stretch those with the smallest and the largest error"));
}

TEST_CASE("without a finding the page names no cause and draws no extended model") {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  d.findings.clear();
  d.verdict = diagnose::Verdict::adequate;
  d.residual.law.clear();
  const std::string page = test::page_of(d);
  CHECK_THAT(page, Contains("as given, re-fitted; on recordings"));
  CHECK_THAT(page, Contains("\"labels\":[\"measured\",\"as given\",\"re-fitted\"]"));
  CHECK(count(page, "class=\"law\"") == 0);
  CHECK(count(page, "class=\"finding\"") == 0);
}

TEST_CASE("several causes have a headline of the first, and a list of all with their sizes") {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  d.findings[0].parameters["force_n"] = {1.5, 1.4, 1.6};
  for (const dynamics::Effect e : {dynamics::Effect::touchdown_loss, dynamics::Effect::force_offset}) {
    d.findings.push_back(d.findings[0]);
    d.findings.back().effect = e;
  }
  d.refitted["height"].rmse = 0.008;
  d.extended["height"].rmse = 0.002;
  d.noise_floor["height"].rmse = 0.001;
  const std::string page = test::page_of(d);
  CHECK_THAT(page, Contains("<h1>The model lacks dry friction, and 2 more</h1>"));
  CHECK_THAT(page, Contains("<title>Furcula: The model lacks dry friction, and 2 more</title>"));
  CHECK_THAT(page, Contains("<li>dry friction <code>coulomb_friction</code>: 1.50 N</li>"));
  CHECK_THAT(page, Contains("<code>force_offset</code>: 1.50 N</li>"));
  CHECK_THAT(page, Contains("(RMSE) goes from 8.00 to 2.00 mm; the noise floor is 1.00 mm."));
  CHECK(count(page, report::escape(d.summary)) == 0);

  // What is not certain is not said to lack, and the engine's sentence tells why.
  d.verdict = diagnose::Verdict::not_identifiable;
  const std::string open = test::page_of(d);
  CHECK_THAT(open, Contains("<h1>Not certain: dry friction, and 2 more</h1>"));
  CHECK_THAT(open, Contains("<p class=\"lead\">" + report::escape(d.summary) + "</p>"));
  d.findings[0].undecided = true;
  const std::string undecided = test::page_of(d);
  CHECK_THAT(undecided,
             Contains("1.50 N; not certain: in its place <code>asymmetric_friction</code> would do as well"));
  CHECK(count(undecided, report::escape(d.summary)) == 0);
}

TEST_CASE("a share below nothing is worse, not a negative percentage") {
  CHECK_THAT(report::share_bar(-9.99), Contains("width:0.0%") && Contains(">worse<"));
  CHECK_THAT(report::share_bar(-0.0004), Contains(">0 %<"));
  CHECK_THAT(report::share_bar(0.4), Contains("width:40.0%") && Contains(">40 %<"));
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  d.findings[0].explainable_nmse_removed = -9.99;
  const std::string page = test::page_of(d);
  CHECK_THAT(page, Contains("Nothing on the held-out recordings: they are predicted worse with it."));
  CHECK(count(page, "-999") == 0);
}

TEST_CASE("a bar of shares is drawn only where each model does better than the one before") {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  CHECK(count(test::page_of(d), "class=\"budget\"") == 1);
  const double refitted = d.refitted["height"].nmse;
  d.extended["height"].nmse = 1.2 * refitted;
  const std::string worse = test::page_of(d);
  CHECK(count(worse, "class=\"budget\"") == 0);
  CHECK_THAT(worse, Contains("the extended model does worse than the re-fitted one"));
  d.extended["height"].nmse = 0.5 * refitted;
  d.baseline["height"].nmse = 0.8 * refitted;
  const std::string refit = test::page_of(d);
  CHECK(count(refit, "class=\"budget\"") == 0);
  CHECK_THAT(refit, Contains("the re-fitted model does worse than the one as given"));
}

TEST_CASE("each held-out recording has its error before and after") {
  diagnose::Diagnosis d;
  d.main_channel = "height";
  d.main_unit = "m";
  d.baseline["height"] = {0.1, 0.01, 0.02};
  // Two windows of one recording, 3 mm off as given, 2 re-fitted, 1 extended; one of another, and a velocity.
  for (const char* log : {"a.csv", "b.csv", "a.csv"})
    d.traces.push_back(
        {log, "height", "m", {0.0, 0.001}, {0.3, 0.3}, {0.303, 0.297}, {0.302, 0.302}, {0.301, 0.299}});
  d.traces.push_back({"c.csv", "velocity", "m/s", {0.0}, {0.0}, {1.0}, {1.0}, {1.0}});
  const std::string page = test::page_of(d);
  const auto row = [](const char* log, const char* windows) {
    return "<tr><td>" + std::string(log) + "</td><td class=\"number\">" + windows +
           "</td><td class=\"number\">3.00</td><td class=\"number\">2.00</td><td "
           "class=\"number\">1.00</td><td>mm</td></tr>";
  };
  CHECK_THAT(page, Contains(row("a.csv", "2")) && Contains(row("b.csv", "1")) && !Contains("<td>c.csv"));
}

TEST_CASE("the foot of the page has the command that writes it again") {
  const diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  CHECK_THAT(test::page_of(d, "furcula diagnose --seed 1 'a <b>.csv'"),
             Contains(": <code>furcula diagnose --seed 1 &#39;a &lt;b&gt;.csv&#39;</code></footer>"));
  CHECK_THAT(test::page_of(d), Contains(".</footer>"));
}

TEST_CASE("hostile names stay text") {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  const std::string hostile = "</script><img src=x onerror=alert(1)>\"'&.csv";
  d.held_out_files = d.training_files = {hostile};
  d.summary = d.next_experiment = hostile;
  for (diagnose::Trace& t : d.traces) t.log = t.channel = t.unit = hostile;
  d.residual.unit = d.residual.velocity_unit = d.residual.position_unit = hostile;
  d.correlated_with = {{hostile, hostile, 0.5, hostile}};
  d.parameters.push_back({hostile, hostile, hostile, true, 0, {}, {}, hostile});
  d.candidates.push_back({{hostile}, {{hostile, {}}}, 0, 0, false, 0, hostile});
  d.findings[0].parameters[hostile] = {};
  d.findings[0].explanation = d.findings[0].next_experiment = hostile;
  d.findings[0].alternatives = {{{hostile}, hostile, {{hostile, {}}}}};
  d.baseline[hostile] = {};
  const std::string page = test::page_of(d);
  CHECK(count(page, "<img") == 0);
  CHECK(count(page, "</script") == count(sample_page(), "</script"));
  CHECK(count(page, "<script") == count(sample_page(), "<script"));
  CHECK_THAT(page, Contains("&lt;/script&gt;&lt;img src=x"));
}

TEST_CASE("an empty diagnosis is a page without plots and without scripts") {
  const std::string page = test::page_of(diagnose::Diagnosis{});
  CHECK_THAT(page, Contains("Adequate"));
  CHECK(count(page, "<script") == 0);
  CHECK(count(page, "<svg") == 0);
  CHECK(count(page, "nan") == 0);
}

TEST_CASE("figures that are not finite are dashes on the page") {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  d.unexplained_fraction = nan;
  d.extended["height"] = {nan, nan, nan};
  d.findings[0].confidence = nan;
  for (auto& c : d.candidates) c.training_gain = nan;
  d.residual.force[7] = nan;
  d.traces[0].extended[3] = nan;
  const std::string page = test::page_of(d);
  const std::string markup = page.substr(0, page.find("<script"));
  CHECK(count(markup, "nan ") + count(markup, ">nan") + count(markup, "Mnan") + count(markup, "Lnan") == 0);
}

TEST_CASE("the table of errors has each channel's unit, and no row for a figure that a channel has not") {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t rows = count(test::page_of(d), ">NMSE</td>");
  REQUIRE(rows > 0);
  d.baseline["torque"] = d.refitted["torque"] = d.extended["torque"] = {0.1, 0.2, 0.3};
  d.baseline["contact"] = d.refitted["contact"] = d.extended["contact"] = {nan, 2e-3, 3e-3};
  const std::string page = test::page_of(d);
  CHECK(count(page, ">NMSE</td>") == rows + 1);
  CHECK_THAT(page, Contains("<td>N m</td>"));
  CHECK(count(page, "<td>nm</td>") == 0);
}

struct Traces {
  std::vector<double> time_s, measured, model;
};

Traces sine_with_a_spike(std::size_t n, std::size_t spike) {
  Traces t;
  for (std::size_t i = 0; i < n; ++i) {
    t.time_s.push_back(1e-3 * static_cast<double>(i));
    t.model.push_back(std::sin(0.01 * static_cast<double>(i)));
    t.measured.push_back(t.model.back() + (i == spike ? 0.5 : 0.0));
  }
  return t;
}

TEST_CASE("thinned traces keep their first, last and worst samples") {
  const Traces t = sine_with_a_spike(50'000, 31'415);
  const report::TraceData data = report::encode(
      {{"measured", "model"}, {{"log", "height", "m", t.time_s, {t.measured, t.model}}}}, 1000);
  CHECK(data.samples == 50'000);
  CHECK(data.kept <= 1000);
  CHECK(data.kept > 400);
  const auto j = nlohmann::json::parse(data.json);
  const auto& s = j["series"][0];
  const auto time = s["time"].get<std::vector<double>>();
  CHECK(std::is_sorted(time.begin(), time.end()));
  CHECK(time.front() == 0.0);
  CHECK(time.back() == Approx(49.999).margin(1e-9));
  REQUIRE(s["values"][0].size() == time.size());
  double worst = 0.0, worst_at = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double e = s["values"][0][i].get<double>() - s["values"][1][i].get<double>();
    if (e > worst) worst = e, worst_at = time[i];
  }
  CHECK(worst == Approx(0.5).margin(1e-4));
  CHECK(worst_at == Approx(31.415).margin(1e-9));
  CHECK_THAT(report::trace_plot_html(data), Contains("of 50000 samples"));
}

TEST_CASE("traces below the limit are kept whole, and the page does not speak of thinning") {
  const Traces t = sine_with_a_spike(200, 100);
  const report::TraceData data =
      report::encode({{"measured", "model"}, {{"log", "height", "m", t.time_s, {t.measured, t.model}}}});
  CHECK(data.kept == 200);
  const auto values = nlohmann::json::parse(data.json)["series"][0]["values"];
  for (std::size_t i = 0; i < 200; ++i)
    CHECK(values[0][i].get<double>() == Approx(t.measured[i]).margin(2e-5));
  CHECK(count(report::trace_plot_html(data), "of 200 samples") == 0);
}

TEST_CASE("windows of one recording become one series, and a missing model an empty column") {
  const Traces t = sine_with_a_spike(10, 5);
  std::vector<double> later = t.time_s;
  for (double& s : later) s += 1.0;
  const report::TraceData data = report::encode({{"measured", "as given", "extended"},
                                                 {{"a", "height", "m", t.time_s, {t.measured, t.model, {}}},
                                                  {"b", "height", "m", t.time_s, {t.measured, t.model, {}}},
                                                  {"a", "height", "m", later, {t.measured, t.model, {}}}}});
  const auto series = nlohmann::json::parse(data.json)["series"];
  REQUIRE(series.size() == 2);
  CHECK(series[0]["log"] == "a");
  CHECK(series[0]["starts"] == nlohmann::json({0, 10}));
  CHECK(series[0]["time"][10].get<double>() == Approx(1.0));
  CHECK(series[0]["one_after_the_other"] == false);
  CHECK(series[0]["values"][2].empty());
}

TEST_CASE("windows that count their time from their own start are put one after the other") {
  const Traces t = sine_with_a_spike(11, 5);
  const report::TraceData data = report::encode(
      {{"measured"},
       {{"a", "height", "m", t.time_s, {t.measured}}, {"a", "height", "m", t.time_s, {t.measured}}}});
  const auto s = nlohmann::json::parse(data.json)["series"][0];
  CHECK(s["one_after_the_other"] == true);
  CHECK(s["time"][11].get<double>() == Approx(0.010));
  CHECK(s["time"][21].get<double>() == Approx(0.020));
}

TEST_CASE("a cloud of a hundred thousand samples is thinned, and the law jumps at zero velocity") {
  result::ResidualForce r;
  r.unit = "N";
  r.velocity_unit = "m/s";
  r.position_unit = "m";
  for (int i = 0; i < 100'000; ++i) {
    const double v = std::sin(1e-3 * i * std::numbers::sqrt2);
    r.time_s.push_back(1e-3 * i);
    r.velocity.push_back(v);
    r.position.push_back(0.3 + 0.05 * std::cos(1e-3 * i));
    r.law.push_back(v >= 0.0 ? -1.6 : 1.6);
    r.force.push_back(r.law.back() + 0.3 * std::sin(17.0 * i));
  }
  const std::string html = report::force_plots(r);
  CHECK(count(html, "<svg") == 3);
  CHECK(html.size() < 200'000);
  CHECK(count(html, "h0") <= 3 * 2600);
  CHECK(count(html, "h0") > 3 * 2000);
  CHECK_THAT(html, Contains("Of 100000 samples"));
  // In the first panel the law is two levels with one upright stroke at v = 0, halfway across the plot.
  const std::size_t at = html.find("class=\"law\" d=\"");
  REQUIRE(at != std::string::npos);
  const std::string law = html.substr(at + 15, html.find('"', at + 15) - at - 15);
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < law.size();) {
    const std::size_t next = law.find_first_of("ML", i + 1);
    double x = 0.0, y = 0.0;
    REQUIRE(std::sscanf(law.c_str() + i + 1, "%lf %lf", &x, &y) == 2);
    points.emplace_back(x, y);
    i = next == std::string::npos ? law.size() : next;
  }
  const double middle = 0.5 * (62.0 + 460.0 - 16.0);
  for (const auto& [x, y] : points)
    CHECK(y == Approx(x < middle - 0.5   ? points.front().second
                      : x > middle + 0.5 ? points.back().second
                                         : y));
  CHECK(points.front().second <
        points.back().second);  // pushes up while it moves down, on a screen's downward y
}

}  // namespace
}  // namespace furcula
