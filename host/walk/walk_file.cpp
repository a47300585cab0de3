#include "host/walk/walk_file.hpp"

#include <toml++/toml.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "host/biped/machine_toml.hpp"
#include "host/biped/robot.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/walk/ensemble.hpp"
#include "host/walk/toml_section.hpp"

namespace furcula::walk {
namespace {

using core::fail;

void expect_kind(const toml::table& table, const std::string& name) {
  const toml::node& kind = entry(table, name, "kind", "[model]");
  if (const std::string which = core::text(kind, name, "kind"); which != "biped")
    fail(name, kind.source(), "kind = " + core::quoted(which) + "; expected \"biped\": walks are of a biped");
}
}  // namespace

Model read_model(const std::string& path) {
  static constexpr std::array<std::string_view, 3> kSections{"model", "limits", "deviations"};
  static constexpr std::array<std::string_view, 3> kKeys{"kind", "schema", "urdf"};
  const toml::table file = core::parse_toml(core::read_small_file(path, "a model file (TOML)"), path);
  const toml::table& model = section(file, path, "model");
  expect_kind(model, path);
  core::refuse_unknown_keys(file, path, "the model file of a biped", kSections);
  core::refuse_unknown_keys(model, path, "[model] of a biped", kKeys);
  expect_schema(model, path, "[model]");
  Model out;
  out.file = path;
  const std::string urdf = core::text(entry(model, path, "urdf", "[model]"), path, "urdf");
  const model::Urdf robot = model::read_urdf((std::filesystem::path(path).parent_path() / urdf).string());
  out.name = robot.name;
  out.undeviated = out.machine.robot = biped::biped_of(robot);
  if (file.contains("deviations"))
    biped::apply_deviations(section(file, path, "deviations"), path, out.machine);
  out.robot = out.machine.robot;
  out.urdf = urdf;
  if (file.contains("limits")) {
    const toml::table& limits = section(file, path, "limits");
    std::vector<std::string_view> known;
    for (const LimitKey& k : kLimitKeys) known.push_back(k.name);
    core::refuse_unknown_keys(limits, path, "[limits]", known);
    for (const LimitKey& k : kLimitKeys)
      if (const toml::node* value = limits.get(k.name))
        out.limits.*k.of =
            core::number(*value, path, "[limits] " + std::string(k.name), k.least, k.most, k.unit);
  }
  return out;
}

RolloutOptions rollout_of(const Model& model, WalkMode mode, double walk_until_s) {
  RolloutOptions o;
  o.mode = mode;
  o.walk_until_s = walk_until_s;
  o.limits = model.limits;
  o.command_delay_s = std::max(model.machine.delay_s, 0.0);
  o.sensors = sensors_of(model.machine);
  o.known = model.undeviated;
  return o;
}

std::string format_model(const Model& model, const biped::Machine& machine, const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path urdf = fs::absolute(fs::path(model.file).parent_path() / model.urdf);
  toml::table limits;
  for (const LimitKey& k : kLimitKeys) limits.insert(k.name, model.limits.*k.of);
  std::ostringstream out;
  out << toml::table{{"model", toml::table{{"kind", "biped"},
                                           {"schema", 1},
                                           {"urdf", fs::relative(urdf, fs::absolute(folder)).string()}}},
                     {"limits", limits}}
      << "\n\n";
  // Against the URDF and the design, not against the model that was given.
  biped::Machine design;
  design.robot = model.undeviated;
  return out.str() + biped::format_deviations(design, machine);
}

std::vector<Member> unseen_robots(const Model& model, WalkMode mode) {
  constexpr std::size_t kRobots = 64;
  constexpr std::uint64_t kOfNoSearch = 0x756e7365656e;
  return drawn_robots(model.machine, mode, {.robots = kRobots, .seed = kOfNoSearch});
}

std::vector<std::string> broken_limits(const Rollout& r, const WalkLimits& m) {
  std::vector<std::string> out;
  const auto said = [](double v) { return core::rounded(v, 3); };
  const auto over = [&](bool broken, const std::string& what) {
    if (broken) out.push_back(what);
  };
  over(r.ending != Ending::stands,
       std::string(kEndingNames[static_cast<std::size_t>(r.ending)]) + " after " + said(r.time_s) + " s");
  over(r.torque_nm > m.torque_nm, "a motor gives " + said(r.torque_nm) + " N m of " + said(m.torque_nm));
  over(r.speed_radps > m.speed_radps,
       "a joint turns with " + said(r.speed_radps) + " rad/s of " + said(m.speed_radps));
  over(r.moment_nm > m.moment_nm, "a foot's moment is " + said(r.moment_nm) + " N m of " + said(m.moment_nm));
  const double inside_m = kSoleMargin_m - r.outside_m;
  over(r.ending == Ending::stands && r.outside_m > 0.0,
       "it has not stopped at the end: its capture point is " + said(100.0 * std::abs(inside_m)) + " cm " +
           (inside_m > 0.0 ? "inside" : "outside") + " of the soles, where " + said(100.0 * kSoleMargin_m) +
           " cm inside are asked");
  return out;
}

std::string to_json_text(const SearchResult& found, const std::optional<Robustness>& robustness,
                         const SearchOptions& options, const Model& model) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  const double asked_s = options.rollout.time_s;
  const Rollout& r = found.rollout;
  std::vector<std::string> limits = broken_limits(r, options.rollout.limits);
  if (!found.found && limits.empty())
    limits.push_back("it gets ahead by " + core::rounded(r.distance_m, 3) + " m, where " +
                     core::rounded(options.first_walk_m, 3) + " m are asked");

  const auto trial = [&](const Trial& t) {
    return Json{{"what", t.what},
                {"ending", kEndingNames[static_cast<std::size_t>(t.rollout.ending)]},
                {"keeps_limits", t.rollout.keeps_limits()},
                {"time_s", t.rollout.time_s},
                {"distance_m", t.rollout.distance_m},
                {"cot", number(t.rollout.cot)}};
  };
  Json history = Json::array();
  for (const SearchPoint& p : found.state.history)
    history.push_back({p.cpu_s, p.objective, number(p.cot), p.steps});
  Json out = {{"schema", "furcula-walk/1"},
              {"robot", model.name},
              {"mode", kModeNames[static_cast<std::size_t>(options.rollout.mode)]},
              {"seed", options.seed},
              {"method", kMethodNames[static_cast<std::size_t>(options.method)]},
              {"ensemble", options.ensemble.size()},
              {"ended", found.interrupted ? "interrupted" : "budget"},
              {"found", found.found},
              {"first_walk", found.state.first_walk ? Json{{"cpu_s", found.state.first_walk->cpu_s},
                                                           {"steps", found.state.first_walk->steps},
                                                           {"rollouts", found.state.first_walk->rollouts}}
                                                    : Json(nullptr)},
              {"steps", found.state.steps},
              {"rollouts", found.state.rollouts},
              {"not_finite", found.state.not_finite},
              {"restarts", found.restarts},
              {"cpu_s", found.state.cpu_s},
              {"objective", r.objective(asked_s)},
              {"cot", number(r.cot)},
              {"distance_m", r.distance_m},
              {"landings", r.landings},
              {"energy_j",
               {{"total", r.energy_j()},
                {"copper", r.copper_j},
                {"work", r.work_j},
                {"positive_work", r.positive_work_j},
                {"constant", r.constant_j}}},
              {"max",
               {{"torque_nm", r.torque_nm},
                {"speed_radps", r.speed_radps},
                {"moment_nm", r.moment_nm},
                {"capture_point_outside_m", r.outside_m - kSoleMargin_m}}},
              {"limits", limits},
              {"history", history}};
  if (robustness) {
    Json steps = Json::array(), changed = Json::array();
    for (const Trial& t : robustness->steps) steps.push_back(trial(t));
    for (const Trial& t : robustness->changed) changed.push_back(trial(t));
    out["robustness"] = {{"steps", steps},
                         {"changed", changed},
                         {"noisy",
                          {{"walks", robustness->noisy},
                           {"upright", robustness->noisy_stand},
                           {"within_limits", robustness->noisy_keep_limits}}},
                         {"other_robots",
                          {{"robots", robustness->drawn},
                           {"deviations", EnsembleOptions{}.deviations},
                           {"upright", robustness->drawn_stand}}}};
    const ReturnMap& map = robustness->map;
    Json& to = out["robustness"]["return_map"];
    if (map.found)
      to = {{"stride_s", map.stride_s},
            {"stride_m", map.stride_m},
            {"cot", map.cot},
            {"closure", map.closure},
            {"multipliers", map.multipliers}};
    else
      to = {{"none", map.none}};
  }
  return out.dump(1) + "\n";
}

}  // namespace furcula::walk
