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

namespace {

/// Whether the gait can be kept up, and what one costs that can.
std::string stability_html(const Search& search, const Evidence& evidence) {
  const Evaluation& e = search.evaluation;
  const Stability& s = evidence.stability;
  const BasinOptions box;
  report::Table law({{""}, {"torques over time", true}, {"with the feedback", true}});
  const auto size = [](const std::vector<std::complex<double>>& m, std::size_t i) {
    return i < m.size() ? number(std::abs(m[i]), 4) : std::string("&ndash;");
  };
  for (std::size_t i = 0; i < 4; ++i)
    law.add({i == 0 ? "Largest multiplier of the return map" : "next", size(e.multipliers, i),
             size(s.multipliers, i)});
  const auto percent = [](const Basin& b) { return number(100.0 * b.share(), 3) + " %"; };
  law.add({"Starts that return", percent(s.open_loop), percent(s.basin)});
  std::string out =
      law.html() +
      report::paragraph(
          "The feedback works in stance, about the gait's own path: " + number(s.gains.kp_nmprad.hip, 3) +
          " N m/rad and " + number(s.gains.kd_nmsprad.hip, 3) + " N m s/rad at each joint, at most " +
          number(s.gains.most_nm, 3) + " N m, from nothing at touch-down to the whole after " +
          number(1e3 * s.gains.ramp_s, 2) + " ms. On the gait it gives nothing, so that the cost stays.") +
      report::paragraph(
          "Of " + std::to_string(s.basin.starts) + " starts, drawn evenly within " +
          number(box.spread.height, 2) + " m, " + number(box.spread.speed, 2) + " m/s, " +
          number(box.spread.angle.hip, 2) + " rad and " + number(box.spread.rate.hip, 2) +
          " rad/s about the apex, all at once. Returned: within a tenth of that after at most " +
          std::to_string(box.strides) + " strides, no joint beyond its range, the ground never pulling.");
  const Disturbed &with = evidence.disturbed, &without = evidence.disturbed_open_loop;
  const DisturbedOptions ground;
  if (with.strides > 0)
    out += report::paragraph(
        "On the board's controller, each landing on ground that lies evenly within " +
        number(100.0 * ground.ground_m, 2) + " cm of level, the switch " +
        number(1e3 * ground.switch_late_s, 2) + " ms late: " + std::to_string(with.falls) + " falls of " +
        std::to_string(with.strides) + " strides with the feedback, at " + number(with.cost_j, 3) +
        " J a stride; " + std::to_string(without.falls) + " without it.");
  if (!evidence.stable)
    return out + report::paragraph("No stable gait was found, up to a toe that lands with 3 m/s.");
  const StableGait& g = *evidence.stable;
  if (g.landing_speed_mps == search.gait->task.landing_speed_mps)
    return out + report::paragraph("This is the cheapest stable gait: the feedback keeps it.");
  const double share =
      g.evaluation.cost_j / g.evaluation.stride.distance / (e.cost_j / e.stride.distance) - 1.0;
  return out +
         report::paragraph(
             "The feedback does not keep this gait: its toe lands with " +
             number(e.stride.touchdown_speed_mps, 3) +
             " m/s, so slowly that a little height changes the time of touch-down a lot. The cheapest stable gait "
             "lands with " +
             number(g.landing_speed_mps, 3) + " m/s: cost of transport " +
             number(g.evaluation.cot.value_or(0.0), 4) + " (" + number(100.0 * share, 2) +
             " % more), largest multiplier " + number(std::abs(g.stability.multipliers.front()), 3) + ", " +
             percent(g.stability.basin) + " of the starts return.");
}

std::string open_html(const Gait& gait, const OpenFigures& open) {
  report::Table table({{"Open parameter"}, {"from", true}, {"to", true}});
  for (const OpenParameter& o : gait.machine.open) table.add({o.name, number(o.low, 5), number(o.high, 5)});
  report::Table figures({{"Figure"}, {"from", true}, {"to", true}});
  const auto add = [&](const char* what, const Interval& i, double scale = 1.0) {
    figures.add({what, number(scale * i.low, 4), number(scale * i.high, 4)});
  };
  add("Cost of a stride, J", open.cost_j);
  if (gait.task.speed_mps) add("Cost of transport", open.cot);
  add("Share of the spring", open.eta);
  add("Knee at touch-down, degrees", open.touchdown_knee_rad, degrees(1.0));
  add("Largest multiplier, torques over time", open.multiplier);
  return table.html() + figures.html() +
         report::paragraph(
             "The gait was found anew at each of " + std::to_string(open.corners) + " corners" +
             (open.without > 0 ? "; " + std::to_string(open.without) + " of them have none." : "."));
}

}  // namespace

std::string render_gait_report(const Search& search, const Evidence& evidence, const std::string& command) {
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
  report::Table needs({{"What the gait asks for"}, {"", true}});
  const StrideEnd<double>& s = e.stride;
  needs.add({"Friction of the ground in stance, where it carries more than 20 N", number(s.friction, 3)});
  needs.add({"Friction of the ground at touch-down's impact", number(s.impact_friction, 3)});
  needs.add({"Speed of the toe at touch-down, downward", with_unit(s.touchdown_speed_mps, 3, "m/s")});
  needs.add({"Least force of the ground in stance", with_unit(s.least_force_n, 3, "N")});
  needs.add({"Voltage of a motor", with_unit(s.voltage_v, 3, "V")});
  needs.add({"Current of a motor", with_unit(s.current_a, 3, "A")});
  needs.add({"Speed of a motor", with_unit(s.motor_speed_radps, 3, "rad/s")});

  const std::string stable =
      e.multipliers.empty() ? "no multiplier could be computed."
      : std::abs(e.multipliers.front()) < 1.0
          ? "it returns to itself after a small disturbance."
          : "it does not return to itself after a disturbance" +
                std::string(evidence.stability.stable() ? "; with a feedback in stance it does."
                                                        : ", nor does it with a feedback in stance.");
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
      report::section("stability", "Stability", stability_html(search, evidence)) +
      (evidence.open.corners > 0 ? report::section("open", "Open digits", open_html(gait, evidence.open))
                                 : "");
  return report::render(page);
}

}  // namespace furcula::gait
