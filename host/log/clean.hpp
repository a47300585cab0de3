// A log without the rows that its own neighbours refute, and with its counters' wraps taken out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/log/log.hpp"

namespace furcula::log {

/// A column that fits rest on.
struct Watched {
  std::string column;
  /// A position moves on from row to row (outliers.hpp, steps_out_and_back); what else there is may jump, and
  /// is refused where it is beyond all others (far_beyond_others).
  bool position = true;
  double turn = 0.0;  ///< of an angle 2 pi; else 0
  bool held = false;  ///< it may be held, and jump as it is let go: of a leg with a clutch
};

/// A row that a fit's residuals refute.
struct Refuted {
  std::size_t row = 0;  ///< of the log as it was given
  std::string column;
  std::string why;
};

struct Clean {
  Log log;                       ///< its `refused` and `notes` are all there are
  std::vector<std::size_t> row;  ///< of the log as it was given, of each row that is left
};

/// The log without refused rows. Columns of which more than kMostRefused would be refused are left as they
/// are, and a note says so.
Clean clean(const Log& log, const std::vector<Watched>& columns, const std::vector<Refuted>& refuted = {});

}  // namespace furcula::log
