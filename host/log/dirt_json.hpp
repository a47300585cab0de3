// What was wrong with recordings, as JSON (docs/contracts.md, section 4).
#pragma once

#include <algorithm>
#include <cmath>

#include "host/log/refused.hpp"

namespace furcula::log {

/// Adds `refused_rows` (the first hundred, and how many there are), `notes` and `left_out` to an object; nothing of recordings that are
/// clean.
template <class Json>
void add_dirt(Json& data, const Dirt& dirt) {
  constexpr std::size_t kMost = 100;
  if (!dirt.refused.empty()) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < std::min(kMost, dirt.refused.size()); ++i) {
      const RefusedRow& r = dirt.refused[i];
      Json row = {{"log", r.log}, {"row", r.row}};
      if (r.line != 0) row["line"] = r.line;
      if (!r.column.empty()) row["column"] = r.column;
      row["value"] = std::isfinite(r.value) ? Json(r.value) : r.text.empty() ? Json(nullptr) : Json(r.text);
      row["why"] = r.why;
      rows.push_back(row);
    }
    data["refused_rows"] = rows;
    data["refused_row_count"] = dirt.refused.size();
  }
  if (!dirt.notes.empty()) data["notes"] = dirt.notes;
  for (const Dirt::LeftOut& l : dirt.left_out)
    data["logs_left_out"].push_back({{"log", l.log}, {"why", l.log + " " + l.why}});
}

}  // namespace furcula::log
