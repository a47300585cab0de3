// Document 001, "On the Energetics of a Switchable Parallel Elastic Actuator Design for Monopedal Running": its figures
// computed anew with the cheapest gaits of three legs, in place and forward.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/gait/search.hpp"
#include "host/reproduce/comparison.hpp"

namespace furcula::reproduce {

struct GaitStudyOptions {
  std::uint64_t seed = 1;
  unsigned starts = 3;
  unsigned processes = 1;
  std::function<void(double fraction, std::string_view doing)> progress;
};

/// One gait that was asked for.
struct StudiedGait {
  std::string name;  ///< "switched, 7.5 cm"
  gait::Machine machine;
  gait::Task task;
  bool fourier = false;
  std::optional<gait::Gait> gait;  ///< none: none was found
  gait::Evaluation evaluation;
  std::vector<gait::Optimum> optima;
  std::string refusal;
};

struct GaitReproduction {
  GaitStudyOptions options;
  std::vector<StudiedGait> gaits;
  std::vector<Row> rows;
  double seconds = 0.0;
};

/// The same for any number of processes, but for the time.
GaitReproduction reproduce_001(const GaitStudyOptions& options);

/// `furcula-reproduction/1`, and the page.
std::string to_json_text(const GaitReproduction& r);
std::string render_gait_reproduction_report(const GaitReproduction& r, const std::string& command);

}  // namespace furcula::reproduce
