#include "host/bench/release_catch_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace furcula::bench {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json conditions(const Conditions& c) {
  return {{"load_kg", c.load_kg},
          {"window_s", c.window_s},
          {"supply_v", c.supply_v},
          {"pressing_n", c.pressing_n}};
}

Json trial(const Trial& t) {
  Json out = conditions(t.conditions);
  out["released_after_s"] = number(t.released_after_s);
  out["caught_after_s"] = number(t.caught_after_s);
  out["drop_m"] = t.caught() ? number(t.drop_m) : Json(nullptr);
  out["held"] = t.held;
  out["slipped"] = t.slipped;
  return out;
}

}  // namespace

std::string to_json_text(const ReleaseCatch& r) {
  Json out;
  out["schema"] = "furcula-release-catch/1";
  out["board"] = r.board;
  out["passed"] = r.passed;
  out["conditions"] = conditions(r.options.conditions);
  out["varied"] = {{"trials", r.options.trials},
                   {"seed", r.options.seed},
                   {"load_share", r.options.load_share},
                   {"window_s", r.options.window_s},
                   {"supply_share", r.options.supply_share}};
  out["standard"] = trial(r.standard);
  const Summary& s = r.summary;
  out["summary"] = {{"trials", s.trials},
                    {"not_held", s.not_held},
                    {"not_released", s.not_released},
                    {"not_caught", s.not_caught},
                    {"slips", s.slips},
                    {"caught_after_median_s", number(s.caught_after_median_s)},
                    {"caught_after_p5_s", number(s.caught_after_p5_s)},
                    {"caught_after_p95_s", number(s.caught_after_p95_s)},
                    {"caught_after_worst_s", number(s.caught_after_worst_s)},
                    {"released_after_worst_s", number(s.released_after_worst_s)},
                    {"drop_median_m", number(s.drop_median_m)},
                    {"drop_worst_m", number(s.drop_worst_m)}};
  out["trials"] = Json::array();
  for (const Trial& t : r.trials) out["trials"].push_back(trial(t));
  out["sweeps"] = Json::object();
  for (const Sweep& sweep : r.sweeps) {
    Json rows = Json::array();
    for (const Trial& t : sweep.trials) rows.push_back(trial(t));
    out["sweeps"][std::string(sweep.of)] = std::move(rows);
  }
  out["holding"] = Json::array();
  for (const Holding& h : r.holding)
    out["holding"].push_back({{"pressing_n", h.pressing_n}, {"load_kg", h.load_kg}});
  out["checks"] = Json::array();
  for (const Check& c : r.checks)
    out["checks"].push_back(
        {{"limit", c.name}, {"asked", c.limit}, {"measured", number(c.measured)}, {"passed", c.passed}});
  return out.dump(2) + "\n";
}

}  // namespace furcula::bench
