#include "host/gait/study.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/core/message.hpp"
#include "host/gait/workers.hpp"

namespace furcula::gait {
namespace {

using Json = nlohmann::ordered_json;

/// Rows that are found one after the other, each from the one before.
using Chain = std::vector<StudyRow>;

Query query_of(const Machine& robot, const StudyRow& row) {
  Query q;
  q.machine = robot;
  q.machine.open.clear();
  q.machine.spring = row.spring;
  q.machine.catching = {row.catch_delay_s, row.lost_rad};
  if (row.rest_rad > 0.0) q.machine.leg.rest_angle_rad = row.rest_rad;
  if (row.speed_mps)
    q.task.speed_mps = row.speed_mps;
  else
    q.task.clearance_m = 0.075;
  q.task.friction = row.friction;
  q.starts = 2;
  q.explains = false;
  return q;
}

/// For whoever waits: "parallel, 2 m/s, friction 0.6"
std::string name_of(const StudyRow& r) {
  std::string out(dynamics::kLegSpringNames[static_cast<std::size_t>(r.spring)]);
  out += r.speed_mps ? ", " + core::rounded(*r.speed_mps, 3) + " m/s" : ", in place";
  if (r.friction) out += ", friction " + core::rounded(*r.friction, 3);
  if (r.catch_delay_s > 0.0) out += ", caught after " + core::rounded(1e3 * r.catch_delay_s, 3) + " ms";
  if (r.tooth_m > 0.0) out += ", teeth of " + core::rounded(1e3 * r.tooth_m, 3) + " mm";
  if (r.spring == LegSpring::parallel)
    out += ", rest angle " + core::rounded(180.0 / std::numbers::pi * r.rest_rad, 3) + " degrees";
  return out;
}

Json json_of(const StudyRow& r) {
  const auto maybe = [](const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); };
  Json out{{"spring", dynamics::kLegSpringNames[static_cast<std::size_t>(r.spring)]},
           {"speed_mps", r.speed_mps.value_or(0.0)},
           {"catch_delay_s", r.catch_delay_s},
           {"tooth_m", r.tooth_m},
           {"lost_knee_rad", r.lost_rad},
           {"friction", maybe(r.friction)},
           {"rest_angle_rad", r.rest_rad},
           {r.speed_mps ? "cot" : "cost_j", maybe(r.cost)}};
  if (r.share) out["advantage_left"] = *r.share;
  if (!r.cost) out["why"] = r.why;
  return out;
}

std::vector<Chain> chains_of(const Machine& robot, const StudyOptions& o) {
  std::vector<Chain> out;
  const double rest = robot.leg.rest_angle_rad;
  if (o.kind == StudyKind::clutch) {
    // In place, and at 1 m/s, where both springs run.
    for (const std::optional<double> speed : {std::optional<double>(), std::optional<double>(1.0)}) {
      StudyRow row;
      row.speed_mps = speed;
      StudyRow parallel = row;
      parallel.spring = LegSpring::parallel;
      parallel.rest_rad = rest;
      out.push_back({parallel});
      Chain late{row};
      for (const double delay : {0.005, 0.010, 0.020, 0.030}) {
        row.catch_delay_s = delay;
        late.push_back(row);
      }
      out.push_back(late);
      row.catch_delay_s = 0.0;
      Chain teeth{row};
      // Half a pitch is lost in the mean, a whole one at worst.
      for (const double tooth : {0.001, 0.003, 0.006})
        for (const double part : {0.5, 1.0}) {
          row.tooth_m = tooth;
          row.lost_rad = part * tooth / o.lever_m;
          teeth.push_back(row);
        }
      out.push_back(teeth);
    }
  } else if (o.kind == StudyKind::ground) {
    for (const LegSpring spring : {LegSpring::switched, LegSpring::parallel, LegSpring::none})
      for (const double speed : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0}) {
        StudyRow row;
        row.spring = spring;
        row.speed_mps = speed;
        if (spring == LegSpring::parallel) row.rest_rad = rest;
        Chain chain{row};
        for (const double friction : {1.5, 1.0, 0.8, 0.6, 0.4, 0.2}) {
          row.friction = friction;
          chain.push_back(row);
        }
        out.push_back(chain);
      }
  } else {
    for (const double speed : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0})
      for (const double way : {1.0, -1.0}) {
        // Up and down from the print's.
        Chain chain;
        for (int step = 0; step <= 5; ++step) {
          StudyRow row;
          row.spring = LegSpring::parallel;
          if (speed > 0.0) row.speed_mps = speed;
          row.rest_rad = rest + way * step * 5.0 * std::numbers::pi / 180.0;
          chain.push_back(row);
        }
        out.push_back(chain);
      }
  }
  return out;
}

}  // namespace

std::vector<StudyRow> run_study(const Machine& robot, const StudyOptions& options) {
  const std::vector<Chain> chains = chains_of(robot, options);
  const auto job = [&](std::size_t i, const Tell& tell) {
    Json out = Json::array();
    std::optional<FreeGait> from;
    for (const StudyRow& row : chains[i]) {
      Query q = query_of(robot, row);
      tell(name_of(row));
      q.from = from;
      Search s = find_gait(q);
      if (!s.gait && from) {
        q.from.reset();
        s = find_gait(q);
      }
      if (s.gait) from = s.free;
      out.push_back(
          {s.gait ? Json(s.evaluation.cot.value_or(s.evaluation.cost_j)) : Json(nullptr), s.refusal});
    }
    return out.dump();
  };
  std::size_t all = 0, begun = 0;
  for (const Chain& chain : chains) all += chain.size();
  const auto texts =
      in_processes(chains.size(), options.processes, job, [&](std::size_t, std::string_view line) {
        if (options.progress) options.progress(static_cast<double>(begun) / static_cast<double>(all), line);
        ++begun;
      });
  std::vector<StudyRow> rows;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const Json results = Json::parse(texts[i]);
    for (std::size_t k = 0; k < chains[i].size(); ++k) {
      StudyRow row = chains[i][k];
      if (!results[k][0].is_null()) row.cost = results[k][0].get<double>();
      row.why = results[k][1].get<std::string>();
      rows.push_back(row);
    }
  }
  if (options.kind == StudyKind::clutch)
    for (StudyRow& row : rows) {
      const auto cost = [&](LegSpring spring) -> std::optional<double> {
        for (const StudyRow& r : rows)
          if (r.spring == spring && r.speed_mps == row.speed_mps && r.catch_delay_s == 0.0 &&
              r.lost_rad == 0.0)
            return r.cost;
        return std::nullopt;
      };
      const auto parallel = cost(LegSpring::parallel), ideal = cost(LegSpring::switched);
      if (row.spring == LegSpring::switched && row.cost && parallel && ideal)
        row.share = (*parallel - *row.cost) / (*parallel - *ideal);
    }
  return rows;
}

std::string study_json(const std::vector<StudyRow>& rows, const StudyOptions& options) {
  Json list = Json::array();
  for (const StudyRow& r : rows) list.push_back(json_of(r));
  return Json{{"schema", "furcula-gait-study/1"},
              {"study", kStudyNames[static_cast<std::size_t>(options.kind)]},
              {"lever_m", options.lever_m},
              {"gaits", list}}
             .dump(2) +
         "\n";
}

std::string study_csv(const std::vector<StudyRow>& rows) {
  std::string out =
      "spring,speed_mps,catch_delay_s,tooth_m,lost_knee_rad,friction,rest_angle_rad,cost,advantage_left\n";
  const auto maybe = [](const std::optional<double>& v) { return v ? core::rounded(*v, 5) : std::string(); };
  for (const StudyRow& r : rows)
    out += std::string(dynamics::kLegSpringNames[static_cast<std::size_t>(r.spring)]) + "," +
           core::rounded(r.speed_mps.value_or(0.0), 3) + "," + core::rounded(r.catch_delay_s, 3) + "," +
           core::rounded(r.tooth_m, 3) + "," + core::rounded(r.lost_rad, 4) + "," + maybe(r.friction) + "," +
           core::rounded(r.rest_rad, 5) + "," + maybe(r.cost) + "," + maybe(r.share) + "\n";
  return out;
}

}  // namespace furcula::gait
