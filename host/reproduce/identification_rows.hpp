// The rows of document 002's chapter 4 and section 6.1.1: an identification study beside what is printed, and
// the same study with one cause switched off or on, which shows why the two differ.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "host/reproduce/comparison.hpp"
#include "host/reproduce/identification_study.hpp"

namespace furcula::reproduce {

/// The same rig and experiments, one cause another.
struct SwitchedStudies {
  IdentificationStudy weightless_links, exact_positions, punctual_switch;  ///< a cause switched off
  IdentificationStudy frictionless;
  IdentificationStudy sticky_guide, ringing, both;  ///< switched on: friction, ringing
};

/// What is switched on: nobody measured how much of it the document's rig has.
inline constexpr double kStickyGuideN = 3.0;
inline constexpr RigChange::Ringing kRinging{1e-3, 40.0, 0.02};

/// As `options`, without the peer and, where no reason needs them, without the fits by equation error and of
/// the non-linear model.
SwitchedStudies run_switched_studies(StudyOptions options);

std::vector<Row> identification_rows(const IdentificationStudy& study, const SwitchedStudies& switched);

}  // namespace furcula::reproduce
