// See traces.hpp.
#include "host/traces/traces.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include "host/core/markup.hpp"
#include "host/core/message.hpp"

namespace furcula::traces {
namespace {

/// Of predictions: a tenth of a micrometre of a metre, with a third of the characters that the exact double has.
constexpr int kDigits = 9;
constexpr std::size_t kPlotsOfTab = 6;
/// A prediction that has no number any more is off by so much, as in the engines' figures.
constexpr double kLost = 1e3;

void append_number(std::string& out, double value, bool exact) {
  if (!std::isfinite(value)) return;
  char text[40];
  const auto end =
      exact ? std::to_chars(text, text + sizeof text, value).ptr
            : std::to_chars(text, text + sizeof text, value, std::chars_format::general, kDigits).ptr;
  out.append(text, end);
}

/// A name as a CSV field.
std::string field(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

/// What the curves of a file begin with.
std::string stem(const std::string& csv) { return std::filesystem::path(csv).stem().string(); }

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(LogTraces& to, const LogTraces& from) {
  const std::size_t windows = to.window.empty() ? 0 : *std::max_element(to.window.begin(), to.window.end());
  append(to.time_s, from.time_s);
  for (const std::size_t w : from.window) to.window.push_back(w == 0 ? 0 : w + windows);
  append(to.held_out, from.held_out);
  for (std::size_t q = 0; q < to.quantities.size(); ++q) {
    append(to.quantities[q].measured, from.quantities[q].measured);
    for (std::size_t m = 0; m < to.quantities[q].predicted.size(); ++m)
      append(to.quantities[q].predicted[m], from.quantities[q].predicted[m]);
  }
}

/// Whether `b` is the rest of the log that `a` is the beginning of.
bool goes_on(const LogTraces& a, const LogTraces& b) {
  return a.log == b.log && a.quantities.size() == b.quantities.size() &&
         (a.time_s.empty() || b.time_s.empty() || a.time_s.back() < b.time_s.front());
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(const std::vector<double>& values) {
    for (const double v : values)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
};

std::string range_element(const LogTraces& log, const Quantity& q) {
  Range time, values;
  time.add(log.time_s);
  values.add(q.measured);
  // What a model predicts may be far off; what was measured is what the plot shows first.
  const double margin = values.high > values.low ? 0.1 * (values.high - values.low) : 1.0;
  if (!(time.low <= time.high) || !(values.low <= values.high)) return {};
  return "       <range left=\"" + core::shortest(time.low) + "\" right=\"" + core::shortest(time.high) +
         "\" bottom=\"" + core::shortest(values.low - margin) + "\" top=\"" +
         core::shortest(values.high + margin) + "\"/>\n";
}

std::string xml(const std::string& text) { return core::escape(core::printable(text)); }

std::string curve(const std::string& name, const char* color) {
  return "       <curve name=\"" + xml(name) + "\" color=\"" + color + "\"/>\n";
}

std::string plot(const Traces& traces, const LogTraces& log, const Quantity& q, const std::string& prefix) {
  constexpr const char* kColors[] = {"#d62728", "#ff7f0e", "#2ca02c", "#9467bd"};
  std::string out =
      "     <DockArea name=\"" + xml(q.column) +
      "\">\n      <plot style=\"Lines\" mode=\"TimeSeries\" flip_x=\"false\" flip_y=\"false\">\n" +
      range_element(log, q) + "       <limitY/>\n";
  out += curve(prefix + "/" + q.column + "_measured", "#1f77b4");
  for (std::size_t m = 0; m < traces.models.size(); ++m)
    out += curve(prefix + "/" + q.column + "_" + traces.models[m], kColors[m % std::size(kColors)]);
  return out + "      </plot>\n     </DockArea>\n";
}

std::string tabs(const Traces& traces, const LogTraces& log, const std::string& prefix) {
  std::string out;
  const std::size_t n = log.quantities.size();
  for (std::size_t first = 0; first < n; first += kPlotsOfTab) {
    const std::size_t count = std::min(kPlotsOfTab, n - first);
    std::string sizes;
    for (std::size_t i = 0; i < count; ++i)
      sizes += (i == 0 ? "" : ";") + core::rounded(1.0 / static_cast<double>(count), 6);
    const std::string part = n <= kPlotsOfTab ? "" : " " + std::to_string(first / kPlotsOfTab + 1);
    out += "  <Tab containers=\"1\" tab_name=\"" + xml(prefix + part) +
           "\">\n   <Container>\n    <DockSplitter orientation=\"-\" count=\"" + std::to_string(count) +
           "\" sizes=\"" + sizes + "\">\n";
    for (std::size_t i = first; i < first + count; ++i) out += plot(traces, log, log.quantities[i], prefix);
    out += "    </DockSplitter>\n   </Container>\n  </Tab>\n";
  }
  return out;
}

/// The loader's settings, in the element of versions up to 3.4 and in that of later ones.
std::string loader(const std::string& indent) {
  const std::string what = " time_axis=\"time_s\" delimiter=\"0\" skip_rows=\"0\"/>\n";
  return indent + "<plugin ID=\"DataLoad CSV\">\n" + indent + " <default" + what + indent + " <parameters" +
         what + indent + "</plugin>\n";
}

}  // namespace

Traces joined(Traces training, Traces held_out) {
  Traces out{std::move(training.models), {}};
  for (LogTraces& log : training.logs) {
    log.held_out.assign(log.time_s.size(), false);
    out.logs.push_back(std::move(log));
  }
  for (LogTraces& log : held_out.logs) {
    log.held_out.assign(log.time_s.size(), true);
    const auto whole = std::find_if(out.logs.begin(), out.logs.end(),
                                    [&](const LogTraces& before) { return goes_on(before, log); });
    if (whole != out.logs.end())
      append(*whole, log);
    else
      out.logs.push_back(std::move(log));
  }
  return out;
}

Error error_of(const LogTraces& log, const Quantity& quantity, std::size_t model) {
  Error out;
  double squares = 0.0, spread = 0.0;
  const std::vector<double>& predicted = quantity.predicted[model];
  for (std::size_t first = 0; first < log.time_s.size();) {
    std::size_t end = first + 1;
    while (end < log.time_s.size() && log.window[end] == log.window[first]) ++end;
    double mean = 0.0;
    for (std::size_t i = first; i < end; ++i) mean += quantity.measured[i] / static_cast<double>(end - first);
    for (std::size_t i = first; i < end && log.window[first] != 0; ++i) {
      if (std::isnan(predicted[i])) continue;
      const double error = std::min(kLost, std::abs(predicted[i] - quantity.measured[i]));
      squares += error * error;
      spread += (quantity.measured[i] - mean) * (quantity.measured[i] - mean);
      ++out.rows;
    }
    first = end;
  }
  out.rmse = out.rows > 0 ? std::sqrt(squares / static_cast<double>(out.rows)) : 0.0;
  out.nmse = spread > 0.0 ? squares / spread : std::numeric_limits<double>::quiet_NaN();
  return out;
}

std::string csv_text(const Traces& traces, const LogTraces& log) {
  std::string out = log.held_out.empty() ? "time_s,window" : "time_s,window,held_out";
  for (const Quantity& q : log.quantities) {
    out += "," + field(q.column + "_measured");
    for (const std::string& model : traces.models) out += "," + field(q.column + "_" + model);
  }
  out += '\n';
  for (std::size_t i = 0; i < log.time_s.size(); ++i) {
    append_number(out, log.time_s[i], true);
    out += ',';
    if (log.window[i] != 0) out += std::to_string(log.window[i]);
    if (!log.held_out.empty()) out += log.held_out[i] ? ",1" : ",0";
    for (const Quantity& q : log.quantities) {
      out += ',';
      append_number(out, q.measured[i], true);
      for (const std::vector<double>& predicted : q.predicted) {
        out += ',';
        append_number(out, predicted[i], false);
      }
    }
    out += '\n';
  }
  return out;
}

std::string layout_text(const Traces& traces, const std::vector<std::string>& names) {
  std::string out =
      "<?xml version='1.0' encoding='UTF-8'?>\n<root version=\"2.3.8\">\n <tabbed_widget parent=\"main_window\" "
      "name=\"Main Window\">\n";
  for (std::size_t i = 0; i < names.size(); ++i) out += tabs(traces, traces.logs[i], stem(names[i]));
  out += "  <currentTabIndex index=\"0\"/>\n </tabbed_widget>\n <use_relative_time_offset enabled=\"0\"/>\n";
  out += " <Plugins>\n" + loader("  ") + " </Plugins>\n <previouslyLoaded_Datafiles>\n";
  for (const std::string& name : names)
    out += "  <fileInfo filename=\"" + xml(name) + "\" prefix=\"" + xml(stem(name)) +
           "\">\n   <selected_datasources value=\"\"/>\n" + loader("   ") + "  </fileInfo>\n";
  return out + " </previouslyLoaded_Datafiles>\n <customMathEquations/>\n <snippets/>\n</root>\n";
}

std::vector<std::string> file_names(const Traces& traces) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const LogTraces& log : traces.logs) {
    // A directory of rosbag2 may be given with a slash at its end.
    std::filesystem::path path = std::filesystem::path(log.log).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    // The layout names it, and XML holds no control characters and nothing that is not UTF-8.
    std::string own = path.stem().empty() ? "log" : core::printable(path.stem().string());
    std::replace(own.begin(), own.end(), '\\', '_');
    std::string name = own;
    for (int i = 2; !taken.insert(name).second; ++i) name = own + "_" + std::to_string(i);
    names.push_back(name + ".csv");
  }
  return names;
}

std::vector<core::NewFile> files(const Traces& traces, const std::string& folder) {
  const std::vector<std::string> names = file_names(traces);
  std::vector<core::NewFile> out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out.push_back({folder + "/" + names[i], csv_text(traces, traces.logs[i])});
  out.push_back({folder + "/plotjuggler.xml", layout_text(traces, names)});
  return out;
}

}  // namespace furcula::traces
