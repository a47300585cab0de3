// Windows made linear, against runs of the tree with a little of each cause.
#include "host/trees/linearised.hpp"

#include <cmath>

#include "host/trees/batch_runner.hpp"
#include "host/trees/hypothesis.hpp"
#include "tests/folder.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Cause;
using trees::Effect;

namespace {

/// The window's change by a run with the causes, less one without: bins of rows as the window says.
Eigen::VectorXd simulated(const trees::Setup& setup, const trees::Recording& r, const trees::Window& w) {
  const std::size_t n = setup.joints.size(), rows = w.last - w.first + 1;
  std::vector<double> out(rows * n);
  trees::run(setup, r, w.first, w.last, w.angle_rad, w.velocity_radps, out);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(w.measured.size());
  std::vector<double> count(static_cast<std::size_t>(w.measured.size()) / n);
  for (const std::size_t b : w.bin) count[b] += 1.0;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t j = 0; j < n; ++j)
      mean(static_cast<Eigen::Index>(w.bin[k] * n + j)) += out[k * n + j] / count[w.bin[k]];
  return mean;
}

/// How far the linear change is from that of the runs, of its size.
double off(const trees::TreeModel& model, const trees::Recording& r, const trees::Window& w,
           const std::vector<Cause>& as_run, const std::vector<Cause>& with, double late_rows = 0.0,
           double later_rows = 0.0) {
  const trees::SetupMaker maker(model);
  const trees::Setup base = maker.make({model.drives, as_run, {}, late_rows}),
                     other = maker.make({model.drives, with, {}, late_rows + later_rows});
  const Eigen::VectorXd runs = simulated(other, r, w) - simulated(base, r, w);
  const std::vector<double> torque_nm(model.joints(), 1e-3);
  const trees::Setup* const others[] = {&other};
  const Eigen::VectorXd linear = trees::Linearised(base, r, w, torque_nm).changes(others).col(0);
  REQUIRE(runs.norm() > 1e-7);
  return (linear - runs).norm() / runs.norm();
}

struct Case {
  std::string law;
  double amplitude;
  std::vector<Cause> as_run;
  double within = 0.05;
};

}  // namespace

TEST_CASE("A tree of more joints than lanes carry is made linear all the same") {
  std::string urdf = "<robot name=\"chain\"><link name=\"base\"/>";
  const std::size_t joints = trees::BatchRunner::kMostJoints + 1;
  for (std::size_t i = 0; i < joints; ++i) {
    const std::string k = std::to_string(i);
    urdf +=
        "<link name=\"l" + k +
        "\"><inertial><origin xyz=\"0 0 0.1\"/><mass value=\"0.5\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" "
        "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link><joint name=\"j" +
        k + "\" type=\"continuous\"><parent link=\"" + (i == 0 ? "base" : "l" + std::to_string(i - 1)) +
        "\"/><child link=\"l" + k + "\"/><origin xyz=\"0 0 0.2\"/><axis xyz=\"" +
        (i % 2 == 0 ? "1 0 0" : "0 1 0") + "\"/></joint>";
  }
  const test::Folder folder;
  folder.write("robot.urdf", urdf + "</robot>");
  const trees::TreeModel model = trees::parse_tree_model(
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n[drive]\ncontrol_mode = \"torque\"\n",
      folder.file("robot.toml"));
  const std::vector<trees::Recording> all{
      test::inputs(model, 1.0, 0.004, [](std::size_t, double t) { return 0.1 * std::sin(9.0 * t); })};
  trees::Window w = trees::windows_of(model, all, 0.2)[1];
  CHECK(off(model, all[0], w, {}, {{Effect::force_offset, {3}, {0.001, 0, 0, 0}}}) < 0.05);
  CHECK(off(model, all[0], w, {}, {{Effect::torque_gain_error, {12}, {1.01, 0, 0, 0}}}) < 0.05);
}

TEST_CASE("A window made linear changes with inputs that are late by part of a row") {
  const trees::TreeModel model = test::arm3("[drive]\ncontrol_mode = \"torque\"\n");
  const std::vector<trees::Recording> all{test::inputs(model, 1.5, 0.01, [](std::size_t j, double t) {
    return 0.8 * std::sin((5.0 + 2.0 * static_cast<double>(j)) * t);
  })};
  trees::Window w = trees::windows_of(model, all, 0.4)[1];
  w.angle_rad = {0.2, -0.3, 0.4};
  w.velocity_radps = {1.0, 2.0, -3.0};
  for (const double late_rows : {-0.5, 0.0, 0.4}) {
    INFO(late_rows);
    CHECK(off(model, all[0], w, {}, {}, late_rows, 0.02) < 0.05);
    CHECK(off(model, all[0], w, {}, {{Effect::torque_gain_error, {1}, {1.01, 0, 0, 0}}}, late_rows) < 0.05);
  }
}

TEST_CASE("A window made linear changes with each cause as its runs do") {
  const Case cases[] = {
      {"[drive]\ncontrol_mode = \"torque\"\n", 0.8, {}},
      {"[drive]\ncontrol_mode = \"torque\"\n", 0.8, {{Effect::coulomb_friction, {0, 1, 2}, {0.1, 0, 0, 0}}}},
      {"[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 20.0\nkd_nmsprad = 0.5\n", 0.6, {}},
      {"[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 20.0\nkd_nmsprad = 0.5\n",
       0.6,
       {{Effect::actuator_lag, {1}, {0.02, 0, 0, 0}}, {Effect::coulomb_friction, {2}, {0.1, 0, 0, 0}}}},
      {"[drive]\ncontrol_mode = \"torque\"\nrotor_inertia_kgm2 = 0.01\n",
       0.8,
       {{Effect::joint_elasticity, {1}, {200.0, 0, 0, 0}}},
       // What acts at the joint is taken as acting at the drive, and its spring rings here.
       0.3}};

  for (const double interval_s : {0.001, 0.01})
    for (const Case& c : cases) {
      const trees::TreeModel model = test::arm3(c.law);
      trees::Recording r = test::inputs(model, 1.5, interval_s, [&](std::size_t j, double t) {
        return c.amplitude * std::sin((5.0 + 2.0 * static_cast<double>(j)) * t);
      });
      const std::vector<trees::Recording> all{r};
      trees::Window w = trees::windows_of(model, all, 0.4)[1];
      w.angle_rad = {0.2, -0.3, 0.4};
      w.velocity_radps = {1.0, 2.0, -3.0};
      const bool position = model.drives[0].law == trees::ControlMode::position;
      std::vector<Cause> tried{{Effect::damping_error, {0}, {0.11, 0, 0, 0}},
                               {Effect::force_offset, {2}, {0.01, 0, 0, 0}},
                               {Effect::quadratic_drag, {1}, {0.001, 0, 0, 0}},
                               {Effect::rotor_inertia_error, {0}, {0.0005, 0, 0, 0}},
                               {Effect::torque_gain_error, {1}, {1.01, 0, 0, 0}},
                               {Effect::encoder_offset, {1}, {0.002, 0, 0, 0}},
                               {Effect::base_tilt, {0}, {0.004, 0.003, 0, 0}},
                               {Effect::actuator_delay, {2}, {0.002, 0, 0, 0}},
                               {Effect::actuator_lag, {0}, {0.002, 0, 0, 0}},
                               {Effect::time_skew, {0}, {0.002, 0, 0, 0}},
                               {Effect::time_skew, {0}, {-0.002, 0, 0, 0}}};
      for (const std::size_t link : trees::sites(model, trees::LocationType::link)) {
        const double mass = model.urdf.links[link].inertia->mass_kg;
        tried.push_back({Effect::mass_error, {link}, {1.01 * mass, 0, 0, 0}});
        tried.push_back({Effect::com_error, {link}, {0.001, 0.002, 0.001, 0}});
        tried.push_back({Effect::inertia_error, {link}, {1.02, 0, 0, 0}});
        tried.push_back({Effect::payload, {link}, {0.01 * mass, 0.05, 0.05, 0.1}});
      }
      if (position) tried.push_back({Effect::position_gain_error, {0}, {20.2, 0.505, 0, 0}});
      // With a position law a run takes steps of its own for these, which alone change as much.
      // Behind a spring the load is the spring's.
      const bool elastic = !c.as_run.empty() && c.as_run.front().effect == Effect::joint_elasticity;
      if (!position && !elastic) tried.push_back({Effect::load_friction, {1}, {0.01, 0, 0, 0}});
      if (!position) tried.push_back({Effect::torque_ripple, {2}, {0.01, 5.0, 0.3, 0}});
      for (const Cause& cause : tried) {
        std::vector<Cause> with = c.as_run;
        with.push_back(cause);
        INFO(trees::cause_name(model, cause) << (position ? " position" : " torque") << " " << interval_s
                                             << " s, " << c.as_run.size() << " as run");
        CHECK(off(model, r, w, c.as_run, with) < c.within);
      }
    }
}

TEST_CASE("What the start of a rotor does to its joint is the swing of two bodies on a spring") {
  constexpr double kRotor_kgm2 = 0.02, kStiffness_nmprad = 20.0, kWheel_kgm2 = 0.5;
  const trees::TreeModel model =
      test::wheel("[drive]\ncontrol_mode = \"torque\"\nrotor_inertia_kgm2 = 0.02\ndamping_nmspr = 0\n");
  const trees::Recording r = test::inputs(model, 1.5, 0.001, [](std::size_t, double) { return 0.0; });
  const trees::SetupMaker maker(model);
  const std::vector<Cause> spring{{Effect::joint_elasticity, {0}, {kStiffness_nmprad, 0, 0, 0}}};
  const trees::Setup stiff = maker.make({model.drives, {}}), elastic = maker.make({model.drives, spring});
  const std::vector<trees::Recording> all{r};
  const trees::Window w = trees::windows_of(model, all, 0.4)[1];
  const trees::Setup* const setups[] = {&stiff, &elastic};
  const std::vector<double> torque_nm{1e-3};
  const Eigen::MatrixXd starts = trees::Linearised(stiff, r, w, torque_nm).rotor_starts(setups);
  REQUIRE(starts.cols() == 4);
  CHECK(starts.leftCols(2).norm() == 0.0);
  // The rotor swings about the joint that was measured; the joint, rotor and all, takes the reaction.
  const double omega = std::sqrt(kStiffness_nmprad / kRotor_kgm2),
               share = kRotor_kgm2 / (kRotor_kgm2 + kWheel_kgm2);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(w.measured.size(), 2);
  std::vector<double> count(static_cast<std::size_t>(w.measured.size()));
  for (const std::size_t b : w.bin) count[b] += 1.0;
  for (std::size_t k = w.first; k <= w.last; ++k) {
    const double t = r.time_s[k] - r.time_s[w.first];
    const auto b = static_cast<Eigen::Index>(w.bin[k - w.first]);
    const double n = count[w.bin[k - w.first]];
    expected(b, 0) += -share * (std::cos(omega * t) - 1.0) / n;
    expected(b, 1) += -share * (std::sin(omega * t) / omega - t) / n;
  }
  for (Eigen::Index k = 0; k < 2; ++k)
    CHECK((starts.col(2 + k) - expected.col(k)).norm() < 0.02 * expected.col(k).norm());
}
