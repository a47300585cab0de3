// What stands on the page of an identification, from top to bottom.
#include "host/report/identification_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/diagnose/result.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"

namespace furcula::report {
namespace {

using identify::Estimation;
using identify::Identification;
using identify::Identified;
using Member = double identify::ChannelErrors::*;

const char* in_words(identify::Method m) {
  return m == identify::Method::simulation ? "Simulation error" : "Equation error";
}

std::string verdict(const Identified& p) {
  if (p.verdict == "correlated") return "correlated with " + p.with;
  if (p.verdict == "at_bound") return "at its " + p.with + " bound";
  if (p.verdict == "not_excited") return "not excited";
  return p.verdict;
}

std::string unit_of(const std::string& channel, const Identification& id) {
  const std::string_view unit = diagnose::channel_unit(channel, id.kind);
  return unit.empty() ? id.main_unit : std::string(unit);
}

/// NaN where there is no such figure.
double figure(const std::optional<identify::Errors>& errors, const std::string& channel, Member member) {
  if (errors)
    if (const auto it = errors->find(channel); it != errors->end()) return it->second.*member;
  return std::numeric_limits<double>::quiet_NaN();
}

double mean_over_folds(const Estimation& e, const std::string& channel, Member member) {
  double sum = 0.0, n = 0.0;
  for (const identify::Errors& fold : e.folds) {
    const double v = figure(fold, channel, member);
    if (std::isfinite(v)) {
      sum += v;
      n += 1.0;
    }
  }
  return n > 0.0 ? sum / n : std::numeric_limits<double>::quiet_NaN();
}

/// The smallest and the largest estimate with one fold left out.
std::string spread(const std::vector<double>& folds) {
  if (folds.empty()) return "";
  const auto [low, high] = std::minmax_element(folds.begin(), folds.end());
  return number(*low, 4) + " to " + number(*high, 4);
}

std::string header(const Identification& id) {
  std::size_t fitted = 0, held = 0;
  std::string doubtful;
  if (!id.estimations.empty())
    for (const Identified& p : id.estimations.front().parameters) {
      ++fitted;
      if (p.verdict == "identified")
        ++held;
      else
        doubtful += (doubtful.empty() ? "" : "; ") + p.name + " is " + verdict(p);
    }
  const bool all = fitted > 0 && held == fitted;
  const std::string sentence =
      all ? (fitted == 1   ? "The free parameter is identified."
             : fitted == 2 ? "Both free parameters are identified."
                           : "All " + std::to_string(fitted) + " free parameters are identified.")
          : std::to_string(held) + " of " + std::to_string(fitted) +
                (fitted == 1 ? " free parameter" : " free parameters") + (held == 1 ? " is" : " are") +
                " identified" + (doubtful.empty() ? "." : ": " + doubtful + ".");
  return "<header>\n<p class=\"eyebrow\">Identification of a model from measurements &middot; model <code>" +
         escape(dynamics::info(id.kind).name) + "</code></p>\n<p>" +
         badge(all ? "Identified" : "Not all identified", all ? Tone::good : Tone::notice) + "</p>\n<h1>" +
         escape(sentence) + "</h1>\n</header>\n";
}

std::string figures(const Identification& id) {
  if (id.estimations.empty() || id.main_channel.empty()) return "";
  const Estimation& best = id.estimations.front();
  using E = identify::ChannelErrors;
  std::vector<KeyFigure> list;
  if (best.held_out) {
    const auto two = [&](Member member, const std::string& unit) {
      const double before = figure(id.as_given, id.main_channel, member);
      const double after = figure(best.held_out, id.main_channel, member);
      const Scale s = scale_for({before, after}, unit);
      return "<small>" + number(s.factor * before, 2) + " <span class=\"arrow\">&#8594;</span> </small>" +
             number(s.factor * after, 2) +
             (s.unit.empty() ? "" : "&#8239;<small>" + escape(s.unit) + "</small>");
    };
    list.push_back({"Mean absolute error of " + id.main_channel, two(&E::mae, unit_of(id.main_channel, id)),
                    "as given, identified; on recordings that no fit has seen"});
    list.push_back({"NMSE of " + id.main_channel, two(&E::nmse, ""), "the same two"});
  }
  if (!best.folds.empty())
    list.push_back(
        {"NMSE in cross-validation", number(mean_over_folds(best, id.main_channel, &E::nmse), 2),
         "mean of " + std::to_string(best.folds.size()) + " folds, each predicted by a fit without it"});
  return list.empty() ? "" : key_figures(list);
}

std::string parameters(const Identification& id) {
  std::string out;
  for (const Estimation& e : id.estimations) {
    Table table({{"Parameter"},
                 {"As given", true},
                 {"Identified (95 % interval)", true},
                 {"Unit"},
                 {"Spread over folds", true},
                 {"Verdict"}});
    for (const Identified& p : e.parameters) {
      std::string meaning;
      if (const auto i = dynamics::parameter_index(id.kind, p.name))
        meaning = "<br><small>" + escape(dynamics::info(id.kind).parameters[*i].meaning) + "</small>";
      table.add({"<code>" + escape(p.name) + "</code>" + meaning, number(p.given, 4),
                 with_interval(p.value, p.lower, p.upper), escape(p.unit), spread(p.folds),
                 escape(verdict(p))});
    }
    for (const identify::Derived& d : e.derived)
      table.add({"<code>" + escape(d.name) + "</code><br><small>computed from the parameters</small>", "",
                 number(d.value, 4), escape(d.unit), spread(d.folds), ""});
    if (table.empty()) continue;
    out += "<h4>" + std::string(in_words(e.method)) + "</h4>\n" + table.html();
  }
  return out;
}

std::string errors(const Identification& id) {
  std::string out;
  for (const Estimation& e : id.estimations) {
    Table table({{"Channel"},
                 {"Figure"},
                 {"As given", true},
                 {"Identified", true},
                 {"Mean over folds", true},
                 {"Unit"}});
    std::vector<std::string> channels;
    const auto take = [&channels](const identify::Errors& from) {
      for (const auto& entry : from)
        if (std::find(channels.begin(), channels.end(), entry.first) == channels.end())
          channels.push_back(entry.first);
    };
    if (e.held_out) take(*e.held_out);
    for (const identify::Errors& fold : e.folds) take(fold);
    for (const std::string& channel : channels) {
      using E = identify::ChannelErrors;
      const auto add = [&](const char* title, Member member, const std::string& unit, bool first) {
        const std::vector<double> v{figure(id.as_given, channel, member), figure(e.held_out, channel, member),
                                    mean_over_folds(e, channel, member)};
        const Scale s = scale_for(v, unit);
        table.add({first ? escape(report::in_words(channel)) : "", title, number(s.factor * v[0]),
                   number(s.factor * v[1]), number(s.factor * v[2]), escape(s.unit)});
      };
      add("NMSE", &E::nmse, "", true);
      add("MAE", &E::mae, unit_of(channel, id), false);
      add("RMSE", &E::rmse, unit_of(channel, id), false);
    }
    if (!table.empty()) out += "<h4>" + std::string(in_words(e.method)) + "</h4>\n" + table.html();
  }
  return out.empty() ? ""
                     : "<p>As given and identified: on the held-out recordings, over prediction windows. "
                       "Over folds: on the windows of each fold, by the fit that has not seen it.</p>\n" +
                           out;
}

TraceData traces(const Identification& id) {
  TracePlot plot{{"measured", "as given", "identified"}, {}};
  for (const identify::FittedTrace& t : id.traces)
    plot.windows.push_back({t.log, t.channel, t.unit, t.time_s, {t.measured, t.as_given, t.identified}});
  return encode(plot);
}

std::string data(const Identification& id) {
  std::string out = "<p>" + std::to_string(id.logs) + " recordings, " + std::to_string(id.held_out_logs) +
                    " of them held out; " + std::to_string(id.windows) + " windows, " +
                    std::to_string(id.samples) + " samples.</p>\n";
  out += data_quality_html(id.data_quality);
  for (const identify::Excluded& l : id.excluded) out += "<p>" + escape(identify::sentence(l)) + ".</p>\n";
  if (!id.training_files.empty()) out += "<h4>Fitted to</h4>\n" + file_list(id.training_files);
  if (!id.held_out_files.empty()) out += "<h4>Held out</h4>\n" + file_list(id.held_out_files);
  return out;
}

constexpr const char* kHowToRead =
    "<dl>"
    "<dt>Simulation error</dt><dd>The model starts once in each window and runs free; its whole path is compared.</dd>"
    "<dt>Equation error</dt><dd>Each instant is predicted from the measured one before it: quick, but noise bends it.</dd>"
    "<dt>NMSE</dt><dd>Sum of squared errors over the sum of squares about the window's mean: 0 is perfect, "
    "1 is as good as a constant.</dd>"
    "<dt>Spread over folds</dt><dd>Smallest and largest estimate when one share of the recordings is left out.</dd>"
    "<dt>Correlated</dt><dd>The recordings tell a combination of the two parameters, not each alone.</dd>"
    "<dt>At a bound</dt><dd>The best value lies at the edge of what the model file allows.</dd>"
    "<dt>Not excited</dt><dd>The recordings hardly depend on the parameter.</dd></dl>\n";

}  // namespace

std::string render_identification_report(const Identification& id, const std::string& command) {
  const TraceData trace_data = traces(id);
  std::string body = header(id) + figures(id);
  body += section("parameters", "Parameters", parameters(id));
  body += section("traces", "Measured against simulated", trace_plot_html(trace_data));
  body += section("errors", "Errors of prediction", errors(id));
  body += section("data", "Data", data(id));
  body += section("reading", "How to read this page", kHowToRead);
  return render({"Furcula: identification", body, trace_data.json, command});
}

}  // namespace furcula::report
