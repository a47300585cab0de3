// Dynamics of trees as functions of arrays: a row a state.
#include "furcula/dynamics/tree/energy.hpp"
#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {
namespace {

using model::RobotModel;
using Joints = RobotModel::Joints;

const RobotModel& dynamics_of(const Model& m) {
  if (m.dynamics) return *m.dynamics;
  throw core::DataError(m.path + ": the kind " + m.kind +
                        " has no joints' dynamics; expected a tree, a planar leg or a biped");
}

struct Input {
  const char* name;
  const Array* array;
};

/// Arrays of (joints,) or (N, joints): one of (joints,) stands for each of N rows.
class Rows {
 public:
  Rows(const Model& m, std::initializer_list<Input> inputs) : joints_(dynamics_of(m).count()) {
    for (const Input& in : inputs) {
      const Array& a = *in.array;
      const bool one = a.ndim() == 1;
      if ((!one && a.ndim() != 2) || a.shape(a.ndim() - 1) != static_cast<py::ssize_t>(joints_))
        throw core::DataError(std::string(in.name) + " has shape " + shape(a) + "; expected (" +
                              std::to_string(joints_) + ",) or (N, " + std::to_string(joints_) +
                              "), a number for each of model.joints");
      if (!one) {
        const auto rows = static_cast<std::size_t>(a.shape(0));
        if (!single_ && rows != rows_)
          throw core::DataError(std::string(in.name) + " has " + std::to_string(rows) + " rows; expected " +
                                std::to_string(rows_) + ", as " + named_);
        single_ = false;
        rows_ = rows;
        named_ = in.name;
      }
      data_.push_back(a.data());
      step_.push_back(one ? 0 : joints_);
    }
  }

  std::size_t count() const { return rows_; }
  Joints read(std::size_t input, std::size_t row) const {
    Joints out{};
    const double* from = data_[input] + row * step_[input];
    for (std::size_t j = 0; j < joints_; ++j) out[j] = from[j];
    return out;
  }
  /// Of the result, before its own dimensions.
  Array make(std::vector<py::ssize_t> own) const {
    if (!single_) own.insert(own.begin(), static_cast<py::ssize_t>(rows_));
    return Array(own);
  }

 private:
  static std::string shape(const Array& a) {
    std::string out = "(";
    for (py::ssize_t i = 0; i < a.ndim(); ++i)
      out += std::to_string(a.shape(i)) + (i + 1 < a.ndim() || a.ndim() == 1 ? "," : "");
    return out + ")";
  }
  std::size_t joints_, rows_ = 1;
  bool single_ = true;
  std::string named_;
  std::vector<const double*> data_;
  std::vector<std::size_t> step_;
};

/// `of(row, out)` fills each row's `size` numbers, with Python free to go on.
template <class Of>
Array for_each_row(const Rows& rows, const std::vector<py::ssize_t>& own, const Of& of) {
  Array out = rows.make(own);
  const std::size_t size = rows.count() > 0 ? static_cast<std::size_t>(out.size()) / rows.count() : 0;
  double* const to = out.mutable_data();
  const py::gil_scoped_release release;
  for (std::size_t r = 0; r < rows.count(); ++r) of(r, to + r * size);
  return out;
}

py::ssize_t joints_of(const RobotModel& m) { return static_cast<py::ssize_t>(m.count()); }
void put(const RobotModel& m, const Joints& values, double* to) {
  for (std::size_t j = 0; j < m.count(); ++j) to[j] = values[j];
}

Array inverse_dynamics(const Model& model, const Array& q, const Array& qd, const Array& qdd) {
  const RobotModel& m = dynamics_of(model);
  const Rows rows(model, {{"q", &q}, {"qd", &qd}, {"qdd", &qdd}});
  return for_each_row(rows, {joints_of(m)}, [&](std::size_t r, double* to) {
    put(m, dynamics::tree::inverse_dynamics(m, rows.read(0, r), rows.read(1, r), rows.read(2, r)), to);
  });
}

Array forward_dynamics(const Model& model, const Array& q, const Array& qd, const Array& tau) {
  const RobotModel& m = dynamics_of(model);
  const Rows rows(model, {{"q", &q}, {"qd", &qd}, {"tau", &tau}});
  return for_each_row(rows, {joints_of(m)}, [&](std::size_t r, double* to) {
    put(m, dynamics::tree::accelerations(m, rows.read(0, r), rows.read(1, r), rows.read(2, r)), to);
  });
}

Array bias_forces(const Model& model, const Array& q, const Array& qd) {
  const RobotModel& m = dynamics_of(model);
  const Rows rows(model, {{"q", &q}, {"qd", &qd}});
  return for_each_row(rows, {joints_of(m)}, [&](std::size_t r, double* to) {
    put(m, dynamics::tree::bias_forces(m, rows.read(0, r), rows.read(1, r)), to);
  });
}

Array mass_matrix(const Model& model, const Array& q) {
  const RobotModel& m = dynamics_of(model);
  const Rows rows(model, {{"q", &q}});
  return for_each_row(rows, {joints_of(m), joints_of(m)}, [&](std::size_t r, double* to) {
    const auto matrix = dynamics::tree::mass_matrix(m, rows.read(0, r));
    for (std::size_t i = 0; i < m.count(); ++i) put(m, matrix[i], to + i * m.count());
  });
}

/// Kinetic, then potential.
Array energy(const Model& model, const Array& q, const Array& qd) {
  const RobotModel& m = dynamics_of(model);
  const Rows rows(model, {{"q", &q}, {"qd", &qd}});
  return for_each_row(rows, {2}, [&](std::size_t r, double* to) {
    const Joints at = rows.read(0, r);
    to[0] = dynamics::tree::kinetic_energy_j(m, at, rows.read(1, r));
    to[1] = dynamics::tree::potential_energy_j(m, at);
  });
}

}  // namespace

void add_dynamics(py::module_& module) {
  module.def("inverse_dynamics", inverse_dynamics);
  module.def("forward_dynamics", forward_dynamics);
  module.def("bias_forces", bias_forces);
  module.def("mass_matrix", mass_matrix);
  module.def("energy", energy);
}

}  // namespace furcula::python
