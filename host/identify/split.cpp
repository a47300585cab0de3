#include "host/identify/split.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <string>

#include "host/core/error.hpp"

namespace furcula::identify {
namespace {

/// Rows [first, last) of a log.
log::Log part(const log::Log& log, std::size_t first, std::size_t last) {
  log::Log some = log;
  if (!log.lines.empty())
    some.lines.assign(log.lines.begin() + static_cast<std::ptrdiff_t>(first),
                      log.lines.begin() + static_cast<std::ptrdiff_t>(last));
  // Rows that were left out on reading stay with the part that they were in; of the end with the last.
  const bool ends = last == log.rows();
  std::erase_if(some.refused, [&](const log::RejectedRow& r) {
    return r.line < (first == 0 ? 0 : log.lines[first]) || (!ends && r.line >= log.lines[last]);
  });
  if (first != 0) some.notes.clear();
  for (auto& [name, values] : some.columns)
    values = std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(first),
                                 values.begin() + static_cast<std::ptrdiff_t>(last));
  return some;
}

}  // namespace

std::pair<std::vector<log::Log>, std::vector<log::Log>> split(std::vector<log::Log> logs, std::uint64_t seed,
                                                              std::size_t least_logs) {
  if (logs.empty()) throw core::DataError("no log given; expected at least one");
  std::pair<std::vector<log::Log>, std::vector<log::Log>> out;
  if (logs.size() < least_logs) {
    constexpr std::size_t kLeastRows = 80;
    for (const log::Log& log : logs) {
      const std::size_t rows = log.rows(), cut = rows < kLeastRows ? rows : rows - rows / 4;
      out.first.push_back(part(log, 0, cut));
      if (cut < rows) out.second.push_back(part(log, cut, rows));
    }
    if (out.second.empty())
      throw core::DataError(logs.front().path + ": " + std::to_string(logs.front().rows()) +
                            " rows are too few to hold a quarter of them out; expected at least " +
                            std::to_string(kLeastRows) + ", or --hold-out");
    return out;
  }
  std::mt19937_64 random(seed);
  std::set<std::size_t> held;
  while (held.size() < std::max<std::size_t>(1, logs.size() / 5)) held.insert(random() % logs.size());
  for (std::size_t i = 0; i < logs.size(); ++i)
    (held.contains(i) ? out.second : out.first).push_back(std::move(logs[i]));
  return out;
}

}  // namespace furcula::identify
