// What document 001 leaves out, as studies of many gaits: a clutch that catches late and on teeth, ground on which the toe
// slips, the fixed spring's best rest angle.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/gait/search.hpp"

namespace furcula::gait {

enum class StudyKind : std::uint8_t { clutch, ground, rest };
inline constexpr std::array<std::string_view, 3> kStudyNames{"clutch", "ground", "rest"};

struct StudyOptions {
  StudyKind kind = StudyKind::clutch;
  double lever_m = 0.03;  ///< of the clutch's cable at the knee: turns a tooth's pitch into an angle
  double rest_rad = 0.0;  ///< of the parallel spring in the model, for the page
  unsigned processes = 1;
  std::function<void(double fraction, std::string_view doing)> progress;
};

/// One gait of a study, found from its neighbour's.
struct StudyRow {
  LegSpring spring = LegSpring::switched;
  std::optional<double> speed_mps;  ///< in place without it, 7.5 cm of clearance
  double catch_delay_s = 0.0, tooth_m = 0.0, lost_rad = 0.0;
  std::optional<double> friction;
  double rest_rad = 0.0;        ///< of a parallel spring
  std::optional<double> cost;   ///< J in place, else of transport; none: no gait was found
  std::optional<double> share;  ///< of what the ideal switch saves against the parallel spring, for `clutch`
  std::string why;              ///< what stands against a gait
};

/// In a fixed order, the same for any number of processes. `robot` gives the leg; its spring and rest angle are set here.
std::vector<StudyRow> run_study(const Machine& robot, const StudyOptions& options);

/// `furcula-gait-study/1` (docs/gaits.md) and a table of the same.
std::string study_json(const std::vector<StudyRow>& rows, const StudyOptions& options);
std::string study_csv(const std::vector<StudyRow>& rows);

}  // namespace furcula::gait
