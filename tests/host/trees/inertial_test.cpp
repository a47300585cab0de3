// Links' inertial parameters in [free]: what recordings tell of them is found, what they do not tell stays as given.
#include "host/trees/inertial.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <random>

#include "host/core/strict_toml.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/exports.hpp"
#include "host/trees/identify.hpp"
#include "host/trees/run.hpp"
#include "tests/folder.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;
using dynamics::tree::Sym3;
using dynamics::tree::Vec3;
using trees::Effect;

namespace {

const model::UrdfInertia& body(const trees::TreeModel& m, const std::string& link) {
  return *m.urdf.links[test::link(m, link)].inertia;
}
/// The robot with another body at a link.
trees::TreeModel with_body(trees::TreeModel m, const std::string& link, double mass_kg,
                           const Vec3<double>& centre_m, const Sym3<double>& about_centre_kgm2) {
  model::UrdfInertia& other = *m.urdf.links[test::link(m, link)].inertia;
  other.mass_kg = mass_kg;
  other.frame.at = centre_m;
  other.about_centre_kgm2 = about_centre_kgm2;
  m.robot = model::tree_of(m.urdf, m.moving, m.hold);
  m.robot.model.gravity_mps2 = m.gravity_mps2;
  return m;
}
trees::TreeModel heavier_fore(const trees::TreeModel& m) {
  return with_body(m, "fore", 1.3, {0.16, 0.01, -0.02}, {0.003, 0.0002, -0.0005, 0.009, 0.0001, 0.01});
}

struct Logs {
  std::vector<log::Log> training, held_out;
};
Logs logs_of(const trees::TreeModel& truth, unsigned seed, std::size_t count = 3, double duration_s = 5.0) {
  return {test::logs(truth, count, duration_s, seed), test::logs(truth, 1, 5.0, seed + 50)};
}

std::string text_of(const trees::Identification& found) {
  std::string out;
  for (const auto& p : found.parameters)
    out += p.name + " " + std::to_string(p.given) + " -> " + std::to_string(p.value) + " [" +
           std::to_string(p.lower) + ", " + std::to_string(p.upper) + "] " + p.verdict + " " + p.with + "\n";
  return out;
}
const trees::Identification::Row& row(const trees::Identification& found, const std::string& name) {
  const auto at = std::find_if(found.parameters.begin(), found.parameters.end(),
                               [&](const auto& p) { return p.name == name; });
  if (at == found.parameters.end()) FAIL("no row " + name);
  return *at;
}

Eigen::Matrix3d matrix(const Sym3<double>& s) {
  Eigen::Matrix3d m;
  m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  return m;
}
/// Second moments over the mass, about the centre: tr(I) / 2 - I.
Eigen::Matrix3d second_moments(const model::UrdfInertia& b) {
  const Eigen::Matrix3d i = matrix(b.about_centre_kgm2);
  return (0.5 * i.trace() * Eigen::Matrix3d::Identity() - i) / b.mass_kg;
}
/// S = U U' with an upper triangle, by the usual factor of the matrix read from its end.
Eigen::Matrix3d upper_factor(const Eigen::Matrix3d& s) {
  const Eigen::Matrix3d turned = s.reverse();
  return Eigen::Matrix3d(turned.llt().matrixL()).reverse();
}
void check_possible(const model::UrdfInertia& b) {
  CHECK(b.mass_kg > 0.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix(b.about_centre_kgm2));
  const auto& i = solver.eigenvalues();
  CHECK(i(0) > 0.0);
  CHECK(i(0) + i(1) >= i(2) * (1.0 - 1e-9));
}

std::string refused(const std::string& urdf, const std::string& settings) {
  return test::error_message([&] { test::robot(urdf, settings); });
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}
std::string double_pendulum_text() {
  return core::read_small_file(test::source("tests/host/model/robots/double_pendulum.urdf"), "a robot");
}
/// The double pendulum with another <inertia> of its lower rod.
std::string refused_inertia(const test::Folder& folder, const std::string& moments) {
  folder.write("robot.urdf",
               replaced(double_pendulum_text(),
                        R"(ixx="0.003" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.0002")", moments));
  folder.write(
      "model.toml",
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n[free]\n\"inertial.lower\" = [0.5, 2]\n");
  return test::error_message([&] { trees::read_tree_model(folder.file("model.toml")); });
}

}  // namespace

TEST_CASE("A body about a given one is it at 0, and has the product of both Cholesky factors elsewhere") {
  const model::UrdfInertia given = body(heavier_fore(test::arm3()), "fore");
  const model::UrdfInertia same = trees::body_at(given, {});
  CHECK(trees::inertial_values(same) == trees::inertial_values(given));
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    trees::BodyCoordinates x{};
    for (double& v : x) v = normal(random);
    const model::UrdfInertia b = trees::body_at(given, x);
    check_possible(b);
    CHECK(b.mass_kg == Approx(1.3 * std::exp(2.0 * x[0])));
    Eigen::Matrix3d v;
    v << std::exp(x[1]), x[4], x[6], 0.0, std::exp(x[2]), x[5], 0.0, 0.0, std::exp(x[3]);
    const Eigen::Matrix3d u = upper_factor(second_moments(given)) * v, expected = u * u.transpose();
    CHECK((second_moments(b) - expected).norm() < 1e-9 * expected.norm());
    // The radius about the centre of mass: root of the trace of the second moments.
    const double radius_m = std::sqrt(second_moments(given).trace());
    CHECK(b.frame.at.x == Approx(0.16 + radius_m * x[7]));
    CHECK(b.frame.at.y == Approx(0.01 + radius_m * x[8]));
    CHECK(b.frame.at.z == Approx(-0.02 + radius_m * x[9]));
  }
}

TEST_CASE("The axes of a body's inertia stay where its URDF turns them") {
  model::UrdfInertia given = body(test::arm3(), "fore");
  given.frame.turn = {{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};  // a quarter about z
  trees::BodyCoordinates x{};
  x[7] = 1.0;  // along the turned x, the link's y
  const model::UrdfInertia moved = trees::body_at(given, x);
  CHECK(moved.frame.at.x == Approx(0.12));
  CHECK(moved.frame.at.y == Approx(std::sqrt(0.5 * (0.001 + 0.006 + 0.006) / 0.9)));
  CHECK(moved.frame.turn.x.y == 1.0);
  CHECK(moved.about_centre_kgm2.xx == Approx(0.001));
}

TEST_CASE(
    "A wrong body of a link is found, and held-out recordings are then predictable as by the true one") {
  const trees::TreeModel model = test::arm3("[free]\n\"inertial.fore\" = [0.3, 3.0]\n");
  const trees::TreeModel truth = heavier_fore(model);
  const Logs logs = logs_of(truth, 300, 4, 8.0);
  const trees::Identification found = trees::identify(model, logs.training, logs.held_out);
  INFO(text_of(found));
  const std::array<double, 10> true_values{1.3,    0.16,    0.01,  -0.02,  0.003,
                                           0.0002, -0.0005, 0.009, 0.0001, 0.01};
  REQUIRE(found.parameters.size() == 10);
  int within = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    const auto& p = found.parameters[i];
    INFO(p.name);
    const auto k = static_cast<Eigen::Index>(i);
    CHECK(std::abs(p.value - true_values[i]) < 4.0 * std::sqrt(found.covariance(k, k)));
    CHECK(p.unit == trees::kInertialUnits[i]);
    within += true_values[i] > p.lower && true_values[i] < p.upper ? 1 : 0;
  }
  CHECK(within >= 8);
  CHECK(row(found, "mass_kg.fore").given == 0.9);
  CHECK(row(found, "mass_kg.fore").value == Approx(1.3).epsilon(0.01));
  CHECK(row(found, "mass_kg.fore").verdict == "identified");
  CHECK(row(found, "com_x_m.fore").value == Approx(0.16).epsilon(0.02));
  CHECK(row(found, "com_x_m.fore").verdict == "identified");
  CHECK(row(found, "iyy_kgm2.fore").value == Approx(0.009).epsilon(0.15));
  // What the true robot's model is off by: process, noise of encoders and torques.
  trees::TreeModel right = truth;
  right.free_bodies.clear();
  right.free = {{3, 0, 0.0, 1.0}};
  const trees::Identification floor = trees::identify(right, logs.training, logs.held_out);
  for (std::size_t j = 0; j < 3; ++j) {
    INFO(j);
    CHECK(found.as_given_error[j].rmse > 10.0 * found.identified_error[j].rmse);
    CHECK(found.identified_error[j].rmse < 1.2 * floor.as_given_error[j].rmse);
  }
  CHECK_THAT(trees::to_json_text(found), Contains("\"iyz_kgm2.fore\"") && Contains("\"given\": 0.9"));
}

TEST_CASE("Of two links in a plane the base parameters are known, and what is no part of them is as given") {
  const trees::TreeModel model =
      test::double_pendulum("[free]\n\"inertial.lower\" = [0.3, 3]\n\"inertial.upper\" = [0.3, 3]\n");
  const trees::TreeModel truth =
      with_body(model, "lower", 0.5, {0.01, 0.0, -0.23}, {0.005, 0.0, 0.0001, 0.005, 0.0, 0.0003});
  const Logs logs = logs_of(truth, 40, 4, 6.0);
  const trees::Identification found = trees::identify(model, logs.training, logs.held_out);
  INFO(text_of(found));
  REQUIRE(found.parameters.size() == 20);
  REQUIRE(found.parameters[0].name == "mass_kg.lower");
  REQUIRE(found.parameters[10].name == "mass_kg.upper");
  Eigen::VectorXd fitted(20), planted(20);
  for (std::size_t i = 0; i < 20; ++i) fitted(static_cast<Eigen::Index>(i)) = found.parameters[i].value;
  planted << 0.5, 0.01, 0.0, -0.23, 0.005, 0.0, 0.0001, 0.005, 0.0, 0.0003,  //
      0.56, 0.0, 0.0, -0.25, 0.004, 0.0, 0.0, 0.004, 0.0, 0.0003;
  // Both joints turn about y, the elbow 0.3 m below the shoulder. The lower link's mass acts on the upper one as if it were there.
  using Of = std::function<double(const Eigen::VectorXd&)>;
  const std::vector<std::pair<const char*, Of>> base{
      {"first moment x, lower", [](const auto& v) { return v(0) * v(1); }},
      {"first moment z, lower", [](const auto& v) { return v(0) * v(3); }},
      {"inertia about the elbow, lower",
       [](const auto& v) { return v(7) + v(0) * (v(1) * v(1) + v(3) * v(3)); }},
      {"first moment x, upper", [](const auto& v) { return v(10) * v(11); }},
      {"first moment z, upper", [](const auto& v) { return v(10) * v(13) - 0.3 * v(0); }},
      {"inertia about the shoulder, upper",
       [](const auto& v) { return v(17) + v(10) * (v(11) * v(11) + v(13) * v(13)) + 0.09 * v(0); }}};
  for (const auto& [name, of] : base) {
    Eigen::VectorXd by(20);
    for (Eigen::Index i = 0; i < 20; ++i) {
      Eigen::VectorXd more = fitted;
      more(i) += 1e-7;
      by(i) = (of(more) - of(fitted)) / 1e-7;
    }
    const double sd = std::sqrt(by.dot(found.covariance * by)), value = of(fitted), right = of(planted);
    INFO(name << ": " << value << " +- " << 1.96 * sd << ", planted " << right);
    CHECK(std::abs(value - right) < 3.0 * sd);
    CHECK(sd < 0.01 * std::max(std::abs(right), 0.1));
  }
  // No single one of these is known: each goes along with others.
  for (const char* const name : {"mass_kg.lower", "com_z_m.lower", "iyy_kgm2.lower", "izz_kgm2.lower",
                                 "mass_kg.upper", "com_z_m.upper", "iyy_kgm2.upper"}) {
    INFO(name);
    const auto& p = row(found, name);
    CHECK(p.verdict != "identified");
    CHECK((p.verdict == "correlated") == !p.with.empty());
  }
  // Out of the plane nothing shows.
  for (const char* const name : {"com_y_m.", "ixy_kgm2.", "iyz_kgm2."})
    for (const char* const link : {"lower", "upper"}) {
      const auto& p = row(found, std::string(name) + link);
      INFO(p.name);
      CHECK(p.verdict == "not_excited");
      CHECK(std::abs(p.value - p.given) < 1e-6 * (p.upper - p.lower));
    }
  CHECK(found.identified_error[1].rmse < 0.2 * found.as_given_error[1].rmse);
}

TEST_CASE("A fitted body is one that can be, also where recordings ask for another") {
  const trees::TreeModel model = test::arm3("[free]\n\"inertial.fore\" = [0.3, 3.0]\n");
  const std::size_t elbow = test::joint(model, "elbow");
  std::vector<trees::TreeModel> planted;
  // All of the mass within a millimetre.
  planted.push_back(with_body(model, "fore", 1.1, {0.15, 0.0, 0.0}, {1e-9, 0, 0, 1e-9, 0, 1e-9}));
  // Less than none about the centre of mass: the mass matrix has it about the joint, where it is positive.
  planted.push_back(model);
  planted.back().robot.model.set_body(
      elbow, dynamics::tree::inertia_of(0.9, Vec3<double>{0.12, 0.0, 0.0},
                                        Sym3<double>{0.001, 0.0, 0.0, -0.003, 0.0, -0.003}));
  for (const trees::TreeModel& truth : planted) {
    const Logs logs = logs_of(truth, 40);
    const trees::Identification found = trees::identify(model, logs.training, logs.held_out);
    INFO(text_of(found));
    REQUIRE(found.bodies.size() == 1);
    check_possible(trees::body_at(body(model, "fore"), found.bodies[0].at));
    CHECK(row(found, "iyy_kgm2.fore").value < 0.1 * 0.006);
    CHECK(row(found, "iyy_kgm2.fore").lower >= 0.0);
    CHECK(found.identified_error[elbow].rmse < 0.5 * found.as_given_error[elbow].rmse);
    const std::string text = trees::urdf_with_bodies(model, found.bodies);
    CHECK_NOTHROW(model::tree_of(model::parse_urdf(text, "identified")));
  }
}

TEST_CASE("A mass stays between its bounds, and the row says at which it is") {
  const trees::TreeModel model = test::arm3("[free]\n\"inertial.fore\" = [0.9, 1.2]\n");
  const Logs logs = logs_of(heavier_fore(model), 40);
  const trees::Identification found = trees::identify(model, logs.training, logs.held_out);
  INFO(text_of(found));
  const auto& p = row(found, "mass_kg.fore");
  CHECK(p.value == Approx(1.2 * 0.9));
  CHECK(p.verdict == "at_bound");
  CHECK(p.with == "upper");
}

TEST_CASE("Of a robot that stands still no inertial parameter is known") {
  const trees::TreeModel model = test::arm3("[free]\n\"inertial.column\" = [0.3, 3.0]\n");
  std::vector<log::Log> logs;
  for (unsigned seed = 0; seed < 4; ++seed) {
    trees::Scenario s = trees::default_scenario(model);
    s.duration_s = 4.0;
    for (trees::Path& path : s.paths) path.profile = trees::Path::Profile::hold;
    s.disturbance_share = 0.0;
    logs.push_back(trees::simulate(model, s, seed));
    logs.back().path = "still.csv";
  }
  const trees::Identification found = trees::identify(model, {logs[0], logs[1], logs[2]}, {logs[3]});
  INFO(text_of(found));
  for (const auto& p : found.parameters) {
    CHECK(p.verdict == "not_excited");
    CHECK(std::abs(p.value - p.given) < 0.05 * (p.upper - p.lower));
  }
}

TEST_CASE(
    "The URDF with fitted bodies differs in their numbers alone, and reads back as the robot that was fitted") {
  const test::Folder folder;
  const std::string given = double_pendulum_text();
  folder.write("robot.urdf", given);
  folder.write(
      "model.toml",
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n[free]\n\"inertial.weight\" = [0.5, 2]\n"
      "\"damping_nmspr.elbow\" = [0.0, 1.0]\n");
  const trees::TreeModel model = trees::read_tree_model(folder.file("model.toml"));
  const std::vector<trees::FittedBody> bodies{
      {test::link(model, "weight"), {0.2, -0.3, 0.1, 0.4, 0.3, -0.2, 0.1, 0.5, -0.6, 0.7}}};
  const std::string text = trees::urdf_with_bodies(model, bodies);
  CHECK_THAT(text, Contains("link weight, mass: 0.25 -> "));
  // But for the comment and the weight's own numbers nothing is changed.
  std::string rest = text;
  const auto comment = rest.find("<!--\n  The robot with inertial");
  REQUIRE(comment != std::string::npos);
  rest.erase(comment, rest.find("-->\n", comment) + 4 - comment);
  const auto blank = [](std::string all) {
    const auto at = all.find("<link name=\"weight\">"), end = all.find("</link>", at);
    REQUIRE(end != std::string::npos);
    return all.erase(at, end - at);
  };
  CHECK(blank(rest) == blank(given));
  CHECK(rest != given);

  folder.write("identified.urdf", text);
  folder.write("identified_model.toml", trees::format_tree_model(model, "identified.urdf"));
  const trees::TreeModel back = trees::read_tree_model(folder.file("identified_model.toml"));
  const trees::Setup setup = trees::SetupMaker(model).make({model.drives, model.causes, bodies});
  for (std::size_t j = 0; j < model.joints(); ++j) {
    const auto a = back.robot.model.body(j), b = setup.model.body(j);
    const auto same = [](double value) { return Approx(value).epsilon(1e-12).margin(1e-15); };
    CHECK(a.mass_kg == same(b.mass_kg));
    CHECK(a.moment_kgm.x == same(b.moment_kgm.x));
    CHECK(a.moment_kgm.y == same(b.moment_kgm.y));
    CHECK(a.moment_kgm.z == same(b.moment_kgm.z));
    CHECK(a.inertia_kgm2.xx == same(b.inertia_kgm2.xx));
    CHECK(a.inertia_kgm2.xy == same(b.inertia_kgm2.xy));
    CHECK(a.inertia_kgm2.yz == same(b.inertia_kgm2.yz));
    CHECK(a.inertia_kgm2.zz == same(b.inertia_kgm2.zz));
  }
  REQUIRE(back.free_bodies.size() == 1);
  CHECK(back.is_free_body(test::link(back, "weight")));
  CHECK(back.free_bodies[0].lower == 0.5);
  CHECK(back.free_bodies[0].upper == 2.0);
  CHECK(back.free.size() == 1);
  // Bodies that are as given leave every number as it stands.
  const std::string unchanged = trees::urdf_with_bodies(model, {{test::link(model, "weight"), {}}});
  CHECK_THAT(unchanged, Contains("Nothing is changed.") && Contains("<mass value=\"0.25\"/>"));
}

TEST_CASE("Bounds of a link's inertial parameters are refused with the line and what was expected") {
  const std::string arm = "trees/robots/arm3.urdf", pendulum = "model/robots/double_pendulum.urdf";
  const auto free = [](const std::string& line) { return "[free]\n" + line + "\n"; };
  CHECK_THAT(refused(arm, free("\"inertial.for\" = [0.5, 2]")),
             Contains("robot.toml:6") && Contains("no link 'for'") && Contains("column, upper, fore") &&
                 Contains("did you mean 'fore'"));
  CHECK_THAT(refused(arm, free("\"inertial.base\" = [0.5, 2]")),
             Contains("robot.toml:6") && Contains("link 'base' does not move") &&
                 Contains("expected one of column, upper, fore"));
  CHECK_THAT(refused(pendulum, "joints = [\"elbow\"]\n" + free("\"inertial.upper\" = [0.5, 2]")),
             Contains("link 'upper' does not move") && Contains("expected one of lower, weight"));
  for (const char* const bounds : {"[0, 2]", "[2, 0.5]", "[0.5, 0.5]", "[1.1, 2]", "[0.2, 0.9]"}) {
    INFO(bounds);
    CHECK_THAT(
        refused(arm, free(std::string("\"inertial.fore\" = ") + bounds)),
        Contains("robot.toml:6") && Contains("expected 0 < lower < upper around 1") && Contains("0.9 kg"));
  }
  CHECK_THAT(refused(arm, free("\"inertial.fore\" = [-1, 2]")), Contains("lower bound"));
  CHECK_THAT(refused(arm, free("\"inertial.fore\" = 2")), Contains("expected two numbers, [lower, upper]"));
  CHECK_THAT(refused(arm, free("inertial = [0.5, 2]")), Contains("\"inertial.LINK\""));
  CHECK_THAT(refused(arm, free("\"inertial.fore\" = [0.5, 2]") + "[effect.mass_error.fore]\nmass_kg = 1.0\n"),
             Contains("robot.toml:7") && Contains("inertial.fore") && Contains("expected one of the two"));

  const test::Folder folder;
  // A sheet: two moments add up to the third.
  CHECK_THAT(refused_inertia(folder, R"(ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.003")"),
             Contains("model.toml:6") && Contains("'lower'") && Contains("a sheet, a rod or a point"));
}

TEST_CASE("A link without mass has no inertial parameters to fit") {
  const test::Folder folder;
  folder.write("robot.urdf",
               replaced(double_pendulum_text(), "<joint name=\"screws\"",
                        "<link name=\"tip\"/><joint name=\"end\" type=\"fixed\"><parent "
                        "link=\"lower\"/><child link=\"tip\"/></joint>\n  <joint name=\"screws\""));
  folder.write(
      "model.toml",
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n[free]\n\"inertial.tip\" = [0.5, 2]\n");
  CHECK_THAT(test::error_message([&] { trees::read_tree_model(folder.file("model.toml")); }),
             Contains("model.toml:6") && Contains("link 'tip' has no mass") &&
                 Contains("expected one of upper, lower, weight"));
}

TEST_CASE("A diagnosis fits free bodies beside the cause that it finds, and names no cause in them",
          "[slow]") {
  const trees::TreeModel model = test::arm3("[free]\n\"inertial.fore\" = [0.3, 3.0]\n");
  trees::TreeModel truth = heavier_fore(model);
  truth.causes = {{Effect::coulomb_friction, {test::joint(truth, "elbow")}, {0.3, 0, 0, 0}}};
  const Logs logs = logs_of(truth, 40);
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out);
  INFO(d.summary);
  REQUIRE(d.findings.size() == 1);
  CHECK(trees::cause_name(model, d.findings[0].cause) == "coulomb_friction@elbow");
  CHECK(d.findings[0].parameters[0].value == Approx(0.3).epsilon(0.1));
  for (const result::Candidate& c : d.candidates)
    for (const char* const effect :
         {"mass_error@fore", "com_error@fore", "inertia_error@fore", "payload@fore"})
      CHECK(label(c.causes) != effect);
  REQUIRE(d.parameters.size() == 10);
  CHECK(d.parameters[0].name == "mass_kg.fore");
  CHECK(d.parameters[0].baseline == 0.9);
  CHECK(d.parameters[0].extended.value == Approx(1.3).epsilon(0.02));
  CHECK(d.parameters[0].extended.lower < 1.3);
  CHECK(d.parameters[0].extended.upper > 1.3);
  CHECK(d.parameters[0].verdict == "identified");
  // The files for other programs have the fitted body.
  const trees::Setup setup = trees::SetupMaker(model).make(d.extended);
  const model::RobotTree back = model::tree_of(model::parse_urdf(trees::extended_urdf(d), "extended"));
  CHECK(back.model.body(2).mass_kg == Approx(setup.model.body(2).mass_kg).epsilon(1e-12));
  CHECK(back.model.body(2).mass_kg == Approx(d.parameters[0].extended.value).epsilon(1e-12));
  CHECK(back.model.laws[2].friction_nm == setup.model.laws[2].friction_nm);
  CHECK_THAT(trees::extended_mjcf(d), Contains("link fore: free inertial parameters, fitted"));
}
