// The page of a study: its figures over what was varied, and its whole table.
#pragma once

#include <string>
#include <vector>

#include "host/gait/study.hpp"

namespace furcula::gait {

/// Of the rows that run_study() gave; `command` writes the same page again.
std::string render_study_report(const std::vector<StudyRow>& rows, const StudyOptions& options,
                                const std::string& command);

}  // namespace furcula::gait
