// The suite's tables as one page without references: rates, the confusion matrices as coloured cells, the
// reliability curve as an SVG. See tally.hpp.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tests/hidden/tally.hpp"

namespace furcula::hidden {

namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

std::string number(const char* pattern, double value) {
  char text[40];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string cell(const std::string& text, const char* attributes = "") {
  return std::string("<td") + attributes + ">" + text + "</td>";
}

std::string share(const Share& s) {
  if (s.of == 0) return "–";
  return number("%.0f&nbsp;%%", 100 * s.value()) + " <small>" + std::to_string(s.are) + "/" +
         std::to_string(s.of) + "</small>";
}

std::string rates(const Tally& t) {
  std::string out =
      "<table><tr><th>tier<th>cases<th>right<th>goal<th>named<th>in a group<th>simpler law<th>half<th>nothing "
      "named<th>honest<th>wrong name<th>extra name<th>main parameter within 10&nbsp;%<th>within 10&nbsp;% of its "
      "change<th>in the 95&nbsp;% interval<th>removes 90&nbsp;%<th>seconds, median<th>longest</tr>\n";
  for (const TierTally& r : t.tiers) {
    out += "<tr><th>" + std::string(name(r.tier));
    out += cell(std::to_string(r.cases)) +
           cell(share(r.right), r.right.value() >= r.goal ? " class=met" : " class=missed") +
           cell(number("%.0f&nbsp;%%", 100 * r.goal));
    for (std::size_t n : {r.named, r.not_separated, r.simpler, r.half, r.nothing, r.honest, r.wrong, r.extra})
      out += cell(n == 0 ? "" : std::to_string(n));
    out += cell(share(r.within_tenth)) + cell(share(r.difference_in_tenth)) + cell(share(r.covered)) +
           cell(share(r.removes_enough)) + cell(number("%.1f", quantile(r.seconds, 0.5))) +
           cell(number("%.1f", quantile(r.seconds, 1.0)));
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

// Shaded by its share of the row: green where the name is the planted one, red where it is another, grey
// where none is.
std::string matrix(const Confusion& c) {
  std::string out = "<table class=matrix><tr><th>";
  for (const std::string& s : c.said) out += "<th class=turned><div>" + escaped(s) + "</div>";
  out += "</tr>\n";
  for (std::size_t row = 0; row < c.planted.size(); ++row) {
    std::size_t all = 0;
    for (std::size_t n : c.counts[row]) all += n;
    out += "<tr><th>" + escaped(c.planted[row]) + " <small>" + std::to_string(all) + "</small>";
    for (std::size_t i = 0; i < c.said.size(); ++i) {
      const std::size_t n = c.counts[row][i];
      const bool right =
          c.said[i] == c.planted[row] || (c.planted[row] == "(nothing)" && c.said[i] == "(adequate)");
      const char* colour = right ? "34,139,76" : c.said[i].starts_with("(") ? "110,110,110" : "200,40,40";
      if (n == 0) {
        out += right ? "<td class=diagonal></td>" : "<td></td>";
        continue;
      }
      const double shade = 0.15 + 0.85 * static_cast<double>(n) / static_cast<double>(all);
      out += "<td title=\"" + escaped(c.planted[row] + ": " + c.said[i]) + "\" style=\"background:rgba(" +
             colour + "," + number("%.2f", shade) + ");color:" + (shade > 0.6 ? "#fff" : "#000") + "\">" +
             std::to_string(n) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string curve(const Tally& t) {
  constexpr double kSide = 320, kLeft = 50, kTop = 10;
  const auto x = [&](double v) { return number("%.1f", kLeft + kSide * v); };
  const auto y = [&](double v) { return number("%.1f", kTop + kSide * (1 - v)); };
  std::string out = "<svg width=420 height=380 role=img aria-label=\"reliability\">";
  for (double v : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    out += "<line class=grid x1=" + x(0) + " x2=" + x(1) + " y1=" + y(v) + " y2=" + y(v) + " />";
    out += "<text x=" + number("%.0f", kLeft - 8) + " y=" + y(v) + " text-anchor=end dy=4>" +
           number("%g", v) + "</text>";
    out += "<text x=" + x(v) + " y=" + number("%.0f", kTop + kSide + 16) + " text-anchor=middle>" +
           number("%g", v) + "</text>";
  }
  out += "<line class=ideal x1=" + x(0) + " y1=" + y(0) + " x2=" + x(1) + " y2=" + y(1) + " />";
  for (const Reliability& bin : t.reliability) {
    if (bin.right.of == 0) continue;
    // Two standard deviations of a share of so many.
    const double n = static_cast<double>(bin.right.of), p = bin.right.value();
    const double spread = 2 * std::sqrt((p * (1 - p) + 0.25 / n) / n);
    out += "<line class=spread x1=" + x(bin.mean()) + " x2=" + x(bin.mean()) +
           " y1=" + y(std::max(0.0, p - spread)) + " y2=" + y(std::min(1.0, p + spread)) + " />";
    out += "<circle cx=" + x(bin.mean()) + " cy=" + y(p) + " r=" + number("%.1f", 3 + std::sqrt(n)) +
           "><title>" + std::to_string(bin.right.are) + " of " + std::to_string(bin.right.of) +
           " right</title></circle>";
  }
  return out + "<text x=" + x(0.5) + " y=" + number("%.0f", kTop + kSide + 36) +
         " text-anchor=middle>confidence given to the first name</text></svg>\n";
}

}  // namespace

std::string page_of(const Tally& t, const std::vector<Answer>& answers, const std::string& head) {
  std::string out =
      R"(<!doctype html><html lang=en><meta charset=utf-8><title>Planted and named</title><style>
body{font:14px/1.45 system-ui,sans-serif;margin:2em;color:#222;max-width:120em}
table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ddd;padding:.2em .5em;text-align:right;font-weight:normal}
tr>th:first-child{text-align:left;white-space:nowrap}th{background:#f6f6f6;vertical-align:bottom}small{color:#777}
.met{background:#d8f0df}.missed{background:#f6d4d4}.matrix td{width:1.7em;text-align:center;padding:.1em}
.turned{height:13em;padding:0 0 .4em 0}.turned div{writing-mode:vertical-rl;transform:rotate(180deg);margin:auto;white-space:nowrap}
.cases{width:100%}.cases tr>th:first-child{white-space:normal;width:22em}.cases td,.cases th{vertical-align:top}
.diagonal{outline:1px solid #34a05c;outline-offset:-2px}
svg text{font-size:12px;fill:#444}.grid{stroke:#e4e4e4}.ideal{stroke:#999;stroke-dasharray:4 3}.spread{stroke:#3465a4}circle{fill:#3465a4;fill-opacity:.8}
</style><h1>Planted and named</h1>
)";
  out += "<p>" + escaped(head) + "</p>\n" + rates(t);
  out +=
      "<p>Right: the planted cause stands first, or in a group of causes that truly predict as well; of a pair both are "
      "named and nothing else; clean: no finding, adequate; outside of the catalogue: said to be unexplained, or no name "
      "with a confidence of 0.9.</p>\n";
  for (const auto& [title, tiers] :
       {std::pair<const char*, std::vector<Tier>>{"Large and medium effects", {Tier::large, Tier::medium}},
        {"Small effects", {Tier::small}},
        {"Clean recordings, and causes outside of the catalogue", {Tier::clean, Tier::outside}}}) {
    const Confusion c = confusion(answers, tiers);
    if (c.planted.empty()) continue;
    out += std::string("<h2>") + title + "</h2>\n" + matrix(c);
  }
  out +=
      "<p>Rows: what was planted. Columns: what stands first in the diagnosis; in brackets its verdict where nothing is "
      "named, or nothing with confidence. Green: the planted law, also in other words or in a group that truly is one; "
      "grey: no name; red: another.</p>\n";
  out += "<h2>Reliability</h2>\n" + curve(t);
  out +=
      "<h2>Cases that were not as they should be</h2>\n<table><tr><th>case<th>tier<th>outcome<th>what was said</tr>\n";
  for (const Answer& a : answers)
    if (!as_it_should_be(a))
      out += "<tr><th>" + escaped(a.description) + cell(std::string(name(a.tier))) +
             cell(a.refused.empty() ? std::string(name(a.judgement.outcome)) : "refused") +
             cell(escaped(a.refused.empty() ? a.judgement.said : a.refused), " style=\"text-align:left\"") +
             "</tr>\n";
  return out + "</table></html>\n";
}

}  // namespace furcula::hidden
