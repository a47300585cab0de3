// Rows that residuals refute, see refute.hpp.
#include "host/identify/refute.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "host/identify/prediction.hpp"
#include "host/log/outliers.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

/// A slip stays; at the end of a window that cannot be seen.
bool beside_slip(const Recording& r, std::size_t row) {
  constexpr std::size_t kBeside = 2;
  return std::any_of(r.slips.begin(), r.slips.end(), [row](const Slip& slip) {
    return row + kBeside >= slip.row && row <= slip.row + kBeside;
  });
}

}  // namespace

std::vector<std::vector<log::Refuted>> refuted_rows(const model::Model& fitted,
                                                    const std::vector<Recording>& recordings,
                                                    const std::vector<Window>& windows) {
  std::vector<std::vector<log::Refuted>> all(recordings.size());
  const machines::Rules& rules = machines::rules(fitted.kind);
  if (rules.held) return all;
  std::vector<std::set<std::size_t>> found(recordings.size());
  for (const Window& w : windows) {
    const Recording& r = recordings[w.recording];
    const Run run = predict(fitted, r, w, start_state(r, w, fitted));
    std::vector<double> left;
    for (std::size_t i = 0; i < w.rows(); ++i) left.push_back(r.position[w.first + i] - run.position[i]);
    if (!std::all_of(left.begin(), left.end(), [](double x) { return std::isfinite(x); })) continue;
    const std::span<const double> time_s(r.time_s.data() + w.first, w.rows());
    for (const std::size_t row : log::steps_out_and_back(time_s, left, r.position_noise))
      if (!beside_slip(r, w.first + row)) found[w.recording].insert(w.first + row);
  }
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& r = recordings[i];
    const auto rows = static_cast<double>(r.rows() + r.refused.size());
    if (static_cast<double>(found[i].size() + r.refused.size()) > log::kMostRefused * rows) continue;
    for (const std::size_t row : found[i])
      all[i].push_back({r.log_row[row], std::string(rules.columns.position),
                        "steps out of what runs of the re-fitted model leave, and back"});
  }
  return all;
}

bool add_refuted(std::vector<std::vector<log::Refuted>>& all,
                 const std::vector<std::vector<log::Refuted>>& more) {
  bool any = false;
  all.resize(more.size());
  for (std::size_t i = 0; i < more.size(); ++i) {
    any = any || !more[i].empty();
    all[i].insert(all[i].end(), more[i].begin(), more[i].end());
  }
  return any;
}

}  // namespace furcula::identify
