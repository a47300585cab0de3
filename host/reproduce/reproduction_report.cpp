// What stands on the page of a reproduction, from top to bottom.
#include "host/reproduce/reproduction_report.hpp"

#include <algorithm>
#include <cmath>

#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
#include "host/report/page.hpp"
#include "host/reproduce/rows.hpp"

namespace furcula::reproduce {
namespace {

using report::Line;
using report::line_plot_html;
using report::number;
using report::Table;
using report::Tone;

/// What shows the reasons: each number again, one cause another.
std::string causes_table(const Reproduction& r) {
  Table t({{"Where"}, {"What"}, {"Printed"}, {"Here", true}, {"One cause another"}, {"Then", true}});
  for (const Row& row : r.rows)
    for (std::size_t i = 0; i < row.counterfactuals.size(); ++i) {
      const Counterfactual& c = row.counterfactuals[i];
      const auto cell = [&](const std::string& text) { return i == 0 ? report::escape(text) : ""; };
      t.add({cell(row.where), cell(row.what), cell(row.published), i == 0 ? number(row.ours, 3) : "",
             report::escape(c.what) + (c.guessed ? " <small>(how much is a guess)</small>" : ""),
             number(c.value, 3) + "&#8239;<small>" + report::escape(c.unit.empty() ? row.unit : c.unit) +
                 "</small>"});
    }
  return t.html();
}

std::string omissions_table(const Reproduction& r) {
  Table t({{"Where"}, {"Printed"}, {""}, {"Why it is not computed"}});
  for (const Omission& o : r.omissions)
    t.add({report::escape(o.where), report::escape(o.published),
           report::badge(name(o.because), Tone::neutral), report::escape(o.why)});
  return t.html();
}

std::vector<double> first(const std::vector<double>& values, std::size_t count) {
  return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(std::min(count, values.size()))};
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

std::string chapter_3(const Reproduction& r) {
  constexpr std::size_t kRows = 2000;
  const auto line = [](const char* label, const Trajectory& t, std::vector<double> Trajectory::*what) {
    return Line{label, first(t.time_s, kRows), first(t.*what, kRows)};
  };
  const auto &one = r.example, &two = r.example_with_losses;
  return line_plot_html({"Fig. 3.4a: height, m", "time, s", {line("", one, &Trajectory::height_m)}}) +
         line_plot_html({"Fig. 3.4b: velocity, m/s", "time, s", {line("", one, &Trajectory::velocity_mps)}}) +
         line_plot_html({"Fig. 3.4c: force of the motor along the leg, N",
                         "time, s",
                         {line("", one, &Trajectory::force_n)}}) +
         line_plot_html({"Fig. 3.5: velocity, m/s",
                         "time, s",
                         {line("no loss", one, &Trajectory::velocity_mps),
                          line("0.8 at touch-down, 0.9 at lift-off", two, &Trajectory::velocity_mps)}}) +
         line_plot_html({"Fig. 3.7a: height, m",
                         "time, s",
                         {line("linear", r.linear_stride, &Trajectory::height_m),
                          line("non-linear", r.nonlinear_stride, &Trajectory::height_m)}}) +
         line_plot_html({"Fig. 3.7b: velocity, m/s",
                         "time, s",
                         {line("linear", r.linear_stride, &Trajectory::velocity_mps),
                          line("non-linear", r.nonlinear_stride, &Trajectory::velocity_mps)}});
}

/// One dot a fold or a recording, the estimators one under the other in the legend.
Line dots(const char* label, const std::vector<double>& values) {
  Line l{label, {}, values, true};
  for (std::size_t i = 0; i < values.size(); ++i) l.x.push_back(static_cast<double>(i + 1));
  return l;
}
Line folds(const char* label, const Estimates& e, std::string_view parameter) {
  std::vector<double> values;
  const std::size_t i = e.index(parameter);
  for (const auto& fold : e.folds) values.push_back(fold[i]);
  return dots(label, values);
}
Line recordings(const char* label, const Estimates& e, double TrajectoryErrors::*member, double factor) {
  std::vector<double> values;
  for (const TrajectoryErrors& t : e.errors) values.push_back(factor * (t.*member));
  return dots(label, values);
}

/// The four panels (a) to (d) of a validation figure.
std::string validation(const std::string& figure, const std::string& phase,
                       const std::vector<std::pair<const char*, const Estimates*>>& all) {
  using E = TrajectoryErrors;
  struct Panel {
    const char* what;
    double E::*member;
    double factor;
  };
  std::string out;
  for (const Panel& p :
       {Panel{"NMSE of height in PHASE, %", &E::nmse_height, 100.0},
        Panel{"NMSE of velocity in PHASE, %", &E::nmse_velocity, 100.0},
        Panel{"mean absolute error of height in PHASE, mm", &E::mae_height_m, 1e3},
        Panel{"mean absolute error of velocity in PHASE, mm/s", &E::mae_velocity_mps, 1e3}}) {
    std::vector<Line> lines;
    for (const auto& [label, estimates] : all)
      lines.push_back(recordings(all.size() > 1 ? label : "", *estimates, p.member, p.factor));
    std::string what = p.what;
    what.replace(what.find("PHASE"), 5, phase);
    out += line_plot_html({figure + ": " + what, "recording", lines, true});
  }
  return out;
}

std::string estimates_table(const IdentificationStudy& s) {
  Table t({{"Phase"},
           {"Estimator"},
           {"Parameter"},
           {"All recordings", true},
           {"Over the folds", true},
           {"The rig's", true}});
  std::vector<const Estimates*> all{&s.stance,   &s.stance_by_equation, &s.stance_by_equation_raw,
                                    &s.flight,   &s.flight_by_equation, &s.strides,
                                    &s.nonlinear};
  for (const PlainStudy& c : s.plain) all.push_back(&c.estimates);
  for (const Estimates* e : all)
    for (std::size_t i = 0; i < e->names.size(); ++i) {
      const auto [low, high] = e->range(e->names[i]);
      t.add({i == 0 ? report::escape(e->phase) : "",
             i != 0                           ? ""
             : e == &s.stance_by_equation_raw ? "equation, the rig's velocity"
                                              : report::escape(e->method),
             "<code>" + report::escape(e->names[i]) + "</code>",
             number(e->values[i], 4) + " <small>" + report::escape(e->units[i]) + "</small>",
             number(low, 4) + " to " + number(high, 4), number(s.rig.truth.parameter(e->names[i]), 4)});
    }
  return t.html();
}

std::string plain_table(const IdentificationStudy& s) {
  if (s.plain.empty()) return "";
  Table t({{"Phase"},
           {"Fits", true},
           {"Here", true},
           {"The plain way", true},
           {"Converged", true},
           {"NMSE, here", true},
           {"the plain way", true},
           {"Estimates, here"},
           {"the plain way"}});
  const auto list = [](const std::vector<double>& values) {
    std::string out;
    for (const double v : values) out += (out.empty() ? "" : ", ") + number(v, 4);
    return out;
  };
  std::string costs;
  for (const PlainStudy& c : s.plain) {
    costs += " " + c.estimates.phase + ": starts fitted " + number(c.ours_nmse_fitted, 2) + " here, " +
             number(c.plain_nmse_fitted, 2) + " the plain way; starts as measured " +
             number(c.ours_nmse_measured, 2) + " and " + number(c.plain_nmse_measured, 2) + ".";
    const Estimates& ours = c.estimates.phase == "flight"   ? s.flight
                            : c.estimates.phase == "stance" ? s.stance
                                                            : s.nonlinear;
    t.add({report::escape(c.estimates.phase), std::to_string(c.fits), number(c.ours_s, 3) + " s",
           number(c.plain_s, 3) + " s", std::to_string(c.converged), number(c.ours_nmse, 3),
           number(c.plain_nmse, 3), list(ours.values), list(c.estimates.values)});
  }
  return t.html() +
         report::paragraph(
             "The plain way: Dormand and Prince's variable step at ode45's tolerances, the cost of eq. 4.5 as one "
             "number, forward differences, BFGS, each run from the measured state; compiled, on one thread. Here: "
             "exact steps at the recorded rate with their derivatives, least squares, each run's start estimated "
             "with the parameters. NMSE: predicted from one set of estimated starts. Each way is best by its own cost:" +
             report::escape(costs));
}

std::string chapter_4(const Reproduction& r) {
  const IdentificationStudy& s = r.study;
  std::string out = estimates_table(s);
  out += line_plot_html({"Fig. 4.9: mass identified in stance, kg",
                         "fold left out",
                         {folds("simulation error", s.stance, "mass_kg"),
                          folds("equation error", s.stance_by_equation, "mass_kg"),
                          folds("equation error, the rig's velocity", s.stance_by_equation_raw, "mass_kg")}});
  out += line_plot_html(
      {"Fig. 4.9: damping identified in stance, N s/m",
       "fold left out",
       {folds("simulation error", s.stance, "damping_stance_nspm"),
        folds("equation error", s.stance_by_equation, "damping_stance_nspm"),
        folds("equation error, the rig's velocity", s.stance_by_equation_raw, "damping_stance_nspm")}});
  const auto frequencies = [&](const char* label, const Estimates& e) {
    std::vector<double> values;
    for (const auto& fold : e.folds)
      values.push_back(damped_frequency_radps(fold[0], s.rig.stiffness_npm, fold[1]));
    return dots(label, values);
  };
  out += line_plot_html(
      {"Fig. 4.10: damped natural frequency, rad/s",
       "fold left out",
       {frequencies("simulation error", s.stance), frequencies("equation error", s.stance_by_equation),
        frequencies("equation error, the rig's velocity", s.stance_by_equation_raw)}});
  out += validation("Fig. 4.11, 4.20", "stance",
                    {{"linear", &s.stance},
                     {"linear, by equation error", &s.stance_by_equation},
                     {"non-linear", &s.nonlinear}});
  out += line_plot_html({"Fig. 4.13: damping in flight, N s/m",
                         "fold left out",
                         {folds("simulation error", s.flight, "damping_flight_nspm"),
                          folds("equation error", s.flight_by_equation, "damping_flight_nspm")}});
  out += validation("Fig. 4.14", "flight",
                    {{"simulation error", &s.flight}, {"equation error", &s.flight_by_equation}});
  out += line_plot_html({"Fig. 4.16: velocity kept",
                         "fold left out",
                         {folds("touch-down", s.strides, "restitution_touchdown"),
                          folds("lift-off", s.strides, "restitution_liftoff")}});
  out += validation("Fig. 4.17", "whole strides", {{"simulation error", &s.strides}});
  for (std::size_t i = 0; i < s.good_and_poor.size(); ++i) {
    const Example& e = s.good_and_poor[i];
    out += line_plot_html({std::string("Fig. 4.18: height of the ") + (i == 0 ? "best" : "poorest") +
                               " predicted stride, m (" + e.recording + ")",
                           "time, s",
                           {{"measured", e.time_s, e.measured_m}, {"predicted", e.time_s, e.predicted_m}}});
  }
  const Estimates& n = s.nonlinear;
  for (const auto& [name, title] :
       {std::pair{"inertia_a_kgm2", "Fig. 4.19: a, kg m^2"}, std::pair{"inertia_b_kgm", "Fig. 4.19: b, kg m"},
        std::pair{"inertia_e_kgm", "Fig. 4.19: e, kg m"}})
    out += line_plot_html({title, "fold left out", {folds("", n, name)}});
  return out;
}

std::string chapter_5(const Reproduction& r) {
  Line travel{"1 kg, caught 40 ms after the release", {}, {}};
  for (std::size_t i = 0; i < std::min<std::size_t>(200, r.release_catch.standard.readings.size()); ++i) {
    travel.x.push_back(static_cast<double>(i));
    travel.y.push_back(r.release_catch.standard.readings[i].count);
  }
  Line caught{"folded against the spring", {}, {}}, clutched{"spring let go", {}, {}};
  Line caught_j = caught, clutched_j = clutched;
  for (const energy::Point& p : r.energy.points) {
    const auto add = [&](const std::optional<energy::Settled>& robot, Line& torque, Line& joules) {
      if (!robot) return;
      torque.x.push_back(100.0 * p.contraction_m);
      torque.y.push_back(robot->energy.peak_torque_flight_nm);
      joules.x.push_back(100.0 * p.contraction_m);
      joules.y.push_back(energy::cost_j(robot->energy, energy::Measure::mechanical));
    };
    add(p.caught, caught, caught_j);
    add(p.clutched, clutched, clutched_j);
  }
  const std::vector<double> at_cm = scaled(r.contraction_m, 100.0);
  return line_plot_html({"Fig. 5.6: encoder of the pulley, counts of 2400 a turn", "time, ms", {travel}}) +
         line_plot_html(
             {"Fig. 5.10a: energy a hop, J",
              "contraction, cm",
              {{"k A^2 / 2 against the spring", at_cm, r.spring_work_j},
               {"coil, as published", at_cm, std::vector<double>(at_cm.size(), r.energy.published.coil_j)}},
              true}) +
         line_plot_html({"Energy a hop of the simulated robots, motor and coil, J",
                         "contraction, cm",
                         {caught_j, clutched_j},
                         true}) +
         line_plot_html(
             {"Fig. 5.11: largest torque in flight, N m", "contraction, cm", {caught, clutched}, true});
}

}  // namespace

std::string render_reproduction_report(const Reproduction& r, const std::string& command) {
  report::Page page;
  page.title = "Document 002, reproduced";
  page.command = command;
  const std::size_t put_in = count(r.rows, Outcome::by_construction);
  const std::size_t printed = r.rows.size() - count(r.rows, Outcome::computed) - put_in;
  const IdentificationStudy& s = r.study;
  page.body_html =
      "<header>\n<p class=\"eyebrow\">Design and experimental verification of a clutched parallel elastic "
      "actuation mechanism for legged locomotion</p>\n<h1>Of " +
      std::to_string(printed) + " printed figures that were computed " +
      std::to_string(count(r.rows, Outcome::met)) + " are met, " +
      std::to_string(count(r.rows, Outcome::smaller)) + " errors are smaller, " +
      std::to_string(count(r.rows, Outcome::explained)) + " differ for a reason that was computed" +
      (count(r.rows, Outcome::differs) == 0
           ? "."
           : ", " + std::to_string(count(r.rows, Outcome::differs)) + " differ.") +
      "</h1>\n<p>" + std::to_string(put_in) +
      " more come out by construction: they were put in, or chosen to come out so, and do not count. What is not "
      "computed is <a href=\"#omissions\">listed below</a>.</p>\n</header>\n" +
      report::key_figures(
          {{"Recordings identified", std::to_string(s.stance.errors.size() + s.flight.errors.size()),
            "of a rig whose parameters are drawn (seed " + std::to_string(r.options.seed) +
                ") and shown to no fit"},
           {"Time of the study", number(s.seconds, 2) + "&#8239;<small>s</small>",
            "all fits, folds and predictions of chapter 4"},
           {"Caught after",
            number(1e3 * r.release_catch.standard.caught_after_s, 2) + "&#8239;<small>ms</small>",
            "1 kg, 40 ms after the release; printed 20 to 50 (by construction)"},
           {"Break-even", number(100.0 * r.energy.published.break_even_m, 3) + "&#8239;<small>cm</small>",
            "of contraction, by the document's accounting; printed near 10 (by construction)"}}) +
      report::section("table", "Printed and computed", rows_html(r.rows)) +
      report::section("causes", "Cause by cause", causes_table(r)) +
      report::section("omissions", "Not computed", omissions_table(r)) +
      report::section("chapter-3", "Chapter 3: the models", chapter_3(r)) +
      report::section("chapter-4", "Chapter 4: identification", chapter_4(r)) +
      report::section("plain", "What the same fits cost the plain way", plain_table(s)) +
      report::section("chapter-5", "Chapter 5: the clutch", chapter_5(r));
  return report::render(page);
}

}  // namespace furcula::reproduce
