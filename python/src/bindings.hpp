// What the files of the module share. Each `add_...` puts its names into the module.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/result/diagnosis.hpp"
#include "python/src/models.hpp"

namespace furcula::python {

namespace py = pybind11;

/// Numbers by rows; what Python hands in is converted.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

void add_logs(py::module_& module);
void add_models(py::module_& module);
void add_dynamics(py::module_& module);
void add_estimates(py::module_& module);
void add_walks(py::module_& module);
void add_tools(py::module_& module);

/// A log as Python holds it: read only, so that arrays of its columns need no copy.
struct PyLog {
  log::Log log;
};

/// The values in an array of their own.
Array array_of(const std::vector<double>& values);

/// Text that may hold bytes that are no UTF-8, as names of files do: in messages U+FFFD stands for them.
py::str text_of(const std::string& bytes);
/// The name of a file as Python has it.
py::str path_of(const std::string& bytes);

/// As many as the option says (0: as the machine has).
unsigned thread_count(unsigned threads);

}  // namespace furcula::python
