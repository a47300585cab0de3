// What `furcula diagnose` does, for the commands that diagnose recordings they have made themselves.
#pragma once

#include "host/cli/recordings.hpp"
#include "host/diagnose/diagnosis.hpp"

namespace furcula::cli {

/// Reads the recordings, diagnoses them, writes the results into `options.out`; the verdict goes to stdout.
/// @throws UsageError, core::DataError, core::OutputError
diagnose::Diagnosis run_diagnose(const RecordingOptions& options);

}  // namespace furcula::cli
