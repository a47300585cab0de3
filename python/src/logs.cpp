// Logs: read from files, made of arrays, written.
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/accept_stamps.hpp"
#include "host/log/column_map.hpp"
#include "host/log/data_quality.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/log/writer.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {
namespace {

void require_rig(const std::string& rig) {
  if (rig.empty() || log::machine_type_named(rig) != nullptr) return;
  std::vector<std::string_view> names;
  for (const log::MachineType& r : log::kMachineTypes) names.push_back(r.name);
  throw core::DataError("machine_type = " + core::quoted(rig) + ": no such machine; expected one of " +
                        core::listed(names) + core::did_you_mean(rig, names));
}

log::Log read(const std::string& path, const std::string& rig, const std::string& map_path, double window_s) {
  require_rig(rig);
  std::optional<log::ColumnMap> map;
  if (!map_path.empty()) map = log::read_column_map(map_path);
  const log::ColumnMap* const used = map ? &*map : nullptr;
  if (rig.empty() && (!map || map->rig.empty()) && log::rig_line(path, used).empty())
    throw core::DataError(
        path +
        ": the log does not name its machine; expected a line '# machine_type: ...' in it, machine_type in the map file, "
        "or machine = one of the types of docs/contracts.md, section 1");
  log::Log out = log::read_log(path, rig, used);
  log::accept_stamps(out, used, window_s);
  return out;
}

/// Through the text of a log, so that the reader checks what stands in it.
log::Log of_columns(const std::map<std::string, Array>& columns, const std::string& rig,
                    const std::string& name, double window_s) {
  require_rig(rig);
  const auto time = columns.find("time_s");
  if (time == columns.end()) throw core::DataError(name + ": no column time_s; expected one, in s");
  log::Log made;
  made.rig = rig;
  for (const auto& [column, values] : columns) {
    const std::string where = name + ": column " + core::quoted(column);
    if (values.ndim() != 1)
      throw core::DataError(where + " has " + std::to_string(values.ndim()) + " dimensions; expected one");
    if (values.size() != time->second.size())
      throw core::DataError(where + " has " + std::to_string(values.size()) + " rows; expected " +
                            std::to_string(time->second.size()) + ", as time_s");
    std::vector<double>& to = made.columns[column];
    to.assign(values.data(), values.data() + values.size());
    const auto bad = std::find_if_not(to.begin(), to.end(), [](double v) { return std::isfinite(v); });
    if (bad != to.end())
      throw core::DataError(where + ", index " + std::to_string(bad - to.begin()) + ": " +
                            core::shortest(*bad) + "; expected finite numbers: leave such rows out");
  }
  log::Log out = log::parse_log(log::format_log(made), name, rig);
  log::accept_stamps(out, nullptr, window_s);
  return out;
}

/// A column without a copy: the array keeps the log.
Array column(const py::object& self, const std::string& name) {
  const log::Log& log = self.cast<const PyLog&>().log;
  const auto found = log.columns.find(name);
  if (found == log.columns.end()) {
    std::vector<std::string_view> names;
    for (const auto& [other, values] : log.columns) names.push_back(other);
    throw py::key_error(log.path + ": no column " + core::quoted(name) + "; expected one of " +
                        core::listed(names) + core::did_you_mean(name, names));
  }
  Array out(static_cast<py::ssize_t>(found->second.size()), found->second.data(), self);
  out.attr("flags").attr("writeable") = false;
  return out;
}

py::dict columns(const py::object& self) {
  py::dict out;
  for (const auto& [name, values] : self.cast<const PyLog&>().log.columns)
    out[py::str(name)] = column(self, name);
  return out;
}

py::list warnings(const PyLog& self) {
  py::list out;
  for (const std::string& line : log::lines_of({self.log.refused, self.log.notes, {}}))
    out.append(text_of(line));
  for (const auto& [name, why] : self.log.unusable)
    out.append(text_of(self.log.path + ": " + name + ": " + why));
  return out;
}

}  // namespace

void add_logs(py::module_& module) {
  py::class_<PyLog, std::shared_ptr<PyLog>>(module, "Log")
      .def_property_readonly("path", [](const PyLog& l) { return path_of(l.log.path); })
      .def_property_readonly("machine", [](const PyLog& l) { return l.log.rig; })
      .def_property_readonly("metadata", [](const PyLog& l) { return l.log.metadata; })
      .def_property_readonly("time_s", [](const py::object& l) { return column(l, "time_s"); })
      .def_property_readonly("columns", columns)
      .def_property_readonly("warnings", warnings)
      .def("__getitem__", column)
      .def("__contains__", [](const PyLog& l, const std::string& name) { return l.log.has(name); })
      .def("__len__", [](const PyLog& l) { return l.log.rows(); })
      .def("write",
           [](const PyLog& l, const std::filesystem::path& path) { log::write_log(l.log, path.string()); })
      .def("__repr__", [](const PyLog& l) {
        return text_of("<furcula.Log of " + l.log.rig + ", " + std::to_string(l.log.rows()) + " rows, " +
                       l.log.path + ">");
      });
  module.def("read_log",
             [](const std::string& path, const std::string& rig, const std::string& map, double window_s) {
               const py::gil_scoped_release release;
               return std::make_shared<PyLog>(PyLog{read(path, rig, map, window_s)});
             });
  module.def("make_log", [](const std::map<std::string, Array>& values, const std::string& rig,
                            const std::string& name, double window_s) {
    return std::make_shared<PyLog>(PyLog{of_columns(values, rig, name, window_s)});
  });
}

}  // namespace furcula::python
