// Pictures without a script: lines within their frame, words escaped, nothing drawn of nothing.
#include "host/report/line_plot.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <regex>

using furcula::report::line_plot_html;

TEST_CASE("A line's points lie within the picture, in their order, and its words are escaped") {
  const std::string html =
      line_plot_html({"height <m>",
                      "time, s",
                      {{"a & b", {0.0, 1.0, 2.0}, {-1.0, 0.5, std::numeric_limits<double>::quiet_NaN()}}}});
  CHECK(html.find("height &lt;m&gt;") != std::string::npos);
  CHECK(html.find("a &amp; b") != std::string::npos);
  std::smatch points;
  REQUIRE(std::regex_search(html, points, std::regex("points=\"([0-9.]+),([0-9.]+) ([0-9.]+),([0-9.]+) \"")));
  CHECK(std::stod(points[1]) < std::stod(points[3]));
  CHECK(std::stod(points[2]) > std::stod(points[4]));  // up is less
  for (int i = 1; i <= 4; ++i) {
    CHECK(std::stod(points[i]) >= 0.0);
    CHECK(std::stod(points[i]) <= 640.0);
  }
}

TEST_CASE("Of less than two points there is no picture, a constant has one") {
  CHECK(line_plot_html({"t", "x", {}}).empty());
  CHECK(line_plot_html({"t", "x", {{"one", {1.0}, {1.0}}}}).empty());
  const std::string html = line_plot_html({"t", "x", {{"flat", {0.0, 1.0}, {3.0, 3.0}}}});
  CHECK(!std::regex_search(html, std::regex("[^a-z]nan")));
  CHECK(html.find("polyline") != std::string::npos);
}

TEST_CASE("An axis that counts has whole numbers, and a line of one point is a dot") {
  furcula::report::LinePlot plot{
      "t", "round", {{"three", {1.0, 2.0, 3.0}, {10.0, 20.0, 30.0}}, {"one", {2.0}, {15.0}}}};
  CHECK(line_plot_html(plot).find(">1.5<") != std::string::npos);
  plot.counts = true;
  const std::string html = line_plot_html(plot);
  for (const char* whole : {">1<", ">2<", ">3<"}) CHECK(html.find(whole) != std::string::npos);
  CHECK(html.find(">1.5<") == std::string::npos);
  CHECK(html.find("<circle") != std::string::npos);
  CHECK(html.find("<circle") == html.rfind("<circle"));
  CHECK(html.find("<polyline") == html.rfind("<polyline"));
}
