// What `furcula check`, `furcula map` and `furcula replay` do: what is in a log, a map file for one, and a model run on its inputs.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/column_map.hpp"
#include "host/log/data_quality.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/mapping/propose.hpp"
#include "host/traces/of_axis.hpp"
#include "host/traces/of_tree.hpp"
#include "host/trees/joint_choice.hpp"
#include "host/trees/recording.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {
namespace {

std::vector<std::string> names_of(const log::Log& log) {
  std::vector<std::string> out;
  for (const auto& [name, values] : log.columns) out.push_back(name);
  return out;
}

py::dict check(const std::string& path, const Model* model, const std::string& machine,
               const std::string& map_path) {
  std::optional<log::ColumnMap> map;
  std::string rig = model != nullptr ? model->rig() : machine;
  log::LogSummary s;
  std::vector<std::string> of_robot;
  {
    const py::gil_scoped_release release;
    if (!map_path.empty()) map = log::read_column_map(map_path);
    const log::ColumnMap* const used = map ? &*map : nullptr;
    if (rig.empty() && map) rig = map->rig;
    if (rig.empty()) rig = log::rig_line(path, used);
    if (rig.empty()) throw core::DataError(log::no_rig(path));
    if (log::machine_type_named(rig) == nullptr)
      throw core::DataError("machine_type = " + core::quoted(rig) + ": no such machine");
    s = log::check_log(path, rig, used);
    if (!s.stamps.fatal().empty()) throw core::DataError(s.stamps.fatal());
    if (model != nullptr && model->tree) {
      // Which columns a robot's log must have, its joints say.
      const log::Log log = log::read_log(path, rig, used);
      const trees::TreeModel tree = tree_for(*model, names_of(log));
      of_robot = trees::notes_on_held(tree, {&log});
      for (const std::string& note : trees::recording_of(tree, log).log_notes)
        if (std::find(log.notes.begin(), log.notes.end(), note) == log.notes.end()) of_robot.push_back(note);
    }
  }
  py::list warnings, ignored;
  if (!s.refused.empty()) warnings.append(text_of(log::in_words(s.refused, s.rejected_rows)));
  for (const auto* notes : {&s.notes, &s.stamps.notes, &s.stamps.remarks, &of_robot})
    for (const std::string& note : *notes) warnings.append(text_of(note));
  if (!s.last_row_ends) warnings.append("no line end after the last row: its last number may have been cut");
  for (const std::string& column : s.ignored_columns) ignored.append(text_of(column));
  py::dict out;
  out["path"] = path_of(path);
  out["machine"] = rig;
  out["columns"] = s.header.columns;
  out["ignored_columns"] = ignored;
  out["rows"] = s.rows;
  out["rejected_rows"] = s.rejected_rows;
  out["duration_s"] = s.duration_s;
  out["interval_min_s"] = s.interval_min_s;
  out["interval_median_s"] = s.interval_median_s;
  out["interval_mean_s"] = s.interval_mean_s;
  out["interval_max_s"] = s.interval_max_s;
  out["warnings"] = warnings;
  return out;
}

py::dict propose_map(const std::string& path, const Model& model) {
  if (model.biped)
    throw core::DataError(model.path + ": kind biped is not for propose_map; expected another kind");
  mapping::Proposal proposal;
  {
    const py::gil_scoped_release release;
    proposal =
        model.tree
            ? mapping::propose(
                  path, [&](const std::vector<std::string>& columns) { return tree_for(model, columns); })
            : mapping::propose(path, *model.machine);
  }
  const auto list = [](const std::vector<std::string>& all) {
    py::list out;
    for (const std::string& s : all) out.append(text_of(s));
    return out;
  };
  py::dict columns, sureness;
  static constexpr const char* kSureness[]{"sure", "likely", "confirm"};
  for (const mapping::Line& line : proposal.lines) {
    py::list parts;
    for (const log::MappedPart& p : line.column.parts) parts.append(text_of(p.column));
    columns[text_of(line.ours)] = parts;
    sureness[text_of(line.ours)] = kSureness[static_cast<int>(line.sureness)];
  }
  py::dict out;
  out["text"] = text_of(mapping::map_text(proposal));
  out["columns"] = columns;
  out["sureness"] = sureness;
  out["notes"] = list(proposal.confirm);
  out["not_found"] = list(proposal.expected);
  out["not_used"] = list(proposal.left);
  return out;
}

/// Measured and predicted, and the text of the CSV file.
py::dict replay(const Model& model, const std::shared_ptr<PyLog>& of, double window_s) {
  if (model.biped)
    throw core::DataError(model.path + ": kind biped is not for replay; expected another kind");
  if (of->log.rig != model.rig())
    throw core::DataError(of->log.path + ": a log of machine " + core::quoted(of->log.rig) +
                          "; expected one of " + core::quoted(model.rig()) + ", as " + model.path);
  if (!(window_s >= 0.0 && window_s <= 60.0))
    throw core::DataError("window_s = " + core::shortest(window_s) +
                          ": expected a number of seconds above 0 and up to 60, or None");
  traces::Traces all;
  {
    const py::gil_scoped_release release;
    if (model.tree) {
      const trees::TreeModel tree = tree_for(model, names_of(of->log));
      const trees::Hypothesis given{tree.drives, tree.causes};
      all = traces::of_tree(tree, {{"predicted", given}}, {of->log}, {}, window_s > 0.0 ? window_s : 0.3);
    } else {
      all = traces::of_axis({{"predicted", *model.machine}}, *model.machine, {of->log}, {},
                            window_s > 0.0 ? window_s : 0.5);
    }
  }
  const traces::LogTraces& log = all.logs.front();
  if (std::all_of(log.window.begin(), log.window.end(), [](std::size_t w) { return w == 0; }))
    throw core::DataError(of->log.path + ": no window to predict over in " +
                          std::to_string(log.time_s.size()) +
                          " rows; expected a longer log, or a smaller window_s");
  py::array_t<std::size_t> window(static_cast<py::ssize_t>(log.window.size()), log.window.data());
  py::list channels;
  for (const traces::Quantity& q : log.quantities) {
    const traces::Error e = traces::error_of(log, q, 0);
    py::dict d;
    d["channel"] = text_of(q.column);
    d["unit"] = q.unit;
    d["measured"] = array_of(q.measured);
    d["predicted"] = array_of(q.predicted.front());
    d["rmse"] = e.rows == 0 ? py::object(py::none()) : py::float_(e.rmse);
    d["nmse"] = e.rows == 0 || std::isnan(e.nmse) ? py::object(py::none()) : py::float_(e.nmse);
    channels.append(d);
  }
  py::dict out;
  out["time_s"] = array_of(log.time_s);
  out["window"] = window;
  out["channels"] = channels;
  out["csv"] = text_of(traces::csv_text(all, log));
  return out;
}

}  // namespace

void add_tools(py::module_& module) {
  module.def("check", check);
  module.def("propose_map", propose_map);
  module.def("replay", replay);
}

}  // namespace furcula::python
