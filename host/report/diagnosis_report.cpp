// What stands on the page of a diagnosis, from top to bottom.
#include "host/report/diagnosis_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/diagnose/diagnosis_json.hpp"
#include "host/diagnose/wording.hpp"
#include "host/report/force_plot.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"
#include "host/report/verdict_words.hpp"

namespace furcula::report {
namespace {

using diagnose::Diagnosis;

constexpr const char* kArrow = " <span class=\"arrow\">&#8594;</span> ";

const diagnose::ChannelErrors* find(const diagnose::Errors& errors, const std::string& channel) {
  const auto it = errors.find(channel);
  return it == errors.end() ? nullptr : &it->second;
}

double or_nan(const diagnose::ChannelErrors* e, double diagnose::ChannelErrors::*member) {
  return e ? e->*member : std::numeric_limits<double>::quiet_NaN();
}

std::string unit_of(const std::string& channel, const Diagnosis& d) {
  const std::string_view suffix = diagnose::channel_suffix(channel, d.kind);
  if (suffix == "mps") return "m/s";
  if (suffix == "radps") return "rad/s";
  if (suffix == "nm") return "N m";
  return suffix.empty() ? d.main_unit : std::string(suffix);
}

/// "a + b"
std::string joined(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& n : list) out += (out.empty() ? "" : " + ") + n;
  return out;
}

/// Names of effects in words; names of parameters as they stand in the model file.
std::string names(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& n : list) {
    if (!out.empty()) out += " + ";
    out += dynamics::effect_named(n) ? escape(in_words(n)) : "<code>" + escape(n) + "</code>";
  }
  return out.empty() ? "nothing: the model as it is, re-fitted" : out;
}

/// "dry friction <code>coulomb_friction</code>: 1.61 N", of each finding, and what would do as well in its
/// place.
std::string list_of_causes(const Diagnosis& d) {
  std::string out = "<ul>\n";
  for (const diagnose::Finding& f : d.findings) {
    const dynamics::EffectInfo& effect = dynamics::info(f.effect);
    std::string values;
    for (const dynamics::EffectParameterInfo& p : effect.parameters()) {
      const std::string name(dynamics::name_on(p, d.kind)), unit(dynamics::unit_on(p, d.kind));
      const auto found = f.parameters.find(name);
      if (found == f.parameters.end()) continue;
      values += (values.empty() ? ": " : ", ") + (effect.parameter_count > 1 ? name + " " : "") +
                number(found->second.value) + (unit.empty() ? "" : " " + unit);
    }
    out += "<li>" + escape(effect.title) + " <code>" + escape(effect.name) + "</code>" + escape(values);
    const auto& rivals = f.indistinguishable_from;
    const auto other = std::find_if(rivals.begin(), rivals.end(), [](const auto& r) { return !r.same_law; });
    if (f.undecided && other != rivals.end())
      out += "; not certain: in its place <code>" + escape(joined(other->names)) + "</code> would do as well";
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
  const dynamics::Effect first = d.findings.front().effect;
  const std::string title(dynamics::info(first).title),
      more = std::to_string(d.findings.size() - 1) + " more";
  if (d.verdict == Verdict::not_identifiable || !diagnose::any_believed(d))
    return "Not certain: " + title + ", and " + more;
  if (diagnose::is_wrong_parameter(first)) return "T" + title.substr(1) + " is wrong, and " + more;
  return "The model lacks " + title + ", and " + more;
}

/// What the named causes do to the error, in the figure of the headline of a single cause.
std::string fall_of_error(const Diagnosis& d) {
  const std::string channel = diagnose::main_channel(d);
  const double before = or_nan(find(d.refitted, channel), &diagnose::ChannelErrors::rmse);
  const double after = or_nan(find(d.extended, channel), &diagnose::ChannelErrors::rmse);
  const double floor = or_nan(find(d.noise_floor, channel), &diagnose::ChannelErrors::rmse);
  if (!std::isfinite(before) || !std::isfinite(after)) return "";
  const Scale s = scale_for({before, after}, unit_of(channel, d));
  return " With them the error of " + channel + " on the held-out recordings (RMSE) goes from " +
         number(s.factor * before) + " to " + number(s.factor * after) + " " + s.unit +
         (floor > 0.0 ? "; the noise floor is " + number(s.factor * floor) + " " + s.unit : "") + ".";
}

std::string header(const Diagnosis& d) {
  const VerdictWords v = words(d.verdict);
  std::string out =
      "<header>\n<p class=\"eyebrow\">Diagnosis of a simulation against measurements &middot; model <code>" +
      escape(dynamics::info(d.kind).name) + "</code></p>\n";
  out += "<p>" + badge(v.title, v.tone) + "</p>\n<h1>" + escape(headline(d)) + "</h1>\n";
  if (d.findings.size() > 1) {
    // Not identifiable without a rival: the held-out recordings refute the causes, and the summary says how.
    const bool refuted = d.verdict == Verdict::not_identifiable && !any_undecided(d);
    const std::string lead = refuted ? d.summary : v.meaning + fall_of_error(d);
    return out + list_of_causes(d) + "<p class=\"lead\">" + escape(lead) + "</p>\n</header>\n";
  }
  if (!d.summary.empty()) out += "<p class=\"lead\">" + escape(v.meaning) + "</p>\n";
  return out + "</header>\n";
}

std::string figures(const Diagnosis& d) {
  const std::string channel = diagnose::main_channel(d);
  const auto* given = find(d.baseline, channel);
  const auto* refitted = find(d.refitted, channel);
  const auto* extended = find(d.extended, channel);
  // Without a finding the extended model is the re-fitted one.
  const bool found = !d.findings.empty();
  const auto steps = [&](double diagnose::ChannelErrors::*member, const std::string& unit) {
    std::vector<double> v{or_nan(given, member), or_nan(refitted, member)};
    if (found) v.push_back(or_nan(extended, member));
    const Scale s = scale_for(v, unit);
    std::string out = "<small>";
    for (std::size_t i = 0; i + 1 < v.size(); ++i) out += number(s.factor * v[i], 2) + kArrow;
    return out + "</small>" + number(s.factor * v.back(), 2) +
           (s.unit.empty() ? "" : "&#8239;<small>" + escape(s.unit) + "</small>");
  };
  const auto* floor = find(d.noise_floor, channel);
  std::vector<KeyFigure> list;
  list.push_back({"Error of " + channel + " (RMSE)",
                  steps(&diagnose::ChannelErrors::rmse, unit_of(channel, d)),
                  std::string(found ? "as given, re-fitted, extended" : "as given, re-fitted") +
                      "; on recordings that no fit has seen"});
  list.push_back({"NMSE of " + channel, steps(&diagnose::ChannelErrors::nmse, ""),
                  std::string("the same ") + (found ? "three" : "two") +
                      (floor ? "; the noise floor is " + number(floor->nmse, 2) : "")});
  list.push_back({"Still unexplained", escape(percent(d.unexplained_fraction)),
                  d.nothing_left ? "of the error above the noise; what remains looks random"
                                 : "of the error above the noise; what remains has structure"});
  return key_figures(list);
}

/// Where the error of the model as given went: one bar of shares.
std::string budget(const Diagnosis& d) {
  const std::string channel = diagnose::main_channel(d);
  const double given = or_nan(find(d.baseline, channel), &diagnose::ChannelErrors::nmse);
  const double refitted = or_nan(find(d.refitted, channel), &diagnose::ChannelErrors::nmse);
  const double extended = or_nan(find(d.extended, channel), &diagnose::ChannelErrors::nmse);
  const auto* floor_entry = find(d.noise_floor, channel);
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
  const double noise = std::clamp(floor_entry ? floor_entry->nmse : 0.0, 0.0, after_causes);
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

std::string errors_table(const Diagnosis& d) {
  using E = diagnose::ChannelErrors;
  Table table({{"Channel"},
               {"Figure"},
               {"As given", true},
               {"Re-fitted", true},
               {"Extended", true},
               {"Noise floor", true},
               {"Unit"}});
  for (const auto& entry : d.baseline) {
    const std::string& channel = entry.first;
    const E& given = entry.second;
    const auto* refitted = find(d.refitted, channel);
    const auto* extended = find(d.extended, channel);
    const auto* floor = find(d.noise_floor, channel);
    const Scale s = scale_for({given.mae, given.rmse}, unit_of(channel, d));
    const auto add = [&](const char* figure, double E::*member, const Scale& scale, bool first) {
      // The floor has no absolute error, and a diagnosis may lack its RMSE.
      const bool known = floor && floor->*member > 0.0;
      table.add({first ? escape(in_words(channel)) : "", figure, number(scale.factor * given.*member),
                 number(scale.factor * or_nan(refitted, member)),
                 number(scale.factor * or_nan(extended, member)),
                 known ? number(scale.factor * floor->*member) : "", escape(scale.unit)});
    };
    // Of instants, which have no spread to compare with, there is no NMSE.
    const bool relative = std::isfinite(given.nmse);
    if (relative) add("NMSE", &E::nmse, {1.0, ""}, true);
    add("MAE", &E::mae, s, !relative);
    add("RMSE", &E::rmse, s, false);
  }
  if (table.empty()) return "";
  return "<details open><summary>Errors on the held-out recordings, by channel</summary>\n" + table.html() +
         "</details>\n";
}

/// Root mean square of each recording's errors, from the windows that are plotted.
std::string recordings_table(const Diagnosis& d) {
  const std::string channel = diagnose::main_channel(d);
  using Model = std::vector<double> diagnose::Trace::*;
  constexpr Model kModels[] = {&diagnose::Trace::as_given, &diagnose::Trace::refitted,
                               &diagnose::Trace::extended};
  struct Row {
    std::string log;
    std::size_t windows = 0;
    double squares[3] = {}, samples[3] = {};
  };
  std::vector<Row> rows;
  for (const diagnose::Trace& t : d.traces) {
    if (t.channel != channel) continue;
    auto row = std::find_if(rows.begin(), rows.end(), [&t](const Row& r) { return r.log == t.log; });
    if (row == rows.end()) row = rows.insert(rows.end(), Row{t.log});
    ++row->windows;
    for (std::size_t m = 0; m < 3; ++m)
      for (std::size_t i = 0; i < std::min(t.measured.size(), (t.*kModels[m]).size()); ++i) {
        const double error = t.measured[i] - (t.*kModels[m])[i];
        row->squares[m] += error * error;
        row->samples[m] += 1.0;
      }
  }
  Table table({{"Recording"},
               {"Windows", true},
               {"As given", true},
               {"Re-fitted", true},
               {"Extended", true},
               {"Unit"}});
  for (const Row& r : rows) {
    double rmse[3];
    for (std::size_t m = 0; m < 3; ++m) rmse[m] = std::sqrt(r.squares[m] / r.samples[m]);
    const Scale s = scale_for({rmse[0], rmse[1], rmse[2]}, unit_of(channel, d));
    table.add({escape(r.log), std::to_string(r.windows), number(s.factor * rmse[0]),
               number(s.factor * rmse[1]), number(s.factor * rmse[2]), escape(s.unit)});
  }
  if (table.empty()) return "";
  return "<details open><summary>Errors by held-out recording (RMSE of " + escape(channel) +
         ", over the windows that are plotted below)</summary>\n" + table.html() + "</details>\n";
}

std::string estimates(const std::map<std::string, diagnose::Estimate>& parameters, const Diagnosis& d,
                      const dynamics::EffectInfo& effect) {
  Table table({{"Parameter"}, {"Value (95 % interval)", true}, {"Unit"}});
  for (const auto& [name, e] : parameters) {
    std::string unit;
    for (const dynamics::EffectParameterInfo& p : effect.parameters())
      if (dynamics::name_on(p, d.kind) == name) unit = dynamics::unit_on(p, d.kind);
    table.add({"<code>" + escape(name) + "</code>", with_interval(e.value, e.lower, e.upper), escape(unit)});
  }
  return table.empty() ? "" : table.html();
}

/// "effect.parameter" without the effect where there is but one.
std::string short_name(const std::string& name, const std::vector<std::string>& effects) {
  const std::size_t dot = name.rfind('.');
  return effects.size() == 1 && dot != std::string::npos ? name.substr(dot + 1) : name;
}

std::string rivals(const std::vector<diagnose::Rival>& list) {
  std::string out = "<ul>\n";
  for (const diagnose::Rival& r : list) {
    out += "<li><strong>" + names(r.names) + "</strong>";
    std::string values;
    for (const auto& [name, e] : r.parameters)
      values += (values.empty() ? "" : ", ") + escape(short_name(name, r.names)) + " = " +
                with_interval(e.value, e.lower, e.upper);
    if (!values.empty()) out += " <small>" + values + "</small>";
    if (!r.why.empty()) out += ": " + escape(r.why);
    out += "</li>\n";
  }
  return out + "</ul>\n";
}

std::string finding(const diagnose::Finding& f, std::size_t place, const Diagnosis& d) {
  const dynamics::EffectInfo& effect = dynamics::info(f.effect);
  const std::string channel = diagnose::main_channel(d);
  const Scale s = scale_for({f.held_out_mae_before, f.held_out_mae_after}, unit_of(channel, d));
  std::string out = "<article class=\"finding\">\n<h3><span class=\"place\">" + std::to_string(place) +
                    "</span> " + escape(in_words(effect.name)) + " <code>" + escape(effect.name) +
                    "</code></h3>\n";
  out +=
      "<p class=\"plain\">" + escape(f.explanation.empty() ? effect.explanation : f.explanation) + "</p>\n";
  out += "<div class=\"columns\"><div>\n<h4>Where to look on the machine</h4>\n" +
         paragraph(effect.where_to_look);
  out +=
      "<h4>The law</h4>\n<p><code>" + escape(effect.law) + "</code>" +
      (dynamics::has(d.kind, dynamics::Seat::leg) ? " <small>in " + escape(effect.phase) + "</small>" : "") +
      "</p>\n";
  out += estimates(f.parameters, d, effect) + "</div>\n<div>\n";
  out += "<h4>What it explains</h4>\n<p>" +
         (f.explainable_nmse_removed < 0.0
              ? "Nothing on the held-out recordings: they are predicted worse with it."
              : share_bar(f.explainable_nmse_removed) + " of what can be explained.") +
         " Without it, all else re-fitted, the mean absolute error (MAE) of " + escape(channel) + " is " +
         number(s.factor * f.held_out_mae_before, 2) + " " + escape(s.unit) + "; with it " +
         number(s.factor * f.held_out_mae_after, 2) + " " + escape(s.unit) + ".</p>\n";
  out += "<h4>Confidence</h4>\n<p>" + share_bar(f.confidence) + "</p>\n";
  for (const std::string& why : f.lowered_by) out += "<p><small>Lowered: " + escape(why) + ".</small></p>\n";
  if (!f.next_experiment.empty()) out += "<h4>To be sure</h4>\n" + paragraph(f.next_experiment);
  out += "</div></div>\n";
  if (!f.indistinguishable_from.empty())
    out += "<div class=\"aside\"><h4>These recordings cannot tell it from</h4>\n" +
           rivals(f.indistinguishable_from) + "</div>\n";
  if (!f.alternatives.empty()) out += "<h4>Alone, these do worse</h4>\n" + rivals(f.alternatives);
  return out + "</article>\n";
}

std::string findings(const Diagnosis& d) {
  if (d.findings.empty())
    return paragraph(d.verdict == Verdict::adequate
                         ? "None. Free parameters may have moved within their bounds; that is identification."
                         : "None: no effect of the catalogue is supported by these recordings.");
  std::string out;
  for (std::size_t i = 0; i < d.findings.size(); ++i) out += finding(d.findings[i], i + 1, d);
  return out;
}

TraceData traces(const Diagnosis& d) {
  TracePlot plot;
  const bool extended = !d.findings.empty();
  plot.labels = {"measured", "as given", "re-fitted"};
  if (extended) plot.labels.push_back("extended");
  for (const diagnose::Trace& t : d.traces) {
    TraceWindow w{t.log, t.channel, t.unit, t.time_s, {t.measured, t.as_given, t.refitted}};
    if (extended) w.values.push_back(t.extended);
    plot.windows.push_back(std::move(w));
  }
  return encode(plot);
}

/// How well the machine repeats itself, and what a flexible law foretells.
std::string repeatability(const Diagnosis& d) {
  if (!d.remainder) return "";
  const diagnose::Remainder& left = *d.remainder;
  const auto percent_of = [&](double force) {
    return number(force, 2) + " " + left.unit + ", " + percent(force / left.typical_force) + " of " +
           left.typical_is;
  };
  std::string out = "<p>What the machine does not repeat is like a random " +
                    std::string(left.unit == "N" ? "force" : "torque") + " of " +
                    escape(percent_of(left.random_force)) + " (root mean square), which lasts " +
                    number(1e3 * left.correlation_s, 2) + " ms";
  if (left.impact_scatter > 0.0)
    out += ", and impacts after which the speed scatters by " + percent(left.impact_scatter);
  out += ". A flexible law of the motion, the input and the time, learned on the training recordings, adds " +
         escape(percent_of(left.foretold.force)) + " on the held-out ones and changes their squares by " +
         percent(-left.foretold.share) + "; that is " + number(left.foretold.deviations, 2) +
         " standard errors. " + (left.is_structured() ? "It counts." : "It does not count.");
  const diagnose::Whiteness& w = left.new_finds;
  out += " What is new from row to row is " + std::string(w.white() ? "" : "not ") +
         "white (Ljung and Box, " + std::to_string(diagnose::kLags) + " lags: p = " + number(w.p_value, 2) +
         ", largest correlation " + number(w.correlation, 2) + " after " + std::to_string(w.lag) +
         " rows).</p>\n";
  return out;
}

std::string remains(const Diagnosis& d) {
  std::string out = "<p>" + escape(percent(d.unexplained_fraction)) +
                    " of the error above the noise floor could be explained and is not. " +
                    (d.nothing_left ? "It has no structure that could be told from noise."
                                    : "It has structure, so it has a cause.") +
                    "</p>\n" + repeatability(d);
  Table table({{"It goes along with"}, {"Strength", true}, {"How"}});
  for (const diagnose::Association& a : d.goes_along_with)
    table.add({"<code>" + escape(a.signal) + "</code>", share_bar(a.strength), escape(a.how)});
  return table.empty() ? out : out + table.html();
}

std::string candidates(const Diagnosis& d) {
  std::vector<const diagnose::Candidate*> order;
  for (const diagnose::Candidate& c : d.candidates) order.push_back(&c);
  const auto gain = [](const diagnose::Candidate* c) {
    return std::isfinite(c->training_gain) ? c->training_gain : -1e300;
  };
  std::stable_sort(order.begin(), order.end(), [&](const auto* a, const auto* b) {
    return a->chosen != b->chosen ? a->chosen : gain(a) > gain(b);
  });
  Table table({{"Hypothesis"}, {"Gain in training", true}, {"Gain held out", true}, {"Outcome"}});
  for (const auto* c : order) {
    std::string values;
    for (const auto& [name, e] : c->parameters)
      values += "<br><small>" + escape(short_name(name, c->effects)) + " = " + number(e.value) + "</small>";
    table.add({names(c->effects) + values, share_bar(c->training_gain), share_bar(c->held_out_gain),
               escape(c->outcome)},
              c->chosen);
  }
  if (table.empty()) return "";
  return std::string("<p>") +
         (d.findings.empty()
              ? "No row is good enough to be named. "
              : "The marked row is the extended model. Every other row is the model with that row's effects "
                "instead: it does worse, or no better; the last column says why it was not chosen. ") +
         "Gain in training: share of the cross-validated error removed on the training logs; it alone decides. Gain held out: "
         "share of the error above the noise floor removed on recordings that no choice has seen.</p>\n" +
         table.html();
}

std::string parameters(const Diagnosis& d) {
  Table table(
      {{"Parameter"}, {"As given", true}, {"Re-fitted", true}, {"Extended", true}, {"Unit"}, {"Verdict"}});
  for (const Diagnosis::ParameterRow& p : d.parameters) {
    std::string meaning;
    if (const auto i = dynamics::parameter_index(d.kind, p.name))
      meaning = "<br><small>" + escape(dynamics::info(d.kind).parameters[*i].meaning) + "</small>";
    const auto fitted = [&p](const diagnose::Estimate& e) {
      return p.free ? with_interval(e.value, e.lower, e.upper) : number(e.value, 4);
    };
    table.add({"<code>" + escape(p.name) + "</code>" + meaning, number(p.given, 4), fitted(p.refitted),
               fitted(p.extended), escape(p.unit),
               escape(p.verdict.empty() ? (p.free ? "free" : "held") : p.verdict)});
  }
  if (table.empty()) return "";
  return "<p>Values with 95 % intervals. Free parameters may move within the bounds of the model file; held "
         "ones stay as given.</p>\n" +
         table.html();
}

/// The engine's advice on the whole; without it that of the findings.
std::string next_steps(const Diagnosis& d) {
  std::string out;
  if (!d.experiments.empty()) {
    constexpr std::size_t kRows = 6;
    Table table({{"Experiment"}, {"Recordings it takes", true}, {"Two nearest predictions differ by", true}});
    for (std::size_t i = 0; i < d.experiments.size() && i < kRows; ++i) {
      const diagnose::Experiment& e = d.experiments[i];
      table.add({escape(e.what), e.recordings > 99 ? "over 99" : std::to_string(e.recordings),
                 escape(diagnose::readable(e.apart, d.main_unit))},
                i == 0);
    }
    out =
        "<p>Each was simulated with every candidate as the truth, at the noise of these recordings; the first one is "
        "in next_experiment.toml as a scenario for furcula sim.</p>\n" +
        table.html();
  }
  if (!d.next_experiment.empty()) return paragraph(d.next_experiment) + out;
  for (const diagnose::Finding& f : d.findings)
    if (!f.next_experiment.empty()) out += "<li>" + escape(f.next_experiment) + "</li>\n";
  return out.empty() ? "" : "<ol>\n" + out + "</ol>\n";
}

std::string data(const Diagnosis& d) {
  std::string out = "<p>" + std::to_string(d.logs) + " recordings, " + std::to_string(d.held_out_logs) +
                    " of them held out; ";
  if (dynamics::has(d.kind, dynamics::Seat::leg)) out += std::to_string(d.hops) + " hops, ";
  out += std::to_string(d.samples) + " samples.";
  if (d.fitted_windows < d.windows)
    out += " The search was made on " + std::to_string(d.fitted_windows) + " of " +
           std::to_string(d.windows) + " stretches of the recordings, those that tell most.";
  out += "</p>\n";
  out += dirt_html(d.dirt);
  for (const identify::LeftOut& l : d.left_out) out += paragraph(identify::sentence(l) + ".");
  if (!d.training_files.empty()) out += "<h4>Fitted to</h4>\n" + file_list(d.training_files);
  if (!d.held_out_files.empty()) out += "<h4>Held out</h4>\n" + file_list(d.held_out_files);
  return out;
}

constexpr const char* kHowToRead =
    "<dl>"
    "<dt>NMSE</dt><dd>Sum of squared errors over the sum of squares about the window's mean: 0 is perfect, "
    "1 is as good as a constant.</dd>"
    "<dt>MAE, RMSE</dt><dd>Mean absolute error, and root of the mean squared error, in the channel's unit.</dd>"
    "<dt>Held out</dt><dd>Recordings that no fit and no choice between causes has seen. The model starts "
    "each window from its first measured samples and then runs free.</dd>"
    "<dt>Noise floor</dt><dd>What no model can remove: sensor noise and the start's uncertainty.</dd>"
    "<dt>As given, re-fitted, extended</dt><dd>The model file as it was; the same with its free parameters "
    "fitted again; and with the named causes switched on, all fitted together.</dd>"
    "<dt>95 % interval</dt><dd>The range in which the parameter lies with that probability, if the model is right.</dd></dl>\n";

}  // namespace

std::string render_report(const Diagnosis& d, const std::string& command) {
  const TraceData trace_data = traces(d);
  std::string body = header(d) + figures(d) + budget(d) + errors_table(d) + recordings_table(d);
  body += section("findings", d.findings.size() == 1 ? "The cause" : "The causes", findings(d));
  body += section("next", "What to do next", next_steps(d));
  body += section("traces", "Measured against simulated, held-out recordings", trace_plot_html(trace_data));
  body += section("force",
                  d.residual.unit == "N m" ? "The torque that the re-fitted model lacks"
                                           : "The force that the re-fitted model lacks",
                  force_plots(d.residual));
  body += section("remains", "What remains", remains(d));
  body += section(
      "candidates",
      d.findings.empty() ? "What was tried, without success" : "What was tried instead, and does no better",
      candidates(d));
  body += section("parameters", "Parameters", parameters(d));
  body += section("data", "Data", data(d));
  body += section("reading", "How to read this page", kHowToRead);
  return render({"Furcula: " + (d.summary.empty() ? std::string(words(d.verdict).title) : headline(d)), body,
                 trace_data.json, command});
}

}  // namespace furcula::report
