// Walks of the biped: the search, and a walk as a log.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/walk/ensemble.hpp"
#include "host/walk/postures.hpp"
#include "host/walk/search.hpp"
#include "host/walk/simulation.hpp"
#include "host/walk/walk_file.hpp"
#include "host/walk/walk_report.hpp"
#include "python/src/background.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {
namespace {

const walk::Model& biped_of(const Model& model) {
  if (model.biped) return *model.biped;
  throw core::DataError(model.path + ": kind " + model.kind + "; expected a biped: walks are of one");
}

template <std::size_t N>
std::size_t place_of(const char* what, const std::string& name,
                     const std::array<std::string_view, N>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw core::DataError(std::string(what) + " = " + core::quoted(name) + ": expected one of " +
                          core::listed(names) + core::did_you_mean(name, names));
  return static_cast<std::size_t>(found - names.begin());
}

walk::Walk walk_of(const std::string& text, const walk::Model& model) {
  walk::Walk out = walk::parse_walk(text, "walk");
  if (out.robot != model.name)
    throw core::DataError("a walk of " + core::quoted(out.robot) + "; expected one of " +
                          core::quoted(model.name) + ", the robot of " + model.file);
  return out;
}

struct FoundWalk {
  std::string json, walk, report;
};

FoundWalk search(const Model& model, const std::string& mode, const std::string& method,
                 const std::optional<std::uint64_t>& steps, const std::optional<double>& seconds,
                 std::uint64_t seed, unsigned threads, const std::string& start, bool robust,
                 double deviations, bool robustness, const py::object& progress) {
  const walk::Model& biped = biped_of(model);
  if (steps.has_value() == seconds.has_value())
    throw core::DataError("expected one of steps and seconds, the budget of the search");
  if (seconds && !(*seconds > 0.0 && *seconds <= 1e6))
    throw core::DataError("seconds = " + core::shortest(*seconds) +
                          ": expected more than 0 and at most 1000000");
  if (!(deviations >= 0.0 && deviations <= 2.0))
    throw core::DataError("deviations = " + core::shortest(deviations) + ": expected from 0 to 2");
  if (steps && *steps < 1) throw core::DataError("steps = 0: expected at least 1");
  walk::SearchOptions options;
  options.rollout =
      walk::rollout_of(biped, static_cast<walk::WalkMode>(place_of("mode", mode, walk::kModeNames)), 5.0);
  options.method = static_cast<walk::MethodKind>(place_of("method", method, walk::kMethodNames));
  options.seed = seed;
  options.seconds = seconds;
  options.steps = steps;
  options.threads = thread_count(threads);
  if (robust)
    options.ensemble =
        walk::drawn_robots(biped.machine, options.rollout.mode, {.deviations = deviations, .seed = seed});
  if (!start.empty()) options.start = walk_of(start, biped).parameters;
  if (const std::string limit = walk::limit_of_no_posture(biped.robot, options.rollout); !limit.empty())
    throw core::DataError(model.path + ": " + limit);
  FoundWalk out;
  in_background(progress, [&](Teller& tell) {
    options.interrupted = [&tell] { return tell.cancelled(); };
    const double share = robustness ? 0.98 : 1.0;
    options.progress = [&](double fraction, const std::string& doing) { tell(share * fraction, doing); };
    const walk::SearchResult found = walk::search_walk(biped.robot, options);
    if (tell.cancelled()) throw Cancelled{};
    std::optional<walk::Robustness> checked;
    if (found.found && robustness)
      checked = walk::robustness_of(
          biped.robot, options.rollout, found.walk, walk::unseen_robots(biped, options.rollout.mode),
          options.threads,
          [&](double fraction) { tell(0.98 + 0.02 * fraction, "the walk again, with errors"); });
    out.json = walk::to_json_text(found, checked, options, biped);
    out.walk = walk::format_walk(walk::walk_of(biped, options.rollout, found.walk));
    out.report = walk::render_walk_report(biped, options.rollout, found.walk, found.rollout,
                                          found.state.history, checked, "furcula.search_walk");
  });
  return out;
}

std::shared_ptr<PyLog> simulate(const Model& model, const std::string& text, double seconds, double rate_hz,
                                const std::optional<std::uint64_t>& seed) {
  const walk::Model& biped = biped_of(model);
  if (!(seconds >= 1.0 && seconds <= 1e4))
    throw core::DataError("seconds = " + core::shortest(seconds) + ": expected from 1 to 10000");
  constexpr double kController_hz = 1000.0;
  const double ticks = kController_hz / rate_hz;
  if (!(rate_hz >= 1.0 && rate_hz <= kController_hz && std::abs(ticks - std::round(ticks)) < 1e-9))
    throw core::DataError("rate_hz = " + core::shortest(rate_hz) +
                          ": expected from 1 to 1000, the controller's rate, and a whole part of it");
  const walk::Walk walk = walk_of(text, biped);
  walk::require_steps(walk, "walk");
  // A longer run walks longer, and has as long to stand.
  walk::RolloutOptions rollout = walk::rollout_of(biped, walk.mode, walk.walk_until_s);
  rollout.walk_until_s = std::max(walk.walk_until_s, seconds - (rollout.time_s - walk.walk_until_s));
  rollout.time_s = seconds;
  const py::gil_scoped_release release;
  log::Log out = walk::simulate_walk(biped.robot, rollout, walk.parameters, 1.0 / rate_hz, seed).log;
  out.path = "simulated walk";
  return std::make_shared<PyLog>(PyLog{std::move(out)});
}

}  // namespace

void add_walks(py::module_& module) {
  py::class_<FoundWalk>(module, "FoundWalk")
      .def_readonly("json", &FoundWalk::json)
      .def_readonly("walk", &FoundWalk::walk)
      .def_readonly("report", &FoundWalk::report);
  module.def("search_walk", search);
  module.def("simulate_walk", simulate);
}

}  // namespace furcula::python
