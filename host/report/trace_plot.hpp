// Measured and predicted traces over time, zoomable, with the error below on the same axis.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::report {

/// One channel over one window: `values[i]` belongs to `TracePlot::labels[i]` and has as many samples as
/// `time_s`; one of another length is taken as absent. The first is what was measured.
struct TraceWindow {
  std::string log;
  std::string channel;
  std::string unit;
  std::span<const double> time_s;
  std::vector<std::span<const double>> values;
};

struct TracePlot {
  std::vector<std::string> labels;  ///< "measured", then the models, the best last
  std::vector<TraceWindow> windows;
};

/// The data for the page's script, and how much of the traces it holds.
struct TraceData {
  std::string json;
  std::size_t samples = 0;  ///< there were
  std::size_t kept = 0;     ///< in `json`
};

/// Windows of one log and channel become one series. Above `most_samples` in total each window is thinned: of
/// every stretch the samples with the smallest and the largest error of the last model stay, so that peaks
/// survive. Where the windows of a log count their time each from its own start, they are put one after the
/// other.
TraceData encode(const TracePlot& plot, std::size_t most_samples = 30000);

/// The places on the page that the script draws into: selectors, legend, the plot and the error below it,
/// which is `error`.
std::string trace_plot_html(const TraceData& data, std::string_view error = "measured minus simulated");

}  // namespace furcula::report
