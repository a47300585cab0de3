#include "host/gait/open_digits.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/gait/machine_file.hpp"
#include "host/gait/workers.hpp"

namespace furcula::gait {
namespace {

using Json = nlohmann::json;

void set(Machine& machine, const std::string& name, double value) {
  for (const MachineKey& k : parameter_keys())
    if (k.name == name) k.of(machine) = value;
}

/// What the figures are of a gait, as numbers.
std::vector<double> figures_of(const Evaluation& e) {
  return {e.cost_j, e.cot.value_or(0.0), e.eta, e.stride.touchdown_knee,
          e.multipliers.empty() ? 0.0 : std::abs(e.multipliers.front())};
}

}  // namespace

OpenFigures open_figures(const Query& query, const Search& found) {
  OpenFigures out;
  const auto& open = query.machine.open;
  if (open.empty() || !found.gait) return out;
  out.corners = 1u << open.size();
  const auto job = [&](std::size_t corner, const Tell&) {
    Query q = query;
    q.processes = 1;
    q.explains = false;
    q.progress = nullptr;
    for (std::size_t i = 0; i < open.size(); ++i)
      set(q.machine, open[i].name, (corner >> i) % 2 == 0 ? open[i].low : open[i].high);
    q.from = found.free;
    Search there = find_gait(q);
    if (!there.gait) {
      q.from.reset();
      there = find_gait(q);
    }
    return (there.gait ? Json(figures_of(there.evaluation)) : Json(nullptr)).dump();
  };
  const auto corners = in_processes(out.corners, query.processes, job, [&](std::size_t i, std::string_view) {
    if (query.progress)
      query.progress(static_cast<double>(i) / out.corners, "corner " + std::to_string(i + 1));
  });
  std::vector<double> low = figures_of(found.evaluation), high = low;
  for (const std::string& text : corners) {
    const Json j = Json::parse(text);
    if (j.is_null()) {
      ++out.without;
      continue;
    }
    for (std::size_t i = 0; i < low.size(); ++i) {
      low[i] = std::min(low[i], j[i].get<double>());
      high[i] = std::max(high[i], j[i].get<double>());
    }
  }
  out.cost_j = {low[0], high[0]};
  out.cot = {low[1], high[1]};
  out.eta = {low[2], high[2]};
  out.touchdown_knee_rad = {low[3], high[3]};
  out.multiplier = {low[4], high[4]};
  return out;
}

}  // namespace furcula::gait
