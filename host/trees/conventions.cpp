// A tree's equations for the trial of conventions, see conventions.hpp.
#include "host/trees/conventions.hpp"

#include <array>
#include <cmath>
#include <span>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/conventions/trial.hpp"
#include "host/core/message.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/run.hpp"
#include "host/trees/windows.hpp"

namespace furcula::trees {
namespace {

using conventions::Forces;
using conventions::Quantity;
using conventions::State;
using Direction = dynamics::tree::Vec3<double>;

class TreeFamily final : public conventions::Family {
 public:
  /// `measured`: of each joint, whether its input is the torque that the drive reports.
  TreeFamily(const TreeModel& model, const std::vector<bool>& measured)
      : setup_(in_flight(SetupMaker(model).make({model.drives, model.causes}))) {
    const SetupMaker maker(model);
    for (const FreeBody& body : model.free_bodies)
      for (std::size_t k = 0; k < BodyCoordinates{}.size(); ++k) {
        FittedBody other{body.link, {}};
        other.at[k] = kProbe;
        probes_.push_back(in_flight(maker.make({model.drives, model.causes, {other}})).model);
        free_.push_back({-2.0 * kBodyPrior, 2.0 * kBodyPrior});
      }
    for (std::size_t j = 0; j < model.joints(); ++j) {
      const bool linear = model.prismatic(j), sets = model.drives[j].law == ControlMode::position;
      conventions::Joint joint;
      joint.name = model.robot.joints[j].name;
      joint.position_column = column_of(model, j, "angle");
      if (model.driven(j))
        joint.input_column = column_of(model, j, sets ? "angle_cmd" : measured[j] ? "torque" : "torque_cmd");
      joint.position = linear ? Quantity::length : Quantity::angle;
      joint.input = sets ? joint.position : linear ? Quantity::force : Quantity::torque;
      joint.sets_position = sets;
      joint.link = model.robot.joints[j].link;
      joint.last = true;
      for (std::size_t k = 0; k < model.joints(); ++k)
        joint.last = joint.last && setup_.model.shape().parent(k) != static_cast<int>(j);
      joints_.push_back(std::move(joint));
    }
    gravities_.push_back(setup_.model.gravity_mps2);
    const double size = std::sqrt(dot(gravities_[0], gravities_[0]));
    constexpr double kSame = 0.98;  // cosine of some ten degrees
    for (int axis = 0; axis < 3 && size > 0.0; ++axis)
      for (const double sign : {1.0, -1.0}) {
        Direction g{0.0, 0.0, 0.0};
        (axis == 0 ? g.x : axis == 1 ? g.y : g.z) = sign * size;
        if (dot(g, gravities_[0]) < kSame * size * size) gravities_.push_back(g);
      }
    for (const Direction& g : gravities_) {
      models_.push_back(setup_.model);
      models_.back().gravity_mps2 = g;
    }
  }

  const std::vector<conventions::Joint>& joints() const override { return joints_; }

  /// The coordinates of each link whose inertial parameters are free, within two of their standard deviations. Drives' free parameters
  /// are those that the trial fits in any case.
  std::vector<conventions::FreeParameter> free_parameters() const override { return free_; }

  std::vector<std::string> other_gravities() const override {
    std::vector<std::string> out;
    for (std::size_t i = 1; i < gravities_.size(); ++i) {
      const Direction& g = gravities_[i];
      const std::string axis = g.x != 0.0 ? "x" : g.y != 0.0 ? "y" : "z";
      out.push_back("gravity points along " + std::string(g.x + g.y + g.z > 0.0 ? "+" : "-") + axis +
                    " of the base (gravity_mps2 = [" + core::shortest(g.x) + ", " + core::shortest(g.y) +
                    ", " + core::shortest(g.z) + "] in [model])");
    }
    return out;
  }

  bool forces(const State& s, std::size_t gravity, Forces& out) const override {
    const std::size_t n = joints_.size();
    const model::RobotModel& tree = models_[gravity];
    model::RobotModel::Joints q{}, v{}, a{};
    for (std::size_t j = 0; j < n; ++j) q[j] = s.position[j], v[j] = s.velocity[j], a[j] = s.acceleration[j];
    const auto needed = dynamics::tree::inverse_dynamics(tree, q, v, a);
    const auto mass = dynamics::tree::mass_matrix(tree, q);
    out.needed.resize(n);
    out.input_gain.resize(n);
    out.of_drive.assign(n, 0.0);
    Eigen::MatrixXd m(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    for (std::size_t j = 0; j < n; ++j) {
      const Setup::Joint& d = setup_.joints[j];
      for (std::size_t k = 0; k < n; ++k)
        m(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) = mass[j][k];
      const bool sets = d.law == ControlMode::position;
      out.needed[j] = needed[j] - d.offset_nm;
      // Else the joint's law has kp and kd as a spring and a damper.
      if (sets) out.of_drive[j] = d.gain * (d.kp_nmprad * q[j] + d.kd_nmsprad * v[j]);
      if (sets && !Runner::is_spring(d)) out.needed[j] += out.of_drive[j];
      out.input_gain[j] = d.law == ControlMode::none ? 0.0 : d.gain * (sets ? d.kp_nmprad : 1.0);
    }
    out.mass.assign(m.data(), m.data() + m.size());
    bool positive = false;
    const Eigen::MatrixXd inverse = linear::inverse_of_positive(m, &positive);
    if (!positive) return false;
    out.inertia.resize(n);
    for (std::size_t j = 0; j < n; ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      out.inertia[j] = 1.0 / inverse(at, at);
    }
    out.by_free.assign(probes_.size(), std::vector<double>(n));
    out.inertia_by_free.assign(probes_.size(), std::vector<double>(n, 0.0));
    for (std::size_t k = 0; k < probes_.size(); ++k) {
      model::RobotModel other = probes_[k];
      other.gravity_mps2 = gravities_[gravity];
      const auto with = dynamics::tree::inverse_dynamics(other, q, v, a);
      for (std::size_t j = 0; j < n; ++j) out.by_free[k][j] = (with[j] - needed[j]) / kProbe;
    }
    out.log_det = linear::log_determinant_of_positive(m);
    return true;
  }

 private:
  /// Its springs are in their laws by phase; a recording without phases is in the air.
  static Setup in_flight(const Setup& setup) { return in_phase(setup, Recording{}, 0); }

  static constexpr double kProbe = 0.1;  ///< of a body's coordinate

  Setup setup_;
  std::vector<model::RobotModel> probes_;  ///< each with one coordinate of a free body changed
  std::vector<conventions::FreeParameter> free_;
  std::vector<conventions::Joint> joints_;
  std::vector<Direction> gravities_;       ///< the model's first
  std::vector<model::RobotModel> models_;  ///< one for each of them
};

/// Columns of rows in a row that a foot does not stand in.
std::vector<conventions::Columns> columns_of(const std::vector<Recording>& recordings) {
  std::vector<conventions::Columns> out;
  for (const Recording& r : recordings) {
    conventions::Columns c{r.path, r.time_s, r.angle_rad, r.input, {}, std::vector<bool>(r.rows(), false)};
    for (const auto& [ours, of] : r.mapped)
      if (of.parts.size() == 1) c.sources[ours] = {of.parts[0].column, of.parts[0].scale, of.offset};
    for (std::size_t i = 0; i < r.rows(); ++i)
      c.breaks[i] = gap_after(r, i) || (!r.phases.empty() && r.phase_at(i).stance);
    out.push_back(std::move(c));
  }
  return out;
}

}  // namespace

void require_conventions(const TreeModel& model, const std::vector<Recording>& recordings, double window_s) {
  if (recordings.empty()) return;
  conventions::require_convention(
      TreeFamily(model, recordings.front().input_measured), columns_of(recordings),
      windows_of(model, recordings, window_s, 1).empty() ? conventions::Asked::time_alone
                                                         : conventions::Asked::all_columns);
}

std::optional<conventions::Finding> find_convention(const TreeModel& model,
                                                    const std::vector<Recording>& recordings) {
  return conventions::find_convention(TreeFamily(model, recordings.front().input_measured),
                                      columns_of(recordings));
}

std::optional<conventions::JointReadings> find_joint_readings(const TreeModel& model,
                                                              const std::vector<Recording>& recordings) {
  return conventions::find_joint_readings(TreeFamily(model, recordings.front().input_measured),
                                          columns_of(recordings));
}

conventions::AsNamed as_named(const TreeModel& model, const std::vector<Recording>& recordings) {
  return conventions::as_named(TreeFamily(model, recordings.front().input_measured), columns_of(recordings));
}

}  // namespace furcula::trees
