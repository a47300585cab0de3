#include "host/gait/evidence.hpp"

namespace furcula::gait {

Evidence evidence_of(const Query& query, const Search& found) {
  const auto tell = [&](std::string_view line) {
    if (query.progress) query.progress(0.95, line);
  };
  Evidence out;
  tell("basin");
  out.stable = cheapest_stable(query, found, tell);
  const bool itself = out.stable && out.stable->landing_speed_mps == query.task.landing_speed_mps;
  out.stability = itself ? out.stable->stability : stability_of(*found.gait);
  // The rig's spring catches at touch-down.
  if (query.machine.catching.ideal()) {
    tell("1,000 strides on uneven ground");
    out.disturbed = run_disturbed(*found.gait, kStanceGains);
    out.disturbed_open_loop = run_disturbed(*found.gait, {});
  }
  Query q = query;
  q.progress = [&](double, std::string_view line) { tell("open digits: " + std::string(line)); };
  out.open = open_figures(q, found);
  return out;
}

}  // namespace furcula::gait
