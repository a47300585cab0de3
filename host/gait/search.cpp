#include "host/gait/search.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/gait/workers.hpp"

namespace furcula::gait {
namespace {

using Json = nlohmann::json;

/// Costs nearer to each other than this are of one optimum.
constexpr double kSameCost = 2e-3;

Json text_of(const FreeGait& g) {
  Json out = Json::array();
  for (const JointPath& p : g.phases) out.push_back({p.duration_s, p.hip, p.knee});
  return out;
}
FreeGait free_of(const Json& text) {
  FreeGait g;
  for (std::size_t k = 0; k < 3; ++k)
    g.phases[k] = {text[k][0].get<double>(), text[k][1].get<std::vector<double>>(),
                   text[k][2].get<std::vector<double>>()};
  return g;
}

double cost_of(const Evaluation& e) { return e.cot ? *e.cot : e.cost_j; }

std::string said(double cost, double violation) {
  return "cost " + core::rounded(cost, 5) + ", violation " + core::rounded(violation, 1);
}

/// What one start came to. `why` says what stood against it, by `violation`, where it is not found.
struct Outcome {
  bool found = false;
  FreeGait free;
  FourierGait fourier;
  double cost = 0.0, violation = 0.0;
  std::string why;

  std::string text() const {
    return Json{{"found", found},
                {"free", text_of(free)},
                {"law", fourier.law.values()},
                {"apex", fourier.apex.values()},
                {"cost", cost},
                {"violation", violation},
                {"why", why}}
        .dump();
  }
  static Outcome of(const std::string& text) {
    const Json j = Json::parse(text);
    Outcome o;
    o.found = j["found"];
    o.free = free_of(j["free"]);
    o.fourier.law = FourierParameters<double>::of(j["law"]);
    o.fourier.apex = Apex<double>::of(j["apex"]);
    // JSON has no infinity.
    o.cost = j["cost"].is_null() ? 0.0 : j["cost"].get<double>();
    o.violation = j["violation"].is_null() ? 1e9 : j["violation"].get<double>();
    o.why = j["why"];
    return o;
  }
};

/// Holds an integrator's stride against the optimiser's word.
bool checked(const Gait& gait, Outcome& out) {
  try {
    const Evaluation e = evaluate(gait, false);
    out.cost = cost_of(e);
    if (e.is_gait() && e.limits.empty()) return true;
    out.why = !e.stride.whole    ? e.stride.why
              : e.limits.empty() ? "the same state after a stride"
                                 : e.limits.front();
    out.violation = e.closure;
  } catch (const core::DataError& error) {
    out.why = error.what();
  }
  return false;
}

Outcome free_from(const Query& q, const FreeGait& start, bool near, const Tell& tell) {
  Outcome out;
  out.free = start;
  FreeGait from = start;
  // Between the points where they are asked for, the ground's force may yet fall below zero and a current rise above
  // its limit: then more is asked for.
  for (const double margin : {0.0, 3.0, 10.0}) {
    FreeOptions options;
    options.near = near;
    options.margin = margin;
    options.progress = [&](int iteration, double cost, double violation) {
      if (iteration % 5 == 0) tell(said(cost, violation));
      return true;
    };
    FreeResult r = find_free_gait(q.machine, q.task, from, options);
    if (r.found) {
      FreeOptions fine = options;
      fine.near = true;
      fine.stance_intervals = 24;
      fine.flight_intervals = 12;
      const FreeResult finer = find_free_gait(q.machine, q.task, r.gait, fine);
      if (finer.found && checked({q.machine, q.task, finer.gait}, out)) {
        out.found = true;
        out.free = finer.gait;
        return out;
      }
      if (checked({q.machine, q.task, r.gait}, out)) {
        out.found = true;
        out.free = r.gait;
        return out;
      }
      from = r.gait;
      near = true;
      continue;
    }
    out.free = r.gait;
    out.why = r.worst[0] ? r.worst : r.status;
    out.violation = r.violation;
    if (margin == 0.0) return out;
  }
  return out;
}

Outcome fourier_from(const Query& q, const FreeGait& start, double omega_factor, const Tell& tell) {
  FourierOptions options;
  options.omega_factor = omega_factor;
  options.progress = [&](int iteration, double cost, double violation) {
    if (iteration % 5 == 0) tell(said(cost, violation));
    return true;
  };
  Outcome out;
  out.free = start;
  try {
    const FourierResult r = find_fourier_gait(q.machine, q.task, start, options);
    out.fourier = r.gait;
    if (r.found && checked({q.machine, q.task, r.gait}, out)) {
      out.found = true;
    } else if (!r.found) {
      out.why = r.worst;
      out.violation = r.violation;
    }
  } catch (const core::DataError& error) {
    out.why = error.what();
  }
  return out;
}

std::vector<Optimum> grouped(const std::vector<Outcome>& all) {
  std::vector<double> costs;
  for (const Outcome& o : all)
    if (o.found) costs.push_back(o.cost);
  std::sort(costs.begin(), costs.end());
  std::vector<Optimum> out;
  for (const double c : costs) {
    if (out.empty() || c > out.back().cost * (1.0 + kSameCost)) out.push_back({c, 0});
    ++out.back().starts;
  }
  return out;
}

const Outcome* best_of(const std::vector<Outcome>& all) {
  const Outcome* best = nullptr;
  for (const Outcome& o : all)
    if (o.found && (best == nullptr || o.cost < best->cost)) best = &o;
  return best;
}

std::string name_of(const Task& task, double value) {
  return task.clearance_m ? "a toe clearance of " + core::rounded(value, 3) + " m in place"
                          : "a speed of " + core::rounded(value, 3) + " m/s";
}

/// Between a task that is easy and the one that was asked for, as far as it goes.
std::optional<double> nearest(const Query& query, const Tell& tell) {
  Query q = query;
  double& value = q.task.clearance_m ? *q.task.clearance_m : *q.task.speed_mps;
  const double asked = value;
  const auto at = [&](double v, const FreeGait& from, bool near, FreeGait& found) {
    value = v;
    tell("the nearest: " + core::rounded(v, 3));
    FreeOptions options;
    options.near = near;
    options.iterations = 150;
    const FreeResult r = find_free_gait(q.machine, q.task, from, options);
    Outcome out;
    if (!r.found || !checked({q.machine, q.task, r.gait}, out)) return false;
    found = r.gait;
    return true;
  };
  for (double easy : q.task.clearance_m ? std::vector{0.075, 0.03, 0.01} : std::vector{1.0, 0.5}) {
    if (asked < 0.0) easy = -easy;
    if (q.task.clearance_m && easy > asked) continue;
    FreeGait here;
    value = easy;
    if (!at(easy, rough_gait(q.machine, q.task, 0), false, here)) continue;
    // As far as it goes, in steps that halve where it does not.
    double reached = easy, step = 0.25 * (asked - easy);
    for (int round = 0; round < 12 && std::abs(step) > 0.01 * std::abs(easy); ++round) {
      const double next_value =
          std::abs(reached + step) < std::abs(asked) ? reached + step : 0.5 * (reached + asked);
      FreeGait next;
      if (at(next_value, here, true, next) || at(next_value, rough_gait(q.machine, q.task, 0), false, next)) {
        reached = next_value;
        here = next;
      } else {
        step *= 0.5;
      }
    }
    return reached;
  }
  return std::nullopt;
}

}  // namespace

Search find_gait(const Query& query) {
  const auto begin = std::chrono::steady_clock::now();
  Search out;
  const std::size_t starts = query.from ? 1 : std::max(1u, query.starts);
  double best = std::numeric_limits<double>::infinity();
  std::size_t told_done = 0;
  const double share = query.fourier ? 0.4 : 1.0;
  const auto told = [&](double from, double width, std::size_t count) {
    told_done = 0;
    return [&query, &best, &told_done, from, width, count](std::size_t i, std::string_view line) {
      told_done = std::max(told_done, i);
      if (!query.progress) return;
      std::string doing = std::isfinite(best) ? "best " + core::rounded(best, 5) + "; " : "";
      doing += "start " + std::to_string(i + 1) + ": " + std::string(line);
      query.progress(from + width * static_cast<double>(told_done) / static_cast<double>(count), doing);
    };
  };
  const auto outcomes = [](const std::vector<std::string>& texts) {
    std::vector<Outcome> all;
    for (const std::string& t : texts) all.push_back(Outcome::of(t));
    return all;
  };
  std::vector<Outcome> free = outcomes(in_processes(
      starts, query.processes,
      [&](std::size_t i, const Tell& tell) {
        if (query.from) return free_from(query, *query.from, true, tell).text();
        const std::uint64_t variety = i == 0 ? 0 : query.seed * 1000003 + i;
        return free_from(query, rough_gait(query.machine, query.task, variety), false, tell).text();
      },
      told(0.0, share, starts)));
  const Outcome* found = best_of(free);
  std::vector<Outcome> fourier;
  std::vector<Outcome>* asked = &free;
  if (found != nullptr && query.fourier) {
    best = found->cost;
    // Every optimum of free torques, with several base frequencies.
    std::vector<const Outcome*> from;
    for (const Optimum& o : grouped(free)) {
      if (from.size() == 2) break;
      for (const Outcome& f : free)
        if (f.found && f.cost >= o.cost && f.cost <= o.cost * (1.0 + kSameCost)) {
          from.push_back(&f);
          break;
        }
    }
    constexpr std::array<double, 3> kFactors{1.0, 0.6, 1.6};
    const std::size_t factors = query.from ? 1 : std::min<std::size_t>(kFactors.size(), starts);
    const std::size_t jobs = from.size() * factors;
    fourier = outcomes(in_processes(
        jobs, query.processes,
        [&](std::size_t i, const Tell& tell) {
          return fourier_from(query, from[i / factors]->free, kFactors[i % factors], tell).text();
        },
        told(share, 1.0 - share, jobs)));
    asked = &fourier;
    found = best_of(fourier);
  }
  out.optima = grouped(*asked);
  for (const Outcome& o : *asked) out.without += o.found ? 0 : 1;
  if (found != nullptr) {
    Gait gait{query.machine, query.task, found->free};
    if (query.fourier) gait.motion = found->fourier;
    out.free = found->free;
    out.evaluation = evaluate(gait);
    out.gait = std::move(gait);
  } else {
    const Outcome& least =
        *std::min_element(asked->begin(), asked->end(),
                          [](const Outcome& a, const Outcome& b) { return a.violation < b.violation; });
    const double value =
        query.task.clearance_m ? *query.task.clearance_m : query.task.speed_mps.value_or(0.0);
    out.refusal = "no gait was found for " + name_of(query.task, value) + " from " + std::to_string(starts) +
                  (starts == 1 ? " start" : " starts") + "; limiting constraint: " + least.why;
    if (query.fourier && asked == &fourier) {
      out.refusal += "; with free torques there is one";
    } else {
      const auto tell = [&](std::string_view line) {
        if (query.progress) query.progress(0.9, line);
      };
      if (query.explains) {
        const auto near = nearest(query, tell);
        out.refusal += near ? "; the nearest that was found is " + name_of(query.task, *near)
                            : "; nor was one found for an easier task";
      }
    }
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace furcula::gait
