// What stands on the page of a diagnosis, from top to bottom. Sections without content are absent.
#include "host/report/diagnosis_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/report/diagnosis_tables.hpp"
#include "host/report/force_plot.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"
#include "host/report/verdict_words.hpp"

namespace furcula::report {
namespace {

using result::ChannelError;
using result::Diagnosis;
using result::Finding;
using result::kUnknown;

constexpr const char* kArrow = " <span class=\"arrow\">&#8594;</span> ";

double or_unknown(const ChannelError* e, double ChannelError::*member) { return e ? e->*member : kUnknown; }

std::string unit_of(const std::string& channel, const Diagnosis& d) {
  const ChannelError* e = find(d.baseline, channel);
  return e && !e->unit.empty() ? e->unit : d.main_unit;
}

bool is_wrong_parameter(const Finding& f) { return f.title.starts_with("the "); }

std::string joined(const std::vector<std::string>& all) {
  std::string out;
  for (std::size_t i = 0; i < all.size(); ++i)
    out += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i];
  return out;
}

/// "dry friction at elbow and wrist".
std::string title_with_place(const Finding& f) {
  if (f.cause.location_type.empty()) return f.title;
  return f.title + (f.cause.location_type == "log" ? " in the log" : " at " + joined(f.cause.locations));
}

/// ", encoder of elbow, wrist"; nothing on machines with one joint.
std::string place(const result::Cause& c) {
  const std::string& type = c.location_type;
  if (type.empty() || type == "base" || type == "log") return type.empty() ? "" : ", " + type;
  std::string out = ", " + type + (type == "joint" || type == "link" ? "" : " of");
  for (std::size_t i = 0; i < c.locations.size(); ++i) out += (i > 0 ? ", " : " ") + c.locations[i];
  return out;
}

/// "dry friction <code>coulomb_friction</code>: 1.61 N", of each finding, and what would do as well in its
/// place.
std::string list_of_causes(const Diagnosis& d) {
  std::string out = "<ul>\n";
  for (const Finding& f : d.findings) {
    std::string values;
    const bool several = f.cause.parameters.size() > 1;
    for (const result::Estimate& e : f.cause.parameters)
      values += (values.empty() ? ": " : ", ") + (several ? e.name + " " : "") + number(e.value) +
                (e.unit.empty() ? "" : " " + e.unit);
    out += "<li>" + escape(f.title) + " <code>" + escape(label(f.cause)) + "</code>" + escape(values);
    const auto& rivals = f.indistinguishable_from;
    const auto other = std::find_if(rivals.begin(), rivals.end(), [](const auto& r) { return !r.same_law; });
    if (f.undecided && other != rivals.end())
      out += "; not certain: in its place <code>" + escape(label(other->causes)) + "</code> would do as well";
    out += "</li>\n";
  }
  return out + "</ul>\n";
}

bool any_undecided(const Diagnosis& d) {
  return std::any_of(d.findings.begin(), d.findings.end(), [](const auto& f) { return f.undecided; });
}

/// Several causes do not fit into one headline: the first, how many more, and the list below it.
std::string headline(const Diagnosis& d) {
  if (d.findings.size() < 2) return d.summary.empty() ? words(d.verdict).meaning : d.summary;
  const Finding& first = d.findings.front();
  const std::string title = title_with_place(first), more = std::to_string(d.findings.size() - 1) + " more";
  const bool believed =
      std::any_of(d.findings.begin(), d.findings.end(), [](const Finding& f) { return f.confidence >= 0.5; });
  if (d.verdict == Verdict::not_identifiable || !believed) return "Not certain: " + title + ", and " + more;
  if (is_wrong_parameter(first)) return "T" + title.substr(1) + " is wrong, and " + more;
  return "The model lacks " + title + ", and " + more;
}

/// What the named causes do to the error, in the figure of the headline of a single cause.
std::string fall_of_error(const Diagnosis& d) {
  const std::string& channel = d.main_channel;
  const double before = or_unknown(find(d.refitted, channel), &ChannelError::rmse);
  const double after = or_unknown(find(d.extended, channel), &ChannelError::rmse);
  const double floor = or_unknown(find(d.noise_floor, channel), &ChannelError::rmse);
  if (!std::isfinite(before) || !std::isfinite(after)) return "";
  const Scale s = scale_for({before, after}, unit_of(channel, d));
  return " With them the error of " + channel + " on the held-out recordings (RMSE) goes from " +
         number(s.factor * before) + " to " + number(s.factor * after) + " " + s.unit +
         (floor > 0.0 ? "; the noise floor is " + number(s.factor * floor) + " " + s.unit : "") + ".";
}

std::string header(const Diagnosis& d) {
  const VerdictWords v = words(d.verdict);
  std::string out = "<header>\n<p class=\"eyebrow\">Diagnosis of a simulation against measurements &middot; ";
  if (d.robot.empty())
    out += "model <code>" + escape(d.kind) + "</code></p>\n";
  else
    out += "robot <code>" + escape(d.robot) + "</code>, " + std::to_string(d.joints) +
           (d.joints == 1 ? " joint" : " joints") + "</p>\n";
  out += "<p>" + badge(v.title, v.tone) + "</p>\n<h1>" + escape(headline(d)) + "</h1>\n";
  if (d.findings.size() > 1) {
    // Not identifiable without a rival: the held-out recordings refute the causes, and the summary says how.
    const bool refuted = d.verdict == Verdict::not_identifiable && !any_undecided(d);
    const std::string lead = refuted ? d.summary : v.meaning + fall_of_error(d);
    out += list_of_causes(d) + "<p class=\"lead\">" + escape(lead) + "</p>\n";
  } else if (!d.summary.empty()) {
    out += "<p class=\"lead\">" + escape(v.meaning) + "</p>\n";
  }
  for (const std::string& note : d.notes) out += "<p class=\"hint\">" + escape(note) + "</p>\n";
  return out + "</header>\n";
}

std::string figures(const Diagnosis& d) {
  const std::string& channel = d.main_channel;
  const ChannelError *given = find(d.baseline, channel), *refitted = find(d.refitted, channel),
                     *extended = find(d.extended, channel), *floor = find(d.noise_floor, channel);
  // Without a finding the extended model is the re-fitted one.
  const bool found = !d.findings.empty();
  const auto steps = [&](double ChannelError::*member, const std::string& unit) {
    std::vector<double> v{or_unknown(given, member), or_unknown(refitted, member)};
    if (found) v.push_back(or_unknown(extended, member));
    const Scale s = scale_for(v, unit);
    std::string out = "<small>";
    for (std::size_t i = 0; i + 1 < v.size(); ++i) out += number(s.factor * v[i], 2) + kArrow;
    return out + "</small>" + number(s.factor * v.back(), 2) +
           (s.unit.empty() ? "" : "&#8239;<small>" + escape(s.unit) + "</small>");
  };
  std::vector<KeyFigure> list;
  list.push_back(
      {"Error of " + channel + " (RMSE)", steps(&ChannelError::rmse, unit_of(channel, d)),
       std::string(found ? "as given, re-fitted, extended" : "as given, re-fitted") +
           "; on recordings that no fit has seen" +
           (d.joints > 1 ? "; of all channels the re-fitted model gets this one most wrong" : "")});
  list.push_back({"NMSE of " + channel, steps(&ChannelError::nmse, ""),
                  std::string("the same ") + (found ? "three" : "two") +
                      (floor ? "; the noise floor is " + number(floor->nmse, 2) : "")});
  if (!d.robot.empty())
    list.push_back({"Still unexplained", escape(percent(d.unexplained_fraction_of_force)),
                    "of the missing torque that a flexible model of the state could predict"});
  else
    list.push_back({"Still unexplained", escape(percent(d.unexplained_fraction_of_nmse)),
                    d.only_noise_left.value_or(true)
                        ? "of the error above the noise; what remains looks random"
                        : "of the error above the noise; what remains has structure"});
  return key_figures(list);
}

/// Where the error of the model as given went: one bar of shares.
std::string budget(const Diagnosis& d) {
  const std::string& channel = d.main_channel;
  const double given = or_unknown(find(d.baseline, channel), &ChannelError::nmse);
  const double refitted = or_unknown(find(d.refitted, channel), &ChannelError::nmse);
  const double extended = or_unknown(find(d.extended, channel), &ChannelError::nmse);
  const ChannelError* floor = find(d.noise_floor, channel);
  if (!(given > 0.0) || !std::isfinite(refitted) || !std::isfinite(extended)) return "";
  // A model that does worse than the one before it has removed nothing that a bar could show.
  constexpr double kWorse = 1.01;
  if (extended > kWorse * refitted)
    return paragraph(
        "On the held-out recordings the extended model does worse than the re-fitted one: none of the squared error of " +
        channel + " is removed by what is named.");
  if (refitted > kWorse * given)
    return paragraph(
        "On the held-out recordings the re-fitted model does worse than the one as given: no share of the squared error of " +
        channel + " is removed by re-fitting.");
  // Each step can only take away from what the step before left; a held-out error may also grow a little.
  const double after_fit = std::clamp(refitted, 0.0, given);
  const double after_causes = std::clamp(extended, 0.0, after_fit);
  const double noise = std::clamp(floor ? floor->nmse : 0.0, 0.0, after_causes);
  struct Part {
    const char* style;
    const char* label;
    double share;
  };
  const Part parts[] = {{"refit", "removed by re-fitting free parameters", (given - after_fit) / given},
                        {"cause", "removed by the named causes", (after_fit - after_causes) / given},
                        {"rest", "remains, above the noise", (after_causes - noise) / given},
                        {"noise", "noise of the recordings", noise / given}};
  std::string bar, key;
  for (const Part& p : parts) {
    if (!(p.share > 0.0)) continue;
    bar += "<span class=\"" + std::string(p.style) + "\" style=\"flex-grow:" + std::to_string(p.share) +
           "\"></span>";
    key += "<span class=\"key " + std::string(p.style) + "-key\">" + p.label + ": " +
           escape(percent(p.share)) + "</span>";
  }
  return "<figure class=\"budget\"><figcaption>Where the squared error of " + escape(channel) +
         " goes (held-out NMSE of the model as given = 100 %)</figcaption><div class=\"stack\">" + bar +
         "</div><div class=\"legend\">" + key + "</div></figure>\n";
}

// The findings.

std::string estimates(const std::vector<result::Estimate>& parameters) {
  Table table({{"Parameter"}, {"Value (95 % interval)", true}, {"Unit"}});
  for (const result::Estimate& e : parameters)
    table.add(
        {"<code>" + escape(e.name) + "</code>", with_interval(e.value, e.lower, e.upper), escape(e.unit)});
  return table.empty() ? "" : table.html();
}

std::string rivals(const std::vector<result::Rival>& list) {
  std::string out = "<ul>\n";
  for (const result::Rival& r : list) {
    out += "<li>" + names_html(r.causes);
    std::string values;
    for (const auto* causes : {&r.causes, &r.retained})
      for (const result::Cause& c : *causes)
        for (const result::Estimate& e : c.parameters)
          values += (values.empty() ? "" : ", ") +
                    escape(r.causes.size() + r.retained.size() == 1 ? e.name : label(c) + "." + e.name) +
                    " = " + with_interval(e.value, e.lower, e.upper) +
                    (e.unit.empty() ? "" : " " + escape(e.unit));
    if (!values.empty()) out += " <small>" + values + "</small>";
    if (!r.reason.empty()) out += ": " + escape(r.reason);
    out += "</li>\n";
  }
  return out + "</ul>\n";
}

/// The share that it removes, and the errors without and with it, of the channel that needs it most.
std::string what_it_is_worth(const Finding& f, const Diagnosis& d) {
  const bool of_training = std::isfinite(f.explainable_training_loss_removed);
  const double share = of_training ? f.explainable_training_loss_removed : f.explainable_nmse_removed;
  std::string out = of_training   ? share_bar(share) + " of what can be explained of the training recordings."
                    : share < 0.0 ? "Nothing on the held-out recordings: they are predicted worse with it."
                                  : share_bar(share) + " of what can be explained.";
  const auto most = std::max_element(f.gains.begin(), f.gains.end(), [](const auto& a, const auto& b) {
    return a.nmse_without - a.nmse_with < b.nmse_without - b.nmse_with;
  });
  if (most == f.gains.end()) return out;
  const Scale s =
      scale_for({most->mae_without, most->mae_with}, most->unit.empty() ? d.main_unit : most->unit);
  return out + " Without it, all else re-fitted, the mean absolute error (MAE) of " + escape(most->channel) +
         " on the held-out recordings is " + number(s.factor * most->mae_without, 2) + " " + escape(s.unit) +
         "; with it " + number(s.factor * most->mae_with, 2) + " " + escape(s.unit) + ".";
}

std::string finding(const Diagnosis& d, std::size_t index) {
  const Finding& f = d.findings[index];
  std::string out = "<article class=\"finding\">\n<h3><span class=\"place\">" + std::to_string(index + 1) +
                    "</span> " + escape(in_words(f.cause.effect) + place(f.cause)) + " <code>" +
                    escape(label(f.cause)) + "</code></h3>\n";
  out += "<p class=\"plain\">" + escape(f.explanation) + "</p>\n";
  out += "<div class=\"columns\"><div>\n<h4>Where to look on the machine</h4>\n" + paragraph(f.where_to_look);
  out += "<h4>Model</h4>\n<p><code>" + escape(f.law) + "</code>" +
         (f.phase.empty() ? "" : " <small>in " + escape(f.phase) + "</small>") + "</p>\n" +
         estimates(f.cause.parameters) + "</div>\n<div>\n";
  out += "<h4>What it explains</h4>\n<p>" + what_it_is_worth(f, d) + "</p>\n";
  out += "<h4>Confidence</h4>\n<p>" + share_bar(f.confidence) + "</p>\n";
  for (const std::string& why : f.confidence_lowered_by)
    out += "<p><small>Lowered: " + escape(why) + ".</small></p>\n";
  if (!f.next_experiment.empty()) out += "<h4>To be sure</h4>\n" + paragraph(f.next_experiment);
  out += "</div></div>\n";
  if (!f.indistinguishable_from.empty())
    out += "<div class=\"aside\"><h4>These recordings cannot distinguish it from</h4>\n" +
           rivals(f.indistinguishable_from) + "</div>\n";
  if (!f.alternatives.empty()) out += "<h4>Alternatives that do worse</h4>\n" + rivals(f.alternatives);
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

TraceData traces(const Diagnosis& d) {
  TracePlot plot;
  const bool extended = !d.findings.empty();
  plot.labels = {"measured", "as given", "re-fitted"};
  if (extended) plot.labels.emplace_back("extended");
  for (const result::Trace& t : d.traces) {
    TraceWindow w{t.log, t.channel, t.unit, t.time_s, {t.measured, t.as_given, t.refitted}};
    if (extended) w.values.emplace_back(t.extended);
    plot.windows.push_back(std::move(w));
  }
  return encode(plot);
}

/// The engine's advice on the whole; without it that of the findings.
std::string next_steps(const Diagnosis& d) {
  std::string out;
  if (!d.experiments.empty()) {
    constexpr std::size_t kRows = 6;
    Table table({{"Experiment"}, {"Recordings it takes", true}, {"Two nearest predictions differ by", true}});
    for (std::size_t i = 0; i < d.experiments.size() && i < kRows; ++i) {
      const result::Experiment& e = d.experiments[i];
      const Scale s = scale_for({e.rms_difference}, e.unit);
      table.add({escape(e.description),
                 !e.recordings        ? "&#8211;"
                 : *e.recordings > 99 ? "over 99"
                                      : std::to_string(*e.recordings),
                 number(s.factor * e.rms_difference) + " " + escape(s.unit)},
                i == 0);
    }
    out = std::string("<p>Each was simulated with the causes that these recordings cannot distinguish") +
          (d.experiments.front().scenario.empty()
               ? ""
               : "; the first one is in next_experiment.toml as a scenario for furcula sim") +
          ".</p>\n" + table.html();
  }
  if (!d.next_experiment.empty()) return paragraph(d.next_experiment) + out;
  for (const Finding& f : d.findings)
    if (!f.next_experiment.empty()) out += "<li>" + escape(f.next_experiment) + "</li>\n";
  return out.empty() ? "" : "<ol>\n" + out + "</ol>\n";
}

std::string how_to_read(const Diagnosis& d) {
  const bool robot = !d.robot.empty();
  return std::string(
             "<dl>"
             "<dt>NMSE</dt><dd>Sum of squared errors over the sum of squares about the window's mean: 0 is perfect, "
             "1 is as good as a constant.</dd>"
             "<dt>MAE, RMSE</dt><dd>Mean absolute error, and root of the mean squared error, in the channel's unit.</dd>"
             "<dt>Held out</dt><dd>Recordings that no fit and no choice between causes has seen. The model starts "
             "each window from its first measured samples and then runs free.</dd>"
             "<dt>Noise floor</dt><dd>What no model can remove: sensor noise and the start's uncertainty.</dd>"
             "<dt>As given, re-fitted, extended</dt><dd>The model file as it was; the same with its free parameters "
             "fitted again; and with the named causes switched on, all fitted together.</dd>") +
         (robot
              ? "<dt>Cause</dt><dd><code>effect@location</code>: an effect of the catalogue at a joint, a drive, an encoder, a link "
                "or the base.</dd>"
                "<dt>Missing torque</dt><dd>Inverse dynamics of the measured motion, less what the model's drive and friction "
                "give.</dd>"
              : "") +
         "<dt>95 % interval</dt><dd>The range in which the parameter lies with that probability, if the model is right.</dd></dl>\n";
}

}  // namespace

std::string render_report(const Diagnosis& d, const std::string& command, const RobotPicture& robot) {
  const TraceData trace_data = traces(d);
  std::string body = header(d) + figures(d) + budget(d) + errors_table(d) + recordings_table(d);
  body += section("robot", "The robot", robot.html);
  body += section("findings", d.findings.size() == 1 ? "The cause" : "The causes", findings(d));
  body += section("next", "What to do next", next_steps(d));
  body += section("traces", "Measured against simulated, held-out recordings", trace_plot_html(trace_data));
  body += section("force",
                  d.residual.unit == "N m" ? "The torque that the re-fitted model lacks"
                                           : "The force that the re-fitted model lacks",
                  force_plots(d.residual));
  body += section("missing", "The torque that the model lacks, joint by joint", missing_force_html(d));
  body += section("remains", "What remains", remains_html(d));
  body += section("candidates", d.findings.empty() ? "What was tried, without success" : "What was tried",
                  candidates_html(d));
  body += section("parameters", "Parameters", parameters_html(d));
  body += section("base-parameters", "What the torques tell of masses and inertias", base_parameters_html(d));
  body += section("data", "Data", data_html(d));
  body += section("reading", "How to read this page", how_to_read(d));
  return render({"Furcula: " + (d.summary.empty() ? std::string(words(d.verdict).title) : headline(d)), body,
                 trace_data.json, command, robot.json});
}

}  // namespace furcula::report
