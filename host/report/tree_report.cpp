// What stands on the page of a diagnosis of a tree, from top to bottom.
#include "host/report/tree_report.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/report/force_plot.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"
#include "host/report/verdict_words.hpp"

namespace furcula::report {
namespace {

using dynamics::tree::Frame;
using dynamics::tree::Mat3;
using dynamics::tree::Vec3;
using nlohmann::json;
using trees::ChannelError;
using trees::Diagnosis;
using trees::Finding;
using trees::Seat;

constexpr const char* kArrow = " <span class=\"arrow\">&#8594;</span> ";
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

std::string unit_of(const Diagnosis& d, std::size_t joint) { return d.model.prismatic(joint) ? "m" : "rad"; }
const std::string& joint_name(const Diagnosis& d, std::size_t joint) {
  return d.model.robot.joints[joint].name;
}

double rmse(const std::vector<ChannelError>& errors, std::size_t joint) {
  return joint < errors.size() ? errors[joint].rmse : kNothing;
}
double mean_nmse(const std::vector<ChannelError>& errors) {
  double sum = 0.0;
  for (const ChannelError& e : errors) sum += e.nmse;
  return errors.empty() ? kNothing : sum / static_cast<double>(errors.size());
}

/// "a &rarr; b &rarr; c unit", the last one large.
std::string steps(const std::vector<double>& values, const Scale& s) {
  std::string out = "<small>";
  for (std::size_t i = 0; i + 1 < values.size(); ++i) out += number(s.factor * values[i], 2) + kArrow;
  return out + "</small>" + number(s.factor * values.back(), 2) +
         (s.unit.empty() ? "" : "&#8239;<small>" + escape(s.unit) + "</small>");
}

std::string header(const Diagnosis& d) {
  const VerdictWords v = words(d.verdict);
  std::string out =
      "<header>\n<p class=\"eyebrow\">Diagnosis of a simulation against measurements &middot; robot <code>" +
      escape(d.model.robot.name) + "</code>, " + std::to_string(d.model.joints()) +
      (d.model.joints() == 1 ? " joint" : " joints") + "</p>\n";
  out += "<p>" + badge(v.title, v.tone) + "</p>\n<h1>" + escape(d.summary.empty() ? v.meaning : d.summary) +
         "</h1>\n";
  if (!d.summary.empty()) out += "<p class=\"lead\">" + escape(v.meaning) + "</p>\n";
  for (const std::string& note : d.notes) out += "<p class=\"hint\">" + escape(note) + "</p>\n";
  return out + "</header>\n";
}

std::string figures(const Diagnosis& d) {
  const bool found = !d.findings.empty();
  const auto of_models = [&](double given, double refitted, double extended) {
    std::vector<double> out{given, refitted};
    if (found) out.push_back(extended);
    return out;
  };
  const std::string models = found ? "as given, re-fitted, extended" : "as given, re-fitted";
  std::vector<KeyFigure> list;
  double floor = 0.0;
  for (const double v : d.noise_floor) floor += v / static_cast<double>(d.noise_floor.size());
  list.push_back(
      {"Error, mean of all joints (NMSE)",
       steps(of_models(mean_nmse(d.as_given_error), mean_nmse(d.refitted_error), mean_nmse(d.extended_error)),
             {1.0, ""}),
       models + "; on recordings that no fit has seen" +
           (d.noise_floor.empty() ? "" : "; the noise floor is " + number(floor, 2))});
  if (!d.refitted_error.empty()) {
    const auto worst = static_cast<std::size_t>(
        std::max_element(d.refitted_error.begin(), d.refitted_error.end(),
                         [](const ChannelError& a, const ChannelError& b) { return a.nmse < b.nmse; }) -
        d.refitted_error.begin());
    const std::vector<double> v = of_models(rmse(d.as_given_error, worst), rmse(d.refitted_error, worst),
                                            rmse(d.extended_error, worst));
    list.push_back({"Error of " + joint_name(d, worst) + " (RMSE)", steps(v, scale_for(v, unit_of(d, worst))),
                    "the joint that the re-fitted model gets most wrong; " + models});
  }
  list.push_back({"Still unexplained", escape(percent(d.unexplained_share)),
                  "of the missing torque that a law of the state could foretell"});
  return key_figures(list);
}

// The robot: what robot_script draws.

json numbers(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
/// By rows, from the frame's coordinates to those of its parent.
json turn_back(const Mat3<double>& m) {
  return {m.x.x, m.y.x, m.z.x, m.x.y, m.y.y, m.z.y, m.x.z, m.y.z, m.z.z};
}

/// "1 dry friction" of each finding that sits there; empty: none.
std::string blamed(const Diagnosis& d, Seat seat, std::size_t site) {
  std::string out;
  for (std::size_t k = 0; k < d.findings.size(); ++k) {
    const trees::Cause& c = d.findings[k].cause;
    const trees::EffectInfo& e = trees::info(c.effect);
    // Joints, their drives and their encoders are one place of the picture.
    const auto place = [](Seat of) { return trees::is_of_joints(of) ? Seat::joint : of; };
    const bool here =
        place(e.seat) == place(seat) && std::find(c.sites.begin(), c.sites.end(), site) != c.sites.end();
    if (here)
      out += (out.empty() ? trees::site_name(d.model, seat, site) + ": " : "; ") + std::to_string(k + 1) +
             " " + in_words(e.name);
  }
  return out;
}

/// The box of even density with the mass and the inertia of a link, in the link frame of the joint that moves it.
json box_of(const Diagnosis& d, std::size_t link) {
  const model::RobotTree::Link& at = d.model.robot.links[link];
  const model::UrdfInertia& inertia = *d.model.urdf.links[link].inertia;
  const auto& s = inertia.about_centre_kgm2;
  Eigen::Matrix3d m;
  m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  const Eigen::Vector3d& i = solver.eigenvalues();
  json half = json::array();
  // I1 = m (b^2 + c^2) / 12 with the edges a, b, c, and so on.
  for (int k = 0; k < 3; ++k)
    half.push_back(0.5 * std::sqrt(std::max(0.0, 6.0 * (i.sum() - 2.0 * i(k)) / inertia.mass_kg)));
  const Mat3<double> turn{{axes(0, 0), axes(1, 0), axes(2, 0)},
                          {axes(0, 1), axes(1, 1), axes(2, 1)},
                          {axes(0, 2), axes(1, 2), axes(2, 2)}};
  const Frame<double> frame = within(within(at.frame, inertia.frame), Frame<double>{turn, {0.0, 0.0, 0.0}});
  return {{"joint", at.joint},
          {"turn", turn_back(frame.turn)},
          {"at", numbers(frame.at)},
          {"half", half},
          {"guilty", blamed(d, Seat::link, link)}};
}

/// Lines from each body's origin to what hangs on it: next joints, links that are fixed to it; else to its centre of mass.
json bones(const Diagnosis& d) {
  const model::RobotTree& robot = d.model.robot;
  json out = json::array();
  for (int joint = -1; joint < static_cast<int>(robot.joints.size()); ++joint) {
    std::vector<Vec3<double>> ends;
    for (std::size_t k = 0; k < robot.joints.size(); ++k)
      if (robot.model.shape().parent(k) == joint) ends.push_back(robot.joints[k].placement.at);
    bool guilty = false;
    for (std::size_t k = 0; k < robot.links.size(); ++k) {
      if (robot.links[k].joint != joint) continue;
      guilty |= joint >= 0 && !blamed(d, Seat::link, k).empty();
      if (joint >= 0) ends.push_back(robot.links[k].frame.at);
    }
    const auto far = [](const Vec3<double>& v) { return dot(v, v) > 1e-8; };
    if (joint >= 0 && std::none_of(ends.begin(), ends.end(), far)) {
      const auto body = robot.model.body(static_cast<std::size_t>(joint));
      if (body.mass_kg != 0.0) ends = {body.moment_kgm * (1.0 / body.mass_kg)};
    }
    for (const Vec3<double>& end : ends)
      if (far(end))
        out.push_back(
            {{"joint", joint}, {"from", {0.0, 0.0, 0.0}}, {"to", numbers(end)}, {"guilty", guilty}});
  }
  return out;
}

/// At most so many numbers in all motions together.
constexpr std::size_t kMostMotionNumbers = 80000;

json motions(const Diagnosis& d) {
  std::size_t numbers_in_all = 0;
  for (const trees::Motion& m : d.motions) numbers_in_all += 2 * m.time_s.size() * d.model.joints();
  const std::size_t stride = 1 + numbers_in_all / kMostMotionNumbers;
  const auto rounded = [](double v) { return std::isfinite(v) ? json(std::round(v * 1e5) / 1e5) : json(); };
  json out = json::array();
  for (const trees::Motion& m : d.motions) {
    const auto thinned = [&](const std::vector<double>& column) {
      json values = json::array();
      for (std::size_t i = 0; i < column.size(); i += stride) values.push_back(rounded(column[i]));
      return values;
    };
    const auto all = [&](const std::vector<std::vector<double>>& columns) {
      json list = json::array();
      for (const auto& column : columns) list.push_back(thinned(column));
      return list;
    };
    if (m.time_s.size() < 2 || m.measured.size() != d.model.joints() ||
        m.simulated.size() != d.model.joints())
      continue;
    out.push_back({{"log", m.log},
                   {"time", thinned(m.time_s)},
                   {"measured", all(m.measured)},
                   {"simulated", all(m.simulated)}});
  }
  return out;
}

json robot_data(const Diagnosis& d) {
  const model::RobotTree& robot = d.model.robot;
  json joints = json::array(), boxes = json::array(), loads = json::array();
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const model::RobotTree::Joint& j = robot.joints[i];
    joints.push_back({{"name", j.name},
                      {"parent", robot.model.shape().parent(i)},
                      {"slides", d.model.prismatic(i)},
                      {"turn", turn_back(j.placement.turn)},
                      {"at", numbers(j.placement.at)},
                      {"axis", numbers(j.axis)},
                      {"guilty", blamed(d, Seat::joint, i)}});
  }
  for (const std::size_t i : trees::sites(d.model, Seat::link)) boxes.push_back(box_of(d, i));
  for (const trees::Cause& c : d.extended.causes)
    for (const std::size_t site : c.sites)
      if (c.effect == trees::Effect::payload)
        loads.push_back({{"joint", robot.links[site].joint},
                         {"at", numbers(robot.links[site].frame.point_back(
                                    Vec3<double>{c.values[1], c.values[2], c.values[3]}))}});
  return {{"joints", joints},
          {"boxes", boxes},
          {"bones", bones(d)},
          {"loads", loads},
          {"motions", motions(d)},
          {"base", blamed(d, Seat::base, 0)},
          {"rest", std::vector<double>(robot.joints.size(), 0.0)}};
}

std::string robot_html(const Diagnosis& d, const json& robot) {
  const bool moves = !robot["motions"].empty();
  std::string out = "<div class=\"legend\">";
  if (moves)
    out +=
        "<span class=\"key measured-key\">measured</span><span class=\"key simulated-key\">simulated, extended model</span>";
  if (!d.findings.empty())
    out += "<span class=\"key before-key\">where a cause sits, with its number below</span>";
  if (!robot["loads"].empty()) out += "<span class=\"key load-key\">payload</span>";
  out +=
      "</div>\n<div class=\"robot\"><canvas id=\"robot-canvas\" tabindex=\"0\" role=\"img\" aria-label=\"The robot, "
      "measured and simulated pose. Arrow keys turn it, plus and minus zoom, space plays.\"></canvas></div>\n";
  if (moves)
    out +=
        "<div class=\"player\"><button type=\"button\" id=\"robot-play\">Play</button>"
        "<input type=\"range\" id=\"robot-slider\" aria-label=\"time\"><output id=\"robot-time\"></output>"
        "<label>Speed <select id=\"robot-speed\"><option value=\"0.1\">0.1</option><option value=\"0.25\">0.25</option>"
        "<option value=\"0.5\">0.5</option><option value=\"1\" selected>1</option><option value=\"2\">2</option>"
        "<option value=\"5\">5</option></select></label></div>\n";
  out += "<div class=\"player\">";
  if (moves)
    out +=
        "<label id=\"robot-log-label\">Recording <select id=\"robot-log\"></select></label>"
        "<label>Show <select id=\"robot-mode\"><option value=\"over\">one over the other</option>"
        "<option value=\"beside\">side by side</option><option value=\"measured\">measured alone</option>"
        "<option value=\"simulated\">simulated alone</option></select></label>";
  out +=
      "<label><input type=\"checkbox\" id=\"robot-names\"> all names</label>"
      "<button type=\"button\" id=\"robot-nearer\" title=\"nearer\">+</button>"
      "<button type=\"button\" id=\"robot-further\" title=\"further away\">&#8722;</button>"
      "<button type=\"button\" id=\"robot-home\">Reset view</button></div>\n";
  if (moves) out += "<p class=\"hint\" id=\"robot-difference\"></p>\n";
  out +=
      "<p class=\"hint screen-only\">Drag to turn, pinch to zoom; after a click the wheel zooms, arrow keys turn, + and &#8722; zoom, "
      "space plays. Thick lines join the joints, boxes have the mass and the inertia of the links in the URDF.</p>\n";
  return out;
}

// The findings.

std::string estimates(const std::vector<trees::Estimate>& parameters) {
  Table table({{"Parameter"}, {"Value (95 % interval)", true}, {"Unit"}});
  for (const trees::Estimate& e : parameters)
    table.add(
        {"<code>" + escape(e.name) + "</code>", with_interval(e.value, e.lower, e.upper), escape(e.unit)});
  return table.empty() ? "" : table.html();
}

std::string rivals(const std::vector<trees::RivalText>& list) {
  std::string out = "<ul>\n";
  for (const trees::RivalText& r : list) {
    std::string causes, values;
    for (const std::string& c : r.causes)
      causes += (causes.empty() ? "" : " + ") + ("<code>" + escape(c) + "</code>");
    for (const trees::Estimate& e : r.parameters)
      values += (values.empty() ? "" : ", ") + escape(e.name) + " = " +
                with_interval(e.value, e.lower, e.upper) + (e.unit.empty() ? "" : " " + escape(e.unit));
    out += "<li>" + (causes.empty() ? "nothing: the model as it is, re-fitted" : causes);
    if (!values.empty()) out += " <small>" + values + "</small>";
    if (!r.why.empty()) out += ": " + escape(r.why);
    out += "</li>\n";
  }
  return out + "</ul>\n";
}

std::string places(const Finding& f) {
  const Seat seat = trees::info(f.cause.effect).seat;
  if (seat == Seat::base || seat == Seat::log) return std::string(trees::name(seat));
  std::string out(seat == Seat::link      ? "link"
                  : seat == Seat::drive   ? "drive of"
                  : seat == Seat::encoder ? "encoder of"
                                          : "joint");
  for (std::size_t i = 0; i < f.at.size(); ++i) out += (i > 0 ? ", " : " ") + f.at[i];
  return out;
}

/// The joint whose error grows most without the finding.
std::string what_it_is_worth(const Diagnosis& d, const Finding& f) {
  std::string out = f.explainable_removed > 0.0
                        ? share_bar(f.explainable_removed) + " of the error that can be explained."
                        : "Nothing of the error that can be explained.";
  std::size_t worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  const std::size_t n = std::min({f.without.size(), d.extended_error.size(), d.model.joints()});
  if (n == 0) return out;
  for (std::size_t i = 0; i < n; ++i)
    if (f.without[i].nmse - d.extended_error[i].nmse > most) {
      most = f.without[i].nmse - d.extended_error[i].nmse;
      worst = i;
    }
  const double without = f.without[worst].rmse, with = d.extended_error[worst].rmse;
  const Scale s = scale_for({without, with}, unit_of(d, worst));
  return out + " Without it, all else fitted again, the error of " + escape(joint_name(d, worst)) +
         " on the held-out recordings (RMSE) is " + number(s.factor * without, 2) + " " + s.unit +
         "; with it " + number(s.factor * with, 2) + " " + s.unit + ".";
}

std::string finding(const Diagnosis& d, std::size_t place) {
  const Finding& f = d.findings[place];
  const trees::EffectInfo& e = trees::info(f.cause.effect);
  std::string out = "<article class=\"finding\">\n<h3><span class=\"place\">" + std::to_string(place + 1) +
                    "</span> " + escape(in_words(e.name)) + ", " + escape(places(f)) + " <code>" +
                    escape(trees::cause_name(d.model, f.cause)) + "</code></h3>\n";
  out += "<p class=\"plain\">" + escape(f.explanation.empty() ? e.explanation : f.explanation) + "</p>\n";
  out += "<div class=\"columns\"><div>\n<h4>Where to look on the machine</h4>\n" +
         paragraph(f.where_to_look.empty() ? e.where_to_look : f.where_to_look);
  out += "<h4>The law</h4>\n<p><code>" + escape(e.law) + "</code></p>\n" + estimates(f.parameters) +
         "</div>\n<div>\n";
  out += "<h4>What it explains</h4>\n<p>" + what_it_is_worth(d, f) + "</p>\n";
  out += "<h4>Confidence</h4>\n<p>" + share_bar(f.confidence) + "</p>\n";
  const std::string_view experiment = f.next_experiment.empty() ? e.experiment : f.next_experiment;
  if (!experiment.empty()) out += "<h4>To be sure</h4>\n" + paragraph(experiment);
  out += "</div></div>\n";
  if (!f.indistinguishable_from.empty())
    out += "<div class=\"aside\"><h4>These recordings cannot tell it from</h4>\n" +
           rivals(f.indistinguishable_from) + "</div>\n";
  if (!f.alternatives.empty()) out += "<h4>In its place, these do worse</h4>\n" + rivals(f.alternatives);
  return out + "</article>\n";
}

std::string findings(const Diagnosis& d) {
  if (d.findings.empty())
    return paragraph(d.verdict == Verdict::adequate
                         ? "None. Free parameters may have moved within their bounds; that is identification."
                         : "None: no effect of the catalogue is supported by these recordings.");
  std::string out;
  for (std::size_t i = 0; i < d.findings.size(); ++i) out += finding(d, i);
  return out;
}

// Joint by joint.

std::string missing_torque(const Diagnosis& d) {
  constexpr std::size_t kMostPoints = 5000, kFewestPoints = 250;  // of all joints, and of one
  const std::size_t points =
      std::max(kFewestPoints, kMostPoints / std::max<std::size_t>(1, d.missing.size()));
  std::string out;
  for (std::size_t i = 0; i < std::min(d.missing.size(), d.model.joints()); ++i) {
    const trees::MissingTorque& m = d.missing[i];
    const bool slides = d.model.prismatic(i);
    const std::string unit = slides ? "N" : "N m";
    const std::string plots =
        missing_force_plots({m.time_s, m.velocity_radps, m.angle_rad, m.before_nm, m.after_nm, unit,
                             slides ? "m/s" : "rad/s", slides ? "m" : "rad"},
                            points);
    if (plots.empty()) continue;
    out += "<div class=\"joint\"><h3>" + escape(joint_name(d, i)) + " <small>RMS " +
           number(m.rms_before_nm, 2) + kArrow + number(m.rms_after_nm, 2) + " " + unit + ", of " +
           number(m.rms_torque_nm, 2) + " " + unit + " that the joint takes</small></h3>\n" + plots +
           "<p class=\"hint\">A flexible law of the state foretells " +
           escape(percent(m.predictable_before)) + " of its square before, " +
           escape(percent(m.predictable_after)) + " after." +
           (m.goes_along_with.empty() ? ""
                                      : " What is left goes along with " + escape(m.goes_along_with) + ".") +
           "</p></div>\n";
  }
  if (out.empty()) return "";
  return "<p>What inverse dynamics of the measured motion asks for, less what drive and friction give: a model that is right lacks "
         "noise alone.</p>\n<div class=\"legend\"><span class=\"key before-key\">model re-fitted</span>"
         "<span class=\"key after-key\">extended</span><span>dots: samples; lines: means, with one standard deviation "
         "to both sides</span></div>\n" +
         out;
}

std::string joints_table(const Diagnosis& d) {
  Table table({{"Joint"},
               {"Error as given", true},
               {"Re-fitted", true},
               {"Extended", true},
               {"Unit"},
               {"NMSE extended", true},
               {"Noise floor", true},
               {"Missing torque before", true},
               {"After", true},
               {"Unit"}});
  for (std::size_t i = 0; i < d.model.joints(); ++i) {
    const std::vector<double> v{rmse(d.as_given_error, i), rmse(d.refitted_error, i),
                                rmse(d.extended_error, i)};
    const Scale s = scale_for(v, unit_of(d, i));
    const bool known = i < d.missing.size();
    table.add(
        {escape(joint_name(d, i)), number(s.factor * v[0]), number(s.factor * v[1]), number(s.factor * v[2]),
         escape(s.unit), number(i < d.extended_error.size() ? d.extended_error[i].nmse : kNothing),
         number(i < d.noise_floor.size() ? d.noise_floor[i] : kNothing),
         number(known ? d.missing[i].rms_before_nm : kNothing),
         number(known ? d.missing[i].rms_after_nm : kNothing), d.model.prismatic(i) ? "N" : "N m"},
        !blamed(d, Seat::joint, i).empty());
  }
  return "<p>Errors on the held-out recordings (RMSE), root mean squares of the missing torque. A cause sits at the marked "
         "joints.</p>\n" +
         table.html();
}

TraceData traces(const Diagnosis& d) {
  TracePlot plot;
  const bool extended = !d.findings.empty();
  plot.labels = {"measured", "as given", "re-fitted"};
  if (extended) plot.labels.emplace_back("extended");
  for (const trees::Trace& t : d.traces) {
    TraceWindow w{t.log, t.joint, t.unit, t.time_s, {t.measured, t.as_given, t.refitted}};
    if (extended) w.values.emplace_back(t.extended);
    plot.windows.push_back(std::move(w));
  }
  return encode(plot);
}

std::string tried(const Diagnosis& d) {
  std::vector<const Diagnosis::Tried*> order;
  for (const Diagnosis::Tried& t : d.tried) order.push_back(&t);
  const auto gain = [](const Diagnosis::Tried* t) { return std::isfinite(t->gain) ? t->gain : -1e300; };
  std::stable_sort(order.begin(), order.end(), [&](const auto* a, const auto* b) {
    return a->chosen != b->chosen ? a->chosen : gain(a) > gain(b);
  });
  constexpr std::size_t kOpen = 12;
  const auto rows = [&](std::size_t from, std::size_t to) {
    Table table({{"Cause"}, {"Gain", true}, {"Outcome"}});
    for (std::size_t i = from; i < std::min(to, order.size()); ++i)
      table.add({"<code>" + escape(order[i]->cause) + "</code>", number(order[i]->gain),
                 order[i]->chosen ? "chosen" : ""},
                order[i]->chosen);
    return table.empty() ? std::string() : table.html();
  };
  std::string out = rows(0, kOpen);
  if (out.empty()) return "";
  if (order.size() > kOpen)
    out += "<details><summary>" + std::to_string(order.size() - kOpen) + " more</summary>\n" +
           rows(kOpen, order.size()) + "</details>\n";
  return "<p>Causes at their sites that the search fitted, and what each takes off the loss of the training windows.</p>\n" +
         out;
}

std::string parameters(const Diagnosis& d) {
  Table table(
      {{"Parameter"}, {"As given", true}, {"Re-fitted", true}, {"Extended", true}, {"Unit"}, {"Verdict"}});
  for (const Diagnosis::ParameterRow& p : d.parameters)
    table.add({"<code>" + escape(p.name) + "</code>", number(p.given, 4),
               with_interval(p.refitted.value, p.refitted.lower, p.refitted.upper),
               with_interval(p.extended.value, p.extended.lower, p.extended.upper), escape(p.unit),
               escape(p.verdict)});
  if (table.empty()) return "";
  return "<p>Free parameters, which may move within the bounds of the model file, with 95 % intervals.</p>\n" +
         table.html();
}

std::string base_parameters(const Diagnosis& d) {
  const bool extended = !d.findings.empty();
  std::vector<Table::Column> columns{{"Combination"}, {"As given", true}};
  if (extended) columns.push_back({"Extended", true});
  columns.insert(
      columns.end(),
      {{"Standard deviation", true}, {"Unit"}, {"Torque, RMS", true}, {"Unit"}, {"At joint"}, {"Shown"}});
  Table table(columns);
  for (const trees::BaseParameter& b : d.base_parameters) {
    std::vector<std::string> row{"<code>" + escape(b.combination) + "</code>", number(b.value)};
    if (extended) row.push_back(number(b.extended));
    row.insert(row.end(), {number(b.sd, 2), escape(b.unit), number(b.torque_rms_nm, 2),
                           d.model.prismatic(b.joint) ? "N" : "N m", escape(joint_name(d, b.joint)),
                           b.shown ? "yes" : "no"});
    table.add(row);
  }
  if (table.empty()) return "";
  constexpr std::size_t kOpen = 12;
  const bool open = d.base_parameters.size() <= kOpen;
  return "<p>The joints' torques depend on these combinations of the links' masses m, first moments mx, my, mz and moments of "
         "inertia about the origins of their frames, and on nothing else: no motion can part what stands in one. Lengths in "
         "m. The torque is at the joint where it is the largest share. A combination is shown if its standard deviation from these "
         "recordings, rotors and friction as in the extended model, is less than a tenth of it, or of what its first parameter can be in "
         "a body of this mass and size.</p>\n" +
         (open ? table.html()
               : "<details><summary>" + std::to_string(d.base_parameters.size()) +
                     " combinations</summary>\n" + table.html() + "</details>\n");
}

std::string data(const Diagnosis& d) {
  std::string out = "<p>" + std::to_string(d.logs) + " recordings, " + std::to_string(d.held_out_logs) +
                    " of them held out; " + std::to_string(d.samples) + " samples; " +
                    std::to_string(d.windows) + " windows of " + number(d.window_s) + " s.</p>\n";
  out += dirt_html(d.dirt);
  if (!d.training_files.empty()) out += "<h4>Fitted to</h4>\n" + file_list(d.training_files);
  if (!d.held_out_files.empty()) out += "<h4>Held out</h4>\n" + file_list(d.held_out_files);
  return out;
}

constexpr const char* kHowToRead =
    "<dl>"
    "<dt>NMSE</dt><dd>Sum of squared errors over the sum of squares about the mean: 0 is perfect, 1 is as good as a constant.</dd>"
    "<dt>RMSE</dt><dd>Root of the mean squared error, in the joint's unit.</dd>"
    "<dt>Window</dt><dd>The model starts each short window from the measured angles around it and then runs free.</dd>"
    "<dt>Held out</dt><dd>Recordings that no fit and no choice between causes has seen.</dd>"
    "<dt>Noise floor</dt><dd>What no model can remove: sensor noise and the start's uncertainty.</dd>"
    "<dt>As given, re-fitted, extended</dt><dd>The model file as it was; the same with its free parameters fitted again; and with the "
    "named causes switched on, all fitted together.</dd>"
    "<dt>Cause</dt><dd><code>effect@site</code>: a law of the catalogue at a joint, a drive, an encoder, a link or the base.</dd>"
    "<dt>Missing torque</dt><dd>What inverse dynamics of the measured motion asks of a joint, less what the model's drive and friction "
    "give.</dd>"
    "<dt>95 % interval</dt><dd>The range in which the parameter lies with that probability, if the model is right.</dd></dl>\n";

}  // namespace

std::string render_tree_report(const Diagnosis& d, const std::string& command) {
  const TraceData trace_data = traces(d);
  const json robot = robot_data(d);
  std::string body = header(d) + figures(d);
  body += section("robot", "The robot", robot_html(d, robot));
  body += section("findings", d.findings.size() == 1 ? "The cause" : "The causes", findings(d));
  body += section("next", "What to do next", paragraph(d.next_experiment));
  body += section("missing", "The torque that the model lacks", missing_torque(d));
  body += section("joints", "Joint by joint", joints_table(d));
  body += section("traces", "Measured against simulated, held-out recordings", trace_plot_html(trace_data));
  body += section("tried", "What was tried", tried(d));
  body += section("parameters", "Parameters", parameters(d));
  body += section("base-parameters", "What the torques tell of masses and inertias", base_parameters(d));
  body += section("data", "Data", data(d));
  body += section("reading", "How to read this page", kHowToRead);
  return render({"Furcula: " + (d.summary.empty() ? std::string(words(d.verdict).title) : d.summary), body,
                 trace_data.json, command, robot.dump(-1, ' ', false, json::error_handler_t::replace)});
}

}  // namespace furcula::report
