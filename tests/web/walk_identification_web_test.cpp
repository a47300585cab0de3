// The page of a walking robot's identification in a real browser: measured and predicted robots are drawn, differ by what the models predict, and
// nothing fails or is fetched.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/biped/points.hpp"
#include "host/floating/identification_report.hpp"
#include "host/walk/simulation.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/skip.hpp"
#include "tests/web/browser.hpp"

namespace furcula {
namespace {

using namespace floating;

constexpr double kKneeOff_rad = 0.1, kRollOff_rad = 0.01;
constexpr std::size_t kLeftKnee = dynamics::biped::kKnee;

/// As if a model predicted that left knee and roll are less by constants.
WindowErrors errors_of(const std::vector<Window>& windows, double share) {
  WindowErrors out;
  out.windows = windows.size();
  for (const Window& w : windows) {
    Predicted p{w, Eigen::VectorXd::Zero(static_cast<Eigen::Index>((w.count - 1) * kRowSize))};
    for (Eigen::Index k = 0; k < p.residual.size(); k += kRowSize) {
      p.residual[k + static_cast<Eigen::Index>(kLeftKnee)] = share * kKneeOff_rad;
      p.residual[k + static_cast<Eigen::Index>(kJoints)] = share * kRollOff_rad;
    }
    out.predicted.push_back(p);
  }
  out.channels[kLeftKnee] = share * kKneeOff_rad;
  out.channels[kJoints] = share * kRollOff_rad;
  out.angle_rad = share * kKneeOff_rad / std::sqrt(12.0);
  out.attitude_rad = share * kRollOff_rad / std::sqrt(3.0);
  return out;
}

constexpr const char* kProbe = R"(<script>
(async function () {
  const canvas = get('walk-canvas');
  const near = (r, g, b) => {
    let n = 0;
    const p = pixelsOf(canvas);
    for (let i = 0; i < p.length; i += 4)
      if (p[i + 3] > 128 && Math.abs(p[i] - r) < 12 && Math.abs(p[i + 1] - g) < 12 && Math.abs(p[i + 2] - b) < 12) ++n;
    return n;
  };
  const seen = {};
  seen.between = window.furculaWalk.at(PLACE_BETWEEN);
  seen.blue_between = near(0, 114, 178);
  seen.moment = window.furculaWalk.at(PLACE_INSIDE);
  seen.blue = near(0, 114, 178);
  seen.marked = near(213, 94, 0);
  const picture = pictureOf(canvas);
  get('walk-scale').value = '1';
  get('walk-scale').onchange();
  await wait(100);
  seen.scaled = pictureOf(canvas) !== picture;
  seen.traces = document.querySelectorAll('#trace-plot canvas').length;
  seen.channels = get('pick-channel').options.length;
  seen.rows = document.querySelectorAll('#parameters svg g').length;
  seen.bold = document.querySelectorAll('b').length;
  seen.sections = [...document.querySelectorAll('section')].map(s => s.id);
  seen.fetched = performance.getEntriesByType('resource').map(r => r.name);
  seen.page_width = document.documentElement.scrollWidth;
  seen.problems = problems;
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
})();
</script>)";

TEST_CASE("measured and predicted robots are drawn, and a knee's error turns the shank by as much") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  Identified found;
  found.given.robot = dynamics::biped::design();
  found.machine = found.given;
  found.unknowns = biped::unknowns(found.given.robot, true, false);
  const auto n = static_cast<Eigen::Index>(found.unknowns.size());
  found.theta = Eigen::VectorXd::Zero(n);
  found.sd = Eigen::VectorXd::LinSpaced(n, 0.02, 1.0);
  walk::RolloutOptions options;
  log::Log log =
      walk::simulate_walk(found.given.robot, options, test::found_walk("active").parameters, 0.01, 1).log;
  log.path = "walk<b>bold</b>.csv";
  for (auto& [name, column] : log.columns) column.resize(300);
  const std::vector<Recording> recordings{recording_of(log)};
  const std::vector<Window> windows = windows_of(recordings[0], 0, 0.3);
  REQUIRE(windows.size() > 4);
  found.before = errors_of(windows, 2.0);
  found.after = errors_of(windows, 1.0);
  const std::vector<Recording> none;
  std::string page = render_identification_report(
      {"furcula<b>biped</b>", &found, &recordings, &none, nullptr, nullptr, 0.3, "furcula walk identify"});
  page.insert(page.find("<meta name=\"viewport\""), test::kFrames);
  const auto time_s = [&](std::size_t row) {
    return recordings[0].rows[row].time_s - recordings[0].rows[0].time_s;
  };
  std::size_t landing = 0;  // the window before one, and its rows until the next window
  while (windows[landing].first + windows[landing].count + 3 > windows[landing + 1].first) ++landing;
  std::string script = test::kPictureTools;
  script += kProbe;
  const auto put = [&](const std::string& place, double value) {
    script.replace(script.find(place), place.size(), std::to_string(value));
  };
  put("PLACE_BETWEEN", time_s(windows[landing].first + windows[landing].count + 1));
  put("PLACE_INSIDE", time_s(windows[landing].first + windows[landing].count / 2));
  for (const int width : {1400, 500}) {
    const nlohmann::json seen = test::look_at(*browser, page, script, width);
    INFO(seen.dump(1));
    CHECK(seen["problems"].empty());
    CHECK(seen["fetched"].empty());
    CHECK(seen["bold"] == 0);
    CHECK(seen["sections"] ==
          nlohmann::json{"answer", "causes", "walk", "channels", "parameters", "recordings"});
    CHECK(seen["between"]["off"].empty());
    CHECK(seen["blue_between"] == 0);
    CHECK(seen["blue"].get<int>() > 50);
    CHECK(seen["marked"].get<int>() > 20);
    CHECK(seen["scaled"] == true);
    CHECK(seen["traces"].get<int>() > 0);
    CHECK(seen["channels"] == 3);
    CHECK(seen["rows"] == found.unknowns.size());
    CHECK(seen["page_width"] <= width);
    const auto& m = seen["moment"];
    REQUIRE(m["off"].size() == 2);
    const auto length = [](const nlohmann::json& a, const nlohmann::json& b) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k) sum += std::pow(a[k].get<double>() - b[k].get<double>(), 2);
      return std::sqrt(sum);
    };
    const std::size_t hip = biped::first_point(0), knee = hip + 1, ankle = hip + 2;
    for (const double share : {2.0, 1.0}) {
      const auto& off = m["off"][share > 1.5 ? 0 : 1];
      // The thigh turns with the pelvis, by the roll; the shank by the knee too, about an axis almost across.
      const double thigh = length(m["points"][hip], m["points"][knee]),
                   shank = length(m["points"][knee], m["points"][ankle]);
      CHECK(length(off[hip], off[knee]) ==
            Approx(2.0 * std::sin(0.5 * share * kRollOff_rad) * thigh).margin(1e-3));
      CHECK(length(off[knee], off[ankle]) ==
            Approx(2.0 * std::sin(0.5 * std::hypot(share * kKneeOff_rad, share * kRollOff_rad)) * shank)
                .epsilon(0.03));
      // One foot's sole stays where it is.
      double stays = 1.0;
      for (const std::size_t side : {0u, 1u}) {
        double middle = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
          double sum = 0.0;
          for (std::size_t c = 0; c < 4; ++c)
            sum += off[biped::first_point(side) + biped::kFirstCorner + c][k].get<double>();
          middle += std::abs(0.25 * sum);
        }
        stays = std::min(stays, middle);
      }
      CHECK(stays < 2e-4);
    }
  }
}

}  // namespace
}  // namespace furcula
