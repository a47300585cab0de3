// Cleaning a log, see clean.hpp.
#include "host/log/clean.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/message.hpp"
#include "host/log/outliers.hpp"

namespace furcula::log {
namespace {

std::vector<double> without(const std::vector<double>& values, const std::vector<bool>& out) {
  std::vector<double> rest;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!out[i]) rest.push_back(values[i]);
  return rest;
}

std::vector<bool> marked(const std::vector<std::size_t>& rows, std::size_t count) {
  std::vector<bool> out(count, false);
  for (const std::size_t i : rows) out[i] = true;
  return out;
}

/// Takes the wraps out of a position. Wrong rows are no wraps, and what flickers about an end is no wrong row.
void unwrap(Log& log, const Watched& w) {
  std::vector<double>& x = log.columns.at(w.column);
  const std::vector<bool> out = marked(steps_out_and_back(log.time_s(), x), x.size());
  const double span = wrap_span(without(log.time_s(), out), without(x, out), w.turn);
  if (span == 0.0) return;
  x = unwrapped(x, span);
  log.notes.push_back(log.path + ": " + w.column + " jumps to and fro by " + core::rounded(span, 6) +
                      (span == w.turn ? ", a turn" : "") + ", as a counter does that wraps: taken to go on.");
}

}  // namespace

Clean clean(const Log& given, const std::vector<Watched>& columns, const std::vector<Refuted>& refuted) {
  Clean c{given, {}};
  const std::size_t n = given.rows();
  std::vector<bool> out(n, false);
  const auto refuse = [&](std::size_t row, const std::string& column, const std::string& why) {
    if (out[row]) return;
    out[row] = true;
    const bool from_file = !given.lines.empty();
    c.log.refused.push_back(
        {given.path,
         from_file ? static_cast<std::size_t>(given.lines[row] - given.header_line) : row + 1,
         from_file ? given.lines[row] : 0,
         column,
         given.at(column)[row],
         {},
         why});
  };
  for (const Watched& w : columns) {
    if (!given.has(w.column)) continue;
    if (w.position) unwrap(c.log, w);
    const std::vector<double>& x = c.log.at(w.column);
    const auto rows = w.position ? steps_out_and_back(given.time_s(), x) : far_beyond_others(x);
    if (static_cast<double>(rows.size()) > kMostRefused * static_cast<double>(n)) {
      c.log.notes.push_back(given.path + ": " + std::to_string(rows.size()) + " of " + std::to_string(n) +
                            " rows of " + w.column +
                            " are out of line with those around, too many to leave out: all are used.");
      continue;
    }
    for (const std::size_t row : rows)
      refuse(row, w.column,
             w.position ? "steps out of the rows around and back" : "is beyond all other rows by far");
    if (!w.position) continue;
    if (!w.held)
      for (const std::size_t row : stuck(given.time_s(), x))
        refuse(row, w.column, "stands still, then jumps");
    for (const std::size_t row : off_at_ends(given.time_s(), x))
      refuse(row, w.column, "is not where the rows beside it predict");
  }
  for (const Refuted& r : refuted) refuse(r.row, r.column, r.why);
  for (std::size_t i = 0; i < n; ++i)
    if (!out[i]) c.row.push_back(i);
  if (c.row.size() == n) return c;
  std::stable_sort(c.log.refused.begin(), c.log.refused.end(),
                   [](const RejectedRow& a, const RejectedRow& b) { return a.row < b.row; });
  for (auto& [name, values] : c.log.columns) values = without(values, out);
  if (!given.lines.empty()) {
    c.log.lines.clear();
    for (const std::size_t i : c.row) c.log.lines.push_back(given.lines[i]);
  }
  return c;
}

}  // namespace furcula::log
