// Refused rows in words, see data_quality.hpp.
#include "host/log/data_quality.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/message.hpp"

namespace furcula::log {

std::string in_words(const RejectedRow& r) {
  std::string out = r.log + " row " + std::to_string(r.row);
  if (r.line != 0) out += " (line " + std::to_string(r.line) + ")";
  if (!r.column.empty()) out += " " + r.column;
  if (std::isfinite(r.value))
    out += " " + core::shortest(r.value);
  else if (!r.text.empty())
    out += " " + core::quoted(r.text);
  return out + ": " + r.why;
}

std::string in_words(const std::vector<RejectedRow>& rows, std::uint64_t count) {
  constexpr std::size_t kShown = 3;
  if (rows.empty()) return {};
  count = std::max<std::uint64_t>(count, rows.size());
  std::string out = std::to_string(count) + (count == 1 ? " row" : " rows") + " refused: ";
  for (std::size_t i = 0; i < std::min(rows.size(), kShown); ++i)
    out += (i == 0 ? "" : "; ") + in_words(rows[i]);
  return out + (count > kShown ? "; ..." : "");
}

std::vector<std::string> lines_of(const DataQuality& data_quality) {
  std::vector<std::string> lines;
  if (!data_quality.refused.empty()) lines.push_back(in_words(data_quality.refused));
  lines.insert(lines.end(), data_quality.notes.begin(), data_quality.notes.end());
  for (const DataQuality::Excluded& l : data_quality.excluded)
    lines.push_back(l.log + " " + l.why + ". It was left out, and the rest diagnosed.");
  return lines;
}

}  // namespace furcula::log
