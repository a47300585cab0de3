#include "host/gait/gait_report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
#include "host/report/page.hpp"

namespace furcula::gait {
namespace {

using report::Line;
using report::number;

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// "2.46 J" with a small unit.
std::string with_unit(double value, int digits, const char* unit) {
  return number(value, digits) + "&#8239;<small>" + unit + "</small>";
}

std::string task_words(const Gait& gait) {
  const char* spring = gait.machine.spring == LegSpring::switched   ? "a switched spring"
                       : gait.machine.spring == LegSpring::parallel ? "a parallel spring"
                                                                    : "no spring";
  const std::string what =
      gait.task.clearance_m
          ? "In place with " + number(100.0 * *gait.task.clearance_m, 3) + " cm of toe clearance"
          : "Forward at " + number(*gait.task.speed_mps, 3) + " m/s";
  return what + ", " + spring + ", " + (gait.is_fourier() ? "Fourier and Bezier" : "free") + " torques";
}

template <class F>
Line curve(const char* label, const std::vector<Moment>& moments, const F& f) {
  Line l{label, {}, {}};
  for (const Moment& m : moments) {
    l.x.push_back(m.time_s);
    l.y.push_back(f(m));
  }
  return l;
}

std::string plots(const std::vector<Moment>& moments) {
  const char* over = "time since the apex, s";
  const auto plot = [&](const char* title, std::vector<Line> lines) {
    return report::line_plot_html({title, over, std::move(lines)});
  };
  return plot("Height of hip and toe, m", {curve("hip", moments, [](const Moment& m) { return m.hip.y; }),
                                           curve("toe", moments, [](const Moment& m) { return m.toe.y; })}) +
         plot("Speed of the hip, m/s",
              {curve("forward", moments, [](const Moment& m) { return m.hip_velocity.x; }),
               curve("upward", moments, [](const Moment& m) { return m.hip_velocity.y; })}) +
         plot("Angles, degrees",
              {curve("hip", moments, [](const Moment& m) { return degrees(m.angle.hip); }),
               curve("knee", moments, [](const Moment& m) { return degrees(m.angle.knee); })}) +
         plot("Torques, N m (the spring's by five)",
              {curve("hip", moments, [](const Moment& m) { return m.torque.hip; }),
               curve("knee", moments, [](const Moment& m) { return m.torque.knee; }),
               curve("spring / 5", moments, [](const Moment& m) { return m.spring_nm / 5.0; })}) +
         plot("Mechanical power, W (the spring's by five)",
              {curve("hip", moments, [](const Moment& m) { return m.torque.hip * m.rate.hip; }),
               curve("knee", moments, [](const Moment& m) { return m.torque.knee * m.rate.knee; }),
               curve("spring / 5", moments,
                     [](const Moment& m) { return m.spring_nm * m.rate.knee / 5.0; })}) +
         plot("Force of the ground, N",
              {curve("forward", moments, [](const Moment& m) { return m.force_n.x; }),
               curve("upward", moments, [](const Moment& m) { return m.force_n.y; })});
}

}  // namespace

std::string leg_data(const Machine& machine, const std::vector<NamedStride>& strides) {
  const dynamics::LegEquations<double> leg(machine.leg);
  double most = 0.0, reach = machine.leg.thigh_length_m + machine.leg.shank_length_m;
  nlohmann::json all = nlohmann::json::array();
  const auto rounded = [](double v) { return std::round(v * 1e5) / 1e5; };
  for (const NamedStride& s : strides) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Moment& m : s.moments) {
      const Vec2<double> knee = leg.knee(leg.pose(m.angle));
      most = std::max(most, std::abs(m.spring_nm));
      reach = std::max(reach, m.hip.y);
      rows.push_back({rounded(m.time_s), rounded(m.hip.x), rounded(m.hip.y), rounded(m.hip.x + knee.x),
                      rounded(m.hip.y + knee.y), rounded(m.toe.x), rounded(m.toe.y), rounded(m.spring_nm),
                      rounded(m.force_n.x), rounded(m.force_n.y)});
    }
    const double way = s.moments.empty() ? 0.0 : s.moments.back().hip.x - s.moments.front().hip.x;
    all.push_back({{"name", s.name}, {"way", way}, {"rows", rows}});
  }
  return nlohmann::json{{"most", most}, {"reach", reach}, {"spring", most > 0.0}, {"strides", all}}.dump();
}

std::string leg_html() {
  return "<div class=\"robot\"><canvas id=\"leg-canvas\" role=\"img\" aria-label=\"The leg over its stride\"></canvas></div>\n"
         "<div class=\"player\"><button type=\"button\" id=\"leg-play\">Play</button>"
         "<input type=\"range\" id=\"leg-slider\" aria-label=\"time\"><output id=\"leg-time\"></output>"
         "<label>Speed <select id=\"leg-speed\"><option value=\"0.1\">0.1</option><option value=\"0.25\" selected>0.25</option>"
         "<option value=\"1\">1</option></select></label><label>Gait <select id=\"leg-choice\"></select></label></div>\n"
         "<p class=\"hint\">The spring is grey at rest and orange at its largest torque; the green line is the ground's force.</p>\n";
}

std::string render_gait_report(const Search& search, const std::string& command) {
  const Gait& gait = *search.gait;
  const Evaluation& e = search.evaluation;
  const std::vector<Moment> moments = moments_of(gait);
  const bool forward = gait.task.speed_mps.has_value();
  report::Page page;
  page.title = "Gait";
  page.command = command;
  page.leg_json = leg_data(gait.machine, {{"gait", moments}});
  std::string limits;
  for (const std::string& l : e.limits)
    limits += "<p>" + report::badge("limit", report::Tone::bad) + " " + report::escape(l) + "</p>\n";

  report::Table optima({{forward ? "Cost of transport" : "Cost, J", true}, {"Starts that found it", true}});
  for (const Optimum& o : search.optima) optima.add({number(o.cost, 5), std::to_string(o.starts)});
  report::Table multipliers({{"Multiplier", true}, {"Size", true}});
  for (const auto& m : e.multipliers)
    multipliers.add({number(m.real(), 4) + (m.imag() != 0.0 ? " + " + number(m.imag(), 4) + " i" : ""),
                     number(std::abs(m), 4)});
  report::Table needs({{"What the gait asks for"}, {"", true}});
  const StrideEnd<double>& s = e.stride;
  needs.add({"Friction of the ground in stance, where it carries more than 20 N", number(s.friction, 3)});
  needs.add({"Friction of the ground at touch-down's impact", number(s.impact_friction, 3)});
  needs.add({"Least force of the ground in stance", with_unit(s.least_force_n, 3, "N")});
  needs.add({"Voltage of a motor", with_unit(s.voltage_v, 3, "V")});
  needs.add({"Current of a motor", with_unit(s.current_a, 3, "A")});
  needs.add({"Speed of a motor", with_unit(s.motor_speed_radps, 3, "rad/s")});

  const std::string stable =
      e.multipliers.empty() ? "no multiplier could be computed."
      : std::abs(e.multipliers.front()) < 1.0
          ? "it returns to itself after a small disturbance."
          : "it does not return to itself after a disturbance without a feedback from stride to stride.";
  page.body_html =
      "<header>\n<p class=\"eyebrow\">Gait of a planar leg</p>\n<h1>" + report::escape(task_words(gait)) +
      "</h1>\n<p class=\"lead\">Played open loop in stance and with the flight's feedback, " + stable +
      "</p>\n" + limits + "</header>\n" +
      report::key_figures(
          {{forward ? "Cost of transport" : "Cost of a stride",
            forward ? number(*e.cot, 4) : with_unit(e.cost_j, 4, "J"),
            "electric energy from the supply, of which nothing comes back" +
                std::string(forward ? "; " + number(e.cost_j, 4) + " J a stride" : "")},
           {"Share of the spring", number(e.eta, 3), "of the joints' positive work"},
           {"Knee at touch-down", with_unit(degrees(s.touchdown_knee), 3, "&deg;"),
            "the rest angle of a switched spring"},
           {"Stride", with_unit(e.stride_s, 3, "s"), number(s.stance, 3) + " s of it in stance"},
           {"Closure", number(e.closure, 2),
            "largest difference of the state after a stride, by an integrator of order 8"},
           {"Toe clearance", with_unit(100.0 * s.highest_toe, 3, "cm"), "at its highest"}}) +
      report::section("leg", "The stride", leg_html()) + report::section("curves", "Curves", plots(moments)) +
      report::section("needs", "What it needs", needs.html()) +
      report::section("optima", "Local optima",
                      optima.html() + (search.without > 0 ? report::paragraph(std::to_string(search.without) +
                                                                              " starts found none.")
                                                          : "")) +
      report::section("multipliers", "Multipliers of the return map", multipliers.html());
  return report::render(page);
}

}  // namespace furcula::gait
