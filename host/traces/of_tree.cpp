// See of_tree.hpp.
#include "host/traces/of_tree.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "host/trees/diagnose.hpp"
#include "host/trees/recording.hpp"
#include "host/trees/windows.hpp"

namespace furcula::traces {
namespace {

LogTraces empty_traces(const trees::TreeModel& model, const trees::Recording& r, std::size_t hypotheses) {
  LogTraces out;
  out.log = r.path;
  out.time_s = r.time_s;
  out.window.assign(r.rows(), 0);
  const std::vector<double> none(r.rows(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t j = 0; j < model.joints(); ++j)
    out.quantities.push_back({trees::column_of(model, j, "angle"), std::string(trees::channel_unit(model, j)),
                              r.angle_rad[j], std::vector<std::vector<double>>(hypotheses, none)});
  return out;
}

}  // namespace

Traces of_tree(const trees::TreeModel& model, const std::vector<TreeHypothesis>& hypotheses,
               const std::vector<log::Log>& training, const std::vector<log::Log>& held_out,
               double window_s) {
  std::vector<trees::Recording> first, second;
  for (const log::Log& log : training) first.push_back(trees::recording_of(model, log));
  for (const log::Log& log : held_out) second.push_back(trees::recording_of(model, log));
  trees::share_lateness(first, second);
  const auto of = [&](const std::vector<trees::Recording>& recordings) {
    Traces out;
    for (const TreeHypothesis& h : hypotheses) out.models.push_back(h.name);
    for (const trees::Recording& r : recordings) {
      LogTraces log = empty_traces(model, r, hypotheses.size());
      const std::vector<trees::Recording> alone{r};
      const std::vector<trees::Window> windows = trees::windows_of(model, alone, window_s);
      for (std::size_t w = 0; w < windows.size(); ++w)
        for (std::size_t row = windows[w].first; row <= windows[w].last; ++row)
          if (log.window[row] == 0) log.window[row] = w + 1;
      for (std::size_t h = 0; h < hypotheses.size(); ++h) {
        std::vector<trees::Trace> traces;
        trees::predict(model, alone, window_s, hypotheses[h].of, &traces, &trees::Trace::extended);
        for (std::size_t j = 0; j < traces.size(); ++j) {
          std::size_t at = 0;
          for (std::size_t w = 0; w < windows.size(); ++w)
            for (std::size_t row = windows[w].first; row <= windows[w].last; ++row) {
              const double value = traces[j].extended[at++];
              if (log.window[row] == w + 1)
                log.quantities[j].predicted[h][row] =
                    std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
            }
        }
      }
      out.logs.push_back(std::move(log));
    }
    return out;
  };
  return held_out.empty() ? of(first) : joined(of(first), of(second));
}

}  // namespace furcula::traces
