// The arm swings as two sines; what is simulated lags behind by little.
#include "tests/host/report/tree_sample.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "host/report/diagnosis_report.hpp"
#include "host/trees/result.hpp"

namespace furcula::test {
namespace {

constexpr const char* kRobot = R"(<?xml version="1.0"?>
<robot name="arm of two">
  <link name="base"/>
  <link name="upper arm">
    <inertial><origin xyz="0 0 -0.15" rpy="0 0 0.3"/><mass value="1.2"/>
      <inertia ixx="0.0101" ixy="0" ixz="0" iyy="0.0098" iyz="0" izz="0.0011"/></inertial>
  </link>
  <link name="forearm">
    <inertial><origin xyz="0.1 0 0" rpy="0 0 0"/><mass value="0.6"/>
      <inertia ixx="0.0004" ixy="0" ixz="0" iyy="0.0031" iyz="0" izz="0.003"/></inertial>
  </link>
  <link name="tool"/>
  <joint name="&lt;b&gt;&amp;&quot;x" type="revolute">
    <parent link="base"/><child link="upper arm"/><origin xyz="0 0 0.6" rpy="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="10"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper arm"/><child link="forearm"/><origin xyz="0 0.05 -0.3" rpy="0 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="20" velocity="10"/>
  </joint>
  <joint name="flange" type="fixed"><parent link="forearm"/><child link="tool"/><origin xyz="0.25 0 0"/></joint>
</robot>
)";

constexpr double kFriction_nm = 0.31;

}  // namespace

trees::Diagnosis sample_tree_diagnosis() {
  using trees::Effect;
  trees::Diagnosis d;
  d.model.file = "arm.toml";
  d.model.urdf_path = "arm.urdf";
  d.model.urdf = model::parse_urdf(kRobot, "arm.urdf");
  d.model.robot = model::tree_of(d.model.urdf);
  d.model.drives.resize(2);
  d.refitted.drives = d.extended.drives = d.model.drives;
  std::size_t forearm = 0;
  while (d.model.robot.links[forearm].name != "forearm") ++forearm;
  d.extended.causes = {{Effect::coulomb_friction, {1}, {kFriction_nm}},
                       {Effect::payload, {forearm}, {0.2, 0.22, 0.0, 0.03}}};
  d.verdict = trees::Verdict::explained;
  d.summary = "The model lacks dry friction at elbow and a payload on forearm";
  d.logs = 8;
  d.held_out_logs = 2;
  d.samples = 16000;
  d.windows = 240;
  d.training_files = {"log-00.csv", "log-01.csv", "log-02.csv"};
  d.held_out_files = {"log-06.csv", "log-07.csv"};
  d.as_given_error = {{0.21, 0.02, 0.031}, {0.84, 0.05, 0.072}};
  d.refitted_error = {{0.11, 0.01, 0.022}, {0.61, 0.04, 0.058}};
  d.extended_error = {{0.0006, 0.001, 0.0016}, {0.0021, 0.002, 0.0034}};
  d.noise_floor = {0.0004, 0.0015};

  trees::Finding friction;
  friction.cause = d.extended.causes[0];
  friction.at = {"elbow"};
  friction.parameters = {{"torque_nm", "N m", kFriction_nm, 0.295, 0.325}};
  friction.explainable_removed = 0.72;
  friction.without = {{0.001, 0.001, 0.002}, {0.44, 0.03, 0.049}};
  friction.confidence = 0.98;
  const auto cause = [](const char* effect, const char* type, const char* location) {
    return result::Cause{effect, {}, type, {location}, {}};
  };
  friction.alternatives = {{{cause("damping_error", "joint", "elbow")}, {}, "leaves 31 % of the error"}};
  friction.alternatives[0].causes[0].parameters = {{"damping_nmspr", "N m s/rad", 0.2, 0.15, 0.25}};
  friction.next_experiment = "Slow strokes of elbow alone.";
  trees::Finding payload;
  payload.cause = d.extended.causes[1];
  payload.at = {"forearm"};
  payload.parameters = {{"mass_kg", "kg", 0.2, 0.19, 0.21},
                        {"x_m", "m", 0.22, 0.2, 0.24},
                        {"y_m", "m", 0.0, -0.01, 0.01},
                        {"z_m", "m", 0.03, 0.01, 0.05}};
  payload.explainable_removed = 0.24;
  payload.without = {{0.09, 0.01, 0.02}, {0.2, 0.02, 0.033}};
  payload.confidence = 0.93;
  payload.indistinguishable_from = {
      {{cause("mass_error", "link", "forearm"), cause("com_error", "link", "forearm")},
       {},
       "the same first moment on these recordings"}};
  d.findings = {friction, payload};
  d.next_experiment = "Hold the arm in postures all around: gravity tells the payload's place.";
  d.unexplained_share = 0.013;
  const auto tried = [&d](result::Cause c, double gain, bool chosen) {
    d.candidates.emplace_back();
    d.candidates.back().causes = {std::move(c)};
    d.candidates.back().score_test_gain = gain;
    d.candidates.back().chosen = chosen;
  };
  tried(cause("coulomb_friction", "joint", "elbow"), 0.812, true);
  tried(cause("payload", "link", "forearm"), 0.24, true);
  tried(cause("damping_error", "joint", "elbow"), 0.53, false);
  tried(cause("torque_ripple", "drive", kHostileJoint), 0.003, false);
  d.parameters = {{"rotor_inertia_kgm2.elbow",
                   "kg m^2",
                   {},
                   true,
                   0.01,
                   {"", "", 0.019, 0.015, 0.022},
                   {"", "", 0.0121, 0.0119, 0.0124},
                   "free"}};
  d.base_parameters = {
      {"mz(upper arm) - 0.3 m(forearm)", "kg m", -0.36, -0.42, 0.011, 0, 1.31, true},
      {"Iyy(forearm)", "kg m^2", 0.0091, 0.0193, std::numeric_limits<double>::infinity(), 1, 0.021, false}};

  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  const auto angle = [](std::size_t joint, double t) {
    return joint == 0 ? 0.8 * std::sin(1.9 * t) : 0.5 + 1.1 * std::sin(3.1 * t + 0.4);
  };
  d.missing.resize(2);
  for (std::size_t log = 0; log < 2; ++log) {
    trees::Motion motion;
    motion.log = d.held_out_files[log];
    motion.measured.resize(2);
    motion.simulated.resize(2);
    for (int k = 0; k < 1000; ++k) {
      const double t = 0.004 * k;
      motion.time_s.push_back(t);
      for (std::size_t j = 0; j < 2; ++j) {
        const double q = angle(j, t + static_cast<double>(log)),
                     before = angle(j, t + static_cast<double>(log) - 1e-3);
        const double v = (q - before) / 1e-3;
        motion.measured[j].push_back(q);
        motion.simulated[j].push_back(q + 0.02 * std::sin(7.0 * t));
        trees::MissingTorque& m = d.missing[j];
        const double rest = noise(random);
        m.recording.push_back(log);
        m.time_s.push_back(t);
        m.angle_rad.push_back(q);
        m.velocity_radps.push_back(v);
        m.after_nm.push_back(rest);
        m.before_nm.push_back(rest + (j == 1 ? std::copysign(kFriction_nm, v) : 0.1 * std::sin(q)));
      }
    }
    for (std::size_t j = 0; j < 2; ++j) {
      trees::Trace trace{motion.log,
                         "angle_" + d.model.robot.joints[j].name,
                         "rad",
                         motion.time_s,
                         motion.measured[j],
                         {},
                         {},
                         motion.simulated[j]};
      for (std::size_t k = 0; k < trace.measured.size(); ++k) {
        trace.as_given.push_back(trace.measured[k] + 0.07 * std::sin(5.0 * trace.time_s[k]));
        trace.refitted.push_back(trace.measured[k] + 0.05 * std::sin(4.0 * trace.time_s[k]));
      }
      d.traces.push_back(std::move(trace));
    }
    d.motions.push_back(std::move(motion));
  }
  for (std::size_t j = 0; j < 2; ++j) {
    d.missing[j].rms_before_nm = j == 1 ? kFriction_nm : 0.08;
    d.missing[j].rms_after_nm = 0.02;
    d.missing[j].rms_torque_nm = 2.4;
    d.missing[j].predictable_before = 0.95;
    d.missing[j].predictable_after = 0.01;
  }
  d.missing[1].correlated_with = "velocity_elbow";
  return d;
}

std::string page_of(const trees::Diagnosis& d, const std::string& command) {
  return report::render_report(trees::result_of(d), command, report::robot_picture(d));
}

}  // namespace furcula::test
