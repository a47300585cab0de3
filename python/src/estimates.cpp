// Simulation, identification and diagnosis. Results are JSON of the contract, which Python makes classes of, and arrays.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <system_error>
#include <tuple>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/gait/machine_file.hpp"
#include "host/identify/identification.hpp"
#include "host/identify/split.hpp"
#include "host/model/writer.hpp"
#include "host/report/diagnosis_report.hpp"
#include "host/report/identification_json.hpp"
#include "host/report/identification_report.hpp"
#include "host/report/robot_picture.hpp"
#include "host/result/diagnosis_json.hpp"
#include "host/sim/simulate.hpp"
#include "host/traces/of_axis.hpp"
#include "host/traces/of_tree.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/exports.hpp"
#include "host/trees/identify.hpp"
#include "host/trees/joint_choice.hpp"
#include "host/trees/result.hpp"
#include "host/trees/simulate.hpp"
#include "python/src/background.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {
namespace {

using Logs = std::vector<std::shared_ptr<PyLog>>;

/// What identify and diagnose have in common.
struct Recordings {
  std::vector<log::Log> training, held_out;
};

struct Settings {
  double window_s = 0.0;  ///< 0: as usual
  unsigned threads = 0;
  std::uint64_t seed = 1;
  bool trust_columns = false;

  template <class Options>
  void put_into(Options& options, bool tree, Teller& tell) const {
    options.window_s = window_s > 0.0 ? window_s : tree ? 0.3 : 0.5;
    options.threads = thread_count(threads);
    options.trust_columns = trust_columns;
    options.progress = [&tell](double fraction, std::string_view doing) { tell(fraction, doing); };
  }
};

Recordings recordings_of(const Model& model, const Logs& training, const Logs& held_out,
                         const Settings& settings) {
  if (!(settings.window_s >= 0.0 && settings.window_s <= 60.0))
    throw core::DataError("window_s = " + core::shortest(settings.window_s) +
                          ": expected a number of seconds above 0 and up to 60, or None");
  if (training.empty()) throw core::DataError("no log is given to fit; expected at least one");
  std::set<const PyLog*> seen;
  Recordings out;
  const auto take = [&](const Logs& logs, std::vector<log::Log>& to) {
    for (const auto& l : logs) {
      if (!seen.insert(l.get()).second)
        throw core::DataError(l->log.path + " is given twice; expected each log once, to fit or to hold out");
      if (l->log.rig != model.rig())
        throw core::DataError(l->log.path + ": a log of machine " + core::quoted(l->log.rig) +
                              "; expected one of " + core::quoted(model.rig()) + ", as " + model.path);
      to.push_back(l->log);
    }
  };
  take(training, out.training);
  take(held_out, out.held_out);
  if (held_out.empty())
    std::tie(out.training, out.held_out) = identify::split(std::move(out.training), settings.seed);
  return out;
}

trees::TreeModel tree_of(const Model& model, const Recordings& r) {
  std::set<std::string> names;
  std::vector<const log::Log*> all;
  for (const auto* list : {&r.training, &r.held_out})
    for (const log::Log& l : *list) {
      all.push_back(&l);
      for (const auto& [name, values] : l.columns) names.insert(name);
    }
  trees::TreeModel out = tree_for(model, {names.begin(), names.end()});
  for (std::string& note : trees::notes_on_held(out, all)) out.notes.push_back(std::move(note));
  return out;
}

void refuse_biped(const Model& model, const char* what) {
  if (model.biped)
    throw core::DataError(model.path + ": kind biped is not for " + what +
                          "; expected a machine with one joint or a tree");
}

/// What a computation found: text of the contract, a model, arrays.
struct Found {
  std::string json, report;
  Model model;
  std::vector<result::Trace>
      traces;  ///< of an identification: `extended` is the identified model's, `refitted` empty
  Eigen::MatrixXd covariance;  ///< of an identified tree's parameters; else empty
  traces::Traces of_logs;      ///< of all rows, as the program writes them
};

/// A tree as a model in Python's hands; `urdf` is the text of the URDF with fitted bodies, empty: as given.
Model tree_again(const Model& given, const trees::TreeModel& tree, const std::string& urdf) {
  std::string text = urdf.empty() ? tree.urdf_text : urdf;
  const std::string name = urdf.empty() ? tree.urdf_path : "fitted_bodies.urdf";
  return parse_model(trees::format_tree_model(tree, name), given.path, text, given.accept_inertias);
}

Model machine_again(const Model& given, const model::Model& machine) {
  return parse_model(model::format_model(machine), given.path, "", false);
}

Found diagnose_tree(const Model& model, const Recordings& r, const Settings& settings, Teller& tell) {
  const trees::TreeModel tree = tree_of(model, r);
  trees::Options options;
  settings.put_into(options, true, tell);
  trees::Diagnosis d = trees::diagnose(tree, r.training, r.held_out, options);
  d.notes.insert(d.notes.begin(), tree.notes.begin(), tree.notes.end());
  trees::TreeModel extended = tree;
  extended.drives = d.extended.drives;
  extended.causes = d.extended.causes;
  const std::string urdf = d.extended.bodies.empty() ? "" : trees::urdf_with_bodies(tree, d.extended.bodies);
  const result::Diagnosis found = trees::result_of(d);
  return {
      result::to_json_text(found),
      report::render_report(found, "furcula.diagnose", report::robot_picture(d)),
      tree_again(model, extended, urdf),
      d.traces,
      {},
      traces::of_tree(
          tree, {{"given", {tree.drives, tree.causes}}, {"refitted", d.refitted}, {"extended", d.extended}},
          r.training, r.held_out, options.window_s)};
}

Found diagnose_machine(const Model& model, const Recordings& r, const Settings& settings, Teller& tell) {
  diagnose::Options options;
  settings.put_into(options, false, tell);
  const diagnose::Diagnosis d = diagnose::diagnose(*model.machine, r.training, r.held_out, options);
  const result::Diagnosis found = diagnose::result_of(d);
  return {result::to_json_text(found),
          report::render_report(found, "furcula.diagnose"),
          machine_again(model, d.extended_model),
          d.traces,
          {},
          traces::of_axis(
              {{"given", *model.machine}, {"refitted", d.refitted_model}, {"extended", d.extended_model}},
              d.refitted_model, r.training, r.held_out, options.window_s)};
}

Found identify_tree(const Model& model, const Recordings& r, const Settings& settings, Teller& tell) {
  const trees::TreeModel tree = tree_of(model, r);
  trees::Options options;
  settings.put_into(options, true, tell);
  trees::Identification found = trees::identify(tree, r.training, r.held_out, options);
  found.notes = tree.notes;
  const std::string urdf = found.bodies.empty() ? "" : trees::urdf_with_bodies(tree, found.bodies);
  const trees::Hypothesis refitted{found.model.drives, found.model.causes, found.bodies};
  return {trees::to_json_text(found),
          "",
          tree_again(model, found.model, urdf),
          {},
          found.covariance,
          traces::of_tree(tree, {{"given", {tree.drives, tree.causes}}, {"refitted", refitted}}, r.training,
                          r.held_out, options.window_s)};
}

Found identify_machine(const Model& model, const Recordings& r, const Settings& settings,
                       const std::string& method, std::size_t folds, Teller& tell) {
  if (model.machine->free.empty())
    throw core::DataError(
        model.path +
        ": no parameter in [free], so there is nothing to identify; expected at least one, as in [free] " +
        std::string(dynamics::info(model.machine->kind).parameters.front().name) + " = [lower, upper]");
  identify::IdentifyOptions options;
  settings.put_into(options, false, tell);
  options.by_equation = method != "simulation";
  options.by_simulation = method != "equation";
  options.folds = folds;
  const identify::Identification found = identify::identify(*model.machine, r.training, r.held_out, options);
  std::vector<result::Trace> traces;
  for (const identify::FittedTrace& t : found.traces)
    traces.push_back({t.log, t.channel, t.unit, t.time_s, t.measured, t.as_given, {}, t.identified});
  return {report::to_json_text(found),
          report::render_identification_report(found, "furcula.identify"),
          machine_again(model, found.estimations.front().model),
          std::move(traces),
          {},
          traces::of_axis({{"given", *model.machine}, {"refitted", found.estimations.front().model}},
                          found.estimations.front().model, r.training, r.held_out, options.window_s)};
}

Found diagnose_any(const Model& model, const Logs& training, const Logs& held_out, double window_s,
                   unsigned threads, std::uint64_t seed, bool trust_columns, const py::object& progress) {
  refuse_biped(model, "diagnose");
  const Settings settings{window_s, threads, seed, trust_columns};
  const Recordings r = recordings_of(model, training, held_out, settings);
  Found out;
  in_background(progress, [&](Teller& tell) {
    out = model.tree ? diagnose_tree(model, r, settings, tell) : diagnose_machine(model, r, settings, tell);
  });
  return out;
}

Found identify_any(const Model& model, const Logs& training, const Logs& held_out, double window_s,
                   unsigned threads, std::uint64_t seed, bool trust_columns, const std::string& method,
                   std::size_t folds, const py::object& progress) {
  refuse_biped(model, "identify");
  if (method != "simulation" && method != "equation" && method != "both")
    throw core::DataError("method = " + core::quoted(method) +
                          ": expected \"simulation\", \"equation\" or \"both\"");
  if (model.tree && method != "simulation")
    throw core::DataError("method = " + core::quoted(method) + ": a tree is identified by simulation");
  if (model.tree && folds != 0)
    throw core::DataError("folds = " + std::to_string(folds) + ": on a tree nothing is cross-validated");
  if (folds == 1 || folds > 1000)
    throw core::DataError("folds = " + std::to_string(folds) +
                          ": expected 2 to 1000, or 0 for as many as usual");
  const Settings settings{window_s, threads, seed, trust_columns};
  const Recordings r = recordings_of(model, training, held_out, settings);
  Found out;
  in_background(progress, [&](Teller& tell) {
    out = model.tree ? identify_tree(model, r, settings, tell)
                     : identify_machine(model, r, settings, method, folds, tell);
  });
  return out;
}

/// `scenario` is the text of a scenario file, none: what is usual for the kind.
std::shared_ptr<PyLog> simulate(const Model& model, const std::optional<std::string>& scenario,
                                const std::string& name, std::uint64_t seed) {
  refuse_biped(model, "simulate; simulate_walk simulates its walks");
  if (gait::is_planar_leg(model.text))
    throw core::DataError(model.path +
                          ": a planar leg plays gaits, which `furcula sim` simulates; expected another kind");
  const py::gil_scoped_release release;
  log::Log out;
  if (model.tree) {
    const trees::Scenario run =
        scenario ? trees::parse_scenario(*scenario, name, *model.tree) : trees::default_scenario(*model.tree);
    out = trees::simulate(*model.tree, run, seed);
  } else {
    const sim::Scenario run = scenario ? sim::parse_scenario(*scenario, name, *model.machine)
                                       : sim::default_scenario(*model.machine);
    out = sim::simulate(*model.machine, run, seed);
  }
  if (out.rows() == 0)
    throw core::DataError(name + ": the height is not homed from the start, so that the log has no row");
  out.path = "simulated, seed " + std::to_string(seed);
  return std::make_shared<PyLog>(PyLog{std::move(out)});
}

py::list traces_of(const Found& found) {
  py::list out;
  for (const result::Trace& t : found.traces) {
    py::dict d;
    d["log"] = text_of(t.log);
    d["channel"] = t.channel;
    d["unit"] = t.unit;
    d["time_s"] = array_of(t.time_s);
    d["measured"] = array_of(t.measured);
    d["as_given"] = array_of(t.as_given);
    d["refitted"] = array_of(t.refitted);
    d["extended"] = array_of(t.extended);
    out.append(d);
  }
  return out;
}

Array covariance_of(const Found& found) {
  const Eigen::MatrixXd& c = found.covariance;
  Array out({c.rows(), c.cols()});
  for (Eigen::Index i = 0; i < c.rows(); ++i)
    for (Eigen::Index j = 0; j < c.cols(); ++j) out.mutable_at(i, j) = c(i, j);
  return out;
}

}  // namespace

void add_estimates(py::module_& module) {
  py::class_<Found>(module, "Found")
      .def_readonly("json", &Found::json)
      .def_property_readonly("report", [](const Found& f) { return text_of(f.report); })
      .def_readonly("model", &Found::model)
      .def_property_readonly("traces", traces_of)
      .def_property_readonly("covariance", covariance_of)
      .def("trace_files", [](const Found& f) {
        py::dict out;
        for (const core::NewFile& file : traces::files(f.of_logs, "traces"))
          out[text_of(file.path)] = text_of(file.content);
        return out;
      });
  module.def("simulate", simulate);
  module.def("diagnose", diagnose_any);
  module.def("identify", identify_any);
}

}  // namespace furcula::python
