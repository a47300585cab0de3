// The page's frame, tables and the small pieces between them.
#include "host/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/report/assets.hpp"
#include "host/report/html.hpp"

namespace furcula::report {
namespace {

std::string_view class_of(Tone tone) {
  switch (tone) {
    case Tone::good:
      return "good";
    case Tone::notice:
      return "notice";
    case Tone::bad:
      return "bad";
    case Tone::neutral:
      break;
  }
  return "neutral";
}

}  // namespace

std::string render(const Page& page) {
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  // Nothing is ever fetched, whatever a file's name or a future change to the script may try.
  out +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">\n";
  out += "<title>" + escape(page.title) + "</title>\n<style>\n";
  out += assets::page_style;
  if (!page.data_json.empty()) out += assets::dygraphs_style;
  out += "</style>\n</head>\n<body>\n<main>\n" + page.body_html;
  out += "<footer>Written by furcula " FURCULA_VERSION;
  out += page.command.empty() ? "." : ": <code>" + escape(page.command) + "</code>";
  out += "</footer>\n</main>\n";
  if (!page.data_json.empty()) {
    out += "<script type=\"application/json\" id=\"trace-data\">" + inside_script(page.data_json) +
           "</script>\n<script>\n/*!\n";
    out += assets::dygraphs_licence;
    out += "*/\n";
    out += assets::dygraphs_script;
    out += "</script>\n<script>\n";
    out += assets::page_script;
    out += "</script>\n";
  }
  const auto drawn = [&](const std::string& json, const char* id, std::string_view script) {
    if (json.empty()) return;
    out += "<script type=\"application/json\" id=\"" + std::string(id) + "\">" + inside_script(json) +
           "</script>\n<script>\n";
    out += script;
    out += "</script>\n";
  };
  if (!page.robot_json.empty() || !page.leg_json.empty() || !page.walk_json.empty()) {
    out += "<script>\n";
    out += assets::canvas_script;
    out += "</script>\n";
  }
  drawn(page.robot_json, "robot-data", assets::robot_script);
  drawn(page.leg_json, "leg-data", assets::leg_script);
  drawn(page.walk_json, "walk-data", assets::walk_script);
  return out + "</body>\n</html>\n";
}

std::string badge(std::string_view text, Tone tone) {
  return "<span class=\"badge " + std::string(class_of(tone)) + "\">" + escape(text) + "</span>";
}

std::string key_figures(const std::vector<KeyFigure>& figures) {
  std::string out = "<div class=\"figures\">\n";
  for (const KeyFigure& f : figures)
    out += "<div><span class=\"label\">" + escape(f.label) + "</span><span class=\"value\">" + f.value_html +
           "</span><span class=\"remark\">" + escape(f.remark) + "</span></div>\n";
  return out + "</div>\n";
}

void Table::add(std::vector<std::string> cells_html, bool marked) {
  cells_html.resize(columns_.size());
  rows_.push_back({std::move(cells_html), marked});
}

std::string Table::html() const {
  const auto open = [this](const char* tag, std::size_t column) {
    return std::string("<") + tag + (columns_[column].numeric ? " class=\"number\">" : ">");
  };
  std::string out = "<div class=\"table\"><table>\n<thead><tr>";
  for (std::size_t i = 0; i < columns_.size(); ++i)
    out += open("th", i) + escape(columns_[i].title) + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const Row& row : rows_) {
    out += row.marked ? "<tr class=\"marked\">" : "<tr>";
    for (std::size_t i = 0; i < columns_.size(); ++i) out += open("td", i) + row.cells[i] + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody>\n</table></div>\n";
}

std::string section(std::string_view id, std::string_view heading, const std::string& content_html) {
  if (content_html.empty()) return "";
  return "<section id=\"" + escape(id) + "\">\n<h2>" + escape(heading) + "</h2>\n" + content_html +
         "</section>\n";
}

std::string paragraph(std::string_view text) { return text.empty() ? "" : "<p>" + escape(text) + "</p>\n"; }

std::string share_bar(double share) {
  const double width = std::isfinite(share) ? 100.0 * std::clamp(share, 0.0, 1.0) : 0.0;
  char style[64];
  std::snprintf(style, sizeof style, "width:%.1f%%", width);
  return "<span class=\"share\"><span class=\"bar\"><span style=\"" + std::string(style) +
         "\"></span></span>" + escape(share < -0.001 ? "worse" : percent(std::max(share, 0.0))) + "</span>";
}

std::string with_interval(double value, double lower, double upper) {
  if (!std::isfinite(lower) || !std::isfinite(upper) || upper <= lower) return number(value, 4);
  // Two digits of the interval's half width are worth showing.
  int digits = 3;
  const double half = 0.5 * (upper - lower);
  if (value != 0.0 && std::isfinite(value))
    digits = 2 + static_cast<int>(std::floor(std::log10(std::abs(value))) - std::floor(std::log10(half)));
  digits = std::clamp(digits, 2, 7);
  return number(value, digits) + " <small>(" + number(lower, digits) + " to " + number(upper, digits) +
         ")</small>";
}

std::string biped_player_html(std::string_view label) {
  return "<div class=\"robot\"><canvas id=\"walk-canvas\" tabindex=\"0\" role=\"img\" aria-label=\"" +
         escape(label) +
         "\"></canvas></div>\n"
         "<div class=\"player\"><button type=\"button\" id=\"walk-play\">Play</button>"
         "<input type=\"range\" id=\"walk-slider\" aria-label=\"time\"><output id=\"walk-time\"></output>"
         "<label>Speed <select id=\"walk-speed\"><option value=\"0.1\">0.1</option><option value=\"0.25\">0.25</option>"
         "<option value=\"1\" selected>1</option></select></label>"
         "<button type=\"button\" id=\"walk-home\">Reset view</button></div>\n";
}

std::string file_list(const std::vector<std::string>& files) {
  std::string out = "<ul class=\"files\">\n";
  for (const std::string& f : files) out += "<li>" + escape(f) + "</li>\n";
  return out + "</ul>\n";
}

std::string data_quality_html(const log::DataQuality& data_quality) {
  constexpr std::size_t kMostRows = 100;
  std::string out;
  for (const std::string& line : log::lines_of(data_quality)) out += paragraph(line);
  if (data_quality.refused.size() < 2) return out;
  Table table({{"Log"}, {"Row", true}, {"Line", true}, {"Column"}, {"Value", true}, {"Why it was left out"}});
  for (std::size_t i = 0; i < std::min(kMostRows, data_quality.refused.size()); ++i) {
    const log::RejectedRow& r = data_quality.refused[i];
    table.add({escape(r.log), std::to_string(r.row), r.line == 0 ? "" : std::to_string(r.line),
               escape(r.column), std::isfinite(r.value) ? number(r.value) : escape(r.text), escape(r.why)});
  }
  return out + "<details><summary>Rows refused</summary>\n" + table.html() + "</details>\n";
}

}  // namespace furcula::report
