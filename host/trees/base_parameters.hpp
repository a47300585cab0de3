// Base parameters: the combinations of the bodies' masses, first moments and inertias on which a tree's torques depend.
//
// Of the ten numbers of a body most never show alone: a mass on the axis of its joint can as well belong to the body before it.
// Gautier and Khalil, Direct calculation of minimum set of inertial parameters of serial robots, IEEE Trans. Robotics and Automation
// 6(3), 1990; by QR: Gautier, Numerical calculation of the base inertial parameters of robots, J. Robotic Systems 8(4), 1991.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "host/trees/fit.hpp"
#include "host/trees/missing_torque.hpp"
#include "host/trees/model.hpp"

namespace furcula::trees {

/// Of a body: m, m x, m y, m z, Ixx, Ixy, Ixz, Iyy, Iyz, Izz about its link frame's origin, in link axes; kg, kg m, kg m^2.
inline constexpr std::size_t kInertialParameters = 10;

/// Body by body, in the order of the tree's joints.
Eigen::VectorXd inertial_parameters(const model::RobotModel& robot);

/// body_torques() = this times inertial_parameters(): a row a joint.
Eigen::MatrixXd inertial_regressor(const model::RobotModel& robot, const model::RobotModel::Joints& q,
                                   const model::RobotModel::Joints& qd, const model::RobotModel::Joints& qdd);

/// Which combinations show in the torques of any motion. It follows from geometry and gravity alone.
struct BaseStructure {
  std::vector<std::size_t> leading;  ///< of each: the parameter that stands in no other and names it
  /// A row a base parameter: base values = this times inertial_parameters(). 1 at the leading one.
  Eigen::MatrixXd combination;
};

/// What can be in a body or in one nearer to the base is counted there, as in the papers above: of a revolute joint's body the mass,
/// the first moment along the axis and one of the moments of inertia across it; of a prismatic joint's the inertias.
BaseStructure base_structure(const model::RobotModel& robot);

struct BaseParameter {
  std::string combination;  ///< "Iyy(upper) + 0.09 m(lower)"
  std::string unit;
  double value = 0.0, extended = 0.0;  ///< in the model as given, and with the causes
  /// Standard deviation with which the recordings tell it, all base parameters sought together. Infinite: not at all.
  double sd = 0.0;
  std::size_t joint = 0;       ///< where it makes the largest share of the torque
  double torque_rms_nm = 0.0;  ///< there, of its value as given
  bool shown = false;          ///< the recordings tell it
};

/// Of the model, with the extended hypothesis' bodies beside those given. `samples` are of the extended model's motion, a joint each:
/// their missing torque is the noise. `torque_nm` is what each joint takes, RMS. A parameter is shown where its standard deviation is less
/// than a tenth of its size. That is its value, or, if it is larger, what the leading parameter can be at most in a body of this mass m
/// and J, the integral of r^2 dm about the link's origin: m of a mass, sqrt(m J) of a first moment, J of an inertia.
std::vector<BaseParameter> base_parameters(const TreeModel& model, const Hypothesis& extended,
                                           const std::vector<TorqueSamples>& samples,
                                           const std::vector<double>& torque_nm);

}  // namespace furcula::trees
