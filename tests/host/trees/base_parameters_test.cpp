// Base parameters: closed forms, published counts, and torques made of nothing else.
#include "host/trees/base_parameters.hpp"

#include <Eigen/LU>
#include <numbers>
#include <random>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using dynamics::tree::Frame;
using dynamics::tree::Inertia;
using dynamics::tree::JointKind;
using dynamics::tree::Mat3;
using dynamics::tree::Vec3;
using Joints = model::RobotModel::Joints;

namespace {

constexpr double kPi = std::numbers::pi;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double most = 1.0) {
    return std::uniform_real_distribution<double>(-most, most)(engine_);
  }
  Vec3<double> vector(double most = 1.0) { return {(*this)(most), (*this)(most), (*this)(most)}; }
  /// Torques are linear in these numbers: they need not be those of a body that there can be.
  Inertia<double> body() {
    return {2.0 + (*this)(), vector(0.3), {(*this)(), (*this)(), (*this)(), (*this)(), (*this)(), (*this)()}};
  }

 private:
  std::mt19937_64 engine_;
};

/// Turned about x.
Mat3<double> about_x(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}};
}

/// A joint of a chain: where the link frame is in the one before, turned about its x; the axis is z.
struct Link {
  double turn_x_rad;
  Vec3<double> at_m;
};
model::RobotModel chain(const std::vector<Link>& links, unsigned seed = 1) {
  Random random(seed);
  model::RobotModel out;
  for (std::size_t i = 0; i < links.size(); ++i)
    REQUIRE(out.add({static_cast<int>(i) - 1, JointKind::revolute},
                    Frame<double>{about_x(links[i].turn_x_rad), links[i].at_m}, {0, 0, 1},
                    random.body()) == Status::ok);
  return out;
}

/// Of inverse dynamics of random motions against the base parameters times the columns of their leading parameters alone.
double largest_difference(const model::RobotModel& robot, unsigned seed) {
  const trees::BaseStructure structure = trees::base_structure(robot);
  const Eigen::VectorXd base = structure.combination * trees::inertial_parameters(robot);
  Random random(seed);
  double largest = 0.0;
  for (int k = 0; k < 200; ++k) {
    Joints q{}, v{}, a{};
    for (std::size_t j = 0; j < robot.count(); ++j) {
      q[j] = random(3.0);
      v[j] = random(5.0);
      a[j] = random(20.0);
    }
    const Joints torque = dynamics::tree::body_torques(robot, q, v, a);
    const Eigen::MatrixXd columns = trees::inertial_regressor(robot, q, v, a);
    double scale = 0.0;
    for (std::size_t j = 0; j < robot.count(); ++j) scale = std::max(scale, std::abs(torque[j]));
    for (std::size_t j = 0; j < robot.count(); ++j) {
      double of_base = 0.0;
      for (std::size_t i = 0; i < structure.leading.size(); ++i)
        of_base += base(static_cast<Eigen::Index>(i)) *
                   columns(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(structure.leading[i]));
      largest = std::max(largest, std::abs(of_base - torque[j]) / scale);
    }
  }
  return largest;
}

std::size_t count(const model::RobotModel& robot) { return trees::base_structure(robot).leading.size(); }

/// States of joints on sines, as of recordings whose missing torque is `noise_nm` in turns to both sides.
std::vector<trees::TorqueSamples> samples(std::size_t joints, const std::vector<double>& amplitude_rad,
                                          double noise_nm, int rows = 300) {
  trees::TorqueSamples s;
  s.others.resize(joints);
  s.half_s = 0.02;
  for (int k = 0; k < rows; ++k) {
    const double t = 0.05 * k;
    s.recording.push_back(0);
    s.time_s.push_back(t);
    s.missing_nm.push_back(k % 2 == 0 ? noise_nm : -noise_nm);
    for (std::size_t j = 0; j < joints; ++j) {
      const double w = 3.0 + 1.7 * static_cast<double>(j), size = amplitude_rad[j];
      s.others[j].angle_rad.push_back(size * std::sin(w * t));
      s.others[j].velocity_radps.push_back(size * w * std::cos(w * t));
      s.others[j].acceleration_radps2.push_back(-size * w * w * std::sin(w * t));
    }
  }
  std::vector<trees::TorqueSamples> out(joints, s);
  for (std::size_t j = 0; j < joints; ++j) out[j].joint = j;
  return out;
}

std::vector<std::string> combinations(const std::vector<trees::BaseParameter>& all) {
  std::vector<std::string> out;
  for (const trees::BaseParameter& b : all) out.push_back(b.combination);
  return out;
}

}  // namespace

TEST_CASE("A planar double pendulum has the six base parameters of the textbooks") {
  // Links along x, 0.4 m apart, axes z, which is horizontal: m1 x1 + m2 l, m1 y1, I1 + m2 l^2; m2 x2, m2 y2, I2.
  const model::RobotModel robot = chain({{0.5 * kPi, {0, 0, 0}}, {0.0, {0.4, 0, 0}}});
  const trees::BaseStructure structure = trees::base_structure(robot);
  CHECK(structure.leading == std::vector<std::size_t>{1, 2, 9, 11, 12, 19});
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6, 20);
  for (int i = 0; i < 6; ++i)
    expected(i, static_cast<Eigen::Index>(structure.leading[static_cast<std::size_t>(i)])) = 1.0;
  expected(0, 10) = 0.4;
  expected(2, 10) = 0.16;
  CHECK((structure.combination - expected).cwiseAbs().maxCoeff() < 1e-10);
  CHECK(largest_difference(robot, 7) < 1e-12);
}

TEST_CASE("Base parameters are named by the URDF's links, with their values in the model") {
  const trees::TreeModel model = test::double_pendulum();
  trees::Hypothesis extended{model.drives, {}};
  extended.causes = {{trees::Effect::payload, {test::link(model, "upper")}, {0.5, 0.0, 0.0, -0.1}}};
  const auto all = trees::base_parameters(model, extended, samples(2, {1.0, 1.0}, 0.01), {1.0, 1.0});
  // The joints turn about -y; the elbow is 0.3 m below the shoulder.
  CHECK(combinations(all) == std::vector<std::string>{"mx(upper)", "mz(upper) - 0.3 m(lower)",
                                                      "Iyy(upper) + 0.09 m(lower)", "mx(lower)", "mz(lower)",
                                                      "Iyy(lower)"});
  const trees::BaseParameter& inertia = all[2];
  CHECK(inertia.unit == "kg m^2");
  // From the file: 0.004 + 0.56 0.25^2 of the upper rod, and 0.65 kg that hang on the elbow.
  CHECK(inertia.value == Approx(0.004 + 0.56 * 0.0625 + 0.65 * 0.09).epsilon(1e-9));
  CHECK(inertia.extended == Approx(inertia.value + 0.5 * 0.01).epsilon(1e-9));
  CHECK(all[1].unit == "kg m");
  CHECK(all[1].value == Approx(-0.56 * 0.25 - 0.65 * 0.3).epsilon(1e-9));
  for (const trees::BaseParameter& b : all) CHECK(b.shown);
}

TEST_CASE("Recordings show the base parameters of the joints that move in them, and no others") {
  const trees::TreeModel model = test::double_pendulum();
  const trees::Hypothesis given{model.drives, {}};
  auto of = samples(2, {0.0, 1.0}, 0.01);
  of[0].missing_nm.clear();  // the shoulder stands still
  const auto all = trees::base_parameters(model, given, of, {10.0, 1.0});
  REQUIRE(all.size() == 6);
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(all[i].combination);
    CHECK_FALSE(all[i].shown);
    CHECK_FALSE(std::isfinite(all[i].sd));
  }
  for (std::size_t i = 3; i < 6; ++i) {
    INFO(all[i].combination);
    CHECK(all[i].shown);
    CHECK(all[i].joint == 1);
  }
  // With three hundred times the noise the standard deviation is so many times as large, and the small first moment is lost.
  auto noisy = samples(2, {0.0, 1.0}, 3.0);
  noisy[0].missing_nm.clear();
  const auto lost = trees::base_parameters(model, given, noisy, {1.0, 1.0});
  CHECK(lost[5].sd == Approx(300.0 * all[5].sd).epsilon(1e-6));
  CHECK_FALSE(lost[3].shown);
}

TEST_CASE(
    "A pendulum's standard deviations are those of least squares, its torque that of inverse dynamics") {
  const trees::TreeModel model = test::pendulum();
  const std::vector<trees::TorqueSamples> of = samples(1, {1.2}, 0.2);
  const auto all = trees::base_parameters(model, {model.drives, {}}, of, {1.0});
  REQUIRE(all.size() == 3);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double squares = 0.0;
  const auto body = model.robot.model.body(0);
  const Vec3<double> axis = model.robot.joints[0].axis;
  INFO(all[0].combination << ", " << all[1].combination << ", " << all[2].combination);
  REQUIRE(std::abs(axis.y) == Approx(1.0));
  for (std::size_t k = 0; k < of[0].time_s.size(); ++k) {
    const double q = axis.y * of[0].others[0].angle_rad[k], a = of[0].others[0].acceleration_radps2[k];
    // Gravity's pull about +y of a mass at (x, z), turned by q: the torque that holds it.
    const double g = 9.81;
    const Eigen::Vector3d row(axis.y * -g * std::cos(q), axis.y * -g * std::sin(q), a);
    information += row * row.transpose() / 0.04;
    squares += a * a;
  }
  const Eigen::Matrix3d covariance = information.inverse();
  for (int i = 0; i < 3; ++i)
    CHECK(all[static_cast<std::size_t>(i)].sd == Approx(std::sqrt(covariance(i, i))).epsilon(1e-6));
  CHECK(all[2].torque_rms_nm ==
        Approx(body.inertia_kgm2.yy * std::sqrt(squares / static_cast<double>(of[0].time_s.size())))
            .epsilon(1e-9));
}

TEST_CASE("Torques of arms with axes anywhere are those of their base parameters alone") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    model::RobotModel robot;
    for (int i = 0; i < 3; ++i)
      REQUIRE(robot.add({i - 1, JointKind::revolute}, Frame<double>{about_x(random(3.0)), random.vector(0.4)},
                        random.vector(), random.body()) == Status::ok);
    CHECK(count(robot) == 3 + 7 + 7);
    CHECK(largest_difference(robot, seed + 100) < 1e-9);
  }
}

TEST_CASE("A prismatic joint's body counts its inertias with the body that turns it") {
  Random random(3);
  model::RobotModel robot;
  REQUIRE(robot.add({-1, JointKind::revolute}, Frame<double>{about_x(0.4), {0, 0, 0}}, {0.2, 0.1, 1},
                    random.body()) == Status::ok);
  REQUIRE(robot.add({0, JointKind::prismatic}, Frame<double>{about_x(1.1), {0.1, 0.3, 0.2}}, {0.3, 1, 0.2},
                    random.body()) == Status::ok);
  const trees::BaseStructure structure = trees::base_structure(robot);
  for (const std::size_t p : structure.leading) CHECK(p < 14);
  CHECK(largest_difference(robot, 8) < 1e-9);

  // A cart on a rail: of it the mass alone.
  const trees::TreeModel cart_pole = test::robot("model/robots/cart_pole.urdf");
  const auto all =
      trees::base_parameters(cart_pole, {cart_pole.drives, {}}, samples(2, {0.5, 1.0}, 0.1), {1.0, 1.0});
  CHECK(combinations(all) ==
        std::vector<std::string>{"m(cart) + m(pole)", "mx(pole)", "mz(pole)", "Iyy(pole)"});
  CHECK(all[0].value == Approx(1.5));
  CHECK(all[0].unit == "kg");
}

TEST_CASE("Both arms of a robot that branches count what they can with the trunk") {
  // The trunk turns about the vertical: its moment of inertia alone. A revolute joint's body has seven, a prismatic one's four.
  const trees::TreeModel model = test::robot("model/robots/branched.urdf");
  CHECK(count(model.robot.model) == 1 + 2 * (7 + 7 + 4));
  CHECK(largest_difference(model.robot.model, 5) < 1e-9);
  const trees::BaseStructure structure = trees::base_structure(model.robot.model);
  REQUIRE(structure.leading.front() == 9);
  for (const char* link : {"left_upper", "right_upper"})
    for (std::size_t b = 0; b < model.joints(); ++b)
      if (model.robot.joints[b].link == link)
        CHECK(structure.combination(0, static_cast<Eigen::Index>(10 * b)) > 0.01);
}

TEST_CASE("An arm like the PUMA 560 has 36 base parameters, as published") {
  // Gautier and Khalil (1990). A body has ten numbers; three of them, a mass on the joint's axis (m, its first moment along the axis, the
  // moments of inertia across it), can as well be in the body before: seven a body. Of the first, whose axis does not
  // move, the moment of inertia alone shows where the axis is vertical, and two first moments too where it is not. Mayeda, Yoshida and Osuka (1990)
  // have the same: 7 N - 4 b1 - 2 b2, with b1 the first joints that are parallel, b2 = 1 where the first is vertical, else 0.
  const auto puma = [](double right_angle, double base_turn) {
    return chain({{base_turn, {0, 0, 0}},
                  {-right_angle, {0, 0.2435, 0}},
                  {0.0, {0.4318, 0, -0.0934}},
                  {right_angle, {-0.0203, -0.4331, 0}},
                  {-right_angle, {0, 0, 0}},
                  {right_angle, {0, 0, 0}}});
  };
  CHECK(count(puma(0.5 * kPi, 0.0)) == 36);
  CHECK(largest_difference(puma(0.5 * kPi, 0.0), 9) < 1e-9);
  CHECK(count(puma(0.5 * kPi, 0.7)) == 38);
  // Angles with as many digits as URDF files have.
  CHECK(count(puma(1.5708, 0.0)) == 36);
  CHECK(largest_difference(puma(1.5708, 0.0), 9) < 1e-3);
  CHECK(count(puma(0.5 * kPi, 1e-7)) == 36);
  // Two parallel joints: a horizontal pair has 14 - 8, a vertical one 14 - 8 - 2.
  CHECK(count(chain({{0.5 * kPi, {0, 0, 0}}, {0.0, {0.4, 0.1, 0.2}}})) == 6);
  CHECK(count(chain({{0.0, {0, 0, 0}}, {0.0, {0.4, 0.1, 0.2}}})) == 4);
}
