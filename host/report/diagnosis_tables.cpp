// See diagnosis_tables.hpp.
#include "host/report/diagnosis_tables.hpp"

#include <algorithm>
#include <cmath>

#include "host/report/force_plot.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"

namespace furcula::report {
namespace {

using result::ChannelError;
using result::Diagnosis;
using result::kUnknown;

constexpr const char* kArrow = " <span class=\"arrow\">&#8594;</span> ";
/// Longer tables are folded.
constexpr std::size_t kOpen = 12;

bool blamed(const Diagnosis& d, const std::string& location) {
  if (location.empty()) return false;
  return std::any_of(d.findings.begin(), d.findings.end(), [&](const result::Finding& f) {
    const auto& all = f.cause.locations;
    return f.cause.location_type != "link" && std::find(all.begin(), all.end(), location) != all.end();
  });
}

double or_unknown(const ChannelError* e, double ChannelError::*member) { return e ? e->*member : kUnknown; }

/// The first rows, and the others behind a fold.
template <class Rows>
std::string folded(std::size_t count, const Rows& rows) {
  std::string out = rows(0, std::min(count, kOpen));
  if (count > kOpen)
    out += "<details><summary>" + std::to_string(count - kOpen) + " more</summary>\n" + rows(kOpen, count) +
           "</details>\n";
  return out;
}

/// How well the machine repeats itself, and what a flexible model predicts.
std::string repeatability(const result::Remainder& r) {
  const auto part_of = [&](double force) {
    return number(force, 2) + " " + r.unit + ", " + percent(force / r.typical_force) + " of " +
           r.typical_force_is;
  };
  std::string out = "<p>What the machine does not repeat is like a random " +
                    std::string(r.unit == "N" ? "force" : "torque") + " of " +
                    escape(part_of(r.random_force)) + " (root mean square) with a correlation time of " +
                    number(1e3 * r.correlation_s, 2) + " ms";
  if (r.impact_scatter > 0.0)
    out += ", and impacts after which the speed scatters by " + percent(r.impact_scatter);
  out += ". A flexible model of motion, input and time, fitted to the training recordings, adds " +
         escape(part_of(r.held_out.force)) + " on the held-out ones and changes their squares by " +
         percent(-r.held_out.share_of_squares) + "; that is " + number(r.held_out.standard_errors, 2) +
         " standard errors. " + (r.held_out.significant ? "It is significant." : "It is not significant.");
  out += " The innovations are " + std::string(r.white ? "" : "not ") + "white (Ljung and Box, " +
         std::to_string(r.lags) + " lags: p = " + number(r.p_value, 2) + ", largest correlation " +
         number(r.largest_correlation, 2) + " after " + std::to_string(r.at_lag) + " rows).</p>\n";
  return out;
}

}  // namespace

const ChannelError* find(const std::vector<ChannelError>& errors, const std::string& channel) {
  const auto it =
      std::find_if(errors.begin(), errors.end(), [&](const ChannelError& e) { return e.channel == channel; });
  return it == errors.end() ? nullptr : &*it;
}

std::string names_html(const std::vector<result::Cause>& causes) {
  std::string out;
  for (const result::Cause& c : causes)
    out += (out.empty() ? "<code>" : " + <code>") + escape(label(c)) + "</code>";
  return out.empty() ? "nothing: the model as it is, re-fitted" : out;
}

std::string errors_table(const Diagnosis& d) {
  Table table({{"Channel"},
               {"Figure"},
               {"As given", true},
               {"Re-fitted", true},
               {"Extended", true},
               {"Noise floor", true},
               {"Unit"}});
  bool marked = false;
  for (const ChannelError& given : d.baseline) {
    const ChannelError* refitted = find(d.refitted, given.channel);
    const ChannelError* extended = find(d.extended, given.channel);
    const ChannelError* floor = find(d.noise_floor, given.channel);
    const std::string& unit = given.unit.empty() ? d.main_unit : given.unit;
    const Scale s = scale_for({given.mae, given.rmse}, unit);
    const bool mark = blamed(d, given.location);
    marked |= mark;
    const auto add = [&](const char* figure, double ChannelError::*member, const Scale& scale, bool first) {
      // The floor has no absolute error, and a diagnosis may lack its RMSE.
      const bool known = floor && floor->*member > 0.0;
      table.add({first ? escape(in_words(given.channel)) : "", figure, number(scale.factor * given.*member),
                 number(scale.factor * or_unknown(refitted, member)),
                 number(scale.factor * or_unknown(extended, member)),
                 known ? number(scale.factor * floor->*member) : "", escape(scale.unit)},
                mark);
    };
    // Of instants, which have no spread to compare with, there is no NMSE.
    const bool relative = std::isfinite(given.nmse);
    if (relative) add("NMSE", &ChannelError::nmse, {1.0, ""}, true);
    add("MAE", &ChannelError::mae, s, !relative);
    add("RMSE", &ChannelError::rmse, s, false);
  }
  if (table.empty()) return "";
  constexpr std::size_t kFewChannels = 4;
  return "<details" + std::string(d.baseline.size() <= kFewChannels ? " open" : "") +
         "><summary>Errors on the held-out recordings, by channel</summary>\n" +
         (marked ? "<p>A cause acts at the marked channels.</p>\n" : "") + table.html() + "</details>\n";
}

std::string recordings_table(const Diagnosis& d) {
  using Model = std::vector<double> result::Trace::*;
  constexpr Model kModels[] = {&result::Trace::as_given, &result::Trace::refitted, &result::Trace::extended};
  struct Row {
    std::string log;
    std::size_t windows = 0;
    double squares[3] = {}, samples[3] = {};
  };
  std::vector<Row> rows;
  for (const result::Trace& t : d.traces) {
    if (t.channel != d.main_channel) continue;
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
               {"Stretches", true},
               {"As given", true},
               {"Re-fitted", true},
               {"Extended", true},
               {"Unit"}});
  const ChannelError* main = find(d.baseline, d.main_channel);
  const std::string unit = main && !main->unit.empty() ? main->unit : d.main_unit;
  for (const Row& r : rows) {
    double rmse[3];
    for (std::size_t m = 0; m < 3; ++m) rmse[m] = std::sqrt(r.squares[m] / r.samples[m]);
    const Scale s = scale_for({rmse[0], rmse[1], rmse[2]}, unit);
    table.add({escape(r.log), std::to_string(r.windows), number(s.factor * rmse[0]),
               number(s.factor * rmse[1]), number(s.factor * rmse[2]), escape(s.unit)});
  }
  if (table.empty()) return "";
  return "<details open><summary>Errors by held-out recording (RMSE of " + escape(d.main_channel) +
         ", over what is plotted below)</summary>\n" + table.html() + "</details>\n";
}

std::string missing_force_html(const Diagnosis& d) {
  constexpr std::size_t kMostPoints = 5000, kFewestPoints = 250;  // of all joints, and of one
  const std::size_t points =
      std::max(kFewestPoints, kMostPoints / std::max<std::size_t>(1, d.missing_force.size()));
  std::string out;
  for (const result::MissingForce& m : d.missing_force) {
    const std::string plots = missing_force_plots(
        {m.time_s, m.velocity, m.position, m.before, m.after, m.unit, m.velocity_unit, m.position_unit},
        points);
    if (plots.empty()) continue;
    out +=
        "<div class=\"joint\"><h3>" + escape(m.location) + " <small>RMS " + number(m.rms_before, 2) + kArrow +
        number(m.rms_after, 2) + " " + escape(m.unit) + ", of " + number(m.rms_joint, 2) + " " +
        escape(m.unit) + " that moves the joint</small></h3>\n" + plots +
        "<p class=\"hint\">A flexible model of the state predicts " + escape(percent(m.predictable_before)) +
        " of its square before, " + escape(percent(m.predictable_after)) + " after." +
        (m.correlated_with.empty() ? "" : " The rest is correlated with " + escape(m.correlated_with) + ".") +
        "</p></div>\n";
  }
  if (out.empty()) return "";
  return "<p>Inverse dynamics of the measured motion, less what drive and friction give: a correct model lacks "
         "noise alone.</p>\n<div class=\"legend\"><span class=\"key before-key\">model re-fitted</span>"
         "<span class=\"key after-key\">extended</span><span>dots: samples; lines: means, with one standard deviation "
         "to both sides</span></div>\n" +
         out;
}

std::string remains_html(const Diagnosis& d) {
  std::string out;
  if (d.only_noise_left)
    out = "<p>" + escape(percent(d.unexplained_fraction_of_nmse)) +
          " of the error above the noise floor could be explained and is not. " +
          (*d.only_noise_left ? "It has no structure that could be distinguished from noise."
                              : "It has structure, so it has a cause.") +
          "</p>\n";
  if (d.remainder) out += repeatability(*d.remainder);
  Table table({{"It is correlated with"}, {"Strength", true}, {"How"}});
  for (const result::Association& a : d.correlated_with)
    table.add({"<code>" + escape(a.signal) + "</code>", share_bar(a.strength), escape(a.description)});
  return table.empty() ? out : out + table.html();
}

std::string candidates_html(const Diagnosis& d) {
  const auto any = [&](double result::Candidate::*figure) {
    return std::any_of(d.candidates.begin(), d.candidates.end(),
                       [&](const auto& c) { return std::isfinite(c.*figure); });
  };
  const bool scored = any(&result::Candidate::score_test_gain);
  const auto training =
      scored ? &result::Candidate::score_test_gain : &result::Candidate::cross_validated_gain;
  const bool judged = any(&result::Candidate::held_out_gain);
  std::vector<const result::Candidate*> order;
  for (const result::Candidate& c : d.candidates) order.push_back(&c);
  const auto gain = [&](const result::Candidate* c) {
    return std::isfinite(c->*training) ? c->*training : -1e300;
  };
  std::stable_sort(order.begin(), order.end(), [&](const auto* a, const auto* b) {
    return a->chosen != b->chosen ? a->chosen : gain(a) > gain(b);
  });
  if (order.empty()) return "";
  const auto rows = [&](std::size_t from, std::size_t to) {
    std::vector<Table::Column> columns{{"Hypothesis"}, {"Gain in training", true}};
    if (judged) columns.push_back({"Gain held out", true});
    columns.push_back({"Outcome"});
    Table table(columns);
    for (std::size_t i = from; i < to; ++i) {
      const result::Candidate& c = *order[i];
      std::string values;
      for (const result::Cause& cause : c.causes)
        for (const result::Estimate& e : cause.parameters)
          values += "<br><small>" + escape(c.causes.size() == 1 ? e.name : label(cause) + "." + e.name) +
                    " = " + number(e.value) + "</small>";
      std::vector<std::string> cells{names_html(c.causes) + values, share_bar(c.*training)};
      if (judged) cells.push_back(share_bar(c.held_out_gain));
      cells.push_back(escape(c.outcome.empty() && c.chosen ? "chosen" : c.outcome));
      table.add(cells, c.chosen);
    }
    return table.html();
  };
  const std::string what =
      scored
          ? "The best of the first linear test. Gain in training: share of the training residuals that each cause would remove."
          : std::string(
                d.findings.empty()
                    ? "No row is good enough to be named. "
                    : "The marked row is the extended model. Every other row is the model with that row's effects "
                      "instead: it does worse, or no better; the last column says why it was not chosen. ") +
                "Gain in training: share of the cross-validated error removed on the training logs; it alone decides. Gain held out: "
                "share of the error above the noise floor removed on recordings that no choice has seen.";
  return "<p>" + what + "</p>\n" + folded(order.size(), rows);
}

std::string parameters_html(const Diagnosis& d) {
  Table table(
      {{"Parameter"}, {"As given", true}, {"Re-fitted", true}, {"Extended", true}, {"Unit"}, {"Verdict"}});
  for (const result::Parameter& p : d.parameters) {
    const std::string meaning = p.meaning.empty() ? "" : "<br><small>" + escape(p.meaning) + "</small>";
    const auto fitted = [&p](const result::Estimate& e) {
      return p.free ? with_interval(e.value, e.lower, e.upper) : number(e.value, 4);
    };
    table.add({"<code>" + escape(p.name) + "</code>" + meaning, number(p.baseline, 4), fitted(p.refitted),
               fitted(p.extended), escape(p.unit),
               escape(p.verdict.empty() ? (p.free ? "free" : "held") : p.verdict)});
  }
  if (table.empty()) return "";
  return "<p>Values with 95 % intervals. Free parameters may move within the bounds of the model file; held "
         "ones stay as given.</p>\n" +
         table.html();
}

std::string base_parameters_html(const Diagnosis& d) {
  const bool extended = !d.findings.empty();
  std::vector<Table::Column> columns{{"Combination"}, {"As given", true}};
  if (extended) columns.push_back({"Extended", true});
  columns.insert(columns.end(), {{"Standard deviation", true},
                                 {"Unit"},
                                 {"Torque, RMS", true},
                                 {"Unit"},
                                 {"At joint"},
                                 {"Identified"}});
  Table table(columns);
  for (const result::BaseParameter& b : d.base_parameters) {
    std::vector<std::string> row{"<code>" + escape(b.combination) + "</code>", number(b.baseline)};
    if (extended) row.push_back(number(b.extended));
    row.insert(row.end(), {number(b.sd, 2), escape(b.unit), number(b.torque_rms, 2), escape(b.torque_unit),
                           escape(b.location), b.identified ? "yes" : "no"});
    table.add(row);
  }
  if (table.empty()) return "";
  const bool open = d.base_parameters.size() <= kOpen;
  return "<p>The joints' torques depend on these combinations of the links' masses m, first moments mx, my, mz and moments of "
         "inertia about the origins of their frames, and on nothing else: no motion can separate the terms of one. Lengths in "
         "m. The torque is at the joint where it is the largest share. A combination is identified if its standard deviation from these "
         "recordings, rotors and friction as in the extended model, is less than a tenth of it, or of what its first parameter can be in "
         "a body of this mass and size.</p>\n" +
         (open ? table.html()
               : "<details><summary>" + std::to_string(d.base_parameters.size()) +
                     " combinations</summary>\n" + table.html() + "</details>\n");
}

std::string data_html(const Diagnosis& d) {
  std::string out = "<p>" + std::to_string(d.logs) + " recordings, " + std::to_string(d.held_out_logs) +
                    " of them held out; ";
  if (d.hops && *d.hops > 0) out += std::to_string(*d.hops) + " hops; ";
  out += std::to_string(d.samples) + " samples";
  if (std::isfinite(d.window_s))
    out += "; " + std::to_string(d.fitted_windows) + " windows of " + number(d.window_s) + " s";
  out += ".";
  if (d.windows && d.fitted_windows < *d.windows)
    out += " The search was made on " + std::to_string(d.fitted_windows) + " of " +
           std::to_string(*d.windows) + " windows, the most informative ones.";
  out += "</p>\n" + data_quality_html(d.data_quality);
  for (const result::ExcludedWindows& w : d.excluded_windows) {
    std::string logs;
    for (const std::string& name : w.logs) logs += (logs.empty() ? "" : ", ") + name;
    out += paragraph(std::to_string(w.windows) + (w.windows == 1 ? " stride" : " strides") + " (" +
                     number(w.duration_s, 2) + " s, " + percent(w.share) + " of all) excluded, in " + logs +
                     ": " + w.reason + ".");
  }
  if (!d.training_files.empty()) out += "<h4>Fitted to</h4>\n" + file_list(d.training_files);
  if (!d.held_out_files.empty()) out += "<h4>Held out</h4>\n" + file_list(d.held_out_files);
  return out;
}

}  // namespace furcula::report
