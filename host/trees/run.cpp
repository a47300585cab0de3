// Trees in motion, see run.hpp.
#include "host/trees/run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "furcula/dynamics/tree/foothold.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/batch_runner.hpp"
#include "host/trees/rotor.hpp"

namespace furcula::trees {
namespace {

using dynamics::tree::Frame;
using dynamics::tree::Inertia;
using dynamics::tree::Sym3;
using dynamics::tree::Vec3;

/// Gravity in a base that is turned by `roll` about x and then by `pitch` about y: R' g with R = Ry Rx.
Vec3<double> tilted(const Vec3<double>& g, double roll, double pitch) {
  const double cr = std::cos(roll), sr = std::sin(roll), cp = std::cos(pitch), sp = std::sin(pitch);
  const Vec3<double> a{cp * g.x - sp * g.z, g.y, sp * g.x + cp * g.z};
  return {a.x, cr * a.y + sr * a.z, -sr * a.y + cr * a.z};
}

/// Dry friction as effects add up to it.
struct Friction {
  double forth, back, more_at_rest = 0.0;
};

}  // namespace

SetupMaker::SetupMaker(const TreeModel& model) : tree_(model) {
  for (std::size_t i = 0; i < model.robot.links.size(); ++i) {
    if (model.robot.links[i].joint >= 0 && model.urdf.links[i].inertia)
      bodies_.push_back(body(i, *model.urdf.links[i].inertia));
  }
}

SetupMaker::Body SetupMaker::body(std::size_t link, const model::UrdfInertia& inertia) const {
  const Frame<double> centre = within(tree_.robot.links[link].frame, inertia.frame);
  return {link, inertia.mass_kg, centre.at, turned_back(centre.turn, inertia.about_centre_kgm2)};
}

double neutral_value(const TreeModel& model, Effect effect, std::size_t parameter, std::size_t site) {
  constexpr double kAny = std::numeric_limits<double>::quiet_NaN();
  switch (effect) {
    case Effect::damping_error:
      return model.drives[site].damping_nmspr;
    case Effect::rotor_inertia_error:
      return model.drives[site].rotor_inertia_kgm2;
    case Effect::position_gain_error:
      return parameter == 0 ? model.drives[site].kp_nmprad : model.drives[site].kd_nmsprad;
    case Effect::mass_error:
      return model.urdf.links[site].inertia->mass_kg;
    case Effect::inertia_error:
    case Effect::torque_gain_error:
      return 1.0;
    case Effect::stribeck_friction:
      return parameter == 2 ? kAny : 0.0;
    case Effect::binding_spot:
    case Effect::torque_ripple:
    case Effect::payload:
      return parameter > 0 ? kAny : 0.0;
    case Effect::torque_saturation:
    case Effect::joint_elasticity:
      return kAny;
    case Effect::spring_rate_error:
      return model.springs[site].stiffness_nmprad;
    default:
      return 0.0;
  }
}

template <>
bool Setup::differs_by_torque(const Setup& other) const {
  if (!by_phase || foot.joint < 0) return true;
  if (extension_m != other.extension_m) return false;
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].encoder_offset_rad != other.joints[i].encoder_offset_rad) return false;
  return true;
}

Setup in_phase(const Setup& setup, const Recording& r, std::size_t row) {
  Setup out = setup;
  if (!setup.by_phase) return out;
  const Phase& phase = r.phase_at(row);
  if (phase.stance) out.model.foothold = setup.foot;
  for (std::size_t i = 0; i < setup.joints.size(); ++i) {
    Setup::Joint& j = out.joints[i];
    auto& law = out.model.laws[i];
    law.one_way_nmprad = j.switched && !phase.stance ? 0.0 : j.spring_nmprad;
    law.one_way_rest_rad = j.spring_rest_rad;
    if (j.switched && phase.stance)
      law.one_way_rest_rad += (j.latch_delay_s != 0.0 ? angle_after_touchdown(r, phase, i, j.latch_delay_s)
                                                      : phase.at_touchdown_rad[i]) -
                              j.encoder_offset_rad;
    if (!phase.stance) j.offset_nm -= j.flight_nm;
  }
  return out;
}

Setup SetupMaker::make(const Hypothesis& hypothesis) const {
  const auto& [drives, causes, fitted, inputs_late_rows] = hypothesis;
  Setup out;
  out.model = tree_.robot.model;
  out.joints.resize(tree_.joints());
  std::vector<Friction> friction;
  std::vector<double> kd(tree_.joints());
  for (std::size_t i = 0; i < tree_.joints(); ++i) {
    auto& law = out.model.laws[i];
    const Drive& d = drives[i];
    friction.push_back({law.friction_nm, law.friction_nm});
    law.armature_kgm2 = d.rotor_inertia_kgm2;
    law.damping_nmspr = d.damping_nmspr;
    Setup::Joint& j = out.joints[i];
    j.law = d.law;
    j.kp_nmprad = d.kp_nmprad;
    j.kd_nmsprad = d.kd_nmsprad;
    if (j.law != ControlMode::none) j.late_rows = inputs_late_rows;
    const Spring& s = tree_.springs[i];
    j.spring_nmprad = s.stiffness_nmprad;
    j.switched = s.switched;
    j.spring_rest_rad = s.switched ? 0.0 : s.rest_rad;
    j.both_ways = s.both_ways;
    out.by_phase |= s.stiffness_nmprad > 0.0 && !s.both_ways;
  }
  if (tree_.foot) {
    const auto& link = tree_.robot.links[tree_.foot->link];
    out.by_phase = true;
    out.foot = {link.joint, link.frame.point_back(tree_.foot->point_m)};
  }
  std::vector<Body> bodies;
  const auto body_of = [&](std::size_t link) -> Body& {
    if (bodies.empty()) bodies = bodies_;
    return *std::find_if(bodies.begin(), bodies.end(), [&](const Body& b) { return b.link == link; });
  };
  for (const FittedBody& f : fitted)
    body_of(f.link) = body(f.link, body_at(*tree_.urdf.links[f.link].inertia, f.at));
  std::vector<std::pair<std::size_t, Inertia<double>>> loads;
  for (const Cause& cause : causes)
    for (const std::size_t site : cause.sites) {
      const auto& v = cause.values;
      // Effects on other sites than joints do not touch these.
      const std::size_t joint = is_of_joints(info(cause.effect).location_type) ? site : 0;
      auto& law = out.model.laws[joint];
      Setup::Joint& drive = out.joints[joint];
      switch (cause.effect) {
        case Effect::coulomb_friction:
          friction[joint].forth += v[0];
          friction[joint].back += v[0];
          break;
        case Effect::stribeck_friction:
          friction[joint].forth += v[0];
          friction[joint].back += v[0];
          friction[joint].more_at_rest += std::max(0.0, v[1] - v[0]);
          law.stribeck_velocity_radps = v[2];
          break;
        case Effect::asymmetric_friction:
          friction[joint].forth += v[0];
          friction[joint].back += v[1];
          break;
        case Effect::quadratic_drag:
          law.drag_nms2prad2 += v[0];
          break;
        case Effect::binding_spot:
          law.binding_friction_nm = v[0];
          law.binding_centre_rad = v[1];
          law.binding_width_rad = v[2];
          break;
        case Effect::damping_error:
          law.damping_nmspr = v[0];
          break;
        case Effect::load_friction:
          law.load_friction_ratio = v[0];
          drive.stepwise |= drive.law == ControlMode::position && v[0] != 0.0;
          break;
        case Effect::force_offset:
          drive.offset_nm += v[0];
          break;
        case Effect::mass_error: {
          Body& b = body_of(site);
          const double ratio = v[0] / b.mass_kg;
          b.mass_kg = v[0];
          const Sym3<double>& s = b.about_centre_kgm2;
          b.about_centre_kgm2 = {s.xx * ratio, s.xy * ratio, s.xz * ratio,
                                 s.yy * ratio, s.yz * ratio, s.zz * ratio};
          break;
        }
        case Effect::com_error: {
          Body& b = body_of(site);
          b.centre_m += transposed_times(tree_.robot.links[site].frame.turn, Vec3<double>{v[0], v[1], v[2]});
          break;
        }
        case Effect::inertia_error: {
          Sym3<double>& s = body_of(site).about_centre_kgm2;
          s = {s.xx * v[0], s.xy * v[0], s.xz * v[0], s.yy * v[0], s.yz * v[0], s.zz * v[0]};
          break;
        }
        case Effect::payload:
          body_of(site);
          loads.emplace_back(
              static_cast<std::size_t>(tree_.robot.links[site].joint),
              dynamics::tree::inertia_of(
                  v[0], tree_.robot.links[site].frame.point_back(Vec3<double>{v[1], v[2], v[3]}),
                  Sym3<double>{}));
          break;
        case Effect::base_tilt:
          out.model.gravity_mps2 = tilted(out.model.gravity_mps2, v[0], v[1]);
          break;
        case Effect::rotor_inertia_error:
          law.armature_kgm2 = v[0];
          break;
        case Effect::torque_gain_error:
          drive.gain *= v[0];
          break;
        case Effect::position_gain_error:
          drive.kp_nmprad = v[0];
          drive.kd_nmsprad = v[1];
          break;
        case Effect::actuator_delay:
          drive.delay_s += v[0];
          break;
        case Effect::actuator_lag:
          drive.lag_s = v[0];
          drive.held_torque |= drive.law == ControlMode::position && v[0] > 0.0;
          break;
        case Effect::torque_saturation:
          drive.limit_nm = v[0];
          drive.stepwise |= drive.law == ControlMode::position;
          break;
        case Effect::torque_ripple:
          drive.ripple_nm = v[0];
          drive.ripple_cycles = v[1];
          drive.ripple_phase_rad = v[2];
          drive.stepwise |= v[0] != 0.0;
          break;
        case Effect::joint_elasticity:
          // A rotor without inertia is a spring in series, which has no state here.
          if (law.armature_kgm2 <= 0.0) break;
          law.elastic = true;
          law.rotor_damping_nmspr =
              law.damping_nmspr;  // bearings and seals of the drive are on the rotor's side
          law.damping_nmspr = 0.0;
          law.drive_stiffness_nmprad = v[0];
          drive.held_torque |= drive.law == ControlMode::position;
          break;
        case Effect::encoder_offset:
          drive.encoder_offset_rad += v[0];
          break;
        case Effect::time_skew:
          // By the angles' clock the drives' inputs come so much later.
          for (Setup::Joint& j : out.joints) j.delay_s += v[0];
          break;
        case Effect::spring_rate_error:
          drive.spring_nmprad = v[0];
          break;
        case Effect::latch_delay:
          drive.latch_delay_s += v[0];
          break;
        case Effect::latch_offset:
          drive.spring_rest_rad += v[0];
          break;
        case Effect::second_spring:
          drive.flight_nm += v[0];
          break;
        case Effect::length_error: {
          const int of_link = tree_.robot.links[site].joint;
          for (std::size_t i = 0; i < tree_.joints(); ++i)
            if (out.model.shape().parent(i) == of_link) out.model.extend(i, v[0]);
          out.extension_m.resize(tree_.joints());
          if (of_link >= 0) out.extension_m[static_cast<std::size_t>(of_link)] += v[0];
          if (out.foot.joint == of_link && of_link >= 0) {
            const double length = std::sqrt(dot(out.foot.at_m, out.foot.at_m));
            if (length > 0.0) out.foot.at_m = out.foot.at_m * (1.0 + v[0] / length);
          }
          break;
        }
      }
    }
  for (std::size_t i = 0; i < tree_.joints(); ++i) {
    auto& law = out.model.laws[i];
    law.friction_nm = friction[i].forth;
    law.asymmetric = friction[i].forth != friction[i].back;
    law.friction_back_nm = friction[i].back;
    law.static_friction_nm = friction[i].more_at_rest > 0.0
                                 ? std::max(friction[i].forth, friction[i].back) + friction[i].more_at_rest
                                 : 0.0;
    Setup::Joint& j = out.joints[i];
    if (j.both_ways) {
      law.one_way_nmprad = j.spring_nmprad;
      law.one_way_rest_rad = j.spring_rest_rad;
      law.two_sided = true;
    }
    j.stepwise |= j.held_torque;
    if (j.law == ControlMode::position && drives[i].loop_rate_hz > 0.0) {
      // Calculated from what was measured at the loop's last tick, half a period ago in the mean: to first order in that, kp (c - q) - kd v has
      // kp v and kd a times half a period more.
      const double half_s = 0.5 / drives[i].loop_rate_hz;
      law.damping_nmspr -= j.gain * j.kp_nmprad * half_s;
      law.armature_kgm2 -= j.gain * j.kd_nmsprad * half_s;
    }
    if (!Runner::is_spring(j)) continue;
    // The drive's position law is a spring to the set point and a damper; between rows both act as they are.
    law.stiffness_nmprad += j.gain * j.kp_nmprad;
    law.damping_nmspr += j.gain * j.kd_nmsprad;
  }
  if (!bodies.empty()) {
    std::vector<Inertia<double>> sum(tree_.joints());
    for (const Body& b : bodies) {
      Inertia<double>& s = sum[static_cast<std::size_t>(tree_.robot.links[b.link].joint)];
      s = s + dynamics::tree::inertia_of(b.mass_kg, b.centre_m, b.about_centre_kgm2);
    }
    for (const auto& [joint, load] : loads) sum[joint] = sum[joint] + load;
    for (std::size_t i = 0; i < sum.size(); ++i) out.model.set_body(i, sum[i]);
  }
  return out;
}

void Runner::reset(std::span<const double> angle_rad, std::span<const double> velocity_radps) {
  Plant::Joints q{}, v{};
  for (std::size_t i = 0; i < setup_.joints.size(); ++i) {
    q[i] = angle_rad[i] - setup_.joints[i].encoder_offset_rad;
    v[i] = velocity_radps[i];
  }
  if (setup_.model.foothold.joint >= 0) follow(q, v);
  start(q, v);
}

void Runner::follow(const Plant::Joints& q, Plant::Joints& v) const {
  const auto point = point_motion(setup_.model, setup_.model.foothold, q, v);
  std::vector<std::size_t> led;
  for (std::size_t i = 0; i < setup_.joints.size(); ++i)
    if (setup_.joints[i].law == ControlMode::none) led.push_back(i);
  if (led.empty()) return;
  Eigen::MatrixXd by(3, static_cast<Eigen::Index>(led.size()));
  for (std::size_t k = 0; k < led.size(); ++k) {
    const auto& c = point.by_joint[led[k]];
    by.col(static_cast<Eigen::Index>(k)) << c.x, c.y, c.z;
    v[led[k]] = 0.0;
  }
  const auto left = point.times(v, setup_.joints.size());
  const Eigen::VectorXd rates =
      linear::least_norm(by, Eigen::Vector3d(-Eigen::Vector3d(left.x, left.y, left.z)));
  for (std::size_t k = 0; k < led.size(); ++k) v[led[k]] = rates(static_cast<Eigen::Index>(k));
}

double input_in_force(const Setup::Joint& drive, const Recording& r, std::size_t joint, std::size_t row) {
  const std::vector<double>& input = r.input[joint];
  const double a = drive.late_rows;
  if (a > 0.0 && row > 0) return (1.0 - a) * input[row] + a * input[row - 1];
  if (a < 0.0 && row + 1 < r.rows()) return (1.0 + a) * input[row] - a * input[row + 1];
  return input[row];
}

std::size_t row_in_force(const Setup::Joint& j, const Recording& r, std::size_t first) {
  std::size_t k = first;
  while (k > 0 && r.time_s[k] + j.delay_s > r.time_s[first]) --k;
  // Where the clocks are apart, inputs may stand later in the log than what they do.
  if (j.delay_s < 0.0)
    while (k + 1 < r.rows() && r.time_s[k + 1] + j.delay_s <= r.time_s[first]) ++k;
  return k;
}

double lagged_before(const Setup::Joint& j, const Recording& r, std::size_t joint, std::size_t first) {
  const std::size_t k = row_in_force(j, r, first);
  std::size_t from = k;
  while (from > 0 && r.time_s[k] - r.time_s[from] < 6.0 * j.lag_s) --from;
  const auto asked = [&](std::size_t b) {
    return asked_torque(j, input_in_force(j, r, joint, b), r.angle_rad[joint][b],
                        velocity_about(r, joint, b));
  };
  double out = asked(from);
  const auto pass = [&](std::size_t b, double dt) {
    const double in = asked(b);
    out = in + (out - in) * std::exp(-dt / j.lag_s);
  };
  for (std::size_t b = from; b < k; ++b) pass(b, r.time_s[b + 1] - r.time_s[b]);
  pass(k, std::max(0.0, r.time_s[first] - r.time_s[k] - j.delay_s));
  return out;
}

void Runner::reset(const Recording& r, std::size_t first, std::span<const double> angle_rad,
                   std::span<const double> velocity_radps, std::span<const double> rotor_more) {
  reset(angle_rad, velocity_radps);
  const std::size_t n = setup_.joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Setup::Joint& j = setup_.joints[i];
    if (j.lag_s > 0.0) settle_input(i, lagged_before(j, r, i, first));
    if (!setup_.model.laws[i].elastic) continue;
    const Rotor rotor = Rotor::at(setup_, r, i, first);
    const bool more = !rotor_more.empty();
    place_rotor(i, rotor.angle_rad() + (more ? rotor_more[i] : 0.0),
                rotor.rate_radps() + (more ? rotor_more[n + i] : 0.0));
  }
}

namespace {

/// From row to row of the recording, with the delays of `setup`: calls `advance(rows, dt_s)` with the rows whose inputs are in force, and
/// `at_row(k)` in each row after the first.
template <class Advance, class F>
void follow_rows(const Setup& setup, const Recording& r, std::size_t first, std::size_t last,
                 const Advance& advance, const F& at_row) {
  const std::size_t n = setup.joints.size();
  std::vector<std::size_t> row(n);
  bool delayed = false;
  for (std::size_t i = 0; i < n; ++i) {
    delayed |= setup.joints[i].delay_s != 0.0;
    row[i] = row_in_force(setup.joints[i], r, first);
  }
  for (std::size_t k = first; k < last; ++k) {
    double now = r.time_s[k];
    const double end = r.time_s[k + 1];
    while (now < end) {
      double until = end;
      for (std::size_t i = 0; i < n; ++i) {
        if (!delayed) {
          row[i] = k;
        } else {
          const double delay = setup.joints[i].delay_s;
          while (row[i] + 1 < r.rows() && r.time_s[row[i] + 1] + delay <= now + 1e-12) ++row[i];
          if (row[i] + 1 < r.rows()) until = std::min(until, r.time_s[row[i] + 1] + delay);
        }
      }
      if (end - until < 1e-9) until = end;
      advance(row, until - now);
      now = until;
    }
    at_row(k + 1);
  }
}

}  // namespace

std::size_t run(std::span<const Run> runs, const Recording& r, std::size_t first, std::size_t last,
                std::span<double> out) {
  std::vector<Setup> setups;
  setups.reserve(runs.size());
  for (const Run& one : runs) {
    Setup& s = setups.emplace_back(in_phase(*one.setup, r, first));
    for (std::size_t i = 0; i < one.rest_more_rad.size(); ++i)
      s.model.laws[i].one_way_rest_rad += one.rest_more_rad[i];
  }
  const std::size_t n = setups.front().joints.size(), size = (last - first + 1) * n;
  std::vector<std::size_t> alone, beside;
  for (std::size_t k = 1; k < runs.size(); ++k)
    (BatchRunner::fits(setups[0], setups[k]) ? beside : alone).push_back(k);
  std::size_t steps = 0;
  std::vector<double> input(n);
  const auto with_inputs = [&](const Setup& s, auto& runner) {
    return [&](const std::vector<std::size_t>& row, double dt_s) {
      for (std::size_t i = 0; i < n; ++i) input[i] = input_in_force(s.joints[i], r, i, row[i]);
      runner.advance(input, dt_s);
    };
  };
  // Of few runs each is quicker by itself than all lanes.
  constexpr std::size_t kLeast = 2;
  if (beside.size() < kLeast) {
    alone.insert(alone.end(), beside.begin(), beside.end());
    beside.clear();
    alone.push_back(0);
  }
  for (const std::size_t k : alone) {
    Runner runner(setups[k]);
    runner.reset(r, first, runs[k].angle_rad, runs[k].velocity_radps, runs[k].rotor_more);
    const auto read = [&](std::size_t row) {
      for (std::size_t i = 0; i < n; ++i) out[k * size + (row - first) * n + i] = runner.measured(i);
    };
    read(first);
    follow_rows(setups[k], r, first, last, with_inputs(setups[k], runner), read);
    steps += runner.steps();
  }
  for (std::size_t from = 0; from < beside.size(); from += BatchRunner::kLanes - 1) {
    std::vector<std::size_t> of_lane{0};
    for (std::size_t k = from; k < std::min(beside.size(), from + BatchRunner::kLanes - 1); ++k)
      of_lane.push_back(beside[k]);
    std::vector<const Setup*> of_lanes;
    std::vector<Runner::Place> starts;
    for (const std::size_t k : of_lane) {
      of_lanes.push_back(&setups[k]);
      Runner start(setups[k]);
      start.reset(r, first, runs[k].angle_rad, runs[k].velocity_radps, runs[k].rotor_more);
      starts.push_back(start.place());
    }
    BatchRunner runner(of_lanes, starts);
    const auto read = [&](std::size_t row) {
      for (std::size_t lane = 0; lane < of_lane.size(); ++lane)
        for (std::size_t i = 0; i < n; ++i)
          out[of_lane[lane] * size + (row - first) * n + i] = runner.measured(lane, i);
    };
    read(first);
    const bool same = std::all_of(of_lanes.begin(), of_lanes.end(), [&](const Setup* s) {
      for (std::size_t i = 0; i < n; ++i)
        if (s->joints[i].late_rows != setups[0].joints[i].late_rows) return false;
      return true;
    });
    std::vector<double> of_each(of_lane.size() * n);
    const auto each = [&](const std::vector<std::size_t>& row, double dt_s) {
      for (std::size_t lane = 0; lane < of_lane.size(); ++lane)
        for (std::size_t i = 0; i < n; ++i)
          of_each[lane * n + i] = input_in_force(of_lanes[lane]->joints[i], r, i, row[i]);
      runner.advance_each(of_each, dt_s);
    };
    if (same)
      follow_rows(setups[0], r, first, last, with_inputs(setups[0], runner), read);
    else
      follow_rows(setups[0], r, first, last, each, read);
    steps += runner.steps();
  }
  return steps;
}

std::size_t run(const Setup& setup, const Recording& r, std::size_t first, std::size_t last,
                std::span<const double> angle_rad, std::span<const double> velocity_radps,
                std::span<double> measured) {
  const Run one{.setup = &setup, .angle_rad = angle_rad, .velocity_radps = velocity_radps};
  return run(std::span(&one, 1), r, first, last, measured);
}

}  // namespace furcula::trees

template class furcula::trees::RunnerOf<double, furcula::model::RobotShape>;
template class furcula::dynamics::tree::Plant<double, furcula::model::RobotShape>;
template void furcula::dynamics::tree::forward_dynamics(
    const furcula::model::RobotModel&, const furcula::model::RobotModel::Joints&,
    const furcula::model::RobotModel::Joints&, const furcula::model::RobotModel::Joints&,
    const furcula::model::RobotModel::Flags&,
    furcula::dynamics::tree::Accelerations<furcula::model::RobotModel>&);
