// The module `furcula._core`: thin functions, whose words for Python are in furcula/__init__.py.
#include <algorithm>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {

Array array_of(const std::vector<double>& values) {
  return Array(static_cast<py::ssize_t>(values.size()), values.data());
}

py::str text_of(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "replace"));
}

py::str path_of(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<py::ssize_t>(bytes.size())));
}

unsigned thread_count(unsigned threads) {
  return threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
}

}  // namespace furcula::python

PYBIND11_MODULE(_core, m) {
  namespace py = pybind11;
  using namespace furcula;
  static const py::exception<core::DataError> error(m, "Error", PyExc_ValueError);
  m.attr("Error").attr("__module__") = "furcula";
  m.attr("Error").attr("__doc__") =
      "Unusable data, model or argument. The message says where, what was expected and what to do.";
  static const auto raise = [](const char* message) {
    PyErr_SetObject(error.ptr(), python::text_of(message).ptr());
  };
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const core::DataError& e) {
      raise(e.what());
    } catch (const core::OutputError& e) {
      raise(e.what());
    } catch (const std::invalid_argument& e) {
      raise(e.what());
    }
  });
  m.attr("__version__") = FURCULA_VERSION;
  python::add_logs(m);
  python::add_models(m);
  python::add_dynamics(m);
  python::add_estimates(m);
  python::add_walks(m);
  python::add_tools(m);
}
