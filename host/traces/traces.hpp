// Measured and predicted values of logs, row by row, and the files that other programs read them from.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/core/atomic_file.hpp"

namespace furcula::traces {

/// One quantity over the rows of a log.
struct Quantity {
  std::string column;  ///< as a log names it, in whose unit all values are: "angle_elbow_rad"
  std::string unit;    ///< "rad", "m", "rad/s", "m/s", "N m"
  std::vector<double> measured;
  std::vector<std::vector<double>> predicted;  ///< [model][row]; NaN: no window holds this row
};

struct LogTraces {
  std::string log;  ///< where it was read from
  std::vector<double> time_s;
  std::vector<std::size_t> window;  ///< of each row, from 1; 0: in none
  std::vector<bool> held_out;       ///< of each row: no fit has seen it; empty: nothing was fitted
  std::vector<Quantity> quantities;
};

/// Each window of a log is a free run on the recorded inputs, from a start state that is estimated from its first 50 ms, the same for all
/// models. A row that ends one window and begins the next has the prediction of the first.
struct Traces {
  std::vector<std::string> models;  ///< "given", "refitted", "extended"
  std::vector<LogTraces> logs;
};

/// Joins the two parts of a log whose end is held out, and marks what is.
Traces joined(Traces training, Traces held_out);

/// Over the rows with a prediction, measured less predicted. NMSE: squared errors over the squares about the mean of each window's
/// measured values; NaN where those do not move.
struct Error {
  std::size_t rows = 0;
  double rmse = 0.0, nmse = 0.0;
};
Error error_of(const LogTraces& log, const Quantity& quantity, std::size_t model);

/// A CSV file with a header row: time_s, window, held_out where something is, and of each quantity "<column>_measured" and
/// "<column>_<model>". A value that is not there is an empty cell.
std::string csv_text(const Traces& traces, const LogTraces& log);

/// A layout of PlotJuggler that loads these files, one of each log, under their names without ".csv" as prefixes: a tab or more for each
/// log, and measured and predicted of a quantity in one plot. `names` are relative to the layout.
std::string layout_text(const Traces& traces, const std::vector<std::string>& names);

/// Names of CSV files, one of each log: the log's own without its folder and ending; where two are the same, the second gets "_2".
std::vector<std::string> file_names(const Traces& traces);

/// All of them in a folder, and the layout as plotjuggler.xml.
std::vector<core::NewFile> files(const Traces& traces, const std::string& folder);

}  // namespace furcula::traces
