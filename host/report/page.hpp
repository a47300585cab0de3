// The building blocks of every report: the page's frame, badges, figures, tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/log/data_quality.hpp"

namespace furcula::report {

/// One page. Members with `html` in their names are markup already; all others are escaped here.
struct Page {
  std::string title;      ///< the browser's title
  std::string body_html;  ///< everything between <main> and </main>
  /// What page_script draws (trace_plot.hpp); empty: no plot, and no script in the page.
  std::string data_json;
  std::string command = {};  ///< that writes the same page again, for the foot; empty: none
  /// What robot_script draws (robot_picture.hpp); empty: no robot, and not its script.
  std::string robot_json = {};
  /// What leg_script draws (host/gait/gait_report.cpp); empty: no leg, and not its script.
  std::string leg_json = {};
  /// What walk_script draws (host/walk/walk_report.cpp, host/floating/walk_picture.cpp); empty: no biped, and not its script.
  std::string walk_json = {};
};

/// The whole HTML file: style, script and data embedded; its content policy forbids any request.
std::string render(const Page& page);

/// Colours carry the same meaning on every page.
enum class Tone { good, notice, bad, neutral };

std::string badge(std::string_view text, Tone tone);

/// A large figure with what it is above it and a remark below it.
struct KeyFigure {
  std::string label;
  std::string value_html;
  std::string remark;
};
std::string key_figures(const std::vector<KeyFigure>& figures);

/// A table that scrolls sideways where the screen is narrow. Cells are markup.
class Table {
 public:
  struct Column {
    std::string title;
    bool numeric = false;
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  /// `marked` sets the row off. Missing cells stay empty.
  void add(std::vector<std::string> cells_html, bool marked = false);
  bool empty() const { return rows_.empty(); }
  std::string html() const;

 private:
  struct Row {
    std::vector<std::string> cells;
    bool marked;
  };
  std::vector<Column> columns_;
  std::vector<Row> rows_;
};

/// A section with its heading; nothing if the content is empty.
std::string section(std::string_view id, std::string_view heading, const std::string& content_html);

/// <p>text</p>; nothing if the text is empty.
std::string paragraph(std::string_view text);

/// A share as a small bar beside its figure; values outside [0, 1] are drawn as its ends, and less
/// than nothing is called "worse".
std::string share_bar(double share);

/// "1.61 <small>(1.52 to 1.70)</small>": a value with its 95 % interval, whose width decides the digits.
std::string with_interval(double value, double lower, double upper);

/// Where walk_script draws a biped, and the controls below it.
std::string biped_player_html(std::string_view label);

/// A list of file names, in columns.
std::string file_list(const std::vector<std::string>& files);

/// What was wrong with the recordings: rows refused, notes, recordings left out. Nothing of clean ones.
std::string data_quality_html(const log::DataQuality& data_quality);

}  // namespace furcula::report
