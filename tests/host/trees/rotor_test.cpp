// Rotors of elastic drives along a recording, against the plant that made it.
#include "host/trees/rotor.hpp"

#include <cmath>

#include "host/trees/hypothesis.hpp"
#include "host/trees/linearised.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Cause;
using trees::Effect;

namespace {

struct Made {
  trees::Recording recording;
  std::vector<std::vector<double>> rotor_rad, rotor_radps;  ///< of each joint
  std::vector<std::vector<double>> velocity_radps;
};

/// The robot from rest on square waves of torque, of a lag and a gain at one drive.
Made made(const trees::TreeModel& model, const trees::Setup& setup, double interval_s) {
  Made out{test::inputs(model, 2.0, interval_s,
                        [](std::size_t j, double t) {
                          return (j == 1 ? 1.5 : 0.5) *
                                 (std::sin((4.0 + static_cast<double>(j)) * t) > 0.0 ? 1.0 : -1.0);
                        }),
           std::vector<std::vector<double>>(model.joints()), std::vector<std::vector<double>>(model.joints()),
           std::vector<std::vector<double>>(model.joints())};
  const std::vector<double> zero(model.joints(), 0.0);
  trees::Runner runner(setup);
  runner.reset(zero, zero);
  trees::Recording& r = out.recording;
  for (std::size_t k = 0; k < r.rows(); ++k) {
    std::vector<double> input;
    for (std::size_t j = 0; j < model.joints(); ++j) {
      r.angle_rad[j][k] = runner.measured(j);
      out.rotor_rad[j].push_back(runner.place().plant.rotor_rad[j]);
      out.rotor_radps[j].push_back(runner.place().plant.rotor_radps[j]);
      out.velocity_radps[j].push_back(runner.velocity(j));
      input.push_back(r.input[j][k]);
    }
    if (k + 1 < r.rows()) runner.advance(input, interval_s);
  }
  return out;
}

constexpr double kStiffness_nmprad = 60.0;
const std::vector<Cause> kSpring{{Effect::joint_elasticity, {1}, {kStiffness_nmprad, 0, 0, 0}}};

trees::TreeModel arm() {
  return test::arm3("[drive]\ncontrol_mode = \"torque\"\nrotor_inertia_kgm2 = 0.02\ndamping_nmspr = 0.2\n");
}

}  // namespace

TEST_CASE("The rotor of an elastic drive is found along a recording of its joint") {
  const trees::TreeModel model = arm();
  const trees::Setup setup = trees::SetupMaker(model).make({model.drives, kSpring});
  const Made m = made(model, setup, 0.002);
  double rings = 0.0;
  for (std::size_t k = 0; k < m.recording.rows(); ++k)
    rings = std::max(rings, std::abs(m.rotor_rad[1][k] - m.recording.angle_rad[1][k]));
  REQUIRE(rings > 0.02);
  for (const std::size_t row : {0U, 100U, 500U, 900U}) {
    INFO(row);
    const trees::Rotor rotor = trees::Rotor::at(setup, m.recording, 1, row);
    // At its very start nobody knows that the spring was relaxed.
    if (row == 0U)
      CHECK(rotor.angle_rad() - m.recording.angle_rad[1][0] ==
            Approx(m.recording.input[1][0] / kStiffness_nmprad).margin(1e-3));
    if (row < 500U) continue;
    CHECK(rotor.angle_rad() == Approx(m.rotor_rad[1][row]).margin(0.02 * rings));
    CHECK(rotor.rate_radps() ==
          Approx(m.rotor_radps[1][row]).margin(0.02 * rings * std::sqrt(kStiffness_nmprad / 0.02)));
  }
}

TEST_CASE("A window within the ringing of an elastic drive goes on with it") {
  const trees::TreeModel model = arm();
  const trees::SetupMaker maker(model);
  const trees::Setup soft = maker.make({model.drives, kSpring}), stiff = maker.make({model.drives, {}});
  const Made m = made(model, soft, 0.002);
  const std::vector<trees::Recording> all{m.recording};
  trees::Window w = trees::windows_of(model, all, 0.3)[4];
  for (std::size_t j = 0; j < model.joints(); ++j) {
    w.angle_rad[j] = m.recording.angle_rad[j][w.first];
    w.velocity_radps[j] = m.velocity_radps[j][w.first];
  }
  const std::size_t n = model.joints(), rows = w.last - w.first + 1;
  const auto off = [&](const trees::Setup& setup) {
    std::vector<double> out(rows * n);
    trees::run(setup, m.recording, w.first, w.last, w.angle_rad, w.velocity_radps, out);
    double most = 0.0;
    for (std::size_t k = 0; k < rows; ++k)
      for (std::size_t j = 0; j < n; ++j)
        most = std::max(most, std::abs(out[k * n + j] - m.recording.angle_rad[j][w.first + k]));
    return most;
  };
  CHECK(off(soft) < 0.05 * off(stiff));

  // And what the linear problem makes of the spring is what the stiff model lacks.
  std::vector<double> out(rows * n);
  trees::run(stiff, m.recording, w.first, w.last, w.angle_rad, w.velocity_radps, out);
  Eigen::VectorXd missing = w.measured;
  std::vector<double> count(static_cast<std::size_t>(w.measured.size()) / n);
  for (const std::size_t b : w.bin) count[b] += 1.0;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t j = 0; j < n; ++j)
      missing(static_cast<Eigen::Index>(w.bin[k] * n + j)) -= out[k * n + j] / count[w.bin[k]];
  const std::vector<double> torque_nm(n, 1e-3);
  const trees::Setup* const others[] = {&soft};
  const Eigen::VectorXd linear = trees::Linearised(stiff, m.recording, w, torque_nm).changes(others).col(0);
  CHECK((linear - missing).norm() < 0.1 * missing.norm());
}
